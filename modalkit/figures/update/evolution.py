"""Parameters of an update by iteration, where there are any beside the values that a paper printed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition.arrays import FloatArray
from modalkit.figures.style import (
    BLUE,
    FAINT,
    INK,
    MARGIN,
    MUTED,
    ORANGE,
    SMALL,
    WIDTH,
    caption,
    caption_height,
    heading,
    new_figure,
    place,
    tidy,
)

COLOURS = (BLUE, ORANGE, INK, MUTED, "#2a9d8f", "#8e5ea2")


@dataclass(frozen=True, eq=False)
class Course:
    """One parameter's way.

    Parameters
    ----------
    label : str
        What the panel calls it.
    values : (n_iterations + 1,) array
        Its values, the start first [unit of the panel].
    printed : float, optional
        What a paper printed [unit of the panel].
    repeats : tuple of int
        Iterations after which the stage was taken up again.
    """

    label: str
    values: FloatArray
    printed: float | None = None
    repeats: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Courses:
    """Parameters that share a panel.

    Parameters
    ----------
    title, unit : str
        Their name and unit.
    lines : tuple of Course
        The parameters, six at the most.
    logarithmic : bool
        Whether they are shown by their logarithm.
    """

    title: str
    unit: str
    lines: tuple[Course, ...]
    logarithmic: bool = False


def evolution_figure(title: str, note: str, panels: Sequence[Courses]) -> Figure:
    """Draw parameters by iteration, panels side by side.

    Parameters
    ----------
    title, note : str
        What the figure states, and what stands behind it.
    panels : sequence of Courses
        One panel each.

    Returns
    -------
    Figure
    """
    top = caption_height(title, note) + 0.75
    figure = new_figure(top + 2.9 + 0.75)
    caption(figure, title, note)
    share = (WIDTH - 2 * MARGIN) / len(panels)
    for i, panel in enumerate(panels):
        left = MARGIN + i * share
        heading(figure, left, top - 0.2, panel.title)
        _draw(place(figure, left + 0.75, top, share - 0.75 - 1.75, 2.9, name=panel.title), panel)
    return figure


def _draw(axes: Axes, panel: Courses) -> None:
    tidy(axes, x="iteration", y=f"[{panel.unit}]")
    if panel.logarithmic:
        axes.set_yscale("log")
    last = max(len(line.values) for line in panel.lines) - 1
    for line, colour in zip(panel.lines, COLOURS, strict=False):
        count = np.arange(len(line.values))
        axes.plot(count, line.values, color=colour, marker="o", markersize=3, linewidth=1.5)
        if line.printed is not None:
            axes.axhline(line.printed, color=colour, linewidth=1.0, linestyle=(0, (2, 2)))
    for again in panel.lines[0].repeats:
        axes.axvline(again, color=FAINT, linewidth=0.6, zorder=1.5)
    axes.set_xlim(-0.02 * last, 1.02 * last)
    axes.margins(y=0.1)
    ends = [(line.values[-1], f"{line.label} {_short(line.values[-1])}", True) for line in panel.lines]
    beside = [(line.printed, i) for i, line in enumerate(panel.lines) if line.printed is not None]
    ends += [(printed, f"printed {_short(printed)}", False) for printed, _ in beside]
    _label(axes, ends, [*COLOURS[: len(panel.lines)], *[COLOURS[i] for _, i in beside]])


def _label(axes: Axes, ends: Sequence[tuple[float, str, bool]], colours: Sequence[str]) -> None:
    """Write what the lines are at their right ends, moved apart where they would overlap."""
    inches = axes.get_position().height * axes.figure.get_size_inches()[1]  # type: ignore[union-attr]
    axes.set_ylim(axes.get_ylim())  # the limits are settled before anything is placed by them
    places = np.array(
        [axes.transAxes.inverted().transform(axes.transData.transform((0, v)))[1] for v, _, _ in ends]
    )
    order, spread = np.argsort(places), places.copy()
    gap = 0.19 / inches
    for _ in range(200):
        moved = False
        for low, high in pairwise(order.tolist()):
            lack = gap - (spread[high] - spread[low])
            if lack > 1e-6:
                spread[low], spread[high], moved = spread[low] - lack / 2, spread[high] + lack / 2, True
        if not moved:
            break
    for (_, text, ours), at, colour in zip(ends, spread, colours, strict=True):
        mark, ink = ("●", INK) if ours else ("–", MUTED)
        for shift, words, own in ((8, mark, colour), (20, text, ink)):
            axes.annotate(
                words, (1.0, at), xycoords="axes fraction", xytext=(shift, 0), textcoords="offset points",
                va="center", fontsize=SMALL, color=own, annotation_clip=False,
            )  # fmt: skip


def _short(value: float) -> str:
    return f"{value:.3g}" if abs(value) < 100 else f"{value:.1f}"
