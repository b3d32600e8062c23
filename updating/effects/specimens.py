"""Specimens on which an effect shows what it takes: a steel beam and a steel plate, both clamped at one end."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from updating.effects.base import Effect
from updating.effects.limits import PLACES
from updating.models.spec import Kind, Material, Spec
from updating.prediction.predict import Predictor
from updating.test_data.measured import Measured

STEEL = Material(210e9, 7850.0)

SPECIMENS: dict[Kind, Spec] = {
    "beam": Spec("beam", 0.376, 0.0305, 0.0047625, (10,), ("x0",), "euler-bernoulli", STEEL),
    "plate": Spec("plate", 0.376, 0.200, 0.003175, (10, 6), ("x0",), "kirchhoff", STEEL),
}
"""Steel cantilevers whose priors a list of effects shows."""

SHOWN = (
    "a steel cantilever beam of 376 x 30.5 x 4.7625 mm, or plate of 376 x 200 x 3.175 mm, hit at 20 to 400 Hz"
)
"""What they are, in words."""


@cache
def example(kind: Kind) -> Predictor:
    """Return the specimen of a kind as seen by a complete test: three points, a sensor at the last."""
    spec = SPECIMENS[kind]
    x = np.linspace(0.2, 0.376, 3)
    points = x[:, None] if spec.dim == 1 else np.column_stack([x, np.full(3, 0.2)])
    two, constants = np.ones(2), np.ones((3, 2))
    measured = Measured(
        np.array([20.0, 400.0]),
        two,
        two,
        two,
        points,
        (1, 2, 3),
        np.full(3, 2),
        np.arange(3),
        constants,
        constants,
        absolute=True,
    )
    return Predictor(spec, replace(measured, level=100.0))


def kinds_of(effect: Effect) -> list[Kind]:
    """Return the kinds of specimen here that an effect applies to."""
    return [kind for kind in SPECIMENS if kind in effect.models]


def unit_of(effect: Effect, parameter: str, kind: Kind) -> str:
    """Return the unit of a parameter of an effect on a kind of model, "" for a ratio and for what is no parameter."""
    units = dict.fromkeys(PLACES, "m")
    for shown in sorted(kinds_of(effect), key=lambda other: other == kind):
        units |= {p.name: p.unit for p in effect.parameters(example(shown))}
    unit = units.get(parameter, "-")
    return "" if unit == "-" else unit
