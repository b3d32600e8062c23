"""Mode shapes at the test points, over the model's."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from acquisition import Geometry, InputError, ModalData
from acquisition.arrays import FloatArray, IntArray
from modalkit.figures.layout import principal
from modalkit.figures.style import (
    BLUE,
    INK,
    MARGIN,
    MUTED,
    ORANGE,
    SIGNED,
    SMALL,
    TEXT,
    WIDTH,
    bare,
    caption,
    caption_height,
    new_figure,
    place,
    tidy,
)
from modalkit.figures.surfaces import grid_values, spans
from modalkit.figures.words import counted, hertz
from updating import Measured, Predictor
from updating.matching import pair_modes

FINE = (161, (61, 41))
"""Points at which the model's shape is drawn, along a beam and over a plate."""


@dataclass(frozen=True, eq=False)
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


def shapes_figure(source: ModalData | Measured, predictor: Predictor | None = None) -> Figure:
    """Draw the mode shapes at the test points: curves along a beam, maps over a plate.

    Parameters
    ----------
    source : ModalData or Measured
        Modes as identified, or as a model can predict them.
    predictor : Predictor, optional
        The model, for a ``Measured``; its shapes are drawn behind the test's. Modes without a partner are left out.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If there are no shapes.
    """
    shapes = _from_modal(source) if isinstance(source, ModalData) else _from_measured(source, predictor)
    return _draw(shapes) if len(shapes.points) > 1 else _nothing(shapes)


def _nothing(shapes: Shapes) -> Figure:
    """Say that there is no shape at a single point."""
    title = f"{counted(len(shapes.frequency), 'mode')} at one test point: there is no shape to draw"
    note = "measure, or hit, more points"
    figure = new_figure(caption_height(title, note) + 0.25)
    caption(figure, title, note)
    return figure


def _from_modal(modal: ModalData) -> Shapes:
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
    scaled = values / size, sigma / np.abs(size)
    return Shapes(modal.frequency, points, *scaled, placed=placed, lines=lines, names=names)


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


def _from_measured(measured: Measured, predictor: Predictor | None) -> Shapes:
    if not measured.has_shapes:
        raise InputError("this test has no shapes to draw: only frequencies are known")
    fine, shape, frequency = None, None, None
    if predictor is not None:
        prediction = predictor.predict()
        paired = pair_modes(measured, prediction)
        measured, prediction = paired.measured, prediction.select(paired.order)
        if predictor.spec.imported is None:
            fine, shape = _evaluate(predictor, prediction.vectors)
        frequency = prediction.frequency
    rows, place_of = _rows(measured)
    values, sigma = measured.constants[rows], np.abs(measured.constants_sigma[rows])
    size = _sizes(values)
    values, sigma, points = values / size, sigma / np.abs(size), measured.points[place_of]
    w = None
    if predictor is not None:
        w = predictor.nominal_rows["w"][place_of][:, : prediction.vectors.shape[0]] @ prediction.vectors
        level = np.sum(w * values, axis=0) / np.maximum(np.sum(w**2, axis=0), 1e-300)
        w, shape = w * level, None if shape is None else shape * level
    if points.shape[1] > 2:
        return _in_space(measured, place_of, values, sigma, w, frequency)
    return Shapes(measured.frequency, points, values, sigma, fine, shape, frequency)


def _in_space(
    measured: Measured,
    place_of: IntArray,
    values: FloatArray,
    sigma: FloatArray,
    model: FloatArray | None,
    frequency: FloatArray | None,
) -> Shapes:
    """Draw points of imported matrices on their plane; point by point if they lie or move in several directions."""
    points = measured.points[place_of]
    along = np.zeros((1, 3)) if measured.directions is None else measured.directions[place_of]
    strength = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if np.ptp(along, axis=0).max() < 0.1 and (len(strength) < 3 or strength[2] < 1e-3 * strength[0]):
        return Shapes(measured.frequency, principal(points), values, sigma, None, None, frequency)
    names = tuple(
        f"{measured.nodes[i]}{'XYZ'[int(np.abs(d).argmax())]}" for i, d in zip(place_of, along, strict=True)
    )
    number = np.arange(1.0, len(points) + 1)
    return Shapes(
        measured.frequency, number[:, None], values, sigma, None if model is None else (number,), model, frequency,
        placed=False, names=names,
    )  # fmt: skip


def _rows(measured: Measured) -> tuple[IntArray, IntArray]:
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


def _draw(shapes: Shapes) -> Figure:
    n, flat = len(shapes.frequency), shapes.points.shape[1] == 2
    columns = min(4 if flat else 3, n)
    title = f"{counted(n, 'mode shape')} at {len(shapes.points)} test points"
    note = "each scaled to its largest component" + (
        "; bars are 2σ" if np.isfinite(shapes.sigma).any() and not flat else ""
    )
    if shapes.model is not None:
        note += (
            "; dots on the model's map, same colours where they agree"
            if flat
            else "; the curve is the model's, scaled to fit"
        )
    top = caption_height(title, note) + 0.25
    gap, left = (0.25, MARGIN) if flat else (0.35, MARGIN + 0.65)
    width = min((WIDTH - left - MARGIN - gap * (columns - 1)) / columns, 5.0)
    aspect = _aspect(shapes) if flat else 0.45
    tall = min(max(width * aspect, 0.5), 3.4)
    pitch = tall + (0.55 if flat else 0.60)
    rows = math.ceil(n / columns)
    figure = new_figure(top + rows * pitch + (0.05 if flat else 0.35))
    caption(figure, title, note)
    for k in range(n):
        x, y = left + (k % columns) * (width + gap), top + (k // columns) * pitch + 0.3
        axes = place(figure, x, y, width, tall, name=f"mode {k + 1}")
        _title(axes, shapes, k)
        if flat:
            _map(axes, shapes, k)
        else:
            _line(axes, shapes, k, first=k % columns == 0, last=k + columns >= n)
    return figure


def _aspect(shapes: Shapes) -> float:
    if shapes.fine is not None:
        return float(np.ptp(shapes.fine[1]) / np.ptp(shapes.fine[0]))
    spread = np.ptp(shapes.points, axis=0)
    return float(spread[1] / max(spread[0], 1e-12))


def _title(axes: Axes, shapes: Shapes, k: int) -> None:
    label = f"{k + 1}   {hertz(shapes.frequency[k])}"
    axes.set_title(label, loc="left", fontsize=TEXT, fontweight="bold", color=INK, pad=5)
    if shapes.model_frequency is not None:
        said = f"model {hertz(shapes.model_frequency[k])}"
        axes.set_title(said, loc="right", fontsize=SMALL, color=MUTED, pad=5)


def _line(axes: Axes, shapes: Shapes, k: int, *, first: bool, last: bool) -> None:
    name = "position [m]" if shapes.placed else "test point"
    tidy(axes, x=name if last else "", y="shape [-]" if first else "", grid="x")
    axes.axhline(0, color=MUTED, linewidth=0.8, zorder=1.2)
    order = np.argsort(shapes.points[:, 0])
    x, y = shapes.points[order, 0], shapes.values[order, k]
    if shapes.model is not None and shapes.fine is not None:
        axes.plot(shapes.fine[0], shapes.model[:, k], color=BLUE, linewidth=1.8, zorder=2)
    elif shapes.lines is not None:
        ends = shapes.points[shapes.lines, 0].T, shapes.values[shapes.lines, k].T
        axes.plot(*ends, color=ORANGE, linewidth=0.9, alpha=0.5, zorder=2)
    else:
        axes.plot(x, y, color=ORANGE, linewidth=0.9, alpha=0.5, zorder=2)
    error = 2 * np.nan_to_num(shapes.sigma[order, k])
    axes.errorbar(x, y, yerr=error, fmt="o", color=ORANGE, markersize=5, capsize=2.5, linewidth=1.1, zorder=3)
    axes.set_ylim(-1.35, 1.35)
    axes.set_yticks([-1, 0, 1])
    if shapes.names:
        every = max(1, -(-len(x) // 6))
        axes.set_xticks(x[::every], [shapes.names[i] for i in order[::every]])
    axes.tick_params(labelleft=first, labelbottom=last)


def _map(axes: Axes, shapes: Shapes, k: int) -> None:
    bare(axes)
    axes.set_aspect("equal", adjustable="box")
    levels = np.linspace(-1.2, 1.2, 17)
    x, y = shapes.points.T
    limits: dict[str, Any] = {"cmap": SIGNED, "vmin": -1.2, "vmax": 1.2}
    if shapes.model is not None and shapes.fine is not None:
        values = np.clip(shapes.model[:, :, k], -1.2, 1.2)
        axes.contourf(*shapes.fine, values, levels=levels, **limits)
        if values.min() < 0 < values.max():
            x_in, y_in = (grid[1:-1] for grid in shapes.fine)  # a clamped edge is no nodal line
            axes.contour(x_in, y_in, values[1:-1, 1:-1], levels=[0.0], colors=MUTED, linewidths=0.9)
    elif (grid := grid_values(shapes.points, shapes.values[:, k])) is not None:
        axes.contourf(grid[0], grid[1], np.clip(grid[2], -1.2, 1.2), levels=levels, **limits)
    elif spans(shapes.points):
        mesh = Triangulation(x, y)
        axes.tricontourf(mesh, np.clip(shapes.values[:, k], -1.2, 1.2), levels=levels, **limits)
    if shapes.lines is not None and shapes.model is None:
        axes.plot(x[shapes.lines].T, y[shapes.lines].T, color=INK, linewidth=0.7, alpha=0.45, zorder=3)
    axes.scatter(
        x, y, c=shapes.values[:, k], s=34, edgecolor=INK, linewidth=0.9, clip_on=False, zorder=4, **limits
    )
