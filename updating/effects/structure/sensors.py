"""Where the sensors of a test sit, and whether one roves."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.prediction.predict import Predictor


def sensor_roves(predictor: Predictor) -> bool:
    """Return whether one sensor was moved from point to point while the hammer stayed."""
    test = predictor.measured
    return predictor.once("sensor roves", lambda: len(test.sensors) > 3 and len(set(test.hit.tolist())) == 1)


def sensor_share(predictor: Predictor) -> float:
    """Return in which share of the measurements each place of :func:`sensor_places` carries the mass [-]."""
    return 1 / len(sensor_places(predictor)) if sensor_roves(predictor) else 1.0


def sensor_places(predictor: Predictor) -> FloatArray:
    """Return where sensors sit, (n, dim) [m]: as the data say, else where the modeller put masses."""
    test, spec = predictor.measured, predictor.spec

    def build() -> FloatArray:
        if test.sensors:
            return np.unique(test.points[list(test.sensors)], axis=0)
        return np.array([mass.at[: spec.dim] for mass in spec.masses], dtype=float).reshape(-1, spec.dim)

    return predictor.once("places of sensors", build)
