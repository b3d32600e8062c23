"""What a diagnosis states, as records that the face turns into text, JSON and figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

import pandas as pd

from acquisition.arrays import FloatArray
from acquisition.display import Displayed, Shown, answers_of, counted
from acquisition.quantities import bare_p, percent
from updating.diagnosis.answer.closing import Remainder, Shrink
from updating.diagnosis.answer.in_no_library import SomethingElse
from updating.diagnosis.answer.located import Where
from updating.diagnosis.answer.mechanism import Level, Mechanism
from updating.diagnosis.answer.ranked import Ranked
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.answer.set_aside import SetAside
from updating.diagnosis.search.compared import Searched
from updating.effects import LIBRARY, Effect
from updating.effects.obstacles import Obstacle

Verdict = Literal["named", "class", "unknown", "none"]

Shortcoming = Literal["fit", "closing", "evidence", "samples", "partners", "one size", "library"]
"""What the most probable set lacks where none is an answer: it is rejected, closes too little and leaves more than
noise, is not clearly more likely than tolerances further off, its probability rests on hardly any sample, most modes
have no partner, parts of the data want another size of it each, or a cause that is not in the library is as likely."""

SETS = 10
"""So many sets of effects are printed."""


@dataclass(frozen=True, eq=False)
class Gap(Displayed):
    """The gap between the test and the nominal model, mode by mode.

    Parameters
    ----------
    modes : DataFrame
        One row per paired mode: test and model frequency [Hz], error and sigma [%], MAC, damping ratios [-].
    rms_percent, floor_percent : float
        R.m.s. frequency error, and what noise alone would give [%].
    frac : (n_frf,) array
        Correlation of measured and predicted modal constants over the modes, per FRF [-].
    """

    modes: pd.DataFrame
    rms_percent: float
    floor_percent: float
    frac: FloatArray

    def _headline(self) -> str:
        return (
            f"{percent(self.rms_percent)} r.m.s. frequency error over {counted(len(self.modes), 'mode')}, "
            f"noise floor {percent(self.floor_percent)}"
        )

    def _frame(self) -> pd.DataFrame:
        return self.modes


@dataclass(frozen=True)
class NextTest(Displayed):
    """A measurement, what it separates, and by how many sigma.

    Parameters
    ----------
    measure : str
        What to do.
    separates : tuple of str
        The effects of the explanations it separates.
    expected_sigma : float
        By how many sigma at least; nan for advice where there is nothing to separate [-].
    pairs : tuple of (set, set)
        Which explanations it separates from which.
    whole : bool
        Whether these are all that are left.
    """

    measure: str
    separates: tuple[str, ...]
    expected_sigma: float
    pairs: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...] = ()
    whole: bool = True


@dataclass(frozen=True, eq=False, kw_only=True)
class Diagnosis(Shown):
    """The whole answer.

    Parameters
    ----------
    title : str
        Of the study.
    significant, p_value : bool, float
        Whether test and model differ by more than tolerances and noise.
    gap, where, shrink : Gap, Where, Shrink
        How large, where, and how far it closes.
    verdict : str
        named, class, unknown or none.
    sets : tuple of tuple of str
        The sets of effects that hold 95 % of the probability.
    ranking : tuple of Ranked
        All sets examined, most probable first.
    next_test : tuple of NextTest
        What to measure next.
    warnings : tuple of str
        What the reader should know.
    not_examined : dict of str to Obstacle
        Effects that could not be examined, and why.
    comparable : bool
        Whether most measured modes have a partner in the model; if not, no cause is named.
    remainder : Remainder, optional
        What the first set of the ranking leaves; None where there is no gap.
    included : dict of str to float
        Probability of each effect that it is among the causes [-].
    own : dict of str to Effect
        The study's hypotheses.
    lacks : str, optional
        What the most probable set lacks, where the verdict is unknown.
    searched : tuple of Searched
        How many sets of one cause, of two and so on were searched, and how many there are.
    something_else : SomethingElse, optional
        A cause that is in no library beside those that are; None where there is no gap, or it was not examined.
    level : {"story", "mechanism"} or None
        At which level the answer is certain: one set is named, or what several of them do alike.
    mechanisms : tuple of Mechanism
        What the most probable set, or a cause in no library, does: all at the same time, the leading one first.
    rules : DecisionRules
        What the answer was decided by.
    set_aside : SetAside, optional
        Data that are worse than stated if there is no cause; None where no set takes any to be.
    beneath : float
        What shear and rotary inertia, which the theory neglects and which no cause at all was given as well, take off a
        frequency at most; 0 where the model has them or they are a cause like others [%].
    """

    title: str
    significant: bool
    p_value: float
    gap: Gap
    where: Where
    shrink: Shrink
    verdict: Verdict
    sets: tuple[tuple[str, ...], ...]
    ranking: tuple[Ranked, ...]
    next_test: tuple[NextTest, ...]
    warnings: tuple[str, ...]
    not_examined: dict[str, Obstacle]
    comparable: bool = True
    remainder: Remainder | None = None
    included: Mapping[str, float] = field(default_factory=dict)
    own: Mapping[str, Effect] = field(default_factory=dict)
    lacks: Shortcoming | None = None
    searched: tuple[Searched, ...] = ()
    something_else: SomethingElse | None = None
    level: Level | None = None
    mechanisms: tuple[Mechanism, ...] = ()
    rules: DecisionRules = DEFAULT_RULES
    set_aside: SetAside | None = None
    beneath: float = 0.0

    @property
    def suspected(self) -> Ranked | None:
        """What would most probably explain the data where some cause is likely, though chance might make the gap."""
        likely = sum(row.probability for row in self.ranking) >= self.rules.likely_all_the_same
        return self.ranking[0] if self.verdict == "none" and likely else None

    @property
    def mechanism(self) -> Mechanism | None:
        """The leading mechanism, where there is any."""
        return self.mechanisms[0] if self.mechanisms else None

    @property
    def effects(self) -> tuple[str, ...]:
        """Union of the sets, in the order of their probability; what occurs twice in one of them is there twice."""
        most: Counter[str] = Counter()
        for names in self.sets:
            most |= Counter(names)
        return tuple(most.elements())

    @property
    def known(self) -> Mapping[str, Effect]:
        """The effects of the library and the study's hypotheses, by name."""
        return {**LIBRARY, **self.own}

    def table(self) -> pd.DataFrame:
        """Return the ranking, one row per set of effects, with its probability [-] to four decimals.

        The effects are the index, so that no width of a terminal hides the probability; `ranking` has all digits.
        """
        columns = {
            "probability": [round(r.probability, 4) for r in self.ranking],
            "fits (p)": [float(f"{r.p_value:.3g}") for r in self.ranking],
            "parameters": [", ".join(r.stated) for r in self.ranking],
        }
        names = [" + ".join(r.effects) or "(tolerances alone)" for r in self.ranking]
        return pd.DataFrame(columns, index=pd.Index(names, name="effects"))

    def sizes(self, *, count: int = SETS) -> pd.DataFrame:
        """Return one row per parameter of the most probable sets, in short columns that print whole.

        Parameters
        ----------
        count : int
            Number of sets.

        Returns
        -------
        DataFrame
            Probability and fit of the set [-]; value and 95 % interval of the parameter [unit]. Effects and parameter
            are the index.
        """
        rows = [
            {
                "effects": " + ".join(r.effects) or "(tolerances alone)",
                "parameter": name,
                "probability": f"{r.probability:.4f}",
                "fits (p)": bare_p(r.p_value),
                "size": "" if size is None else str(size),
            }
            for r in self.ranking[:count]
            for name, size in r.parameters.items() or [("", None)]
        ]
        columns = ["effects", "parameter", "probability", "fits (p)", "size"]
        return pd.DataFrame(rows, columns=columns).set_index(["effects", "parameter"])

    def __str__(self) -> str:
        """Return one line, and the sizes below it, nothing cut."""
        if not self.ranking:
            return self._headline()
        rows = self.sizes().reset_index()
        again = rows["effects"].duplicated()
        rows[["effects", "probability", "fits (p)"]] = rows[["effects", "probability", "fits (p)"]].mask(
            again, ""
        )
        return f"{self._headline()}\n{rows.to_string(index=False, justify='left', max_colwidth=None)}"

    def _answer(self) -> Mapping[str, str]:
        return answers_of(self)

    def _headline(self) -> str:
        which = " | ".join(" + ".join(names) for names in self.sets)
        return f"{self.title}: {self.verdict}{f' ({which})' if which else ''}; {self.gap._headline()}"
