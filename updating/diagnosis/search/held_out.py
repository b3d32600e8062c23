"""Data left out of a fit and predicted from the rest, so that a gap that closes by mere freedom shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import lsq_linear

from acquisition.arrays import BoolArray, FloatArray
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.fit import highest
from updating.diagnosis.search.slope import sensitivities
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import marginal, normal_equations
from updating.problem.candidate import Candidate
from updating.thresholds import (
    BELIEVED_DOUBT,
    FRESH_PARAMETERS,
    HELD_OUT_FOLDS,
    REFIT_STEPS,
    SHORT_STEP,
    UNSEEN_CURVATURE,
)


def modes_held_out(diagnosis_problem: DiagnosisProblem, explanation: Explanation) -> FloatArray:
    """Predict each mode from all others, and return measured minus predicted data, (n,) [-].

    Parameters
    ----------
    diagnosis_problem : Problem or Several
        Test and model.
    explanation : Explanation
        What is refitted without each mode in turn.
    """
    comparison = explanation.best.comparison
    mode = comparison.mode
    return held_out(diagnosis_problem, explanation, [mode != m for m in np.unique(mode[comparison.of_pairs])])


def points_held_out(
    diagnosis_problem: DiagnosisProblem, explanation: Explanation
) -> tuple[FloatArray, BoolArray] | None:
    """Predict the constants at a part of the points from all other data, part by part.

    Returns
    -------
    residual : (n,) array
        Measured minus predicted data [-].
    predicted : (n,) bool array
        Which of them are constants of modes that have a partner.
    None
        Where there are too few points to leave any out.
    """
    groups = _groups(diagnosis_problem)
    if groups is None:
        return None
    parts = [groups != fold for fold in range(HELD_OUT_FOLDS)]
    return held_out(diagnosis_problem, explanation, parts), explanation.best.comparison.scaled


def _groups(diagnosis_problem: DiagnosisProblem) -> np.ndarray | None:
    """Return which part each datum belongs to, -1 if it is of no channel; None where there are few points."""
    found = []
    for problem in diagnosis_problem.specimens:
        test = problem.measured
        source = problem.at(Candidate(), np.zeros(0)).source
        group = np.full(len(source), -1)
        if test.has_shapes:
            roving = test.hit if len(np.unique(test.hit)) >= len(np.unique(test.seen)) else test.seen
            rank = np.unique(roving, return_inverse=True)[1] % HELD_OUT_FOLDS
            group[source >= 0] = rank[source[source >= 0]]
        found.append(group)
    groups = np.concatenate(found)
    return groups if len(np.unique(groups[groups >= 0])) == HELD_OUT_FOLDS else None


def held_out(
    diagnosis_problem: DiagnosisProblem, explanation: Explanation, parts: Sequence[BoolArray]
) -> FloatArray:
    """Return measured minus predicted data, those outside each part predicted from those inside, (n,) [-].

    Tolerances alone are kept within what is believed of them; how far an effect's fit stretches them, its p-value
    judges. Where nothing is left to fit, the residuals are nan.
    """
    best = explanation.best
    columns = sensitivities(diagnosis_problem, explanation.candidate, best)
    errors = np.zeros(len(best.comparison.residual))
    for keep in parts:
        if not keep.any():
            errors[~keep] = np.nan
        elif not explanation.names:
            errors[~keep] = believed(best.comparison, marginal(best.comparison, keep).scale, keep)[~keep]
        else:
            errors[~keep] = _refitted(diagnosis_problem, explanation, columns, keep)[~keep]
    return errors


def _refitted(
    diagnosis_problem: DiagnosisProblem, explanation: Explanation, columns: FloatArray, keep: BoolArray
) -> FloatArray:
    """Return what is left of all data when some of them were fitted: of many parameters by a short linear step."""
    best = explanation.best
    if columns.shape[1] <= FRESH_PARAMETERS:
        return highest(
            diagnosis_problem, explanation.candidate, best.coordinates, keep=keep, rounds=REFIT_STEPS
        ).left_over
    normal, load = normal_equations(best.comparison, columns, best.marginal.scale, keep)
    step = np.linalg.solve(normal + UNSEEN_CURVATURE * np.eye(len(load)), load)
    step = np.clip(best.coordinates + step, 0.0, 1.0) - best.coordinates
    if np.abs(step).max(initial=0.0) > SHORT_STEP:
        return highest(
            diagnosis_problem, explanation.candidate, best.coordinates, keep=keep, rounds=REFIT_STEPS
        ).left_over
    moved = replace(best.comparison, residual=best.comparison.residual - columns @ step)
    return np.asarray(moved.residual - moved.nuisance @ marginal(moved, keep).shift)


def believed(comparison: Comparison, scale: float, keep: BoolArray | None = None) -> FloatArray:
    """Return what is left of a residual once all doubts, within what is believed of them, have done their best.

    Parameters
    ----------
    comparison : Comparison
        Residual, nuisances and noise.
    scale : float
        Of the noise of the shapes [-].
    keep : (n,) bool array, optional
        Data that are fitted; left out, all.
    """
    rows = slice(None) if keep is None else keep
    weight = 1 / np.sqrt(comparison.noise(scale)[rows])
    columns = comparison.nuisance[rows] * weight[:, None]
    count = columns.shape[1]
    whole = np.vstack([columns, np.eye(count)])
    data = np.concatenate([comparison.residual[rows] * weight, np.zeros(count)])
    shift = np.linalg.lstsq(whole, data, rcond=None)[0]
    limit = np.full(count, np.inf)
    limit[comparison.doubts] = BELIEVED_DOUBT
    if (np.abs(shift) > limit).any():
        shift = lsq_linear(whole, data, bounds=(-limit, limit)).x
    return np.asarray(comparison.residual - comparison.nuisance @ shift)
