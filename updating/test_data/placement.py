"""Test points on the model: which degrees of freedom it can follow, where they are, and which way they move."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from acquisition import Dof, Geometry
from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import StudyError
from acquisition.quantities import quantity
from updating.models import Spec
from updating.models.imported.placing import Found
from updating.test_data.axes import Axes

FOLLOWED = 0.9
"""Cosine of the angle to what the model can do from which a degree of freedom is followed [-]."""

THOUSANDFOLD = (300.0, 3000.0)
"""Ratio of the sizes of test and model that looks like millimetres beside metres [-]."""

Key = tuple[int, tuple[float, float, float]]


@dataclass(frozen=True, eq=False)
class Placed:
    """Degrees of freedom of a test on the model.

    Parameters
    ----------
    rows : (n,) int array
        Which degrees of freedom the model can follow.
    index : (n,) int array
        Point of each of them.
    keys : tuple of (node, direction)
        What the points are, the direction in model axes and never pointing backwards.
    points : (n_points, dim) array
        Where they are in model axes [m].
    signs : (n,) array
        Whether the transducer points forwards or backwards [-].
    warnings : tuple of str
        What was left out.
    """

    rows: IntArray
    index: IntArray
    keys: tuple[Key, ...]
    points: FloatArray
    signs: FloatArray
    warnings: tuple[str, ...]

    def point(self, key: Key) -> FloatArray:
        """Return where a point is, shape (dim,) [m]."""
        return np.asarray(self.points[self.keys.index(key)])


def place(dofs: tuple[Dof, ...], geometry: Geometry, axes: Axes, spec: Spec) -> Placed:
    """Find the degrees of freedom that the model can follow, and their points on it.

    A beam or a plate moves along its z. Imported matrices move along whatever axes their node table holds.

    Raises
    ------
    StudyError
        If a point lies off the model.
    """
    along = np.array([axes.rotation @ geometry.direction(d) for d in dofs]).reshape(-1, 3)
    rows = np.flatnonzero(_followed(along, spec))
    warnings = []
    if len(rows) < len(dofs):
        others = ", ".join(sorted({str(d) for i, d in enumerate(dofs) if i not in set(rows.tolist())})[:5])
        what = "in no direction of the node table" if spec.imported else "not along the model's z"
        warnings.append(f"left out: {what}: {others}")
    forward, signs = _forward(along[rows])
    if spec.imported is None:
        forward = np.tile([0.0, 0.0, 1.0], (len(rows), 1))
    stated: list[Key] = [
        (dofs[i].node, (x, y, z)) for i, (x, y, z) in zip(rows, forward.tolist(), strict=True)
    ]
    keys = tuple(dict.fromkeys(stated))
    points = (
        axes.to_model(geometry.at([k[0] for k in keys]))[:, : spec.dim] if keys else np.zeros((0, spec.dim))
    )
    if spec.imported is None:
        _check_on(points, keys, spec)
    where = {key: i for i, key in enumerate(keys)}
    index = np.array([where[key] for key in stated], dtype=int)
    return Placed(rows, index, keys, points, signs, tuple(warnings))


def _followed(along: FloatArray, spec: Spec) -> FloatArray:
    """Return which unit vectors (n, 3) the model can follow, shape (n,)."""
    if spec.imported is None:
        return np.asarray(np.abs(along[:, 2]) > FOLLOWED)
    able = np.array([spec.imported.places.has(axis) for axis in range(3)])
    return np.asarray(np.linalg.norm(along[:, able], axis=1) > FOLLOWED)


def _forward(along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Turn unit vectors so that their largest component is positive, and say which were turned."""
    if not len(along):
        return along, np.zeros(0)
    clean = np.where(np.abs(along) < 1e-9, 0.0, np.round(along, 9))
    signs = np.sign(clean[np.arange(len(clean)), np.abs(clean).argmax(axis=1)])
    return clean * signs[:, None] + 0.0, signs


def _check_on(points: FloatArray, keys: tuple[Key, ...], spec: Spec) -> None:
    size = np.array([spec.length, spec.width][: points.shape[1]])
    slack = 0.02 * spec.length
    off = ((points < -slack) | (points > size + slack)).any(axis=1)
    if off.any():
        first = int(np.flatnonzero(off)[0])
        raise StudyError(
            f"test point {keys[first][0]} lies at {np.round(points[first], 4).tolist()} m in model axes, off the "
            f"{spec.kind} of {size.tolist()} m; check axes in [test], the units of the file, and the dimensions"
        )


def matched(
    points: FloatArray, keys: tuple[Key, ...], spec: Spec, tolerance: float | None = None
) -> tuple[FloatArray, tuple[str, ...]]:
    """Match points to imported nodes, or to places between them.

    Parameters
    ----------
    points : (n, dim) array
        Where they are in model axes [m].
    keys : tuple of (node, direction)
        What they are.
    spec : Spec
        The model.
    tolerance : float, optional
        How far from its nodes, or elements, one may lie: if that is off the structure it is put on the nearest
        node; left out, none may, and a point on the structure is where it is [m].

    Returns
    -------
    points : (n, dim) array
        Where they are taken to be [m].
    warnings : tuple of str
        How many lie between nodes, or were put on one.

    Raises
    ------
    StudyError
        If one lies off the structure, or farther from it than the tolerance.
    """
    if spec.imported is None or not len(points):
        return points, ()
    places = spec.imported.places
    if (stated := _thousandfold(points, spec)) and len(points) > 1:
        raise StudyError(
            f"the test spans {quantity(np.ptp(points, axis=0).max(), 'm')} along the model's axes: {stated}"
        )
    taken, between, moved = points.copy(), dict[int, float](), dict[int, float]()
    several: dict[int, tuple[int, ...]] = {}
    for i, (point, (node, direction)) in enumerate(zip(points, keys, strict=True)):
        for axis in np.flatnonzero(np.abs(direction) > 1e-9).tolist():
            if not places.has(axis):
                continue
            found = places.find(point, axis)
            if len(found.sides):
                several[node] = tuple(places.node[found.index[found.sides.any(axis=0)]].tolist())
            if not found.on if tolerance is None else found.distance > tolerance:
                raise StudyError(_astray(point, node, found, spec, tolerance))
            if not found.on:
                taken[i] = places.at[found.nearest]
                moved[node] = max(moved.get(node, 0.0), found.distance)
            elif found.distance > 0.05 * found.spacing:
                between[node] = max(between.get(node, 0.0), found.distance)
    return taken, _beside_nodes(between, moved) + _at_several_nodes(several)


def _at_several_nodes(several: Mapping[int, tuple[int, ...]]) -> tuple[str, ...]:
    """Return which points lie where the model has several nodes, by their numbers."""
    if not several:
        return ()
    node, there = next(iter(several.items()))
    return (
        f"{len(several)} test point(s) lie where the model has several nodes: point {node} at nodes "
        f"{' and '.join(map(str, sorted(there)))}; the test does not tell which of them it is, so this is left open",
    )


def _beside_nodes(between: dict[int, float], moved: dict[int, float]) -> tuple[str, ...]:
    """Return how many points lie between nodes, and were put on one, by their distance from it [m]."""
    warnings = []
    if between:
        worst = max(between, key=lambda n: between[n])
        warnings.append(
            f"{len(between)} test point(s) lie beside the model's nodes and are interpolated: point {worst} is "
            f"{quantity(between[worst], 'm')} from the nearest"
        )
    if moved:
        worst = max(moved, key=lambda n: moved[n])
        warnings.append(
            f"{len(moved)} test point(s) lie off the model and are put on its nearest nodes by match_tolerance: "
            f"point {worst} by {quantity(moved[worst], 'm')}"
        )
    return tuple(warnings)


def _thousandfold(points: FloatArray, spec: Spec) -> str:
    """Return what to say where test and model look like millimetres beside metres, else nothing."""
    assert spec.imported is not None
    low, high = spec.imported.extents
    ratio = max(float(np.ptp(points, axis=0).max(initial=0.0)), 1e-12) / max(float((high - low).max()), 1e-12)
    remedies = (
        ("test", ratio, "scale its geometry to [m]"),
        ("node table", 1 / ratio, 'if matrices and nodes are in mm and t, write units = "mm-t-s" in [model]'),
    )
    for wrong, value, remedy in remedies:
        if THOUSANDFOLD[0] < value < THOUSANDFOLD[1]:
            return f"the {wrong} seems a thousand times too large: is it in mm? {remedy}"
    return ""


def _astray(point: FloatArray, node: int, found: Found, spec: Spec, tolerance: float | None) -> str:
    assert spec.imported is not None
    places = spec.imported.places
    at = np.round(places.at[found.nearest], 4).tolist()
    if tolerance is not None:
        return (
            f"test point {node} lies at {np.round(point, 4).tolist()} m in model axes, {quantity(found.distance, 'm')} "
            f"from the nearest node {int(places.node[found.nearest])} at {at} m, more than match_tolerance = "
            f"{quantity(tolerance, 'm')}; check axes and places in [test], or allow more"
        )
    return (
        f"test point {node} lies at {np.round(point, 4).tolist()} m in model axes, off the imported structure: the "
        f"nearest node {int(places.node[found.nearest])} at {at} m is {quantity(found.distance, 'm')} away (nodes are "
        f"{quantity(found.spacing, 'm')} apart there); check axes in [test], the units of the file, and the node "
        "table, or allow more by match_tolerance"
    )
