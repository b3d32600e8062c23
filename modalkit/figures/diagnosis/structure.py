"""Where the cause sits on a structure of the user's own: its mesh in space, regions coloured by probability."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from acquisition.arrays import FloatArray
from modalkit.figures.space import View, draw_directions, draw_faces, draw_lines
from modalkit.figures.style import FAINT, INK, MUTED, ORANGE, PROBABILITY, SMALL, TEXT, text_width
from modalkit.output.words import located
from modalkit.views.mesh import Mesh, mesh_of
from updating import Case, Diagnosis

LEAST = 0.12
"""Darkness of what has no probability, so that it is seen on white [-]."""


def draw_structure(axes: Axes, diagnosis: Diagnosis, case: Case, *, width: float, height: float) -> None:
    """Draw the mesh with its regions by probability, test points with their directions, and the places found.

    Parameters
    ----------
    axes : Axes
        The panel; its units are inches already.
    diagnosis : Diagnosis
        The answer.
    case : Case
        What was diagnosed; its model has a table of nodes.
    width, height : float
        Size of the panel [in].
    """
    mesh = mesh_of(case.spec)
    assert mesh is not None
    points = case.measured.points
    view = View.fit(np.concatenate([mesh.places, points]), width, height - 0.45)
    held = probabilities(diagnosis, case, mesh)
    _mesh(axes, view, mesh, held)
    if case.measured.directions is not None:
        # length of the stroke of a direction
        draw_directions(axes, view, points, case.measured.directions, length=0.16)
    flat = view.flat(points)
    axes.scatter(flat[:, 0], flat[:, 1], s=9, color=INK, linewidth=0, zorder=5)
    _places(axes, view, diagnosis, width, height)
    _key(axes, points, held)


def probabilities(diagnosis: Diagnosis, case: Case, mesh: Mesh) -> FloatArray:
    """Return the probability of the region of every node, nan where it belongs to none or nothing is to be placed."""
    found = {zone.name: zone.probability for zone in diagnosis.where.zones}
    own = np.array([found.get(region.name, np.nan) for region in case.spec.regions] + [np.nan])
    return np.full(len(mesh.node), np.nan) if diagnosis.verdict == "none" else own[mesh.region]


def _mesh(axes: Axes, view: View, mesh: Mesh, held: FloatArray) -> None:
    def colour(rows: tuple[int, ...]) -> object:
        value = float(np.min(held[list(rows)])) if np.isfinite(held[list(rows)]).all() else np.nan
        return FAINT if np.isnan(value) else PROBABILITY(LEAST + (1 - LEAST) * value)

    draw_faces(axes, view, mesh.places, mesh.faces, [colour(face) for face in mesh.faces], alpha=1.0)
    draw_lines(axes, view, mesh.places, mesh.lines, colour=[colour(pair) for pair in mesh.lines], width=2.2)
    if not mesh.faces and not mesh.lines:
        flat = view.flat(mesh.places)
        shade = [colour((i,)) for i in range(len(held))]
        axes.scatter(flat[:, 0], flat[:, 1], c=shade, s=6, linewidth=0, zorder=2)  # type: ignore[arg-type]


def _places(axes: Axes, view: View, diagnosis: Diagnosis, width: float, height: float) -> None:
    """Ring the places found and name the first above the structure."""
    where = diagnosis.where
    if where.location is None or diagnosis.verdict not in ("named", "class"):
        return
    places = np.array(where.locations or (where.location,), dtype=float)
    flat = view.flat(places)
    axes.scatter(flat[:, 0], flat[:, 1], s=150, facecolor="none", edgecolor=ORANGE, linewidth=2.2, zorder=6)
    label = located(diagnosis) + (f"  (one of {len(places)})" if len(places) > 1 else "")
    half = text_width(label, TEXT, weight="bold") / 144
    middle = float(np.clip(flat[0, 0], half, max(width - half, half)))
    axes.plot(
        [flat[0, 0], middle], [flat[0, 1] + 0.1, height - 0.22], color=ORANGE, linewidth=1.0, zorder=5.5
    )
    axes.text(middle, height - 0.17, label, fontsize=TEXT, fontweight="bold", color=ORANGE, ha="center")


def _key(axes: Axes, points: FloatArray, held: FloatArray) -> None:
    """Say below what the marks are."""
    text = f"{len(points)} test points with their directions"
    if np.isfinite(held).any():
        text += "; the darker, the more probable"
    axes.text(0.0, -0.28, text, fontsize=SMALL, color=MUTED, va="center")
