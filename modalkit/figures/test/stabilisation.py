"""The stabilisation chart over the summed FRFs: what became of every pole, and where every mode comes from."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition.arrays import BoolArray
from acquisition.quantities import bare_hertz, hertz
from identification import ModalModel, pole_origins
from identification.pole_reasons import Origins
from modalkit.figures.style import (
    FAINT,
    MARGIN,
    MARKERS,
    MUTED,
    NAMED,
    ORANGE,
    SMALL,
    WIDTH,
    broken,
    caption,
    caption_height,
    new_figure,
    place,
    tidy,
)
from modalkit.figures.test.modes import mark_modes
from modalkit.views.charts.poles import KINDS, ORIGINS, poles_title, rejected_columns

LISTED = 24
"""Frequencies of so many modes are listed; of more, the first and the last [-]."""

LINE = 0.19
"""Height of a line under the chart [in]."""


def stabilisation_figure(
    model: ModalModel, *, add: Sequence[float] = (), drop: Sequence[float] = ()
) -> Figure:
    """Draw every pole of every order over the summed magnitude, with the reason of every column that is no mode.

    Parameters
    ----------
    model : ModalModel
        The identification.
    add, drop : sequence of float
        The frequencies that were added and dropped by hand [Hz].

    Returns
    -------
    Figure
    """
    origins = pole_origins(model, add=add, drop=drop)
    title, note = poles_title(origins, int(_shown(model).sum())), _note(model)
    columns = rejected_columns(model, origins)
    lines = [line for i, column in enumerate(columns) for line in _reason(i, column)]
    top = caption_height(title, note) + 0.85
    figure = new_figure(top + 4.9 + LINE * len(lines) + 0.15 * bool(lines))
    caption(figure, title, note)
    width = WIDTH - 2 * MARGIN - 1.45
    box = (MARGIN + 0.7, top, width, 4.2)
    behind = place(figure, *box, name="sum")
    front = place(figure, *box, name="chart")
    _sum(behind, model)
    _poles(front, model, origins)
    low, high = _limits(model)
    for axes in (behind, front):
        axes.set_xlim(low, high)
    _modes(front, model, origins)
    mark_modes(front, model.modal.frequency, width=width)
    _draw_labels(front, model, columns)
    tall = figure.get_size_inches()[1]
    for k, line in enumerate(lines):
        figure.text(
            MARGIN / WIDTH, 1 - (top + 4.9 + LINE * k) / tall, line, fontsize=SMALL, color=MUTED, va="top"
        )
    return figure


def _reason(i: int, column: tuple[float, str]) -> list[str]:
    text = f"{_label(i)}   {hertz(column[0])}: {column[1]}"
    return broken(text, 72 * (WIDTH - 2 * MARGIN), SMALL)


def _label(i: int) -> str:
    """Return a, b, ... z, aa, ab, ..."""
    return (_label(i // 26 - 1) if i >= 26 else "") + chr(ord("a") + i % 26)


def _note(model: ModalModel) -> str:
    listed = [bare_hertz(f) for f in model.modal.frequency]
    few = len(listed) <= LISTED
    return f"{', '.join(listed)} Hz" if few else f"{listed[0]} to {listed[-1]} Hz"


def _limits(model: ModalModel) -> tuple[float, float]:
    low, high = model.band
    edge = 0.01 * (high - low)
    return low - edge, high + edge


def _shown(model: ModalModel) -> BoolArray:
    """Return which poles are drawn: those in the band."""
    low, high = model.band
    return np.asarray((model.chart.frequency >= low) & (model.chart.frequency <= high))


def _sum(axes: Axes, model: ModalModel) -> None:
    """Draw the summed magnitude on the right-hand axis."""
    frfs = model.frfs
    total = np.abs(frfs.values).sum(axis=0)
    tidy(axes, y=f"Σ|H| [{frfs.unit}]", grid="")
    axes.semilogy(frfs.frequency, np.where(total > 0, total, np.nan), color=FAINT, linewidth=1.1)
    axes.yaxis.tick_right()
    axes.yaxis.set_label_position("right")
    axes.tick_params(labelbottom=False, bottom=False, colors=FAINT, labelcolor=MUTED, labelsize=SMALL)
    axes.tick_params(which="minor", color=FAINT)
    axes.yaxis.label.set_color(MUTED)
    for side in ("left", "bottom"):
        axes.spines[side].set_visible(False)


def _poles(axes: Axes, model: ModalModel, origins: Origins) -> None:
    """Draw the poles of the band by what became of them."""
    chart = model.chart
    tidy(axes, x="frequency [Hz]", y="model order", grid="y")
    axes.patch.set_alpha(0.0)
    order = chart.orders[chart.level]
    kind = np.array([origins.reasons[r].kind for r in origins.chain], dtype=object)
    for which, (name, marker, colour, size) in KINDS.items():
        keep = _shown(model) & (kind == which)
        if keep.any():
            axes.scatter(
                chart.frequency[keep],
                order[keep],
                marker=MARKERS[marker],
                s=(1.5 * size) ** 2,
                color=NAMED[colour],
                linewidth=0.8,
                label=name,
                zorder=2.5,
            )


def _modes(axes: Axes, model: ModalModel, origins: Origins) -> None:
    """Mark every mode above the orders, by where it comes from, and put the key over the chart."""
    top = 1.05 * float(model.chart.orders.max())
    for which, (name, marker, colour) in ORIGINS.items():
        rows = [r for r, origin in enumerate(origins.modes) if origin == which]
        if rows:
            at = model.modal.frequency[rows]
            axes.plot(
                at,
                np.full(len(rows), top),
                MARKERS[marker],
                color=NAMED[colour],
                markersize=6,
                label=name,
                zorder=3,
            )
    axes.set_ylim(0, 1.09 * float(model.chart.orders.max()))
    axes.legend(
        loc="lower left",
        bbox_to_anchor=(-0.01, 1.065),
        ncols=5,
        frameon=False,
        fontsize=SMALL,
        handletextpad=0.2,
        columnspacing=1.2,
        borderpad=0.0,
        borderaxespad=0.0,
    )


def _draw_labels(axes: Axes, model: ModalModel, columns: Sequence[tuple[float, str]]) -> None:
    """Write a letter at the foot of each column that is no mode; those that stand close go one above the other."""
    low, high = _limits(model)
    last, level = -np.inf, 0
    step = 0.055 * float(model.chart.orders.max())
    for i, (frequency, _) in enumerate(columns):
        level = level + 1 if frequency - last < 0.012 * (high - low) else 0
        last = frequency
        axes.text(
            frequency, step * (0.35 + level), _label(i), fontsize=SMALL, color=ORANGE, ha="center", zorder=4
        )
