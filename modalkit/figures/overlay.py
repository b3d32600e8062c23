"""Measured FRFs and a model's, one over the other."""

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
    SMALL,
    TEXT,
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
from updating.correlation.frfs import CorrelatedFrfs

TALL, SHORT, BLOCK = 2.35, 0.75, 4.4
"""Heights of magnitude, phase, and all that belongs to one FRF [in]."""


def overlay_figure(both: CorrelatedFrfs, *, count: int = 4) -> Figure:
    """Draw magnitude and phase of some FRFs, measured and the model's.

    Parameters
    ----------
    both : CorrelatedFrfs
        The FRFs and their FRAC.
    count : int
        How many at the most: a drive point if there is one, the best, the worst, and those between.

    Returns
    -------
    Figure
    """
    chosen = chosen_frfs(both, count)
    columns = min(2, len(chosen))
    title = f"{NAMES[both.measured.form]}: test and model"
    several = f"{len(chosen)} of {len(both.frac)} FRFs" if len(chosen) < len(both.frac) else "all FRFs"
    note = (
        f"{several}, FRAC {both.frac.min():.3f} to {both.frac.max():.3f}, median {np.median(both.frac):.3f}. "
        f"Model: {both.damping}."
    )
    if both.measured.decay:
        note += f" Both with the exponential window of {both.measured.decay:g} 1/s."
    top = caption_height(title, note) + 0.35
    figure = new_figure(top + math.ceil(len(chosen) / columns) * BLOCK - 0.3)
    caption(figure, title, note)
    width = (WIDTH - 2 * MARGIN - 0.75 * columns - 0.2 * (columns - 1)) / columns
    for i, (row, why) in enumerate(chosen.items()):
        left = MARGIN + 0.75 + (i % columns) * (width + 0.95)
        _block(figure, both, row, why, left=left, top=top + (i // columns) * BLOCK, width=width)
    return figure


def _block(
    figure: Figure, both: CorrelatedFrfs, row: int, why: str, *, left: float, top: float, width: float
) -> None:
    """Draw the two panels of one FRF."""
    test, model = both.measured, both.model
    name = f"{test.responses[row]} / {test.references[row]}"
    heading(figure, left, top - 0.02, f"{name}, FRAC {both.frac[row]:.3f}" + (f" ({why})" if why else ""))
    magnitude = place(figure, left, top + 0.28, width, TALL, name=f"magnitude {name}")
    phase = place(figure, left, top + 0.28 + TALL + 0.15, width, SHORT, name=f"phase {name}")
    tidy(magnitude, y=f"|H| [{test.unit}]")
    tidy(phase, y="phase [°]")
    magnitude.set_yscale("log")
    _curve(magnitude, test.frequency, np.abs(test.values[row]), INK, "measured")
    _curve(magnitude, model.frequency, np.abs(model.values[row]), BLUE, "model")
    _phase(phase, test, test.values[row], FAINT)
    _phase(phase, model, model.values[row], BLUE)
    size = np.abs(np.concatenate([test.values[row], model.values[row]]))
    size = size[size > 0]
    magnitude.set_ylim(float(np.percentile(size, 0.5)) / 2.5, float(size.max()) * 3)
    for panel in (magnitude, phase):
        panel.set_xlim(float(test.frequency[0]), float(test.frequency[-1]))
    phase.set_ylim(-190, 190)
    phase.set_yticks([-180, 0, 180])
    magnitude.tick_params(labelbottom=False)
    phase.set_xlabel("frequency [Hz]", fontsize=TEXT, color=INK)
    magnitude.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=2,
        frameon=False,
        fontsize=SMALL,
        handlelength=1.4,
        borderpad=0.0,
        borderaxespad=0.1,
    )


def _curve(axes: Axes, frequency: FloatArray, size: FloatArray, colour: str, label: str) -> None:
    shown = np.where(size > 0, size, np.nan)
    axes.plot(frequency, shown, color=colour, linewidth=1.0 if colour == INK else 1.4, label=label)


def _phase(axes: Axes, frfs: FrfSet, values: ComplexArray, colour: str) -> None:
    angle = np.degrees(np.angle(values))
    if colour == FAINT:
        axes.plot(frfs.frequency, angle, ".", color=colour, markersize=2.2, rasterized=True)
        return
    jump = np.append(np.abs(np.diff(angle)) > 180, False)
    axes.plot(frfs.frequency, np.where(jump, np.nan, angle), color=colour, linewidth=1.4)
