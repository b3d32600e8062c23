"""Where a stage may begin whose peaks do not overlap: where the identified frequencies put its parameters.

An FRF is little affected by a resonance that lies many widths away, and the misfit has hollows at every chance meeting
of peaks. The frequencies themselves change smoothly with the parameters (paper A, Eqs. 15-25), and lead near.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.frf_update.stage import Stage
from updating.prediction.assignment import match
from updating.prediction.prediction import Prediction
from updating.update.data.specimen import Specimen

STEP = 1e-3
"""Step of the differences of frequencies, in a parameter's doubts [-]."""

CLOSE = 0.005
"""Standard deviation given to a measured frequency, relative: near is enough [-]."""

ITERATIONS = 20
"""Most steps."""

SETTLED = 1e-2
"""Steps under this share of each parameter's doubt end the iteration [-]."""


def from_frequencies(specimen: Specimen, stage: Stage, theta: FloatArray) -> FloatArray:
    """Return coordinates at which the model meets the identified frequencies, held to the start by the doubts.

    Parameters
    ----------
    specimen : Specimen
        The specimen, with its identified modes.
    stage : Stage
        Whose parameters are turned.
    theta : (p,) array
        Coordinates to start from and to be held to.
    """
    start, doubt = theta, stage.doubt
    at, partner = paired(specimen, stage, theta)
    cost = _cost(specimen, at, partner, (theta - start) / doubt)
    for _ in range(ITERATIONS):
        rows = frequency_slopes(stage, theta, at, partner) / CLOSE
        load = np.log(specimen.measured.frequency / at.frequency[partner]) / CLOSE
        system = np.vstack([rows, np.eye(len(theta))])
        step = np.linalg.lstsq(system, np.concatenate([load, (start - theta) / doubt]), rcond=None)[0] * doubt
        found = None
        for halving in range(6):
            new = np.clip(theta + step / 2**halving, stage.low, stage.high)
            there, other = paired(specimen, stage, new)
            fell = _cost(specimen, there, other, (new - start) / doubt)
            if fell < cost:
                found = new
                break
        if found is None:
            return theta
        moved, theta, at, partner, cost = found - theta, found, there, other, fell
        if np.all(np.abs(moved) < SETTLED * doubt):
            return theta
    return theta


def _cost(specimen: Specimen, at: Prediction, partner: IntArray, moved: FloatArray) -> float:
    miss = np.log(specimen.measured.frequency / at.frequency[partner]) / CLOSE
    cost = float(miss @ miss + moved @ moved)
    return cost if np.isfinite(cost) else np.inf


def paired(specimen: Specimen, stage: Stage, theta: FloatArray) -> tuple[Prediction, IntArray]:
    """Return the model's modes at some coordinates, and which of them each measured mode is."""
    at = stage.predictor.predict(stage.state(theta))
    return at, match(specimen.measured, at, specimen.order)


def frequency_slopes(stage: Stage, theta: FloatArray, at: Prediction, partner: IntArray) -> FloatArray:
    """Return the differences of ln f of the partners by the coordinates, in their doubts, (n_modes, p) [-]."""
    slopes = np.zeros((len(partner), len(theta)))
    for i, model_parameter in enumerate(stage.model_parameters):
        ends = np.clip(
            theta[i] + STEP * model_parameter.doubt * np.array([-1, 1]), stage.low[i], stage.high[i]
        )
        logs = []
        for end in ends:
            moved = np.where(np.arange(len(theta)) == i, end, theta)
            prediction = stage.predictor.predict(stage.state(moved), count=len(at.frequency))
            logs.append(np.log(prediction.frequency[partner]))
        slopes[:, i] = (logs[1] - logs[0]) / (ends[1] - ends[0]) * model_parameter.doubt
    return slopes
