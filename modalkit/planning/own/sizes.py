"""What the families of a study's own model have in common: how they are made, and how sizes are written."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from acquisition.quantities import severity
from modalkit.planning.family import Family
from updating.effects.base import Effect
from updating.prediction.predict import Predictor

Maker = Callable[[Effect, Predictor], Iterator[Family]]
"""Makes the families of an effect on a model, none where it has no place there."""

FAINTEST = 1e-5
"""Smallest severity that is solved where it ranges over many decades, of the largest [-]."""

HEAVIEST, BODY = 0.3, 0.05
"""Largest body and the one that is asked about, of the structure's mass [-]."""


def in_unit(unit: str) -> Callable[[float], str]:
    """Return what writes a severity in a unit."""
    return lambda q: f"{severity(q)} {unit}"


def in_g(q: float) -> str:
    """Return a mass [kg] in grams."""
    return f"{severity(1e3 * q)} g"
