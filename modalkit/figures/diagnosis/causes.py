"""What causes the gap: the probability of every explanation, the answer marked."""

from __future__ import annotations

from matplotlib.axes import Axes

from acquisition.quantities import probability
from modalkit.figures.style import (
    BLUE,
    FAINT,
    GRID,
    INK,
    MUTED,
    SMALL,
    TEXT,
    bare,
    broken,
    shortened,
    text_width,
)
from modalkit.views.charts.causes import Bar, explanations
from updating import Diagnosis

ROWS = 7
"""Most rows shown."""


UNDER = 3
"""Most lines under a bar."""

ROW, LINE = 0.44, 0.16
"""Height of a row and of a line under it [in]."""


def draw_causes(axes: Axes, diagnosis: Diagnosis, *, width: float, height: float) -> None:
    """Draw one bar per explanation, its name above it.

    Parameters
    ----------
    axes : Axes
        The panel.
    diagnosis : Diagnosis
        The answer.
    width, height : float
        Size of the panel [in].
    """
    bare(axes)
    axes.set_xlim(0, width)
    axes.set_ylim(-height, 0)
    found = explanations(diagnosis)
    down, ends = 0.0, [0.0]
    for i, row in enumerate(found):
        # so many rows of an answer have their parameters written out
        under = _under(row, width) if i < 4 else []
        tall = ROW + LINE * len(under)
        last = i == len(found) - 1
        if i == ROWS or down + tall + (0.0 if last else LINE) > height:
            total = probability(sum(other.probability for other in found[i:]))
            rest = f"{len(found) - i} more, together {total}"
            axes.text(0, -down - 0.17, rest, fontsize=SMALL, color=MUTED)
            break
        _bar(axes, row, -down - 0.30, width)
        for k, line in enumerate(under):
            axes.text(0, -down - 0.30 - LINE * (k + 0.9), line, fontsize=SMALL - 1, color=MUTED)
        down += tall
        if row.answer:
            ends.append(down)
    if diagnosis.verdict == "class":
        _bracket(axes, ends[-1])


def _under(row: Bar, width: float) -> list[str]:
    """Return the text on an answer's parameters below its bar."""
    if not row.answer:
        return []
    room, parts = 72 * width, row.detail.split(", ")
    lines = broken(row.detail, room, SMALL - 1)
    while len(lines) > UNDER and len(parts) > 1:  # a parameter is there whole or not at all
        parts.pop()
        lines = broken(", ".join([*parts, "…"]), room, SMALL - 1)
    return lines[:UNDER]


def _bar(axes: Axes, row: Bar, bottom: float, width: float) -> None:
    colour = BLUE if row.answer else FAINT
    axes.barh(bottom, width, height=0.09, color=GRID, align="edge")
    axes.barh(bottom, width * min(row.probability, 1.0), height=0.09, color=colour, align="edge")
    weight, line = ("bold" if row.answer else "normal"), bottom + 0.145
    value = probability(row.probability)
    room = 72 * width - text_width(value, TEXT, weight=weight) - 10
    label = shortened(row.label, room, TEXT, weight=weight)
    axes.text(0, line, label, fontsize=TEXT, color=INK, fontweight=weight)
    axes.text(width, line, value, fontsize=TEXT, color=INK, fontweight=weight, ha="right")
    used = text_width(label, TEXT, weight=weight) + 8
    if row.detail and not row.answer and text_width(row.detail, SMALL - 1) < room - used:
        axes.text(used / 72, line, row.detail, fontsize=SMALL - 1, color=MUTED)


def _bracket(axes: Axes, end: float) -> None:
    """Tie the rows of a class together."""
    left, top, bottom = -0.14, -0.04, 0.12 - end
    axes.plot(
        [left + 0.06, left, left, left + 0.06],
        [top, top, bottom, bottom],
        color=BLUE,
        linewidth=1.6,
        clip_on=False,
    )
    axes.text(
        left - 0.05,
        (top + bottom) / 2,
        "one of these",
        rotation=90,
        ha="right",
        va="center",
        fontsize=SMALL,
        color=BLUE,
    )
