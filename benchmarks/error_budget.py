"""Why was each wrong answer of a blind run wrong? By computation, from the stored run and its opened seals.

    modalkit blind --trials 200 --seed 7 --store run.jsonl
    uv run python benchmarks/error_budget.py run.jsonl --seed 7          # some 20 s a wrong trial on one core

Every wrong trial whose effects the library holds, and every alarm where nothing was hidden, is measured anew and
diagnosed again. Then the true set is weighed *from the truth*: its parameters begin where they were put in, all
starting places of the search beside them. One cause of the error follows, the first that holds:

* *search*: the truth, weighed from the truth, is more probable than what the search made of it, and would lead;
* *rejection*: it leads, and a rule threw it out; the check that did, and the datum furthest off, are said;
* *sketch*: it does not lead and does not fit either; which check, and the datum furthest off;
* *prior*: its best parameters fit as well as the leader's (2 delta ln L < 4) and it loses by prior volume;
* *information*: the data prefer the answer given.

An alarm is *search*-free by nature: it is booked under the check that the empty set failed, with its datum.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

from modalkit.blind import DrawRanges, Outcome, Trial, check_store, draw_trial, write_trial
from modalkit.blind.scoring.judge import is_right, label, sort_of
from modalkit.workflow.case import open_study
from updating.diagnosis.answer.rules import DEFAULT_RULES
from updating.diagnosis.answer.verdict import rejected
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.compared import Compared, Search
from updating.diagnosis.search.evidence import Explanation, explain, finish
from updating.diagnosis.search.goodness import p_values
from updating.diagnosis.search.prior import log_prior
from updating.diagnosis.search.search import search
from updating.effects import LIBRARY
from updating.likelihood.comparison import CHANNELS
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

GAINED = 2.0
"""By how much more log evidence the truth must have from the truth than from the search, before the search is blamed:
a draft's evidence errs by one or two."""

MIDDLES = (0.15, 0.5, 0.85)
"""Quantiles tried for parameters of the library that the rig's effect does not have."""


@dataclass(frozen=True, kw_only=True)
class Entry:
    """One wrong trial and its cause."""

    trial: int
    kind: str
    truth: str
    answer: str
    cause: str
    check: str
    datum: str
    truth_score: float
    searched_score: float
    leader_score: float
    p_value: float


def wrong(outcomes: Sequence[Outcome]) -> Iterator[Outcome]:
    """Yield the trials that the budget is about."""
    for outcome in outcomes:
        if outcome.answer is None or is_right(outcome.answer, outcome.truth):
            continue
        if sort_of(outcome.truth) in ("none", "effect", "pair"):
            yield outcome


def entry(trial: Trial, outcome: Outcome) -> Entry:
    """Measure and diagnose a trial again, and say why its answer was wrong."""
    with tempfile.TemporaryDirectory() as name, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        case = open_study(write_trial(trial, Path(name))).case
    problem, _ = pose(case)
    found = search(problem, list(LIBRARY.values()))
    answer = outcome.answer
    assert answer is not None
    said = " | ".join(label(s) for s in answer.sets) or answer.verdict
    leader = found.compared[0]
    if not trial.truth.effects:
        check, datum = _worst(found.nothing)
        lead = next(row for row in found.compared if row.names)
        return Entry(
            trial=trial.index, kind=trial.truth.kind, truth="none", answer=said, cause="alarm", check=check,
            datum=datum, truth_score=_score(found.nothing), searched_score=_score(found.nothing),
            leader_score=_score(lead.explanation), p_value=found.nothing.p_value,
        )  # fmt: skip
    theories = (False, True) if found.both else (False,)
    weighed = (
        _from_truth(problem, trial, names, fuller=fuller)
        for names in trial.truth.accepted
        for fuller in theories
    )
    true = max(weighed, key=_known_score)
    if true is None:
        return Entry(
            trial=trial.index, kind=trial.truth.kind, truth=label(trial.truth.effects), answer=said,
            cause="not examined", check="", datum="", truth_score=-np.inf, searched_score=-np.inf,
            leader_score=_score(leader.explanation), p_value=0.0,
        )  # fmt: skip
    cause, searched = _cause(found, leader, true)
    check, datum = _worst(true)
    return Entry(
        trial=trial.index, kind=trial.truth.kind, truth=label(trial.truth.effects), answer=said, cause=cause,
        check=check, datum=datum, truth_score=_score(true), searched_score=searched,
        leader_score=_score(leader.explanation), p_value=true.p_value,
    )  # fmt: skip


def _cause(found: Search, leader: Compared, true: Explanation) -> tuple[str, float]:
    own = [row for row in found.compared if set(row.names) == set(true.names)]
    searched = max((_score(row.explanation) for row in own), default=-np.inf)
    best, ahead = _score(true), _score(leader.explanation)
    leads = best > ahead - GAINED or bool(own and own[0] is leader)
    if leads and best > searched + GAINED:
        return "search", searched
    if leads:
        return "rejection", searched
    row = Compared(explanation=true, probability=0.0, p_value=true.p_value, as_stated=true.p_value)
    if rejected(row, DEFAULT_RULES):
        return "sketch", searched
    behind = leader.explanation.best.marginal.log_likelihood - true.best.marginal.log_likelihood
    return ("prior" if 2 * behind < DEFAULT_RULES.close_fits else "information"), searched


def _score(explanation: Explanation) -> float:
    """Return log evidence and log prior of a set [-]."""
    return explanation.log_evidence + log_prior(len(explanation.names), len(LIBRARY))


def _known_score(explanation: Explanation | None) -> float:
    return -np.inf if explanation is None else _score(explanation)


def _from_truth(
    problem: SpecimenProblem, trial: Trial, names: tuple[str, ...], *, fuller: bool
) -> Explanation | None:
    """Weigh a set from the values that were put in, in every form, on one theory; None where it does not apply."""
    effects = tuple(LIBRARY[name] for name in names)
    if any(problem.applies(effect) is not None for effect in effects):
        return None
    found = []
    forms: list[tuple] = [()]
    for effect in effects:
        forms = [(*chosen, form) for chosen in forms for form in problem.forms(effect)]
    for chosen in forms:
        candidate = Candidate(effects, fuller=fuller, chosen=chosen)
        known = trial.truth.parameters
        parameters = problem.parameters(candidate)
        stated = {name: float(known[name]) for name, _ in parameters if name in known}
        there = candidate.coordinates(problem.predictor, stated)
        starts = [
            np.array([u if name in stated else other for (name, _), u in zip(parameters, there, strict=True)])
            for other in MIDDLES
        ]
        own = problem.starts(candidate) if len(effects) == 1 else []
        with threadpool_limits(1, user_api="blas"):
            draft = explain(problem, candidate, starts=starts + own, laplace_only=True, maximisations=4)
            found.append(finish(problem, draft) if draft.peaks else draft)
    return max(found, key=_score, default=None)


def _worst(explanation: Explanation) -> tuple[str, str]:
    """Return the check with the smallest p-value, and the datum furthest off, in sigma of what is left."""
    values = p_values(explanation.best, explanation.samples.shape[1])
    check = min(values, key=lambda name: values[name])
    point = explanation.best
    comparison = point.comparison
    off = point.left_over / np.sqrt(comparison.noise(point.marginal.scale))
    i = int(np.argmax(np.abs(off)))
    datum = f"{CHANNELS[comparison.channel[i]]} of mode {comparison.mode[i] + 1}: {off[i]:+.1f} sigma"
    return f"{check} (p = {values[check]:.1e})", datum


def report(entries: Sequence[Entry], total: int) -> str:
    """Return the budget as a table by cause, then by effect and kind of body, then trial by trial."""
    lines = [f"{len(entries)} of {total} trials wrong", "", "| cause | trials |", "|---|---|"]
    lines += [f"| {cause} | {n} |" for cause, n in Counter(e.cause for e in entries).most_common()]
    lines += ["", "| cause | body | truth | trials |", "|---|---|---|---|"]
    grouped = Counter((e.cause, e.kind, e.truth) for e in entries)
    lines += [f"| {' | '.join(key)} | {n} |" for key, n in sorted(grouped.items())]
    lines += [
        "",
        "| trial | truth | answer | cause | check | datum | truth, searched, leader |",
        "|---|---|---|---|---|---|---|",
    ]
    lines += [
        f"| {e.trial} {e.kind} | {e.truth} | {e.answer} | {e.cause} | {e.check} | {e.datum} | "
        f"{e.truth_score:.1f}, {e.searched_score:.1f}, {e.leader_score:.1f} |"
        for e in entries
    ]
    return "\n".join(lines)


def main() -> int:
    """Read the store, and write the budget."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("store", type=Path)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--only", type=int, nargs="*")
    parser.add_argument("--json", type=Path)
    arguments = parser.parse_args()
    checked = check_store(arguments.store, seed=arguments.seed)
    plan = DrawRanges.from_json(checked.plan)
    entries = []
    for outcome in wrong([checked.outcomes[i] for i in sorted(checked.outcomes)]):
        if arguments.only and outcome.index not in arguments.only:
            continue
        entries.append(entry(draw_trial(arguments.seed, outcome.index, plan=plan), outcome))
        print(entries[-1], file=sys.stderr, flush=True)
    print(report(entries, len(checked.outcomes)))
    if arguments.json:
        arguments.json.write_text(json.dumps([asdict(e) for e in entries], indent=1) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
