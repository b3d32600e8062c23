"""What sits at node sets, each by its name, or at any of the test's points."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.quantities import severity
from modalkit.planning.family import Family, Values, per_cent
from modalkit.planning.own.sizes import BODY, FAINTEST, HEAVIEST, in_g, in_unit
from updating.effects.base import Effect, total_mass
from updating.effects.regions import WAYS
from updating.effects.structure.spring import own_stiffness
from updating.prediction.predict import Predictor

STIFFEST, SPRING = 100.0, 0.3
"""Stiffest spring to the ground and the one that is asked about, over the structure's own stiffness [-]: the latter
raises a cantilever's lowest frequency by a twentieth."""


def _bodies(effect: Effect, predictor: Predictor, points: FloatArray) -> Iterator[Family]:
    """A body at each node set, and at any of the test's points."""
    mass = total_mass(predictor.spec)
    for name, place in _places(predictor, points):
        more: Values = {"bulk": 1.0}
        yield _body(effect.name, name, place, more, mass)


def _body(cause: str, name: str, places: list[Values], more: Values, mass: float) -> Family:
    return Family(
        name=f"{cause} at {name}" if name else cause,
        values=lambda q, i: {**places[int(i)], **more, "mass": q}, low=0.0, high=HEAVIEST * mass, clear=BODY * mass,
        words=f"a body at {name} heavier than" if name else "a body at a point heavier than", amount=in_g,
        places=np.arange(float(len(places))) if len(places) > 1 else np.zeros(0), effect=cause, at=name,
    )  # fmt: skip


def _places(predictor: Predictor, points: FloatArray) -> Iterator[tuple[str, list[Values]]]:
    """Give each node set by its name, and all points of the test together under none."""
    imported = predictor.spec.imported
    for group in () if imported is None else imported.groups:
        yield group.name, [{"at": group.name}]
    if len(points):
        yield "", [dict(zip("xyz", map(float, at), strict=False)) for at in np.unique(points, axis=0)]


def _springs(effect: Effect, predictor: Predictor, points: FloatArray) -> Iterator[Family]:
    """A spring at each node set along each axis, and at any of the test's points."""
    own, imported = own_stiffness(predictor), predictor.spec.imported
    still: Values = {"damping": 0.0, "extent": 0.0}

    def family(name: str, at: str, places: list[Values]) -> Family:
        return Family(
            name=name, values=lambda q, i: {**places[int(i)], **still, "stiffness": q}, low=0.0,
            high=STIFFEST * own, clear=SPRING * own,
            words=f"a spring to the ground at {at or 'a point'} stiffer than", amount=in_unit("N/m"),
            places=np.arange(float(len(places))) if len(places) > 1 else np.zeros(0), effect=effect.name,
            at=at, finest=FAINTEST,
        )  # fmt: skip

    for name, places in _places(predictor, points):
        if not name:
            yield family(effect.name, "", places)
            continue
        assert imported is not None
        (group,) = (one for one in imported.groups if one.name == name)
        for axis in (axis for axis in range(3) if group.moves(axis)):
            yield family(
                f"{effect.name} at {name} along {WAYS[axis]}", name, [{**places[0], "along": WAYS[axis]}]
            )


def _channels(effect: Effect, predictor: Predictor, points: FloatArray) -> Iterator[Family]:
    """Any of the points by a gain of its own."""
    nodes = predictor.measured.nodes[: len(points)]
    end = float(np.log(2.5))
    yield Family(
        name=effect.name, values=lambda q, i: {"points": (nodes[int(i)],), "gain": float(np.exp(q))},
        low=-end, high=end, clear=0.2, words="a point's level off by more than", amount=per_cent,
        places=np.arange(float(len(points))), separately=True,
    )  # fmt: skip


def _strayed(effect: Effect, predictor: Predictor, points: FloatArray) -> Iterator[Family]:
    """Any of the points beside its place, along x."""
    nodes, length = predictor.measured.nodes, predictor.spec.length
    yield Family(
        name=effect.name, values=lambda q, i: {"point": nodes[int(i)], "dx": q, "dy": 0.0},
        low=-0.12 * length, high=0.12 * length, clear=0.05 * length, words="a point off by more than",
        amount=lambda q: f"{severity(1e3 * abs(q))} mm", places=np.arange(float(len(points))),
        separately=True,
    )  # fmt: skip


AtPoints = Callable[[Effect, Predictor, FloatArray], Iterator[Family]]

SPOTS: dict[str, AtPoints] = {
    "lumped_mass": _bodies,
    "ground_spring": _springs,
    "channel_gain": _channels,
    "position_error": _strayed,
}
"""By effect; each is given the points of the test, (n, dim) [m]."""
