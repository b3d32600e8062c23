"""Where the cause sits: the structure with its zones, points, sensors, and the place found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from acquisition.quantities import probability
from modalkit.figures.diagnosis.structure import draw_structure
from modalkit.figures.style import (
    BLUE,
    FAINT,
    GRID,
    INK,
    MUTED,
    ORANGE,
    PROBABILITY,
    SMALL,
    TEXT,
    bare,
    text_width,
)
from modalkit.output.location import spans
from modalkit.output.words import located
from modalkit.views.outline import Outline, outline
from updating import Case, Diagnosis


def draw_where(axes: Axes, diagnosis: Diagnosis, case: Case | None, *, width: float, height: float) -> None:
    """Draw the structure, coloured by probability.

    Parameters
    ----------
    axes : Axes
        The panel; its units become inches.
    diagnosis : Diagnosis
        The answer.
    case : Case or None
        The structure and its test points, if known.
    width, height : float
        Size of the panel [in].
    """
    bare(axes)
    axes.set_xlim(0, width)
    axes.set_ylim(0, height)
    if case is not None and case.spec.imported is not None:
        draw_structure(axes, diagnosis, case, width=width, height=height)
        return
    body = outline(diagnosis, case)
    frame = Frame.fit(body, width, height)
    coloured = not body.even and diagnosis.where.channel != "none"
    _zones(axes, body, frame, coloured=coloured)
    if coloured:
        axes.text(width, height + 0.22, "probability, %", fontsize=SMALL, color=MUTED, ha="right")
    _clamps(axes, body, frame)
    _points(axes, body, frame)
    _cause(axes, diagnosis, body, frame, width)


@dataclass(frozen=True)
class Frame:
    """From metres to inches on the panel: what :func:`draw_where` draws in."""

    left: float
    bottom: float
    scale: float
    across: float
    wide: float
    tall: float

    @classmethod
    def fit(cls, body: Outline, width: float, height: float) -> Frame:
        """Fit a structure into a panel of some size [in]."""
        above, below, side = 0.62, 0.62, 0.22
        if body.width == 0:
            scale = (width - 2 * side) / body.length
            tall = min(0.62, height - above - below)
            return cls(side, (height - tall - above + below) / 2, scale, 0.0, scale * body.length, tall)
        scale = min((width - 2 * side) / body.length, (height - above - below) / body.width)
        wide, tall = scale * body.length, scale * body.width
        return cls((width - wide) / 2, (height - tall - above + below) / 2, scale, scale, wide, tall)

    def x(self, metres: float) -> float:
        """Return where a place along the structure lies [in]."""
        return self.left + self.scale * metres

    def y(self, metres: float) -> float:
        """Return where a place across it lies [in]."""
        return self.bottom + (self.across * metres if self.across else 0.0)

    @property
    def top(self) -> float:
        """Upper edge of the structure [in]."""
        return self.bottom + self.tall


def _zones(axes: Axes, body: Outline, frame: Frame, *, coloured: bool) -> None:
    for x0, x1, y0, y1, held in body.zones:
        low = frame.y(y0)
        high = frame.y(y1) if body.width else frame.top
        corner, wide = (frame.x(x0), low), frame.scale * (x1 - x0)
        colour = PROBABILITY(held) if coloured else GRID
        axes.add_patch(
            Rectangle(corner, wide, high - low, facecolor=colour, edgecolor="white", linewidth=1.2)
        )
        label = f"{100 * held:.0f}"
        if held >= 0.005 and coloured and text_width(label, SMALL - 1) < 72 * wide - 2:
            axes.text(
                corner[0] + wide / 2,
                (low + high) / 2,
                label,
                fontsize=SMALL - 1,
                color="white" if held > 0.45 else INK,
                ha="center",
                va="center",
                zorder=4,
            )
    edge = Rectangle(
        (frame.left, frame.bottom), frame.wide, frame.tall, fill=False, edgecolor=MUTED, linewidth=1.0
    )
    axes.add_patch(edge)


def _clamps(axes: Axes, body: Outline, frame: Frame) -> None:
    depth = 0.11
    places = {
        "x0": (frame.left - depth, frame.bottom - 0.08, depth, frame.tall + 0.16),
        "x1": (frame.left + frame.wide, frame.bottom - 0.08, depth, frame.tall + 0.16),
        "y0": (frame.left - 0.08, frame.bottom - depth, frame.wide + 0.16, depth),
        "y1": (frame.left - 0.08, frame.top, frame.wide + 0.16, depth),
    }
    for name in body.clamped:
        x, y, wide, tall = places[name]
        axes.add_patch(
            Rectangle((x, y), wide, tall, facecolor="white", edgecolor=MUTED, hatch="/////", linewidth=0.0)
        )


def _points(axes: Axes, body: Outline, frame: Frame) -> None:
    """Draw test points as rings and sensors as squares, and say below what they are."""
    beam = body.width == 0
    at = np.array([[frame.x(x), frame.bottom if beam else frame.y(y)] for x, y in body.points]).reshape(-1, 2)
    on = np.array([[frame.x(x), frame.top if beam else frame.y(y)] for x, y in body.sensors]).reshape(-1, 2)
    style: dict[str, Any] = {"facecolor": "white", "edgecolor": INK, "clip_on": False, "zorder": 5}
    axes.scatter(at[:, 0], at[:, 1], s=22, linewidth=1.1, **style)
    axes.scatter(on[:, 0], on[:, 1], s=62, marker="s", linewidth=1.5, **style)
    line, x = frame.bottom - 0.36, 0.0 if body.width else frame.left
    for count, marker, area, name in ((len(at), "o", 22, "test point"), (len(on), "s", 62, "sensor")):
        if count:
            axes.scatter([x + 0.06], [line], s=area, marker=marker, linewidth=1.2, **style)
            label = name if count == 1 else f"{name}s"
            axes.text(x + 0.18, line, label, fontsize=SMALL, color=MUTED, va="center")
            x += 0.42 + text_width(label, SMALL) / 72
    size = f"{body.length:.4g} m" if beam else f"{body.length:.4g} × {body.width:.4g} m"
    right = axes.get_xlim()[1] if body.width else frame.left + frame.wide
    if x + text_width(size, SMALL) / 72 < right:
        axes.text(right, line, size, fontsize=SMALL, color=MUTED, ha="right", va="center")


def _cause(axes: Axes, diagnosis: Diagnosis, body: Outline, frame: Frame, width: float) -> None:
    """Ring the places found and name the first above the structure."""
    where, plate = diagnosis.where, body.width > 0
    base = frame.top + 0.42
    if where.location is None or diagnosis.verdict == "unknown":
        texts = {
            "none": "no gap, so no place",
            "measurement": "in the measurement, not in the structure",
        }
        if spans(diagnosis):
            texts[where.channel] = "in the measurement and in the structure"
        text = texts.get(where.channel, "no single place: it acts on all of it")
        if diagnosis.verdict == "unknown":
            text = "no place is known: no explanation was found"
        axes.text(0.0, base, text, fontsize=TEXT, color=MUTED)
        return
    places = where.locations or (where.location,)
    for place in places:
        along, across = body.flat(place)
        x = frame.x(along)
        y = frame.y(across) if plate else frame.bottom + frame.tall / 2
        if plate:
            axes.scatter(
                [x], [y], s=190, facecolor="none", edgecolor=ORANGE, linewidth=2.4, clip_on=False, zorder=6
            )
            foot = y + 0.13
        else:
            foot = frame.top + 0.10
            axes.scatter([x], [foot + 0.02], s=75, marker="v", color=ORANGE, clip_on=False, zorder=6)
        axes.plot([x, x], [foot, base - 0.05], color=ORANGE, linewidth=1.4, clip_on=False, zorder=5.5)
    label = located(diagnosis, plate=plate) + (f"  (one of {len(places)})" if len(places) > 1 else "")
    half = text_width(label, TEXT, weight="bold") / 144
    middle = float(np.clip(frame.x(body.flat(where.location)[0]), half, max(width - half, half)))
    axes.text(middle, base, label, fontsize=TEXT, fontweight="bold", color=ORANGE, ha="center")


def draw_channels(axes: Axes, diagnosis: Diagnosis, *, width: float, height: float) -> None:
    """Draw how the probability divides among stiffness, mass, damping and measurement.

    Parameters
    ----------
    axes : Axes
        The panel; its units become inches.
    diagnosis : Diagnosis
        The answer.
    width, height : float
        Size of the panel [in].
    """
    bare(axes)
    axes.set_xlim(0, width)
    axes.set_ylim(-height, 0)
    shares = {n: v for n, v in diagnosis.where.channels.items() if n != "none"}
    step = height / max(len(shares), 1)
    left, right = 1.08, 0.68
    full = width - left - right
    for i, (name, value) in enumerate(shares.items()):
        y, top = -(i + 0.5) * step, name == diagnosis.where.channel
        axes.text(left - 0.12, y, name, fontsize=SMALL, ha="right", va="center", color=INK if top else MUTED)
        axes.barh(y, full, left=left, height=0.09, color=GRID)
        axes.barh(y, full * value, left=left, height=0.09, color=BLUE if top else FAINT)
        axes.text(
            width, y, probability(value), fontsize=SMALL, ha="right", va="center", color=INK if top else MUTED
        )
