"""Why an effect cannot be examined on some data."""

from __future__ import annotations

import numpy as np

from updating.prediction.predict import Predictor
from updating.test_data.chain import roving
from updating.test_data.measured import Measured


def damping_obstacle(predictor: Predictor) -> str | None:
    """Return why nothing can be said of what changes the damping, or None."""
    if not np.isfinite(predictor.measured.damping).any():
        return "no damping was measured"
    return None if predictor.expects_damping else "neither model nor baseline says what damping to expect"


def shape_obstacle(measured: Measured, least: int) -> str | None:
    """Return why so few points do not tell one of them apart, or None."""
    moved = measured.hit if roving(measured) == "hit" else measured.seen
    count = len(np.unique(moved[moved >= 0]))
    return None if count >= least else f"it takes shapes at {least} points or more to tell, found {count}"
