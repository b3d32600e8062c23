"""Where a test that is only planned will be hit and seen, on a model that has more than one direction to go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition import Dof, Geometry
from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from modalkit.study.planned_points import PlainPoint
from modalkit.study.read import Study
from updating import Measured, Spec
from updating.test_data.axes import Axes
from updating.test_data.placement import Placed, matched, place


@dataclass(frozen=True, eq=False)
class PlannedPoints:
    """Points of a planned test on the model.

    Parameters
    ----------
    points : (n, dim) array
        Where they are [m].
    nodes : tuple of int
        Their numbers: those of the model where these were stated, else counted on.
    directions : (n, 3) array or None
        Which way each moves; None is along z [-].
    hit : tuple of int
        Which of them are hit.
    sensor : int or None
        Which carries the sensor; None where the study does not say.
    """

    points: FloatArray
    nodes: tuple[int, ...]
    directions: FloatArray | None
    hit: tuple[int, ...]
    sensor: int | None

    def test(self, study: Study, sensor: int) -> Measured:
        """Return the test without modes: every point is hit, one is observed."""
        n, none, table = len(self.hit), np.zeros(0), study.test
        return Measured(
            frequency=none, frequency_sigma=none, damping=none, damping_sigma=none, points=self.points,
            nodes=self.nodes, seen=np.full(n, sensor), hit=np.array(self.hit), constants=np.zeros((n, 0)),
            constants_sigma=np.zeros((n, 0)), absolute=True, calibration=table.calibration,
            repeatability=table.repeatability, position_sigma=table.position_sigma, title=study.name,
            directions=self.directions,
        )  # fmt: skip


def planned_points(study: Study, spec: Spec) -> PlannedPoints | None:
    """Return the points that a study plans to hit, None where it names none.

    Parameters
    ----------
    study : Study
        The study.
    spec : Spec
        Its model.

    Raises
    ------
    StudyError
        If a point is written for another kind of model, or lies off it.
    """
    table = study.test
    if not table.points:
        return None
    stated = [*table.points, *([] if table.sensor is None else [table.sensor])]
    keys = "points" if table.sensor is None else "points and sensor"
    try:
        placed = _placed(stated, spec)
        points, _ = matched(placed.points, placed.keys, spec, table.match_tolerance)
    except StudyError as error:
        raise StudyError(f"{study.path}: [test] {keys}: {error}") from error
    count = len(table.points)
    if len(placed.rows) < len(stated):
        lost = stated[min(set(range(len(stated))) - set(placed.rows.tolist()))]
        raise StudyError(
            f"{study.path}: [test] {keys}: {_written(lost)}: the model cannot move in that direction there"
        )
    directions = None if spec.imported is None else np.array([key[1] for key in placed.keys])
    hit = tuple(dict.fromkeys(placed.index[:count].tolist()))
    return PlannedPoints(
        points, tuple(key[0] for key in placed.keys), directions, hit,
        None if table.sensor is None else int(placed.index[-1]),
    )  # fmt: skip


def _placed(stated: list[PlainPoint], spec: Spec) -> Placed:
    numbers = [Dof.of(one).node for one in stated if isinstance(one, str)]
    known: dict[tuple[float, ...], int] = {}
    dofs, at = [], {}
    for one in stated:
        if isinstance(one, str):
            dof = Dof.of(one)
            where = _of_node(dof.node, spec)
        elif isinstance(one, tuple) and spec.kind == "beam":
            raise StudyError(f"{list(one[:-1])} is not a place along a beam; {_how(spec)}")
        elif isinstance(one, tuple):
            *place_of, way = one
            where = np.array([*place_of, 0.0][:3])
            number = known.setdefault(tuple(place_of), max(numbers, default=0) + len(known) + 1)
            dof = Dof.of(f"{number}{way}")
        elif spec.kind == "beam":
            if not 0 <= one <= spec.length:
                raise StudyError(f"{one:g} m is off the beam, which reaches from 0 to {spec.length:g} m")
            dof, where = Dof.of(f"{known.setdefault((one,), len(known) + 1)}+z"), np.array([one, 0.0, 0.0])
        else:
            raise StudyError(f"{one:g} is a place along a beam; {_how(spec)}")
        dofs.append(dof)
        at[dof.node] = where
    geometry = Geometry(tuple(at), np.array(list(at.values())))
    return place(tuple(dofs), geometry, Axes(), spec)


def _of_node(node: int, spec: Spec) -> FloatArray:
    if spec.imported is None:
        raise StudyError(f"node {node}: {spec.called} has no node numbers; {_how(spec)}")
    places = spec.imported.places
    here = np.flatnonzero(places.node == node)
    if not len(here):
        raise StudyError(
            f"node {node} is not one of the model's, which reach from {places.node.min()} to "
            f"{places.node.max()}"
        )
    return np.asarray(places.at[here[0]])


def _how(spec: Spec) -> str:
    """Return how a point is written on a model."""
    if spec.imported is None:
        return "write x in [m]" if spec.kind == "beam" else "write [x, y] in [m]"
    return 'write a node and its direction as "12+Z", or [x, y, z, "+z"] in [m]'


def _written(point: PlainPoint) -> str:
    return f"{list(point[:-1])} along {point[-1]}" if isinstance(point, tuple) else str(point)
