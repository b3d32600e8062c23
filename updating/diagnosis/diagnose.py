"""From a case to a diagnosis."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from acquisition.errors import InputError
from updating.case import Case
from updating.diagnosis.answer.result import Diagnosis
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.decision import SearchedCase, diagnosis_of
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.problem.several import Several
from updating.diagnosis.search.search import search
from updating.diagnosis.search.unmeasured import fits, with_unmeasured_modes
from updating.effects import LIBRARY, Effect, hypotheses_of
from updating.models.state import State
from updating.nominal import accepted_additions, predictor_of
from updating.prediction.baseline import correct, doubt_in_mass, in_one_chain
from updating.prediction.matching import Paired, pair_modes
from updating.prediction.predict import Predictor
from updating.prediction.suspended import without_suspended
from updating.problem.specimen import SpecimenProblem
from updating.problem.stated_doubts import of_updates_alone
from updating.problem.theory_error import theory_error
from updating.steps import SILENT, SingleCause, Steps
from updating.test_data.same_places import unmatched


def diagnose(
    case: Case,
    *,
    library: Sequence[Effect] | None = None,
    rules: DecisionRules = DEFAULT_RULES,
    rng: np.random.Generator | None = None,
    progress: Callable[[str], None] | None = None,
    part: Callable[[float], None] | None = None,
    found: Callable[[SingleCause], None] | None = None,
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
    part : function, optional
        Called with how much of a stage is done, from 0 to 1, in those that compare causes.
    found : function, optional
        Called with every single cause as it is compared, no cause first.

    Returns
    -------
    Diagnosis

    Raises
    ------
    EstimationError
        If no measured mode has a partner in the model.
    """
    with threadpool_limits(1, user_api="blas"):  # two threads are slower on small eigenproblems
        steps = Steps.to(progress, part, found)
        return diagnosis_of(
            searched_case(case, library=library, steps=steps), rules=rules, rng=rng, steps=steps
        )


def diagnose_together(
    cases: Sequence[Case],
    *,
    shared: Sequence[str] = (),
    library: Sequence[Effect] | None = None,
    rules: DecisionRules = DEFAULT_RULES,
    rng: np.random.Generator | None = None,
    progress: Callable[[str], None] | None = None,
    part: Callable[[float], None] | None = None,
    found: Callable[[SingleCause], None] | None = None,
) -> Diagnosis:
    """Diagnose several specimens whose gaps have causes in common.

    Parameters
    ----------
    cases : sequence of Case
        One per specimen.
    shared : sequence of str
        Effects whose parameters are one and the same on all specimens (one accelerometer, one kind of clamp); those
        of all others are free on each.
    library, rules, rng, progress, part, found
        As in :func:`diagnose`.

    Raises
    ------
    InputError
        If a shared effect is not in the library, or two cases bear one title.
    EstimationError
        If no measured mode of a specimen has a partner in its model.
    """
    with threadpool_limits(1, user_api="blas"):
        steps = Steps.to(progress, part, found)
        searched = searched_together(cases, shared=shared, library=library, steps=steps)
        return diagnosis_of(searched, rules=rules, rng=rng, steps=steps)


def searched_case(
    case: Case, *, library: Sequence[Effect] | None = None, steps: Steps = SILENT
) -> SearchedCase:
    """Pose the problem of a case and search it; what it means is for :func:`diagnosis_of` to decide.

    Parameters
    ----------
    case : Case
        Test, model, baseline and doubts.
    library : sequence of Effect, optional
        As in :func:`diagnose`.
    steps : Steps
        Where stages are announced.
    """
    steps.begin("pairing the modes")
    problem, warnings = pose(case)
    accepted = {name for name, _ in case.accepted}
    return _searched(problem, (case.title,), accepted, library, warnings, steps)


def searched_together(
    cases: Sequence[Case],
    *,
    shared: Sequence[str] = (),
    library: Sequence[Effect] | None = None,
    steps: Steps = SILENT,
) -> SearchedCase:
    """Pose the problem of several cases and search it, as :func:`searched_case` does for one.

    Parameters
    ----------
    cases : sequence of Case
        One per specimen.
    shared, library
        As in :func:`diagnose_together`.
    steps : Steps
        Where stages are announced.

    Raises
    ------
    InputError
        If a shared effect is not in the library, or two cases bear one title.
    """
    effects = list(LIBRARY.values()) if library is None else list(library)
    own = {one.name for case in cases for one in hypotheses_of(case.spec)}
    if unknown := [name for name in shared if name not in {effect.name for effect in effects} | own]:
        raise InputError(f"--shared {unknown[0]}: there is no such effect; `modalkit effects` lists them")
    titles = tuple(case.title for case in cases)
    if len(set(titles)) < len(titles):
        raise InputError(f"two studies have the same title ({', '.join(titles)}); give each its own title")
    steps.begin("pairing the modes")
    problems = [pose(case) for case in cases]
    several = Several(tuple(problem for problem, _ in problems), titles, frozenset(shared))
    accepted = {name for case in cases for name, _ in case.accepted}
    warnings = [f"{title}: {one}" for title, (_, own) in zip(titles, problems, strict=True) for one in own]
    return _searched(several, titles, accepted, library, warnings, steps)


def _searched(
    problem: DiagnosisProblem,
    titles: tuple[str, ...],
    accepted: Collection[str],
    library: Sequence[Effect] | None,
    warnings: Sequence[str],
    steps: Steps,
) -> SearchedCase:
    own = {effect.name: effect for one in problem.specimens for effect in hypotheses_of(one.predictor.spec)}
    effects = _examined(problem, library, own, accepted)
    found = search(problem, effects, steps)
    steps.begin("looking for modes that are missing in the test")
    anew = with_unmeasured_modes(problem, found, effects)
    if anew is not None:
        again = search(anew[0], effects, steps)
        if fits(again):  # what does not fit with other pairs either is no reason for them
            problem, found, warnings = anew[0], again, [*warnings, anew[1]]
    return SearchedCase(problem, titles, found, own, tuple(warnings))


def _examined(
    problem: DiagnosisProblem,
    library: Sequence[Effect] | None,
    own: Mapping[str, Effect],
    accepted: Collection[str],
) -> list[Effect]:
    """Return the effects of a library and the user's own, those left out that are accepted and occur once alone."""
    effects = list(LIBRARY.values() if library is None else library)
    effects += [effect for name, effect in own.items() if name not in {effect.name for effect in effects}]
    return [e for e in effects if e.name not in accepted or e.several or e.repeats_on(problem.predictor)]


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
        notes = (*case.baseline.warnings, *before.warnings, *unmatched(case.measured, before.measured))
        warnings += [f"baseline: {w}" for w in notes]
        warnings += _on_accepted(case)
        additions.append(_corrected(before, there))
        baseline, baseline_order = before.measured, before.order
        predictor = predictor.for_test(case.measured, tuple(additions))
        paired = pair_modes(in_one_chain(case.measured, before.measured), predictor.predict())
        warnings += _on_one_chain(case.measured.calibration, paired.measured.calibration)
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


def _on_one_chain(stated: float, left: float) -> list[str]:
    """Return what two tests through one measurement chain are taken to be, where that narrows what is stated."""
    if left >= stated:
        return []
    return [
        f"test and baseline have the same calibration, {100 * stated:g} %: one measurement chain is assumed, whose "
        f"level repeats to {100 * left:g} %; if it was changed in between, state a different calibration in [baseline]"
    ]


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
