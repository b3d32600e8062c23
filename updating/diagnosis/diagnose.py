"""From a case to a diagnosis."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from acquisition.errors import InputError
from updating.case import Case
from updating.diagnosis.answer.consistency import Split, splits
from updating.diagnosis.answer.remainder import remainder_of
from updating.diagnosis.answer.result import Diagnosis, Gap, Shrink, Verdict, Where
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.answer.shrink import shrinkage
from updating.diagnosis.answer.verdict import decide, included, is_significant, rank, shortcoming
from updating.diagnosis.answer.where import locate
from updating.diagnosis.generic.something_else import something_else
from updating.diagnosis.next_test import propose
from updating.diagnosis.problem.doubtful import notes_on_doubtful
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.problem.several import Several
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.prior import holds
from updating.diagnosis.search.search import Search, search
from updating.effects import LIBRARY, Effect, hypotheses_of
from updating.models.state import State
from updating.nominal import accepted_additions, predictor_of
from updating.prediction.assignment import frac_of_constants
from updating.prediction.baseline import correct, doubt_in_mass
from updating.prediction.matching import Paired, mac_of_constants, pair_modes
from updating.prediction.predict import Predictor
from updating.prediction.suspended import without_suspended
from updating.problem.gates import notes_on, on_levels, on_modes, on_reduction, theory_error
from updating.problem.specimen import SpecimenProblem
from updating.problem.stated_doubts import of_updates_alone
from updating.test_data.same_places import unmatched
from updating.thresholds import ENOUGH_SAMPLES, NEGLIGIBLE_PROBABILITY


def diagnose(
    case: Case,
    *,
    library: Sequence[Effect] | None = None,
    rules: DecisionRules = DEFAULT_RULES,
    rng: np.random.Generator | None = None,
    progress: Callable[[str], None] | None = None,
) -> Diagnosis:
    """State where the gap between a test and a model lies, what causes it, and how far it closes.

    Parameters
    ----------
    case : Case
        Test, model, baseline and doubts.
    library : sequence of Effect, optional
        Effects to consider beside the study's hypotheses; left out, the whole library.
    rules : DecisionRules
        What the verdict is decided by.
    rng : Generator, optional
        For the bootstrap; left out, a fixed one, so that the answer repeats.
    progress : function, optional
        Called with the name of every stage as it begins.

    Returns
    -------
    Diagnosis

    Raises
    ------
    EstimationError
        If no measured mode has a partner in the model.
    """
    with threadpool_limits(1, user_api="blas"):  # two threads are slower on small eigenproblems
        _stage(progress, "pairing the modes")
        problem, warnings = pose(case)
        accepted = {name for name, _ in case.accepted}
        return _diagnose(problem, (case.title,), accepted, library, rules, rng, warnings, progress)


def diagnose_together(
    cases: Sequence[Case],
    *,
    shared: Sequence[str] = (),
    library: Sequence[Effect] | None = None,
    rules: DecisionRules = DEFAULT_RULES,
    rng: np.random.Generator | None = None,
) -> Diagnosis:
    """Diagnose several specimens whose gaps have causes in common.

    Parameters
    ----------
    cases : sequence of Case
        One per specimen.
    shared : sequence of str
        Effects whose parameters are one and the same on all specimens (one accelerometer, one kind of clamp); those
        of all others are free on each.
    library, rules, rng
        As in :func:`diagnose`.

    Raises
    ------
    InputError
        If a shared effect is not in the library, or two cases bear one title.
    EstimationError
        If no measured mode of a specimen has a partner in its model.
    """
    effects = list(LIBRARY.values()) if library is None else list(library)
    own = {one.name for case in cases for one in hypotheses_of(case.spec)}
    if unknown := [name for name in shared if name not in {effect.name for effect in effects} | own]:
        raise InputError(f"--shared {unknown[0]}: there is no such effect; `modalkit effects` lists them")
    titles = tuple(case.title for case in cases)
    if len(set(titles)) < len(titles):
        raise InputError(f"two studies are titled alike ({', '.join(titles)}); give each its own title")
    with threadpool_limits(1, user_api="blas"):
        diagnosis_problem = [pose(case) for case in cases]
        several = Several(tuple(problem for problem, _ in diagnosis_problem), titles, frozenset(shared))
        accepted = {name for case in cases for name, _ in case.accepted}
        warnings = [f"{t}: {w}" for t, (_, own) in zip(titles, diagnosis_problem, strict=True) for w in own]
        return _diagnose(several, titles, accepted, library, rules, rng, warnings)


def _diagnose(
    problem: DiagnosisProblem,
    titles: tuple[str, ...],
    accepted: set[str],
    library: Sequence[Effect] | None,
    rules: DecisionRules,
    rng: np.random.Generator | None,
    warnings: list[str],
    progress: Callable[[str], None] | None = None,
) -> Diagnosis:
    effects = list(LIBRARY.values()) if library is None else list(library)
    own = {effect.name: effect for one in problem.specimens for effect in hypotheses_of(one.predictor.spec)}
    effects += [effect for name, effect in own.items() if name not in {effect.name for effect in effects}]
    _stage(progress, "comparing the effects")
    examined = [e for e in effects if e.name not in accepted or e.several or e.repeats_on(problem.predictor)]
    found = search(problem, examined)
    chance = found.empty.p_value
    significant = is_significant(found, chance, rules=rules)
    comparable = not any(one.mostly_alone for one in problem.specimens)
    draws = np.random.default_rng(1) if rng is None else rng
    _stage(progress, "predicting modes held out")
    shrink = _shrink(problem, found, draws, rules, significant=significant)
    leader = next((row.explanation for row in found.compared if row.names), found.nothing)
    stated = leader if significant else found.empty.explanation
    left = remainder_of(problem, titles, stated, shrink, rules=rules)
    _stage(progress, "comparing with a cause outside the library")
    other = something_else(problem, found, rules) if significant else None
    lacks = shortcoming(
        found,
        comparable=comparable,
        closed=None if shrink.closed is None else shrink.closed.value,
        left=left.significant or (other is not None and other.beside > rules.something_left),
        unnamed=0.0 if other is None else other.probability,
        rules=rules,
    )
    verdict, sets = decide(found, lacks, significant=significant, rules=rules)
    inconsistent = splits(problem, leader, rules=rules) if verdict == "named" else ()
    if inconsistent:
        verdict, sets, lacks = "unknown", (), "one size"
    on_fit = _on_fit(leader, inconsistent, significant=significant)
    _stage(progress, "choosing the next test")
    return Diagnosis(
        title=" and ".join(titles),
        significant=significant,
        p_value=chance,
        gap=_gap(problem, titles),
        where=_locate(problem, found, verdict, rules),
        shrink=shrink,
        verdict=verdict,
        sets=sets,
        ranking=rank(problem, found, rules=rules),
        next_test=propose(problem, found, sets, verdict, separated=rules.separated_sigma),
        warnings=tuple(dict.fromkeys([*warnings, *_on_rules(rules), *_notes(problem, found, sets), *on_fit])),
        not_examined=found.not_examined,
        comparable=comparable,
        remainder=left if significant or found.empty.explanation.candidate.outliers else None,
        included=included(found),
        own=own,
        lacks=lacks if verdict == "unknown" else None,
        searched=found.searched,
        something_else=other,
        rules=rules,
    )


def _on_rules(rules: DecisionRules) -> list[str]:
    """Return which rules differ from the defaults, and by what."""
    stated = [
        f"{name} = {value:g} (default: {getattr(DEFAULT_RULES, name):g})"
        for name, value in rules.changed.items()
    ]
    return [f"the verdict was decided by rules of its own: {', '.join(stated)}"] if stated else []


def _stage(progress: Callable[[str], None] | None, name: str) -> None:
    if progress is not None:
        progress(name)


def pose(case: Case) -> tuple[SpecimenProblem, list[str]]:
    """Pair the modes, put the baseline and accepted effects into the model, and pose the problem."""
    predictor = predictor_of(case)
    additions = list(predictor.additions)
    there = accepted_additions(case.accepted_before) if case.baseline is not None else ()
    paired = pair_modes(case.measured, predictor.predict())
    warnings = [*case.measured.warnings, *paired.warnings, *of_updates_alone(case.tolerances, case.spec)]
    baseline, baseline_order, tolerances = None, None, case.tolerances
    if case.baseline is not None:
        own_predictor = predictor.for_test(case.baseline, there)
        before = pair_modes(case.baseline, own_predictor.predict())
        doubt = doubt_in_mass(predictor.for_test(before.measured, there), before.measured, before.order)
        tolerances = replace(tolerances, factors={**tolerances.factors, "section": doubt})
        statement = (*case.baseline.warnings, *before.warnings, *unmatched(case.measured, before.measured))
        warnings += [f"baseline: {w}" for w in statement]
        warnings += _on_accepted(case)
        additions.append(_corrected(before, there))
        baseline, baseline_order = before.measured, before.order
        predictor = predictor.for_test(case.measured, tuple(additions))
        paired = pair_modes(case.measured, predictor.predict())
    measured, suspended = without_suspended(paired.measured, predictor)
    warnings += suspended
    predictor = predictor.for_test(measured)
    accepted = tuple(LIBRARY[name] for name, _ in case.accepted)
    problem = SpecimenProblem(
        predictor=predictor,
        measured=measured,
        tolerances=tolerances,
        order=paired.order,
        baseline=baseline,
        baseline_order=baseline_order,
        accepted=accepted,
        theory_error=theory_error(predictor, paired.order),
        mostly_alone=paired.mostly_alone,
        before_additions=there,
    )
    return problem, warnings


def _on_accepted(case: Case) -> list[str]:
    """Return which of the effects put into the model were there in the baseline, too, and which came afterwards."""
    notes = []
    before, after = (
        (False, "was there in the baseline, too", "false"),
        (True, "came after the baseline", "true"),
    )
    for since, when, other in (before, after):
        ranks = [i for i in range(len(case.accepted)) if (i in case.since_baseline) == since]
        for stated, why in ((False, f"; if not, write before = {other}"), (True, ", as the study states")):
            names = [case.accepted[i][0] for i in ranks if (i in case.baseline_stated) == stated]
            notes += [f"{', '.join(names)} of [[model.effect]] {when}{why}"] * bool(names)
    return notes


def _corrected(
    before: Paired, there: tuple[Callable[[Predictor], State], ...]
) -> Callable[[Predictor], State]:
    def build(predictor: Predictor) -> State:
        own_predictor = predictor.for_test(before.measured, there)
        return correct(own_predictor, before.measured, before.order)

    return build


def _locate(
    problem: DiagnosisProblem, found: Search, verdict: Verdict, rules: DecisionRules = DEFAULT_RULES
) -> Where:
    """State where the cause sits; of several specimens, on the first on which all of the best explanation acts."""
    if not isinstance(problem, Several):
        return locate(problem.specimens[0], found, verdict=verdict, rules=rules)
    leader = next((row.explanation for row in found.compared if row.names), found.nothing)

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
    part = replace(found, nothing=on(found.nothing, i), compared=rows)
    return locate(problem.specimens[i], part, verdict=verdict, whole=found, rules=rules)


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


def _shrink(
    problem: DiagnosisProblem,
    found: Search,
    rng: np.random.Generator,
    rules: DecisionRules,
    *,
    significant: bool,
) -> Shrink:
    named = [row for row in found.compared if row.names]
    best = named[0].explanation if named else found.nothing
    # what holds the best set and more is no rival of it
    rivals = [row.explanation for row in named[1:] if not holds(row.names, best.names)]
    runner_up = rivals[0] if rivals else None
    result = shrinkage(problem, found.nothing, best, runner_up, rng, rules=rules)
    return result if significant else replace(result, closed=None)


def _on_fit(
    leader: Explanation, inconsistent: Sequence[Split], *, significant: bool, fewest: int = 6
) -> list[str]:
    """Return what the reader should know about how far the data bear the first set of causes.

    What is left of fewer than ``fewest`` data beyond its parameters scatters by a third, so that it is weak evidence
    on the noise.
    """
    notes = [f"{' + '.join(leader.names)}: {split}: it is not named" for split in inconsistent[:1]]
    if not significant:
        return notes
    beyond = len(leader.best.comparison.residual) - len(leader.best.coordinates)
    if leader.names and beyond < fewest:
        notes.append(
            f"only {beyond} data beyond the parameters of {' + '.join(leader.names)}: how well it fits rests on "
            "the stated noise; measure more modes, or shapes"
        )
    return notes


def _on_samples(found: Search) -> list[str]:
    """Return which of the two most probable sets rest on few samples."""
    return [
        f"the probability and the intervals of {' + '.join(row.names) or 'no cause'} are rough: they rest on "
        f"{row.explanation.effective:.0f} effective samples; {ENOUGH_SAMPLES:.0f} are wanted"
        for row in found.compared[:2]
        if row.probability > NEGLIGIBLE_PROBABILITY and 0 < row.explanation.effective < ENOUGH_SAMPLES
    ]


def _notes(problem: DiagnosisProblem, found: Search, sets: tuple[tuple[str, ...], ...]) -> list[str]:
    """Return what the reader should know about how the answer was reached."""
    notes = []
    if found.both:
        notes.append(
            "the model's theory neglects shear and rotary inertia, which exceed the noise: every set of "
            "causes was compared with and without them"
        )
    notes += _on_samples(found)
    for one in problem.specimens:
        notes += notes_on_doubtful(one, " or ".join(" + ".join(names) for names in sets))
        if one.theory_error is not None:
            notes += notes_on(one.theory_error, one.measured, one.predictor.spec)
        notes += on_reduction(one.predictor, len(one.measured.frequency))
        notes += on_modes(one.measured, one.predictor.predict(at_least=one.reach).frequency, one.order)
        wet = one.predictor.environment.fluid_density is not None
        acting = [effect for row in found.compared[:1] for effect in row.explanation.candidate.effects]
        wet |= any("in air" in effect.undone_by for effect in acting)
        notes += on_levels(one.measured, fluid=wet)
    return notes
