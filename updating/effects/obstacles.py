"""Why an effect cannot be examined on a model or on some data."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from updating.prediction.predict import Predictor
from updating.test_data.measured import Measured


class Lack(Enum):
    """What is missing where an effect cannot be examined."""

    MODEL = "model"
    """The model has no place for it, or holds it already."""
    DATA = "data"
    """The test did not measure what would show it."""
    EXPECTATION = "expectation"
    """Neither model nor baseline states what would be there without it."""
    ONE_TEST = "one test"
    """It differs from test to test, and several are diagnosed together."""


@dataclass(frozen=True)
class Obstacle:
    """Why an effect cannot be examined.

    Parameters
    ----------
    lack : Lack
        What is missing.
    sentence : str
        The reason in words, a name in braces where one of the numbers stands.
    numbers : tuple of (str, float)
        What would be needed and what was found, by name.
    """

    lack: Lack
    sentence: str
    numbers: tuple[tuple[str, float], ...] = ()

    def __str__(self) -> str:
        """Return the reason in words."""
        return self.sentence.format(**dict(self.numbers))


def damping_obstacle(predictor: Predictor) -> Obstacle | None:
    """Return why changes of the damping cannot be examined, or None."""
    if not np.isfinite(predictor.measured.damping).any():
        return Obstacle(Lack.DATA, "no damping was measured")
    if predictor.expects_damping:
        return None
    return Obstacle(Lack.EXPECTATION, "neither model nor baseline states the expected damping")


def shape_obstacle(measured: Measured, least: int) -> Obstacle | None:
    """Return why so few points do not separate one of them, or None."""
    moved = measured.hit if measured.roving == "hit" else measured.seen
    count = len(np.unique(moved[moved >= 0]))
    if count >= least:
        return None
    what = "shapes at {needed} points or more are needed, found {found}"
    return Obstacle(Lack.DATA, what, (("needed", least), ("found", count)))
