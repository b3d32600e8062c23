"""Mode shapes of structures in space: trace lines bent by the mode, surfaces only where lines close one."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import ModalData
from acquisition.arrays import FloatArray
from acquisition.display import counted
from acquisition.quantities import hertz
from modalkit.figures.shapes.shaped import at_points, beside_model, common_rows
from modalkit.figures.space import View, draw_faces, draw_lines
from modalkit.figures.style import (
    BLUE,
    FAINT,
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
)
from modalkit.views.mesh import mesh_of
from modalkit.views.shapes import shapes_page
from updating import Measured, Predictor

LARGEST = 0.13
"""Motion of the point that moves most, as a part of the structure's size: enough to be seen, too little to change which
parts seem to lie where [-]."""

TALL = 2.5
"""Height of a panel [in]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Spatial:
    """Shapes in space.

    Parameters
    ----------
    places : (n, 3) array
        Points [m].
    motion : (n_modes, n, 3) array
        How they move, the largest motion of each mode 1 [-].
    frequency : (n_modes,) array
        Measured frequencies [Hz].
    directions : int
        Directions that were measured [-].
    lines, faces : sequences of tuples of int
        What joins the points, as rows.
    model : (n_modes, n, 3) array, optional
        How the model moves them [-].
    model_frequency : (n_modes,) array, optional
        Its frequencies [Hz].
    mesh : (array, list), optional
        Places and lines of the model, at rest.
    still : int
        So many of the points, the last, belong to lines alone: nothing was measured there [-].
    """

    places: FloatArray
    motion: FloatArray
    frequency: FloatArray
    directions: int
    lines: list[tuple[int, ...]]
    faces: list[tuple[int, ...]]
    model: FloatArray | None = None
    model_frequency: FloatArray | None = None
    mesh: tuple[FloatArray, list[tuple[int, ...]]] | None = None
    still: int = 0

    @property
    def measured(self) -> int:
        """Points at which something was measured [-]."""
        return len(self.places) - self.still


def in_space(modal: ModalData) -> bool:
    """Return whether modes are drawn in space: points off a plane, or measured along several axes or within it."""
    nodes = [dof.node for dof in modal.dofs]
    if not all(node in modal.geometry for node in nodes):
        return False
    directions = np.abs([modal.geometry.direction(dof) for dof in modal.dofs])
    return not _flat(modal.geometry.at(nodes), directions)


def _flat(points: FloatArray, directions: FloatArray) -> bool:
    """Return whether points lie in a plane or on a line, and all move along one direction across it."""
    if np.ptp(directions, axis=0).max() > 0.1:
        return False
    size = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    plane = len(size) < 3 or size[2] <= 1e-3 * max(size[0], 1e-300)
    along = np.ptp(points @ directions[0]) > 0.05 * max(float(np.ptp(points, axis=0).max()), 1e-300)
    return bool(plane and not along)


def spatial_modes(modal: ModalData) -> Spatial:
    """Return identified shapes as they move in space, every direction measured in them."""
    page = shapes_page(modal, None)
    motion = np.array([mode["re"] for mode in page["modes"]])
    return Spatial(
        places=np.asarray(page["places"]),
        motion=motion / _largest(motion),
        frequency=modal.frequency,
        directions=len(modal.dofs),
        lines=page["lines"],
        faces=page["faces"],
        still=page["still"],
    )


def spatial_measured(measured: Measured, predictor: Predictor | None) -> Spatial | None:
    """Return the shapes of a test on its points in the model's axes; None where they are flat."""
    if measured.points.shape[1] < 3 or measured.directions is None or not measured.has_shapes:
        return None
    if _flat(measured.points, np.abs(measured.directions)):
        return None
    model, hz = None, None
    if predictor is not None:
        measured, prediction = beside_model(measured, predictor)
        hz = prediction.frequency
    rows, at = common_rows(measured)
    assert measured.directions is not None
    values = measured.constants[rows]
    motion = (values[:, :, None] * measured.directions[at][:, None, :]).transpose(1, 0, 2)
    size = _largest(motion)
    if predictor is not None:
        w, level = at_points(predictor, prediction, at, values)
        model = (w * level)[:, :, None] * measured.directions[at][:, None, :]
        model = model.transpose(1, 0, 2) / size
    mesh = None if predictor is None else mesh_of(predictor.spec)
    return Spatial(
        places=measured.points[at], motion=motion / size, frequency=measured.frequency, directions=len(at),
        lines=[], faces=[], model=model, model_frequency=hz,
        mesh=None if mesh is None else (mesh.places, mesh.lines),
    )  # fmt: skip


def _largest(motion: FloatArray) -> FloatArray:
    """Return the largest motion of each mode, shaped to divide by."""
    return np.asarray(np.maximum(np.linalg.norm(motion, axis=2).max(axis=1), 1e-300)[:, None, None])


def spatial_figure(shapes: Spatial) -> Figure:
    """Draw every mode in a panel of its own.

    Parameters
    ----------
    shapes : Spatial
        The shapes.

    Returns
    -------
    Figure
    """
    n = len(shapes.frequency)
    columns = min(3, n)
    where = f"{counted(shapes.measured, 'point')}, {counted(shapes.directions, 'direction')}"
    title = f"{counted(n, 'mode shape')} at {where}"
    note = _note(shapes)
    top = caption_height(title, note) + 0.25
    gap = 0.3
    width = (WIDTH - 2 * MARGIN - gap * (columns - 1)) / columns
    pitch = TALL + 0.5
    figure = new_figure(top + math.ceil(n / columns) * pitch + 0.05)
    caption(figure, title, note)
    size = float(np.linalg.norm(np.ptp(shapes.places, axis=0))) or 1.0
    whole = shapes.places[None] + LARGEST * size * shapes.motion
    everything = [whole.reshape(-1, 3), shapes.places, *([] if shapes.mesh is None else [shapes.mesh[0]])]
    view = View.fit(np.concatenate(everything), width, TALL)
    for k in range(n):
        left, down = MARGIN + (k % columns) * (width + gap), top + (k // columns) * pitch + 0.3
        axes = bare(place(figure, left, down, width, TALL, name=f"mode {k + 1}"))
        axes.set_xlim(0, width)
        axes.set_ylim(0, TALL)
        _heading(axes, shapes, k)
        _panel(axes, view, shapes, k, LARGEST * size)
    return figure


def _note(shapes: Spatial) -> str:
    """State what the colours and lines are."""
    parts = ["each scaled to its largest motion, blue against orange"]
    if shapes.lines:
        parts.append("grey: at rest")
    if shapes.model is not None:
        parts.append("rings: the model's, scaled to fit")
    if not shapes.lines and shapes.mesh is None:
        parts.append("the test has no lines between its points")
    return "; ".join(parts)


def _heading(axes: Axes, shapes: Spatial, k: int) -> None:
    label = f"{k + 1}   {hertz(shapes.frequency[k])}"
    axes.set_title(label, loc="left", fontsize=TEXT, fontweight="bold", color=INK, pad=5)
    if shapes.model_frequency is not None:
        label = f"model {hertz(shapes.model_frequency[k])}"
        axes.set_title(label, loc="right", fontsize=SMALL, color=MUTED, pad=5)


def _panel(axes: Axes, view: View, shapes: Spatial, k: int, reach: float) -> None:
    motion = shapes.motion[k]
    moved = shapes.places + reach * motion
    main = np.abs(motion).argmax(axis=1)
    signed = motion[np.arange(len(motion)), main]
    shade = SIGNED(0.5 + 0.5 * signed)
    if shapes.mesh is not None:
        draw_lines(axes, view, shapes.mesh[0], shapes.mesh[1], colour=FAINT, width=0.5, zorder=1)
    draw_lines(axes, view, shapes.places, shapes.lines, colour=FAINT, width=0.5, zorder=1)
    if shapes.faces:
        faces = [SIGNED(0.5 + 0.5 * float(signed[list(face)].mean())) for face in shapes.faces]
        draw_faces(axes, view, moved, shapes.faces, faces)
    bent = [SIGNED(0.5 + 0.5 * float(signed[list(pair)].mean())) for pair in shapes.lines]
    draw_lines(axes, view, moved, shapes.lines, colour=bent, width=1.4, zorder=2.5)
    if not shapes.lines:  # each point by itself: from where it rests to where it goes
        sticks = [(i, len(motion) + i) for i in range(len(motion))]
        draw_lines(axes, view, np.concatenate([shapes.places, moved]), sticks, colour=ORANGE, width=0.9)
    seen = shapes.measured
    flat = view.flat(moved)[:seen]
    axes.scatter(
        flat[:, 0], flat[:, 1], c=shade[:seen], s=14, edgecolor=INK, linewidth=0.5, zorder=3, clip_on=False
    )
    if shapes.model is not None:
        own = view.flat(shapes.places + reach * shapes.model[k])
        axes.scatter(own[:, 0], own[:, 1], s=34, facecolor="none", edgecolor=BLUE, linewidth=1.0, zorder=2.8)
