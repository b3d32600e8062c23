"""The stabilisation chart over the summed FRFs."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition.arrays import BoolArray
from acquisition.display import counted
from acquisition.quantities import bare_hertz
from identification import ModalModel, StabilisationChart
from modalkit.figures.style import (
    BLUE,
    FAINT,
    GREEN,
    MARGIN,
    MUTED,
    SMALL,
    WIDTH,
    caption,
    caption_height,
    new_figure,
    place,
    tidy,
)
from modalkit.figures.test.modes import mark_modes

LISTED = 24
"""Frequencies of so many modes are listed; of more, the first and the last."""

NEAR = 0.01
"""Poles of two orders within this relative distance are taken for stable in frequency."""


def stabilisation_figure(model: ModalModel) -> Figure:
    """Draw every pole of every order over the summed magnitude of the FRFs, and the modes selected.

    Parameters
    ----------
    model : ModalModel
        The identification.

    Returns
    -------
    Figure
    """
    title = f"{counted(len(model), 'mode')} selected from {counted(len(model.chart.poles), 'pole')}"
    listed = [bare_hertz(f) for f in model.modal.frequency]
    few = len(listed) <= LISTED
    note = f"{', '.join(listed)} Hz" if few else f"{listed[0]} to {listed[-1]} Hz"
    top = caption_height(title, note) + 0.55
    figure = new_figure(top + 4.9)
    caption(figure, title, note)
    width = WIDTH - 2 * MARGIN - 1.45
    box = (MARGIN + 0.7, top, width, 4.2)
    behind = place(figure, *box, name="sum")
    front = place(figure, *box, name="chart")
    _sum(behind, model)
    _poles(front, model)
    low, high = _limits(model)
    for axes in (behind, front):
        axes.set_xlim(low, high)
    mark_modes(front, model.modal.frequency, width=width)
    return figure


def _limits(model: ModalModel) -> tuple[float, float]:
    low, high = model.band
    edge = 0.01 * (high - low)
    return low - edge, high + edge


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


def _near_one_before(chart: StabilisationChart) -> BoolArray:
    """Tell which poles have one of the order below close in frequency, whatever its damping."""
    near = np.zeros(len(chart.poles), dtype=bool)
    for level in range(1, len(chart.orders)):
        here, before = chart.level == level, chart.frequency[chart.level == level - 1]
        if before.size:
            distance = np.abs(chart.frequency[here][:, None] / before[None, :] - 1.0)
            near[here] = distance.min(axis=1) < NEAR
    return near


def _poles(axes: Axes, model: ModalModel) -> None:
    chart = model.chart
    tidy(axes, x="frequency [Hz]", y="model order", grid="y")
    axes.patch.set_alpha(0.0)
    order, stable = chart.orders[chart.level], chart.stable
    near = _near_one_before(chart)
    inside = (chart.frequency >= model.band[0]) & (chart.frequency <= model.band[1])
    for keep, marker, size, colour, name in (
        (inside & ~stable & ~near, "x", 16, FAINT, "new"),
        (inside & ~stable & near, "+", 26, GREEN, f"within {100 * NEAR:g} % of one before"),
        (inside & stable, "o", 13, BLUE, "stable in frequency, damping and participation"),
    ):
        axes.scatter(
            chart.frequency[keep],
            order[keep],
            marker=marker,
            s=size,
            color=colour,
            linewidth=0.8,
            label=name,
            zorder=2.5,
        )
    axes.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 1.065),
        ncols=3,
        frameon=False,
        fontsize=SMALL,
        handletextpad=0.2,
        borderpad=0.0,
        borderaxespad=0.0,
    )
