"""Specimens on which an effect shows what it takes: a beam and a plate of steel, clamped at one end; a chain."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from updating.effects.base import Effect
from updating.effects.limits import PLACES
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable
from updating.models.parts import Region
from updating.models.spec import Kind, Material, Spec
from updating.prediction.predict import Predictor
from updating.test_data.measured import Measured

STEEL = Material(210e9, 7850.0)

BODY, SPRING = 0.1, 1e5
"""Of the chain that stands for imported matrices [kg, N/m]."""


def _chain() -> Imported:
    """Return four bodies on a chain of springs that move along z, the second and third joined at one place."""
    links = np.diag([2.0, 2.0, 2.0, 1.0]) - np.diag(np.ones(3), 1) - np.diag(np.ones(3), -1)
    first, second = np.diag([1.0, 1.0, 0.0, 0.0]), np.diag([0.0, 0.0, 1.0, 1.0])
    root = np.zeros((4, 4))
    root[0, 0] = 1.0
    nodes = NodeTable(
        np.arange(1, 5),
        np.array([[0.1, 0, 0], [0.2, 0, 0], [0.2, 0, 0], [0.3, 0, 0]]),
        np.full(4, 3),
        np.arange(4),
        sets={"joint_left": np.array([2]), "joint_right": np.array([3])},
    )
    return Imported(
        Sparse(SPRING * links),
        Sparse(BODY * np.eye(4)),
        nodes,
        (Sparse(SPRING * root), Sparse(SPRING * (links - root))),
        (Sparse(BODY * first), Sparse(BODY * second)),
        "chain",
    )


@cache
def chain() -> Spec:
    """Return the specification of a chain of bodies, which stands for imported matrices."""
    regions = Region("root", (0.0, 0.1)), Region("rest", (0.1, 0.3))
    return Spec(
        "matrices",
        length=0.2,
        width=1e-3,
        thickness=1e-3,
        elements=(),
        clamped=(),
        theory="imported",
        material=STEEL,
        regions=regions,
        imported=_chain(),
    )


SPECIMENS: dict[Kind, Spec] = {
    "beam": Spec(
        "beam",
        length=0.376,
        width=0.0305,
        thickness=0.0047625,
        elements=(10,),
        clamped=("x0",),
        theory="euler-bernoulli",
        material=STEEL,
    ),
    "plate": Spec(
        "plate",
        length=0.376,
        width=0.200,
        thickness=0.003175,
        elements=(10, 6),
        clamped=("x0",),
        theory="kirchhoff",
        material=STEEL,
    ),
}
"""Steel cantilevers whose priors a list of effects shows."""

SHOWN = (
    "a steel cantilever beam of 376 x 30.5 x 4.7625 mm, or plate of 376 x 200 x 3.175 mm, hit at 20 to 400 Hz; where "
    "neither can have it, a chain of four bodies"
)
"""What they are, in words."""


@cache
def example(kind: Kind) -> Predictor:
    """Return the specimen of a kind as seen by a complete test: three points, a sensor at the last."""
    spec = chain() if kind == "matrices" else SPECIMENS[kind]
    x = np.linspace(0.2, 0.3 if kind == "matrices" else 0.376, 3)
    points = np.column_stack([x, np.full(3, 0.2), np.zeros(3)])[:, : spec.dim]
    points = points * [1.0, 0.0, 0.0] if kind == "matrices" else points
    two, constants = np.ones(2), np.ones((3, 2))
    measured = Measured(
        frequency=np.array([20.0, 400.0]),
        frequency_sigma=two,
        damping=two,
        damping_sigma=two,
        points=points,
        nodes=(1, 2, 3),
        seen=np.full(3, 2),
        hit=np.arange(3),
        constants=constants,
        constants_sigma=constants,
        absolute=True,
    )
    return Predictor(spec, replace(measured, level=100.0))


def kinds_of(effect: Effect) -> list[Kind]:
    """Return the kinds of specimen here that an effect applies to; imported matrices where no other does."""
    return [kind for kind in SPECIMENS if kind in effect.models] or ["matrices"]


def unit_of(effect: Effect, parameter: str, kind: Kind) -> str:
    """Return the unit of a parameter of an effect on a kind of model, "" for a ratio and for what is no parameter."""
    units = dict.fromkeys(PLACES, "m")
    for shown in sorted(kinds_of(effect), key=lambda other: other == kind):
        units |= {p.name: p.unit for p in effect.parameters(example(shown))}
    unit = units.get(parameter, "-")
    return "" if unit == "-" else unit
