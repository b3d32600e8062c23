"""Measured FRFs under those of the unchanged model and of the model with the best explanation in it."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import FrfSet
from acquisition.arrays import ComplexArray, FloatArray
from modalkit.figures.style import (
    BLUE,
    FAINT,
    INK,
    MARGIN,
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
from modalkit.figures.test.frf import NAMES
from modalkit.views.charts.frfs import chosen_frfs
from modalkit.workflow.overlaid import Overlaid
from updating.correlation.frfs import CorrelatedFrfs

TALL, SHORT, BLOCK = 2.2, 0.7, 4.15
"""Heights of magnitude, phase, and all that belongs to one FRF [in]."""


def overlaid_figure(both: Overlaid, *, count: int = 4) -> Figure:
    """Draw magnitude and phase of some FRFs: measured, the unchanged model, and with the explanation.

    Parameters
    ----------
    both : Overlaid
        The FRFs.
    count : int
        How many at the most.

    Returns
    -------
    Figure
    """
    shown = both.before if both.after is None else both.after
    chosen = chosen_frfs(shown, count)
    columns = min(2, len(chosen))
    title, note = _words(both, len(chosen))
    top = caption_height(title, note) + 0.45
    figure = new_figure(top + math.ceil(len(chosen) / columns) * BLOCK - 0.2)
    caption(figure, title, note)
    width = (WIDTH - 2 * MARGIN - 0.75 * columns - 0.2 * (columns - 1)) / columns
    for i, (row, why) in enumerate(chosen.items()):
        left = MARGIN + 0.75 + (i % columns) * (width + 0.95)
        _block(figure, both, row, why, left=left, top=top + (i // columns) * BLOCK, width=width)
    return figure


def _words(both: Overlaid, shown: int) -> tuple[str, str]:
    before, form = both.before, NAMES[both.before.measured.form]
    count = f"{shown} of {len(before.frac)}" if shown < len(before.frac) else "all"
    lines = f" on every {both.every}th line" if both.every > 1 else ""
    note = f"{count} FRFs{lines}. Damping of the model: {before.damping}."
    if both.levelled:
        note += " The level of the test is not known; that of the models is drawn to fit it."
    if before.measured.decay:
        note += f" All with the exponential window of {before.measured.decay:g} 1/s."
    median = f"median FRAC {np.median(before.frac):.3f}"
    if both.after is None:
        return f"{form}: test and model, {median}", note
    return f"{form}: {median} before, {np.median(both.after.frac):.3f} after", note


def _block(
    figure: Figure, both: Overlaid, row: int, why: str, *, left: float, top: float, width: float
) -> None:
    """Draw the two panels of one FRF."""
    test, models = both.before.measured, _models(both)
    name = f"{test.responses[row]} / {test.references[row]}"
    heading(figure, left, top - 0.02, name + (f" ({why})" if why else ""))
    magnitude = place(figure, left, top + 0.3, width, TALL, name=f"magnitude {name}")
    phase = place(figure, left, top + 0.3 + TALL + 0.12, width, SHORT, name=f"phase {name}")
    tidy(magnitude, y=f"|H| [{test.unit}]")
    tidy(phase, x="frequency [Hz]", y="phase [°]")
    magnitude.set_yscale("log")
    _curve(magnitude, test, test.values[row], INK, "measured", width=1.0)
    angle = np.degrees(np.angle(test.values[row]))
    phase.plot(test.frequency, angle, ".", color=FAINT, markersize=2.0, rasterized=True)
    for label, stated, colour, dashed in models:
        correlation = f"{label}, FRAC {stated.frac[row]:.3f}"
        _curve(magnitude, stated.model, stated.model.values[row], colour, correlation, dashed=dashed)
        _phase(phase, stated.model.frequency, stated.model.values[row], colour, dashed=dashed)
    size = np.abs(
        np.concatenate([test.values[row], *(stated.model.values[row] for _, stated, _, _ in models)])
    )
    size = size[np.isfinite(size) & (size > 0)]
    if len(size):
        magnitude.set_ylim(float(np.percentile(size, 0.5)) / 2.5, float(size.max()) * 2)
    for panel in (magnitude, phase):
        panel.set_xlim(float(test.frequency[0]), float(test.frequency[-1]))
    phase.set_ylim(-190, 190)
    phase.set_yticks([-180, 0, 180])
    magnitude.tick_params(labelbottom=False)
    magnitude.legend(
        loc="lower left",
        bbox_to_anchor=(-0.01, 1.0),
        ncols=3,
        frameon=False,
        fontsize=SMALL,
        handlelength=1.3,
        handletextpad=0.4,
        columnspacing=1.0,
        borderpad=0.0,
        borderaxespad=0.1,
    )


def _models(both: Overlaid) -> list[tuple[str, CorrelatedFrfs, str, bool]]:
    found = [("before", both.before, ORANGE, True)]
    return found if both.after is None else [*found, ("after", both.after, BLUE, False)]


def _curve(
    axes: Axes,
    frfs: FrfSet,
    values: ComplexArray,
    colour: str,
    label: str,
    *,
    dashed: bool = False,
    width: float = 1.4,
) -> None:
    size = np.abs(values)
    style = (0, (4, 2)) if dashed else "solid"
    axes.plot(
        frfs.frequency,
        np.where(size > 0, size, np.nan),
        color=colour,
        linewidth=width,
        linestyle=style,
        label=label,
    )


def _phase(axes: Axes, frequency: FloatArray, values: ComplexArray, colour: str, *, dashed: bool) -> None:
    angle = np.degrees(np.angle(values))
    jump = np.append(np.abs(np.diff(angle)) > 180, False)
    style = (0, (4, 2)) if dashed else "solid"
    axes.plot(frequency, np.where(jump, np.nan, angle), color=colour, linewidth=1.3, linestyle=style)
