"""FRFs with their coherence and the fit."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import FrfSet
from acquisition.arrays import ComplexArray, FloatArray
from identification import ModalModel
from modalkit.figures.style import (
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
from modalkit.figures.test.modes import mark_modes

BLOCK = 4.45
"""Height of the panels of one FRF [in]."""

MEASURED, FITTED = 2.8, 1.1
"""Widths of the measured curve and of the fit over it [pt]: the broader one shows on both sides of the other where they
agree; alike, it is hidden."""

NAMES = {"receptance": "Receptances", "mobility": "Mobilities", "accelerance": "Accelerances"}


def frf_figure(frfs: FrfSet, model: ModalModel | None = None, *, count: int = 4) -> Figure:
    """Draw magnitude, phase and coherence of some FRFs, with the fit over them and the modes marked.

    Parameters
    ----------
    frfs : FrfSet
        Measured FRFs.
    model : ModalModel, optional
        The fit; the figure is then limited to its band.
    count : int
        Number of FRFs shown at the most: a drive point if there is one, the others spread over the set.

    Returns
    -------
    Figure
    """
    chosen = pick(frfs, count)
    columns = min(2, len(chosen))
    blocks = math.ceil(len(chosen) / columns)
    shown = frfs if model is None else _within(frfs, *model.band)
    fitted = "with the fit " if model else ""
    title = f"{NAMES[frfs.form]} {fitted}{_where(len(chosen), len(frfs.responses))}"
    note = _note(frfs, model)
    top = caption_height(title, note) + 0.35
    figure = new_figure(top + blocks * BLOCK - 0.2)
    caption(figure, title, note)
    width = (WIDTH - 2 * MARGIN - 0.75 * columns - 0.2 * (columns - 1)) / columns
    for i, row in enumerate(chosen):
        left = MARGIN + 0.75 + (i % columns) * (width + 0.95)
        _block(figure, shown, model, row, left=left, top=top + (i // columns) * BLOCK, width=width)
    return figure


def _where(shown: int, whole: int) -> str:
    if whole == 1:
        return "at the one pair of points"
    return f"at all {whole} pairs of points" if shown == whole else f"at {shown} of {whole} pairs of points"


def pick(frfs: FrfSet, count: int) -> list[int]:
    """Choose rows: a drive point first, the others spread evenly over the set."""
    n = len(frfs.responses)
    wanted = max(1, min(count, n))
    spread = np.unique(np.linspace(0, n - 1, wanted).round().astype(int)).tolist()
    drive = [
        i
        for i in range(n)
        if frfs.responses[i].node == frfs.references[i].node
        and frfs.responses[i].axis == frfs.references[i].axis
    ]
    if drive and not set(drive) & set(spread):
        nearest = min(range(len(spread)), key=lambda k: abs(spread[k] - drive[0]))
        spread[nearest] = drive[0]
    return [int(i) for i in sorted(spread, key=lambda i: (i not in drive, i))]


def _within(frfs: FrfSet, low: float, high: float) -> FrfSet:
    """Return the lines of a band and a margin, all of them if the band holds too few."""
    inside = np.count_nonzero((frfs.frequency >= low) & (frfs.frequency <= high))
    edge = 0.03 * (high - low)
    return frfs.band(max(low - edge, 0.0), high + edge) if inside >= 2 else frfs


def _note(frfs: FrfSet, model: ModalModel | None) -> str:
    parts = [f"{frfs.frequency[0]:.4g}–{frfs.frequency[-1]:.4g} Hz in steps of {frfs.df:.3g} Hz"]
    if frfs.averages is not None:
        few, many = int(frfs.averages.min()), int(frfs.averages.max())
        parts.append(f"{few if few == many else f'{few} to {many}'} hits averaged")
    if frfs.decay:
        parts.append(f"exponential window of {frfs.decay:.3g} 1/s still in them")
    if model is not None:
        parts.append(f"{len(model)} modes between {model.band[0]:.4g} and {model.band[1]:.4g} Hz")
    return "  ·  ".join(parts)


def _block(
    figure: Figure, frfs: FrfSet, model: ModalModel | None, row: int, *, left: float, top: float, width: float
) -> None:
    """Draw the panels of one FRF."""
    has_coherence = frfs.coherence is not None
    name = f"{frfs.responses[row]} / {frfs.references[row]}"
    heading(figure, left, top - 0.02, name)
    tall = 1.75 if has_coherence else 2.35
    magnitude = place(figure, left, top + 0.28, width, tall, name=f"magnitude {name}")
    phase = place(figure, left, top + 0.28 + tall + 0.15, width, 0.75, name=f"phase {name}")
    panels = [magnitude, phase]
    tidy(magnitude, y=f"|H| [{frfs.unit}]")
    magnitude.set_yscale("log")
    tidy(phase, y="phase [°]")
    _curves(magnitude, phase, frfs.frequency, frfs.values[row], colour=INK, label="measured", points=True)
    _limits(magnitude, frfs.values[row])
    fit = None if model is None else _fit(model, frfs, row)
    if fit is not None:
        _curves(magnitude, phase, fit[0], fit[1], colour=ORANGE, label="fit", points=False)
    if frfs.coherence is not None:
        panels.append(place(figure, left, top + 0.28 + tall + 1.05, width, 0.55, name=f"coherence {name}"))
        tidy(panels[2], y="γ² [-]")
        panels[2].plot(frfs.frequency, frfs.coherence[row], color=INK, linewidth=0.8)
        panels[2].set_ylim(0, 1.05)
        panels[2].set_yticks([0, 1])
    phase.set_ylim(-190, 190)
    phase.set_yticks([-180, 0, 180])
    _share(panels, frfs, model, width)
    if fit is not None:
        _key(magnitude)


def _share(panels: list[Axes], frfs: FrfSet, model: ModalModel | None, width: float) -> None:
    for panel in panels:
        panel.set_xlim(float(frfs.frequency[0]), float(frfs.frequency[-1]))
        if model is not None:
            mark_modes(panel, model.modal.frequency, width=width, label=panel is panels[0])
        if panel is not panels[-1]:
            panel.tick_params(labelbottom=False)
    panels[-1].set_xlabel("frequency [Hz]", fontsize=11, color=INK)


def _curves(
    magnitude: Axes,
    phase: Axes,
    frequency: FloatArray,
    values: ComplexArray,
    *,
    colour: str,
    label: str,
    points: bool,
) -> None:
    size = np.where(np.abs(values) > 0, np.abs(values), np.nan)
    angle = np.degrees(np.angle(values))
    magnitude.plot(
        frequency,
        size,
        color=colour,
        linewidth=MEASURED if points else FITTED,
        label=label,
        zorder=2 + (not points),
    )
    if points:
        phase.plot(frequency, angle, ".", color=FAINT, markersize=2.2, rasterized=True)
    else:
        jump = np.append(np.abs(np.diff(angle)) > 180, False)
        phase.plot(frequency, np.where(jump, np.nan, angle), color=colour, linewidth=FITTED)


def _limits(magnitude: Axes, values: ComplexArray) -> None:
    """Cut off the single lines that antiresonances drive towards zero."""
    size = np.abs(values)
    size = size[size > 0]
    if len(size):
        magnitude.set_ylim(float(np.percentile(size, 0.5)) / 2.5, float(size.max()) * 3)


def _fit(model: ModalModel, frfs: FrfSet, row: int) -> tuple[FloatArray, ComplexArray] | None:
    """Return lines and values of the fit of one FRF; None where it was left out of the identification."""
    data = model.frfs
    same = [
        i
        for i, pair in enumerate(zip(data.responses, data.references, strict=True))
        if pair == (frfs.responses[row], frfs.references[row])
    ]
    if not same:
        return None
    fitted = model.synthesise().select(same[:1]).to(frfs.form)
    return fitted.frequency, fitted.values[0]


def _key(axes: Axes) -> None:
    axes.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 1.10),
        ncols=2,
        frameon=False,
        fontsize=SMALL,
        handlelength=1.4,
        borderpad=0.0,
        borderaxespad=0.0,
    )
