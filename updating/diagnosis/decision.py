"""From what was searched of a test and a model to a diagnosis: what the rules decide, without another search."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from updating.diagnosis.answer.closing import Shrink
from updating.diagnosis.answer.consistency import splits
from updating.diagnosis.answer.in_no_library import SOMETHING_ELSE, SomethingElse
from updating.diagnosis.answer.levels import levels
from updating.diagnosis.answer.remainder import remainder_of
from updating.diagnosis.answer.result import Diagnosis, Gap, Shortcoming, Verdict
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.answer.set_aside import most_probable
from updating.diagnosis.answer.shrink import shrinkage
from updating.diagnosis.answer.verdict import decide, included, is_significant, rank, shortcoming
from updating.diagnosis.answer.where import locate
from updating.diagnosis.generic.something_else import something_else
from updating.diagnosis.next_test import propose
from updating.diagnosis.notes import on_fit, on_rules, on_search
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.problem.several import Several
from updating.diagnosis.search.compared import Search
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.prior import holds
from updating.effects import Effect
from updating.prediction.assignment import frac_of_constants, mac_of_constants
from updating.problem.specimen import SpecimenProblem
from updating.steps import SILENT, Steps


@dataclass(frozen=True, eq=False)
class SearchedCase:
    """A test and a model with all that was compared of them.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    titles : tuple of str
        One per specimen.
    found : Search
        What was compared.
    own : mapping of str to Effect
        The user's own effects, by name.
    warnings : tuple of str
        From the test and from pairing.
    """

    problem: DiagnosisProblem
    titles: tuple[str, ...]
    found: Search
    own: Mapping[str, Effect] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


def diagnosis_of(
    searched: SearchedCase,
    *,
    rules: DecisionRules = DEFAULT_RULES,
    rng: np.random.Generator | None = None,
    steps: Steps = SILENT,
) -> Diagnosis:
    """Decide on what was searched; nothing is searched again.

    Parameters
    ----------
    searched : SearchedCase
        Test and model, and what was compared.
    rules : DecisionRules
        What the verdict is decided by.
    rng : Generator, optional
        For the bootstrap; left out, a fixed one, so that the answer repeats.
    steps : Steps
        Where stages are announced.
    """
    problem, titles, found = searched.problem, searched.titles, searched.found
    significant = is_significant(found, found.empty.p_value, rules=rules)
    steps.begin("predicting modes held out")
    shrink = _shrink(problem, found, rng, rules, significant=significant)
    left = remainder_of(problem, titles, _stated(found, significant=significant), shrink, rules=rules)
    steps.begin("comparing with a cause outside the library")
    other = something_else(problem, found, rules) if significant else None
    verdict, sets, lacks, fit_notes = _decided(
        problem, found, other, shrink, rules, significant=significant, left=left.significant
    )
    one = on_one(problem, found)
    where = locate(*one, verdict=verdict, whole=found, rules=rules)
    certain = levels(*one, where, verdict, sets, other, whole=found, rules=rules)
    steps.begin("choosing the next test")
    return Diagnosis(
        title=" and ".join(titles),
        significant=significant,
        p_value=found.empty.p_value,
        gap=_gap(problem, titles),
        where=where,
        shrink=shrink,
        verdict=verdict,
        sets=sets,
        ranking=rank(problem, titles, found, rules=rules),
        next_test=propose(problem, found, sets, verdict, certain.mechanisms, separated=rules.separated_sigma),
        warnings=_warnings(searched, sets, rules, fit_notes),
        not_examined=found.not_examined,
        comparable=_comparable(problem),
        remainder=left if significant or found.empty.explanation.candidate.outliers else None,
        included=included(found),
        own=searched.own,
        lacks=lacks if verdict == "unknown" else None,
        searched=found.searched,
        something_else=other,
        level=certain.level,
        mechanisms=certain.mechanisms,
        rules=rules,
        set_aside=most_probable(problem, titles, found),
        beneath=_beneath(problem) if found.empty.explanation.candidate.fuller else 0.0,
    )


def _warnings(
    searched: SearchedCase,
    sets: tuple[tuple[str, ...], ...],
    rules: DecisionRules,
    fit_notes: Sequence[str],
) -> tuple[str, ...]:
    """Return what limits the answer, each once: of the test, the rules, the search and the fit."""
    notes = (
        *searched.warnings,
        *on_rules(rules),
        *on_search(searched.problem, searched.found, sets),
        *fit_notes,
    )
    return tuple(dict.fromkeys(notes))


def _beneath(problem: DiagnosisProblem) -> float:
    """Return what the fuller theory takes off a frequency at most [%]."""
    errors = [one.theory_error for one in problem.specimens if one.theory_error is not None]
    return 100.0 * max((float(np.abs(error.theory).max()) for error in errors), default=0.0)


def _leader(found: Search) -> Explanation:
    """Return the most probable set of effects, and no effect where none was compared."""
    return next((row.explanation for row in found.compared if row.names), found.nothing)


def _stated(found: Search, *, significant: bool) -> Explanation:
    """Return what the answer rests on: the most probable set, and no effect where there is no gap."""
    return _leader(found) if significant else found.empty.explanation


def _comparable(problem: DiagnosisProblem) -> bool:
    """Return whether most measured modes have a partner on all specimens."""
    return not any(one.mostly_alone for one in problem.specimens)


def _decided(
    problem: DiagnosisProblem,
    found: Search,
    other: SomethingElse | None,
    shrink: Shrink,
    rules: DecisionRules,
    *,
    significant: bool,
    left: bool,
) -> tuple[Verdict, tuple[tuple[str, ...], ...], Shortcoming | None, list[str]]:
    """Return the verdict, its sets, what the first set lacks, and what the reader should know of its fit.

    ``shrink`` is how far the first set closes the gap, ``left`` whether it leaves more than noise.
    """
    unnamed = 0.0 if other is None else other.probability
    lacks = shortcoming(
        found,
        comparable=_comparable(problem),
        closed=None if shrink.closed is None else shrink.closed.value,
        aside=shrink.all_aside,
        left=left or (other is not None and other.beside > rules.something_left),
        unnamed=unnamed,
        rules=rules,
    )
    verdict, sets = decide(found, lacks, significant=significant, unnamed=unnamed, rules=rules)
    leader = _leader(found)
    stories = [names for names in sets if names != (SOMETHING_ELSE,)]
    inconsistent = splits(problem, leader, rules=rules) if len(stories) == 1 else ()
    if inconsistent:
        verdict, sets, lacks = "unknown", (), "one size"
    return verdict, sets, lacks, on_fit(leader, inconsistent, significant=significant)


def _shrink(
    problem: DiagnosisProblem,
    found: Search,
    rng: np.random.Generator | None,
    rules: DecisionRules,
    *,
    significant: bool,
) -> Shrink:
    named = [row for row in found.compared if row.names]
    best = named[0].explanation if named else found.nothing
    # what holds the best set and more is no rival of it
    rivals = [row.explanation for row in named[1:] if not holds(row.names, best.names)]
    runner_up = rivals[0] if rivals else None
    result = shrinkage(problem, found.nothing, best, runner_up, rng or np.random.default_rng(1), rules=rules)
    return result if significant else replace(result, closed=None)


def _gap(problem: DiagnosisProblem, titles: tuple[str, ...]) -> Gap:
    tables = []
    for title, one in zip(titles, problem.specimens, strict=True):
        test, model = one.measured, one.nominal
        mac = (
            np.diag(mac_of_constants(test, model))
            if test.has_shapes
            else np.full(len(test.frequency), np.nan)
        )
        columns = {
            "study": title,
            "test [Hz]": test.frequency,
            "model [Hz]": model.frequency,
            "error [%]": 100 * (model.frequency / test.frequency - 1),
            "sigma [%]": 100 * np.hypot(test.frequency_sigma / test.frequency, test.repeatability),
            "MAC": mac,
            "test damping": test.damping,
            "model damping": model.damping,
        }
        count = len(test.frequency)
        tables.append(pd.DataFrame(columns, index=pd.RangeIndex(1, count + 1, name="mode")))
    modes = pd.concat(tables)
    frac = np.concatenate([frac_of_constants(one.measured, one.nominal) for one in problem.specimens])
    return Gap(modes, _rms(modes["error [%]"]), _rms(modes["sigma [%]"]), frac)


def _rms(values: pd.Series) -> float:
    return float(np.sqrt(np.mean(np.square(values.to_numpy(dtype=float)))))


def on_one(problem: DiagnosisProblem, found: Search) -> tuple[SpecimenProblem, Search]:
    """Return a specimen with what was compared of it: of several the first on which all of the best set acts."""
    if not isinstance(problem, Several):
        return problem.specimens[0], found
    leader = _leader(found)

    def on(one: Explanation, i: int) -> Explanation:
        return one.restricted(*problem.part(one.candidate, i))

    i = int(np.argmax([len(on(leader, j).names) for j in range(len(problem.specimens))]))
    rows = tuple(
        replace(
            row,
            explanation=on(row.explanation, i),
            forms=tuple((on(form, i), share) for form, share in row.forms),
        )
        for row in found.compared
    )
    return problem.specimens[i], replace(found, nothing=on(found.nothing, i), compared=rows)
