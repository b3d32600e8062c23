"""Check a forecast: blind trials of the test on the study's own model, as it is and once the advice is followed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import pandas as pd

from acquisition.errors import ModalkitError
from modalkit.blind.answer import Answer
from modalkit.output.schemas.plan import BlindCase, CheckedForecast
from modalkit.planning.case import Case
from modalkit.planning.cases import choose
from modalkit.planning.forecast import Advice, Forecast
from modalkit.planning.separability import SEEN, SURE

_LEAST = SURE - 1e-6


@dataclass(frozen=True, eq=False)
class Tried:
    """One case, diagnosed.

    Parameters
    ----------
    case : Case
        What was hidden.
    followed : bool
        Whether the advice was followed.
    answer : Answer or None
        What was answered; None where the diagnosis failed.
    right : frozenset of str
        Names that are right.
    failure : str
        Why it failed.
    """

    case: Case
    followed: bool
    answer: Answer | None
    right: frozenset[str]
    failure: str = ""

    @property
    def sigma(self) -> float:
        """Forecast: distance to the nearest rival [-]."""
        return self.case.then if self.followed else self.case.now

    @property
    def named(self) -> bool:
        """Whether the effect alone was named."""
        answer = self.answer
        if answer is None or answer.verdict not in ("named", "class") or not answer.sets:
            return False
        return all(len(s) == 1 and s <= self.right for s in answer.sets)

    @property
    def kept(self) -> bool:
        """Whether the effect was named, or is in the class that was answered."""
        answer = self.answer
        if answer is None or answer.verdict not in ("named", "class"):
            return False
        return any(len(s) == 1 and s <= self.right for s in answer.sets)

    @property
    def answer_text(self) -> str:
        """The answer in words."""
        if self.answer is None:
            return f"failed: {self.failure}"
        if self.answer.verdict in ("none", "unknown"):
            return self.answer.verdict
        return " or ".join(" + ".join(sorted(s)) for s in self.answer.sets)

    @property
    def forecast(self) -> str:
        """The forecast in words."""
        rival = self.case.rival_then if self.followed else self.case.rival_now
        if self.sigma >= _LEAST:
            return "separated"
        return f"close to the limit from {rival}" if self.sigma >= SEEN else f"not separated from {rival}"

    def row(self) -> BlindCase:
        """Return a line of the table."""
        return {
            "effect": self.case.family.name,
            "severity": self.case.severity_text,
            "test": "advice followed" if self.followed else "as it is",
            "forecast": self.forecast,
            "sigma": self.sigma,
            "answered": self.answer_text,
            "right": "yes" if self.named else "in the class" if self.kept else "no",
        }


@dataclass(frozen=True, eq=False)
class Check:
    """Forecast and answers beside each other.

    Parameters
    ----------
    advice : Advice or None
        What was followed.
    tried : tuple of Tried
        As the test is, then with the advice followed.
    """

    advice: Advice | None
    tried: tuple[Tried, ...]

    @property
    def table(self) -> pd.DataFrame:
        """One line a trial."""
        return pd.DataFrame([one.row() for one in self.tried])

    @property
    def summary(self) -> tuple[str, ...]:
        """Counts in words."""
        lines = []
        for followed, words in ((False, "As the test is"), (True, "With the advice followed")):
            mine = [one for one in self.tried if one.followed == followed]
            if mine:
                lines.append(f"{words}: {_counted(mine)}")
        if self.advice is not None:
            lines.append(f"Advice followed: {self.advice.change.measure}")
        return tuple(lines)

    def to_json(self) -> CheckedForecast:
        """Return it as JSON can carry it."""
        return {
            "followed": None if self.advice is None else self.advice.change.measure,
            "trials": [one.row() for one in self.tried],
            "summary": list(self.summary),
        }


def _counted(tried: Sequence[Tried]) -> str:
    """Return how many were named, by what was forecast of them."""
    kinds = (("separated", _LEAST, np.inf), ("on the edge", SEEN, _LEAST), ("not separated", 0.0, SEEN))
    words = []
    for kind, low, high in kinds:
        mine = [one for one in tried if low <= one.sigma < high]
        if mine:
            words.append(f"{sum(t.named for t in mine)} of {len(mine)} forecast as {kind}")
    kept = sum(one.kept for one in tried)
    return f"named alone {', '.join(words)}; in the class answered {kept} of {len(tried)}"


def first_to_follow(found: Forecast) -> Advice | None:
    """Return the first of the advice that gains something and that a trial can follow."""
    return next((one for one in found.advice if one.worth > 0 and found.bench.follows(one.change)), None)


def check(
    found: Forecast,
    count: int,
    seed: int,
    *,
    workers: int = 1,
    progress: Callable[[], None] | None = None,
) -> Check:
    """Hide effects at severities about the thresholds in the user's own structure, and have them diagnosed.

    Parameters
    ----------
    found : Forecast
        What is to be checked; the first of its advice that can be followed is followed.
    count, seed : int
        Cases, each tried as the test is and with the advice followed, and the seed of all draws [-].
    workers : int
        Diagnoses at a time [-].
    progress : callable, optional
        Called after each diagnosis.

    Returns
    -------
    Check
        The diagnosis is given the study and the raw hits, and nothing else.
    """
    bench = found.bench
    advice = first_to_follow(found)
    cases = choose(found.now, advice, count, np.random.default_rng([seed, 0]))
    wanted = [(case, False) for case in cases] + [(case, True) for case in cases if advice is not None]
    with ThreadPoolExecutor(workers) as pool:

        def one(job: tuple[int, tuple[Case, bool]]) -> Tried:
            index, (case, follows) = job
            change = advice.change if follows and advice is not None else None
            right, answer, failure = bench.right(case), None, ""
            try:  # the same draws with and without the advice
                answer = bench.attempt(case, change, [seed, 1 + index % len(cases)])
            except (ModalkitError, OSError) as error:
                failure = str(error)
            if progress is not None:
                progress()
            return Tried(case, follows, answer, right, failure)

        return Check(advice, tuple(pool.map(one, enumerate(wanted))))
