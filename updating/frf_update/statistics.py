"""How well the parameters of a stage are known."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.frf_update.begin import paired
from updating.frf_update.evaluation import Change, sensitivity
from updating.frf_update.mounting import resonances, shifted
from updating.frf_update.solve import DROWNED, Solved
from updating.frf_update.stage import Stage, modal_shares, whitened
from updating.frf_update.step import Step
from updating.models.damping import Matrices
from updating.prediction.prediction import Prediction
from updating.update.data.specimen import Specimen
from updating.update.gauss_newton import strong

WEAK = 0.2
"""Modal constants under this share of a mode's largest are weak evidence on relative errors [-]."""


@dataclass(frozen=True, eq=False)
class StageStatistics:
    """Statistics of one stage.

    Parameters
    ----------
    covariance : (p, p) array
        Of the coordinates; the variance of the doubt where the data determine less.
    undetermined : (p,) bool array
        Parameters that the data determine less than the prior knowledge, and that could as well not be there.
    chi2 : float
        Sum of squared residuals over the variance of the noise, real and imaginary parts [-].
    count : int
        Number of real data.
    """

    covariance: FloatArray
    undetermined: BoolArray
    chi2: float
    count: int


def assess(stage: Stage, solved: Solved, calibration: float, repeatability: float = 0.0) -> StageStatistics:
    """Work out covariance and determinability at the solution.

    What the model cannot follow is alike on neighbouring lines and at all points, so that it is no fresh piece of
    information on each: where there is a discrepancy, the residuals of the lines on one flank of a resonance are
    summed before they are squared (the cluster-robust covariance of Liang and Zeger 1986, with the correction
    G / (G - p)).
    A common error of the level moves the parameters as it would the FRFs, and so does another mounting each
    resonance.

    Parameters
    ----------
    stage : Stage
        The stage.
    solved : Solved
        Where it came to rest.
    calibration : float
        Relative 1-sigma uncertainty of the level [-].
    repeatability : float
        Relative 1-sigma scatter of every frequency by mounting the structure anew [-].
    """
    at = solved.at
    slopes = stage.slopes(solved.theta, at, measured=False)
    rows, load = whitened(stage, slopes, at, stage.variance(at, solved.discrepancy))
    rows = rows * stage.doubt
    _, size, right = np.linalg.svd(rows, full_matrices=False)
    kept = strong(size, DROWNED)
    bread = (right[kept].T / size[kept] ** 2) @ right[kept]
    covariance = bread
    if solved.discrepancy > 0:
        covariance = _clustered(stage, bread, rows * load[:, None], covariance)
    level = np.concatenate([part.ravel() for part in _level(stage, solved)])
    shift = bread @ (rows.T @ level) * calibration
    covariance = covariance + np.outer(shift, shift)
    if repeatability > 0:
        shift = bread @ (rows.T @ _mounted(stage, solved, repeatability))
        covariance = covariance + shift @ shift.T
    lost = right[~kept].T @ right[~kept]
    covariance = covariance + lost
    noise = 2 * np.abs(stage.residual(at)) ** 2 / stage.frfs.variance
    sigma = np.sqrt(np.diag(covariance))
    moved = np.abs(solved.theta) / stage.doubt  # a factor of 1 and a value of 0 have the coordinate 0
    alone = np.sqrt(np.sum((right.T / np.maximum(size, 1e-10)) ** 2 * ~kept, axis=1))
    undetermined = (alone > 1.0) | ((sigma > 1.0) & (moved < 2 * sigma))
    return StageStatistics(
        covariance * np.outer(stage.doubt, stage.doubt), undetermined, float(noise.sum()), 2 * noise.size
    )


def _level(stage: Stage, solved: Solved) -> tuple[FloatArray, FloatArray]:
    """Return what a relative error of the level adds to the whitened residuals."""
    scale = np.sqrt(2 / stage.variance(solved.at, solved.discrepancy))
    raised = stage.frfs.values * scale
    return np.asarray(raised.real), np.asarray(raised.imag)


def _mounted(stage: Stage, solved: Solved, repeatability: float) -> FloatArray:
    """Return what each resonance's scatter adds to the whitened residuals, (2 n, n_modes)."""
    small = 1e-3 * repeatability
    shift = np.full(len(resonances(solved.at)), small)
    scale = np.sqrt(2 / stage.variance(solved.at, solved.discrepancy)) * repeatability / small
    moved = (shifted(solved.at, stage.ends, shift) * scale).reshape(len(shift), -1)
    return np.hstack([moved.real, moved.imag]).T


def _clustered(stage: Stage, bread: FloatArray, scores: FloatArray, plain: FloatArray) -> FloatArray:
    """Return the cluster-robust covariance, or the plain one scaled up where clusters are too few."""
    resonances = stage.all_resonances
    nearest = np.abs(stage.frfs.frequency[:, None] - resonances).argmin(axis=1)
    cluster = 2 * nearest + (stage.frfs.frequency > resonances[nearest])
    clusters, parameters = len(np.unique(cluster)), scores.shape[1]
    n_frf = len(stage.frfs.values)
    member = np.tile(cluster, 2 * n_frf)
    if clusters <= parameters + 1:
        per = len(scores) / max(clusters, 1)
        return plain * per
    sums = np.stack([scores[member == c].sum(axis=0) for c in np.unique(cluster)])
    meat = sums.T @ sums * clusters / (clusters - parameters)
    return np.asarray(bread @ meat @ bread)


def misses(specimen: Specimen, step: Step) -> FloatArray:
    """Return how far parameters may be off for the frequencies and damping ratios that the model misses, (p, p).

    A model of another form cannot meet all modes: what it must give to one it takes from another. Every paired mode
    is given an error of its own, of the size that frequencies and damping ratios are missed by in the mean (frequencies
    by no less than they scatter from one mounting to the next), and that is
    followed through the estimate: how far an error of one mode's pole pulls each parameter.

    Parameters
    ----------
    specimen : Specimen
        The specimen.
    step : Step
        A stage at rest.
    """
    stage, solved = step.stage, step.solved
    at_rest, partner = paired(specimen, stage, solved.theta)
    test = specimen.measured
    variance = stage.variance(solved.at, solved.discrepancy)
    rows, _ = whitened(stage, stage.slopes(solved.theta, solved.at, measured=False), solved.at, variance)
    _, size, right = np.linalg.svd(rows * stage.doubt, full_matrices=False)
    kept = strong(size, DROWNED)
    gain = (right[kept].T / size[kept] ** 2) @ right[kept] @ (rows * stage.doubt).T
    dampers = sum(model_parameter.damper is not None for model_parameter in stage.model_parameters)
    total = np.zeros((len(solved.theta),) * 2)
    if np.all(stage.warp == 1.0):
        missed = max(
            _scatter(
                np.log(test.frequency / at_rest.frequency[partner]), len(stage.model_parameters) - dampers
            ),
            test.repeatability,
        )
        total += missed**2 * _pulled(
            stage, solved, gain, _pole_changes(stage, solved, partner, damping=False)
        )
    known = np.isfinite(test.damping) & (test.damping > 0) & np.isfinite(at_rest.damping[partner])
    if known.any() and stage.earlier.ratios is None:
        missed = _scatter(np.log(test.damping / at_rest.damping[partner])[known], dampers)
        total += missed**2 * _pulled(stage, solved, gain, _pole_changes(stage, solved, partner, damping=True))
    total += _constants_missed(specimen, stage, at_rest, partner) ** 2 * _reshaped(
        stage, solved, gain, partner
    )
    return np.asarray(total * np.outer(stage.doubt, stage.doubt))


def _constants_missed(specimen: Specimen, stage: Stage, at_rest: Prediction, partner: IntArray) -> float:
    """Return the relative error of the modal constants, a common level apart [-]."""
    test = specimen.measured
    seen = np.abs(test.constants) > WEAK * np.abs(test.constants).max(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = test.constants / at_rest.constants[:, partner]
    known = seen & (ratio > 0) & np.isfinite(ratio)
    if known.sum() < 2:
        return 0.0
    return float(np.std(np.log(ratio[known])))


def _reshaped(stage: Stage, solved: Solved, gain: FloatArray, partner: IntArray) -> FloatArray:
    """Return the covariance of the coordinates, in doubts, for unit relative errors of every modal constant."""
    constants, dynamic = modal_shares(solved.at, stage.ends)
    first = stage.predictor.reduced.structure.rigid_modes
    scale = np.sqrt(2 / stage.variance(solved.at, solved.discrepancy))
    n_frf, n_lines = scale.shape
    both = gain.reshape(len(gain), 2, n_frf, n_lines)
    total = np.zeros((len(gain),) * 2)
    for mode in first + partner:
        share = constants[:, [mode]] * dynamic[mode] * solved.at.gain * scale
        pull = np.einsum("pfl,fl->pf", both[:, 0], share.real) + np.einsum(
            "pfl,fl->pf", both[:, 1], share.imag
        )
        total += pull @ pull.T
    return total


def _scatter(residual: FloatArray, parameters: int) -> float:
    """Return the standard deviation of what is left by a fit of some parameters [-]."""
    return float(np.sqrt(residual @ residual / max(len(residual) - parameters, 1)))


def _pole_changes(stage: Stage, solved: Solved, partner: IntArray, *, damping: bool) -> list[Change]:
    """Return what a relative error of each mode's frequency, or of its damping, is in the matrices."""
    matrices = solved.at.matrices
    values, vectors = matrices.undamped
    first = stage.predictor.reduced.structure.rigid_modes
    nothing = np.zeros_like(matrices.mass)
    found = []
    for mode in first + partner:
        momentum = matrices.mass @ vectors[:, mode]
        shape = np.outer(momentum, momentum)
        own = float(vectors[:, mode] @ matrices.viscous @ vectors[:, mode])
        lost = float(vectors[:, mode] @ matrices.structural @ vectors[:, mode])
        changed = (
            Matrices(nothing, nothing, own * shape, lost * shape)
            if damping
            else Matrices(2 * values[mode] * shape, nothing, nothing, nothing)
        )
        found.append(Change(changed, np.zeros_like(solved.at.rows), log_gain=0.0, decay=0.0))
    return found


def _pulled(stage: Stage, solved: Solved, gain: FloatArray, errors: list[Change]) -> FloatArray:
    """Return the covariance of the coordinates, in doubts, for unit errors of the modes."""
    scale = np.sqrt(2 / stage.variance(solved.at, solved.discrepancy))
    total = np.zeros((len(gain),) * 2)
    for change in errors:
        moved = (sensitivity(solved.at, change, stage.ends) * scale).ravel()
        pull = gain @ np.concatenate([moved.real, moved.imag])
        total += np.outer(pull, pull)
    return total


def with_misses(found: StageStatistics, extra: FloatArray) -> StageStatistics:
    """Return statistics with a further covariance of the coordinates."""
    return replace(found, covariance=found.covariance + extra)
