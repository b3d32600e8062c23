"""Mode shapes at the test points, over the model's."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from acquisition import ModalData
from acquisition.display import counted
from acquisition.quantities import hertz
from modalkit.figures.shapes.shaped import Shapes, from_measured, from_modal
from modalkit.figures.shapes.space import in_space, spatial_figure, spatial_measured, spatial_modes
from modalkit.figures.shapes.surfaces import grid_values, spans
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
from updating import Measured, Predictor


def shapes_figure(source: ModalData | Measured, predictor: Predictor | None = None) -> Figure:
    """Draw the mode shapes at the test points: curves along a beam, maps over a plate, all else in space.

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
    if isinstance(source, ModalData) and source.shapes is not None and in_space(source):
        return spatial_figure(spatial_modes(source))
    if isinstance(source, Measured) and (found := spatial_measured(source, predictor)) is not None:
        return spatial_figure(found)
    shapes = from_modal(source) if isinstance(source, ModalData) else from_measured(source, predictor)
    return _draw(shapes) if len(shapes.points) > 1 else _nothing(shapes)


def _nothing(shapes: Shapes) -> Figure:
    """State that there is no shape at a single point."""
    title = f"{counted(len(shapes.frequency), 'mode')} at one test point: there is no shape to draw"
    note = "measure, or hit, more points"
    figure = new_figure(caption_height(title, note) + 0.25)
    caption(figure, title, note)
    return figure


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
    if shapes.left_out:
        note += f"; not drawn, as they move along other axes and have no coordinates: {', '.join(shapes.left_out)}"
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
        beside = f"model {hertz(shapes.model_frequency[k])}"
        axes.set_title(beside, loc="right", fontsize=SMALL, color=MUTED, pad=5)


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
