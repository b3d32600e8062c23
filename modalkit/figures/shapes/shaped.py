"""Mode shapes made ready to draw: the test's at its points, the model's along a line or over a plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition import Geometry, InputError, ModalData
from acquisition.arrays import FloatArray, IntArray
from modalkit.figures.shapes.layout import principal
from updating import Measured, Prediction, Predictor
from updating.prediction.matching import pair_modes

FINE = (161, (61, 41))
"""Points at which the model's shape is drawn, along a beam and over a plate."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Shapes:
    """Shapes ready to draw, each scaled so that the largest component measured is 1.

    Parameters
    ----------
    frequency : (n_modes,) array
        Measured frequencies [Hz].
    points : (n, dim) array
        Test points along a line or on a plane [m].
    values, sigma : (n, n_modes) arrays
        Components and their standard deviations, nan where unknown [-].
    fine : tuple of arrays, optional
        Where the model is evaluated: (x,) or (x, y) [m].
    model : (n_fine, n_modes) or (n_y, n_x, n_modes) array, optional
        The model's shape there, scaled to fit the measured components [-].
    model_frequency : (n_modes,) array, optional
        The model's frequencies [Hz].
    placed : bool
        Whether the points are known; if not, ``points`` are their numbers.
    lines : (n_lines, 2) int array, optional
        Pairs of points that the test's geometry joins.
    names : tuple of str
        Names of the points, where they are not placed.
    left_out : tuple of str
        Degrees of freedom that are not drawn.
    """

    frequency: FloatArray
    points: FloatArray
    values: FloatArray
    sigma: FloatArray
    fine: tuple[FloatArray, ...] | None = None
    model: FloatArray | None = None
    model_frequency: FloatArray | None = None
    placed: bool = True
    lines: IntArray | None = None
    names: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()


def from_modal(modal: ModalData) -> Shapes:
    """Return identified shapes ready to draw.

    Raises
    ------
    InputError
        If there are none.
    """
    if modal.shapes is None or not len(modal.dofs):
        raise InputError("these modes have no shapes to draw; identify them from FRFs at several points")
    axis = np.array([dof.axis for dof in modal.dofs])
    rows = np.flatnonzero(axis == np.bincount(axis[axis >= 0], minlength=1).argmax())
    shapes = modal.shapes[rows]
    angle = 0.5 * np.angle(np.sum(shapes**2, axis=0))
    values = (shapes * np.exp(-1j * angle)).real
    nodes = [modal.dofs[i].node for i in rows]
    placed = all(node in modal.geometry for node in nodes)
    points = principal(modal.geometry.at(nodes)) if placed else np.arange(1.0, len(rows) + 1)[:, None]
    sigma = np.full(values.shape, np.nan) if modal.shape_sigma is None else modal.shape_sigma[rows]
    size = _sizes(values)
    lines = _lines(modal.geometry, nodes) if placed else None
    names = () if placed else tuple(str(modal.dofs[i]) for i in rows)
    left_out = tuple(str(dof) for i, dof in enumerate(modal.dofs) if i not in set(rows.tolist()))
    return Shapes(
        frequency=modal.frequency,
        points=points,
        values=values / size,
        sigma=sigma / np.abs(size),
        placed=placed,
        lines=lines,
        names=names,
        left_out=left_out,
    )


def _lines(geometry: Geometry, nodes: list[int]) -> IntArray | None:
    """Return the lines of the geometry between points that were measured, as pairs of rows; None without."""
    row = {node: i for i, node in enumerate(nodes)}
    drawn = geometry.lines
    pairs = [(row[int(a)], row[int(b)]) for a, b in drawn if int(a) in row and int(b) in row]
    return np.array(pairs, dtype=np.int64) if pairs else None


def _sizes(values: FloatArray) -> FloatArray:
    """Return the largest component of each mode, with the sign of its first one that counts [as ``values``]."""
    size = np.maximum(np.abs(values).max(axis=0), 1e-300)
    first = np.argmax(np.abs(values) > 0.3 * size, axis=0)
    return np.asarray(size * np.sign(values[first, np.arange(values.shape[1])] + 1e-300))


def beside_model(measured: Measured, predictor: Predictor) -> tuple[Measured, Prediction]:
    """Return the measured modes that have a partner in the model, and the predicted ones in their order."""
    prediction = predictor.predict()
    paired = pair_modes(measured, prediction)
    return paired.measured, prediction.select(paired.order)


def at_points(
    predictor: Predictor, prediction: Prediction, places: IntArray, values: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the model's shapes at points of the test (n, n_modes), and what brings each nearest to the measured one.

    Parameters
    ----------
    predictor, prediction : Predictor and Prediction
        The model, and its modes in the order of the measured ones.
    places : (n,) int array
        Which points.
    values : (n, n_modes) array
        What was measured there.
    """
    w = predictor.point_rows()[places][:, : prediction.vectors.shape[0]] @ prediction.vectors
    return w, np.sum(w * values, axis=0) / np.maximum(np.sum(w**2, axis=0), 1e-300)


def from_measured(measured: Measured, predictor: Predictor | None) -> Shapes:
    """Return a test's shapes ready to draw, over the model's where there is one.

    Raises
    ------
    InputError
        If only frequencies are known.
    """
    if not measured.has_shapes:
        raise InputError("this test has no shapes to draw: only frequencies are known")
    fine, shape, frequency = None, None, None
    if predictor is not None:
        measured, prediction = beside_model(measured, predictor)
        if predictor.spec.imported is None:
            fine, shape = _evaluate(predictor, prediction.vectors)
        frequency = prediction.frequency
    rows, place_of = common_rows(measured)
    values, sigma = measured.constants[rows], np.abs(measured.constants_sigma[rows])
    size = _sizes(values)
    values, sigma, points = values / size, sigma / np.abs(size), measured.points[place_of]
    w = None
    if predictor is not None:
        w, level = at_points(predictor, prediction, place_of, values)
        w, shape = w * level, None if shape is None else shape * level
    if points.shape[1] > 2:
        return Shapes(
            frequency=measured.frequency,
            points=principal(points),
            values=values,
            sigma=sigma,
            fine=None,
            model=None,
            model_frequency=frequency,
        )
    return Shapes(
        frequency=measured.frequency,
        points=points,
        values=values,
        sigma=sigma,
        fine=fine,
        model=shape,
        model_frequency=frequency,
    )


def common_rows(measured: Measured) -> tuple[IntArray, IntArray]:
    """Return the FRFs that share the point with the most of them, and the other point of each."""
    if np.all(measured.hit < 0):
        return np.arange(len(measured.seen)), measured.seen
    by_sensor, by_hammer = np.bincount(measured.seen), np.bincount(measured.hit)
    if by_sensor.max() >= by_hammer.max():
        rows = np.flatnonzero(measured.seen == by_sensor.argmax())
        return rows, measured.hit[rows]
    rows = np.flatnonzero(measured.hit == by_hammer.argmax())
    return rows, measured.seen[rows]


def _evaluate(predictor: Predictor, vectors: FloatArray) -> tuple[tuple[FloatArray, ...], FloatArray]:
    """Return where the model's shapes are drawn, and the shapes there."""
    spec = predictor.spec
    if spec.kind == "beam":
        x = np.linspace(0, spec.length, FINE[0])
        rows = predictor.reduced.rows(x[:, None])["w"][:, : vectors.shape[0]]
        return (x,), np.asarray(rows @ vectors)
    x, y = np.linspace(0, spec.length, FINE[1][0]), np.linspace(0, spec.width, FINE[1][1])
    grid = np.stack(np.meshgrid(x, y), axis=-1)
    rows = predictor.reduced.rows(grid.reshape(-1, 2))["w"][:, : vectors.shape[0]]
    return (x, y), np.asarray(rows @ vectors).reshape(len(y), len(x), -1)
