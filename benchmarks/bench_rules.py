"""What each rule of the verdict is worth: every one is doubled by itself, and the same searches are decided on again.

    python benchmarks/bench_rules.py --blind 12 --seed 98301            # 30 cases, an hour on one core
    python benchmarks/bench_rules.py --samples none --blind 4 --seed 5  # blind trials alone

A case is searched once; the rules only decide on what was searched. Cases are the sample studies, judged as
``modalkit blind --real`` judges, and fresh blind trials. Of a rule above one half that is a share, and of one in
percent, the distance from the whole is doubled: 0.95 becomes 0.90.

The table has for each rule its value, the value tried, in how many cases verdict or sets differ, in how many a right
answer becomes wrong or a wrong one right (partly right is wrong), and where else an answer differs. Below it stands
each case whose verdict differs. No next test is chosen, which is all that ``separated_sigma`` is for.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, fields
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from modalkit.blind import DrawRanges, draw_trial, write_trial
from modalkit.blind.answer import Answer, read_answer
from modalkit.blind.scoring.judge import is_right
from modalkit.output.documents import diagnosis_document
from modalkit.output.summary import summary_text
from modalkit.output.whole import plain
from modalkit.papers.a.chain import sample_folder
from modalkit.papers.real import judge
from modalkit.papers.real.anonymous import write_anonymous
from modalkit.papers.real.case import SYNTHETIC, Case, Source, sets
from modalkit.papers.real.paper_a import PAPER_A, PAPER_A_LEFT_OUT
from modalkit.papers.real.paper_b import PAPER_B, PAPER_B_LEFT_OUT
from modalkit.workflow.case import open_study
from updating.diagnosis import decision
from updating.diagnosis.answer.rules import DEFAULT_RULES, SHARES, DecisionRules
from updating.diagnosis.decision import SearchedCase
from updating.diagnosis.diagnose import searched_case, searched_together
from updating.effects import LIBRARY

PERCENT = frozenset({"closes_nearly_all"})
SLOW = frozenset(
    {"plate in water, FRFs", "plate_dry, FRFs", "dry beam and dry plate", "dry beam and dry plate, left out"}
)
"""Samples that take minutes; ``--samples all`` has them, too."""


def _of_study(name: str, known: str, *accepted: str) -> Case:
    """Return a sample study as a case of its own, by what it was made with."""
    answer = sets(*accepted) if accepted else (frozenset[str](),)
    source = Source(Path(name) / "study.toml")
    return Case(f"{name}, FRFs", SYNTHETIC, (source,), "", known, "sample_data/README.md", answer)


MADE = (
    _of_study("beam_dry", "clamp 16 mm deep, sensor of 8.6 g", "length + sensor_mass", "length"),
    _of_study("plate_dry", "clamp 16 mm deep, sensor of 8.6 g", "length + sensor_mass"),
    _of_study(
        "beam_joint", "a clamp that softens", "joint_nonlinearity", "clamp_rotation + joint_nonlinearity"
    ),
    _of_study("tape_bare", "a gain of 0.74", "calibration_gain", "section_scale"),
)
SAMPLES = {case.name: case for case in (*PAPER_A, *PAPER_B, *MADE, *PAPER_A_LEFT_OUT, *PAPER_B_LEFT_OUT)}

STEPS = ("shrinkage", "something_else", "splits", "locate", "levels", "rank")
"""Steps of a decision that take time."""

Job = tuple[str, int, int]
"""Name of a sample, or ``blind``; seed and number of the trial."""


@dataclass(frozen=True)
class Decided:
    """An answer under one set of rules.

    Parameters
    ----------
    verdict : str
        Verdict and sets in words.
    right : bool
        Whether it is true.
    parts : dict of str to str
        Everything else that it states, by the names of the document.
    """

    verdict: str
    right: bool
    parts: dict[str, str]


@dataclass(frozen=True)
class Replayed:
    """A case decided by the default rules and by those with one rule doubled.

    Parameters
    ----------
    name : str
        Of the case, with what is hidden.
    default : Decided
        By the default rules.
    by_rule : dict of str to Decided
        With that rule doubled.
    seconds : float
        Of the search, and of all decisions [s].
    """

    name: str
    default: Decided
    by_rule: dict[str, Decided]
    seconds: tuple[float, float]


def doubled(name: str) -> float:
    """Return a rule doubled: its distance to the nearer end, where it is a share or in percent."""
    value = float(getattr(DEFAULT_RULES, name))
    whole = 1.0 if name in SHARES else 100.0 if name in PERCENT else None
    return 2 * value if whole is None or value <= whole / 2 else whole - 2 * (whole - value)


class Reading:
    """Rules that keep in mind which of them were read.

    Parameters
    ----------
    rules : DecisionRules
        Their values.
    """

    def __init__(self, rules: DecisionRules) -> None:
        self.rules = rules
        self.read: dict[str, float] = {}

    def __getattr__(self, name: str) -> float:
        value: float = getattr(self.rules, name)
        self.read[name] = value
        return value


def remembered(step: Callable[..., Any]) -> Callable[..., Any]:
    """Return a step of a decision that is not computed again for the same input and the same of the rules it read.

    Generators of random numbers count as the same: each decision begins with a fresh one of the same seed.
    """
    known: list[tuple[list[Any], dict[str, float], Any]] = []

    def run(*args: Any, **options: Any) -> Any:
        given = [*args, *options.values()]
        rules = next((one for one in given if isinstance(one, DecisionRules)), DEFAULT_RULES)
        kept = [one for one in given if not isinstance(one, DecisionRules | np.random.Generator)]
        for other, read, result in known:
            if _same(kept, other) and all(getattr(rules, name) == value for name, value in read.items()):
                return result
        reading = Reading(rules)
        words = [reading if isinstance(one, DecisionRules) else one for one in args]
        named = {name: reading if isinstance(one, DecisionRules) else one for name, one in options.items()}
        result = step(*words, **named)
        known.append((kept, reading.read, result))
        return result

    return run


def _no_test(*_: Any, **__: Any) -> tuple[()]:
    """Propose no test: that takes longer than all else, and of the rules ``separated_sigma`` alone concerns it."""
    return ()


def _same(one: Any, other: Any) -> bool:
    """Return whether two inputs are one object, or plain values that are equal."""
    if isinstance(one, list | tuple) and isinstance(other, list | tuple):
        return len(one) == len(other) and all(map(_same, one, other))
    return one is other or (isinstance(one, str | float | int) and type(one) is type(other) and one == other)


def replayed(job: Job) -> Replayed:
    """Search a case, and decide on it by all rules."""
    with threadpool_limits(1), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        begin = time.perf_counter()
        name, seed, index = job
        name, searched, right = _blind(seed, index) if name == "blind" else _sample(SAMPLES[name])
        middle = time.perf_counter()
        for step in STEPS:  # in a process of its own
            setattr(decision, step, remembered(getattr(decision, step)))
        decision.propose = _no_test  # type: ignore[assignment]
        default = decided(searched, DEFAULT_RULES, right)
        by_rule = {
            rule: decided(searched, DecisionRules(**{rule: doubled(rule)}), right)
            for rule in (one.name for one in fields(DecisionRules))
        }
    return Replayed(name, default, by_rule, (middle - begin, time.perf_counter() - middle))


def _blind(seed: int, index: int) -> tuple[str, SearchedCase, Callable[[Answer], bool]]:
    trial = draw_trial(seed, index, plan=DrawRanges())
    truth = trial.truth
    with tempfile.TemporaryDirectory(prefix="test-") as folder:
        case = open_study(write_trial(trial, Path(folder))).case
        library = [effect for name, effect in LIBRARY.items() if name not in truth.without]
        found = searched_case(case, library=library)
    hidden = " + ".join(truth.effects) or "nothing"
    return f"blind {seed}.{index}, {truth.kind}, {hidden}", found, partial(is_right, truth=truth)


def _sample(case: Case) -> tuple[str, SearchedCase, Callable[[Answer], bool]]:
    with tempfile.TemporaryDirectory(prefix="test-") as folder:
        written = [
            write_anonymous(one, sample_folder(), Path(folder), i) for i, one in enumerate(case.sources)
        ]
        cases = [open_study(path).case for path in written]
        library = [effect for name, effect in LIBRARY.items() if name not in case.removed]
        found = (
            searched_case(cases[0], library=library)
            if len(cases) == 1
            else searched_together(cases, shared=case.shared, library=library)
        )
    return case.name, found, partial(_judged_right, case)


def _judged_right(case: Case, answer: Answer) -> bool:
    return judge(case, answer).grade == "right"


def decided(searched: SearchedCase, rules: DecisionRules, right: Callable[[Answer], bool]) -> Decided:
    """Decide on a case, and judge the answer."""
    found = decision.diagnosis_of(searched, rules=rules)
    document: dict[str, Any] = plain(diagnosis_document(found))
    cause = document.pop("cause")
    sets_in_words = "; ".join(sorted(" + ".join(names) for names in cause["sets"]))
    others = {name: json.dumps(value, sort_keys=True) for name, value in document.items()}
    del others["rules"], others["warnings"]
    others |= {name: json.dumps(cause[name], sort_keys=True) for name in ("level", "mechanism", "ranking")}
    others["summary"] = "\n".join(summary_text(found))
    answer = read_answer({**document, "cause": cause})
    return Decided(f"{cause['verdict']} {sets_in_words}".strip(), right(answer), others)


def each(jobs: Sequence[Job], workers: int) -> Iterator[Replayed]:
    """Yield the cases in order, each from a process of its own."""
    with get_context("fork").Pool(workers, maxtasksperchild=1) as pool:
        yield from pool.imap(replayed, jobs)


def table(found: Sequence[Replayed]) -> str:
    """Return a row for each rule, and below the table each verdict that differs."""
    lines = [
        f"| rule | value | tried | verdicts of {len(found)} | right to wrong | wrong to right | elsewhere |",
        "|---|---:|---:|---:|---:|---:|---|",
    ]
    changes = []
    for rule in (one.name for one in fields(DecisionRules)):
        pairs = [(one, one.default, one.by_rule[rule]) for one in found]
        differ = [(one, a, b) for one, a, b in pairs if a.verdict != b.verdict]
        worse = sum(a.right and not b.right for _, a, b in pairs)
        better = sum(b.right and not a.right for _, a, b in pairs)
        elsewhere = Counter(
            part
            for _, a, b in pairs
            if a.verdict == b.verdict
            for part in a.parts
            if a.parts[part] != b.parts[part]
        )
        text = ", ".join(f"{part} {count}" for part, count in elsewhere.items())
        lines.append(
            f"| {rule} | {getattr(DEFAULT_RULES, rule):g} | {doubled(rule):g} | {len(differ)} | {worse} | {better} "
            f"| {text} |"
        )
        changes += [f"* {rule}, {one.name}: {a.verdict} -> {b.verdict}" for one, a, b in differ]
    return "\n".join([*lines, "", *changes])


def jobs_of(samples: str, trials: int, seed: int) -> list[Job]:
    """Return the cases asked for."""
    names = [] if samples == "none" else [name for name in SAMPLES if samples == "all" or name not in SLOW]
    return [*((name, 0, 0) for name in names), *(("blind", seed, index) for index in range(trials))]


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--samples", choices=("quick", "all", "none"), default="quick")
    parser.add_argument("--blind", type=int, default=0, metavar="N", help="how many fresh blind trials")
    parser.add_argument("--seed", type=int, default=1, help="of the blind trials")
    parser.add_argument("--workers", type=int, default=1)
    given = parser.parse_args()
    found = []
    for one in each(jobs_of(given.samples, given.blind, given.seed), given.workers):
        found.append(one)
        right = "right" if one.default.right else "not right"
        took = f"searched {one.seconds[0]:.0f} s, decided {one.seconds[1]:.0f} s"
        print(f"{one.name}: {one.default.verdict}: {right}; {took}", flush=True)
    right = sum(one.default.right for one in found)
    print(f"\n{len(found)} cases, {right} right by the default rules\n\n{table(found)}")


if __name__ == "__main__":
    main()
