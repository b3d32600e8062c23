"""Structures in space on paper: one direction of view for all figures, what is behind drawn first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from acquisition.arrays import FloatArray
from modalkit.figures.style import FAINT, GREEN

AZIMUTH, HEIGHT = -0.9, 0.5
"""Where the eye stands, about z and over the plane of x and y: as the app and the report begin [rad]."""


@dataclass(frozen=True, eq=False)
class View:
    """From places in space to inches on a panel.

    Parameters
    ----------
    axes : (3, 3) array
        Rows point to the right, upwards, and to the eye [-].
    scale : float
        Inches per metre.
    origin : (2,) array
        Where the place (0, 0, 0) is drawn [in].
    """

    axes: FloatArray
    scale: float
    origin: FloatArray

    @classmethod
    def fit(cls, points: FloatArray, width: float, height: float) -> View:
        """Return the view in which all points fill a panel of some size [in]."""
        eye = np.array([np.cos(HEIGHT) * np.cos(AZIMUTH), np.cos(HEIGHT) * np.sin(AZIMUTH), np.sin(HEIGHT)])
        right = np.array([-np.sin(AZIMUTH), np.cos(AZIMUTH), 0.0])
        axes = np.array([right, np.cross(eye, right), eye])
        flat = points @ axes[:2].T
        low, high = flat.min(axis=0), flat.max(axis=0)
        size = np.maximum(high - low, 1e-9 * max(float(np.ptp(points)), 1e-12))
        # part of a panel that a structure fills: marks at its ends stay whole
        scale = 0.95 * float(np.min(np.array([width, height]) / size))
        return cls(axes, scale, np.array([width, height]) / 2 - scale * (low + high) / 2)

    def flat(self, points: FloatArray) -> FloatArray:
        """Return where places are drawn, (n, 2) [in]."""
        return np.asarray(self.origin + self.scale * (points @ self.axes[:2].T))

    def depth(self, points: FloatArray) -> FloatArray:
        """Return how near to the eye places are [m]."""
        return np.asarray(points @ self.axes[2])


def draw_lines(
    axes: Axes,
    view: View,
    points: FloatArray,
    lines: Sequence[Sequence[int]],
    *,
    colour: object = FAINT,
    width: float = 0.8,
    zorder: float = 2.0,
    dashed: bool = False,
) -> None:
    """Draw lines between places; ``colour`` is one, or one for each line."""
    if len(lines):
        flat = view.flat(points)
        ends = [flat[list(pair)] for pair in lines]
        style = (0, (3, 2)) if dashed else "solid"
        axes.add_collection(
            LineCollection(ends, colors=colour, linewidths=width, linestyles=style, zorder=zorder)
        )


def draw_faces(
    axes: Axes,
    view: View,
    points: FloatArray,
    faces: Sequence[Sequence[int]],
    colours: Sequence[object],
    *,
    alpha: float = 0.7,
    edge: str = "white",
) -> None:
    """Draw faces between places, the farthest first, each in its colour."""
    if not len(faces):
        return
    flat, depth = view.flat(points), view.depth(points)
    order = np.argsort([float(depth[list(face)].mean()) for face in faces], kind="stable")
    axes.add_collection(
        PolyCollection(
            [flat[list(faces[i])] for i in order],
            facecolors=[colours[i] for i in order],
            edgecolors=edge,
            linewidths=0.3,
            alpha=alpha,
            zorder=1.5,
        )
    )


def draw_directions(
    axes: Axes, view: View, points: FloatArray, directions: FloatArray, *, length: float
) -> None:
    """Draw short strokes from places along their directions; ``length`` is in inches."""
    draw_lines(
        axes,
        view,
        np.concatenate([points, points + length / view.scale * directions]),
        [(i, len(points) + i) for i in range(len(points))],
        colour=GREEN,
        width=1.2,
        zorder=4,
    )
