"""How well the parameters of a stage are known."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.frf_update.solve import DROWNED, Solved
from updating.frf_update.stage import Stage, whitened
from updating.frf_update.step import Step
from updating.matching import match
from updating.update.specimen import Specimen

STEP = 1e-3
"""Step of the differences of frequencies, in a parameter's doubts [-]."""

FAINT = 0.02
"""Directions in which a doubt moves the frequencies no more than this share of the most are none to them [-]."""


@dataclass(frozen=True, eq=False)
class StageStatistics:
    """Statistics of one stage.

    Parameters
    ----------
    covariance : (p, p) array
        Of the coordinates; the variance of the doubt where the data say less.
    undetermined : (p,) bool array
        Parameters of which the data say less than was known before, and that could as well not be there.
    chi2 : float
        Sum of squared residuals over the variance of the noise, real and imaginary parts [-].
    count : int
        Number of real data.
    """

    covariance: FloatArray
    undetermined: BoolArray
    chi2: float
    count: int


def assess(stage: Stage, solved: Solved, calibration: float) -> StageStatistics:
    """Work out covariance and determinability at the solution.

    What the model cannot follow is alike on neighbouring lines and at all points, so that it is no fresh piece of
    information on each: where there is a discrepancy, the residuals of the lines on one flank of a resonance are
    summed before they are squared (the cluster-robust covariance of Liang and Zeger 1986, with the correction
    G / (G - p)).
    A common error of the level moves the parameters as it would the FRFs.

    Parameters
    ----------
    stage : Stage
        The stage.
    solved : Solved
        Where it came to rest.
    calibration : float
        Relative 1-sigma uncertainty of the level [-].
    """
    at = solved.at
    slopes = stage.slopes(solved.theta, at, measured=False)
    rows, load = whitened(stage, slopes, at, stage.variance(at, solved.discrepancy))
    rows = rows * stage.doubt
    _, size, right = np.linalg.svd(rows, full_matrices=False)
    kept = size > max(DROWNED, 1e-10 * size.max(initial=0.0))
    bread = (right[kept].T / size[kept] ** 2) @ right[kept]
    covariance = bread
    if solved.discrepancy > 0:
        covariance = _clustered(stage, bread, rows * load[:, None], covariance)
    level = np.concatenate([part.ravel() for part in _level(stage, solved)])
    shift = bread @ (rows.T @ level) * calibration
    covariance = covariance + np.outer(shift, shift)
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
    """Return how far parameters may be off for the frequencies that the updated model misses, (p, p).

    A model of another form cannot meet all modes: what it must give to one it takes from another. Least squares
    of the frequencies, with their own residual scatter, says how much that leaves open; directions that frequencies
    do not determine get nothing from here.

    Parameters
    ----------
    specimen : Specimen
        The specimen.
    step : Step
        A stage at rest.
    """
    stage, theta = step.stage, step.solved.theta
    test, predictor = specimen.measured, stage.predictor
    at_rest = predictor.predict(step.state)
    partner = match(test, at_rest, specimen.order)
    residual = np.log(test.frequency / at_rest.frequency[partner])
    slopes = np.zeros((len(residual), len(theta)))
    for i, knob in enumerate(stage.knobs):
        ends = np.clip(theta[i] + STEP * knob.doubt * np.array([-1, 1]), stage.low[i], stage.high[i])
        logs = []
        for end in ends:
            moved = np.where(np.arange(len(theta)) == i, end, theta)
            prediction = predictor.predict(stage.state(moved), count=len(at_rest.frequency))
            logs.append(np.log(prediction.frequency[partner]))
        slopes[:, i] = (logs[1] - logs[0]) / (ends[1] - ends[0]) * knob.doubt
    _, size, right = np.linalg.svd(slopes, full_matrices=False)
    kept = size > FAINT * max(size.max(initial=0.0), 1e-6)
    scatter = float(residual @ residual) / max(len(residual) - int(kept.sum()), 1)
    inverse = (right[kept].T / size[kept] ** 2) @ right[kept]
    return np.asarray(scatter * inverse * np.outer(stage.doubt, stage.doubt))


def with_misses(found: StageStatistics, extra: FloatArray) -> StageStatistics:
    """Return statistics with a further covariance of the coordinates."""
    return replace(found, covariance=found.covariance + extra)
