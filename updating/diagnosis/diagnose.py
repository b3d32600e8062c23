"""From a case to a diagnosis."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from acquisition.arrays import FloatArray
from updating.baseline import correct, doubt_in_mass
from updating.case import Case
from updating.diagnosis.goodness import p_value
from updating.diagnosis.next_test import propose
from updating.diagnosis.problem import Problem
from updating.diagnosis.result import Diagnosis, Gap, Shrink
from updating.diagnosis.search import Search, search
from updating.diagnosis.shrink import shrinkage
from updating.diagnosis.verdict import decide, is_significant, rank
from updating.diagnosis.where import locate
from updating.effects import LIBRARY, Effect
from updating.matching import Paired, mac_of_constants, pair_modes
from updating.models.state import State
from updating.nominal import predictor_of
from updating.prediction import Predictor


def diagnose(
    case: Case, *, library: Sequence[Effect] | None = None, rng: np.random.Generator | None = None
) -> Diagnosis:
    """Say where the gap between a test and a model lies, what causes it, and how far it closes.

    Parameters
    ----------
    case : Case
        Test, model, baseline and doubts.
    library : sequence of Effect, optional
        Effects to consider; left out, the whole library.
    rng : Generator, optional
        For the bootstrap; left out, a fixed one, so that the answer repeats.

    Returns
    -------
    Diagnosis

    Raises
    ------
    EstimationError
        If no measured mode has a partner in the model.
    """
    rng = np.random.default_rng(1) if rng is None else rng
    effects = list(LIBRARY.values()) if library is None else list(library)
    with threadpool_limits(1, user_api="blas"):  # two threads are slower on small eigenproblems
        return _diagnose(case, effects, rng)


def _diagnose(case: Case, effects: list[Effect], rng: np.random.Generator) -> Diagnosis:
    problem, warnings = pose(case)
    accepted = {name for name, _ in case.accepted}
    found = search(problem, [e for e in effects if e.name not in accepted])
    chance = p_value(found.nothing.best)
    significant = is_significant(found, chance)
    verdict, sets = decide(found, significant=significant)
    return Diagnosis(
        case.title,
        significant,
        chance,
        _gap(problem),
        locate(problem, found, significant=significant),
        _shrink(problem, found, rng, significant=significant),
        verdict,
        sets,
        rank(problem, found),
        propose(problem, found, sets),
        (*warnings, *_remarks(problem, found)),
        found.not_examined,
    )


def pose(case: Case) -> tuple[Problem, list[str]]:
    """Pair the modes, put the baseline and accepted effects into the model, and pose the problem."""
    predictor = predictor_of(case)
    additions = list(predictor.additions)
    paired = pair_modes(case.measured, predictor.predict())
    warnings = [*case.measured.warnings, *paired.warnings]
    baseline, baseline_order, tolerances = None, None, case.tolerances
    if case.baseline is not None:
        looking = predictor.looking(case.baseline, ())
        before = pair_modes(case.baseline, looking.predict())
        doubt = doubt_in_mass(predictor.looking(before.measured, ()), before.measured, before.order)
        tolerances = replace(tolerances, factors={**tolerances.factors, "section": doubt})
        warnings += [f"baseline: {w}" for w in before.warnings]
        additions.append(_corrected(before))
        baseline, baseline_order = before.measured, before.order
        predictor = predictor.looking(case.measured, tuple(additions))
        paired = pair_modes(case.measured, predictor.predict())
    predictor = predictor.looking(paired.measured)
    accepted = tuple(LIBRARY[name] for name, _ in case.accepted)
    problem = Problem(
        predictor,
        paired.measured,
        tolerances,
        paired.order,
        baseline,
        baseline_order,
        accepted,
        paired.trusted,
    )
    return problem, warnings


def _corrected(before: Paired) -> Callable[[Predictor], State]:
    def build(predictor: Predictor) -> State:
        looking = predictor.looking(before.measured, ())
        return correct(looking, before.measured, before.order)

    return build


def _gap(problem: Problem) -> Gap:
    test, model = problem.measured, problem.nominal
    error = 100 * (model.frequency / test.frequency - 1)
    sigma = 100 * np.sqrt((test.frequency_sigma / test.frequency) ** 2 + test.repeatability**2)
    mac = np.diag(mac_of_constants(test, model)) if test.has_shapes else np.full(len(error), np.nan)
    modes = pd.DataFrame(
        {
            "test [Hz]": test.frequency,
            "model [Hz]": model.frequency,
            "error [%]": error,
            "sigma [%]": sigma,
            "MAC": mac,
            "test damping": test.damping,
            "model damping": model.damping,
        },
        index=pd.RangeIndex(1, len(error) + 1, name="mode"),
    )
    rms = float(np.sqrt(np.mean(error**2)))
    return Gap(modes, rms, float(np.sqrt(np.mean(sigma**2))), _frac(problem))


def _frac(problem: Problem) -> FloatArray:
    """Return, per FRF, the correlation of measured and nominal constants over the modes [-]."""
    a, b = problem.measured.constants, problem.nominal.constants
    power = np.sum(a**2, axis=1) * np.sum(b**2, axis=1)
    return np.asarray(np.sum(a * b, axis=1) ** 2 / np.maximum(power, 1e-300))


def _shrink(problem: Problem, found: Search, rng: np.random.Generator, *, significant: bool) -> Shrink:
    named = [row for row in found.weighed if row.names]
    best = named[0].explanation if named else found.nothing
    runner_up = named[1].explanation if len(named) > 1 else None
    result = shrinkage(problem, found.nothing, best, runner_up, rng)
    return result if significant else replace(result, closed=None)


def _mesh_error(problem: Problem) -> float:
    """Return the largest relative change of a paired beam mode when the mesh is refined [-]."""
    spec = problem.predictor.spec
    if spec.kind != "beam":
        return 0.0
    rank = 1 + int(problem.order.max())
    coarse, fine = (
        Predictor(one, problem.measured).predict(count=rank).frequency
        for one in (spec, spec.with_elements(2 * spec.elements[0]))
    )
    return float(np.abs(np.log(fine / coarse)).max())


def _remarks(problem: Problem, found: Search) -> list[str]:
    """Return what the reader ought to know about how the answer was reached."""
    remarks = []
    leader = next((row for row in found.weighed if row.names), None)
    if leader is not None and leader.explanation.candidate.theory is not None:
        remarks.append(
            "the beam theory of the model leaves out shear and rotary inertia by more than the noise; "
            "every effect was weighed with and without them"
        )
    finer = _mesh_error(problem)
    if finer > problem.measured.repeatability:
        remarks.append(
            f"the mesh alone moves a mode by {100 * finer:.2g} %, more than the noise: use more elements"
        )
    if len(problem.measured.frequency) < 3:
        remarks.append(f"only {len(problem.measured.frequency)} modes are paired: little can be told apart")
    return remarks
