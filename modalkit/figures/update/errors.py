"""What updating did to the errors, and to the parameters."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import InputError
from acquisition.arrays import FloatArray
from acquisition.display import counted
from acquisition.quantities import percent
from modalkit.figures.dumbbell import dumbbells
from modalkit.figures.style import (
    BLUE,
    FAINT,
    INK,
    MARGIN,
    MUTED,
    TEXT,
    WIDTH,
    caption,
    caption_height,
    heading,
    new_figure,
    place,
    tidy,
)


def update_figure(
    frequency: FloatArray,
    before: FloatArray,
    after: FloatArray,
    *,
    sigma: FloatArray | None = None,
    parameters: Mapping[str, tuple[float, float]] | None = None,
    title: str = "",
) -> Figure:
    """Draw the frequency errors before and after updating, and the factors found.

    Parameters
    ----------
    frequency : (n_modes,) array
        Measured frequencies [Hz].
    before, after : (n_modes,) arrays
        Errors of the nominal and of the updated model, relative to the test [%].
    sigma : (n_modes,) array, optional
        Standard deviation of the measured frequencies [%].
    parameters : mapping of str to (factor, sigma), optional
        Factors on the nominal values and their standard deviations, nan where unknown [-].
    title : str
        Of the study.

    Returns
    -------
    Figure

    Raises
    ------
    InputError
        If the arrays do not have one entry per mode.
    """
    f, b, a = (np.asarray(v, dtype=float) for v in (frequency, before, after))
    if not f.ndim == 1 or not f.shape == b.shape == a.shape or len(f) == 0:
        raise InputError(f"frequencies {f.shape}, errors {b.shape} and {a.shape}: give one of each per mode")
    factors = parameters or {}
    statement = f"Updating takes the frequency error from {percent(_rms(b))} to {percent(_rms(a))} r.m.s."
    note = "  ·  ".join(
        part
        for part in (title, counted(len(f), "mode"), counted(len(factors), "parameter") if factors else "")
        if part
    )
    rows = max(len(f), len(factors))
    top = caption_height(statement, note) + 0.8
    tall = max(1.2, 0.36 * rows)
    figure = new_figure(top + tall + 0.7)
    caption(figure, statement, note)
    split = 6.0 if factors else WIDTH - MARGIN
    panel = place(figure, MARGIN + 1.1, top, split - MARGIN - 1.35, tall, name="errors")
    heading(figure, MARGIN, top - 0.42, "Errors, mode by mode")
    floor = None if sigma is None else 2 * np.asarray(sigma, dtype=float)
    dumbbells(panel, f, b, a, floor=floor, label="model − test, of the frequency [%]", indent=1.1)
    if factors:
        heading(figure, split + 0.3, top - 0.42, "Parameters, over their nominal values")
        _factors(place(figure, split + 1.9, top, WIDTH - split - 1.9 - 1.5, tall, name="parameters"), factors)
    return figure


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _factors(axes: Axes, factors: Mapping[str, tuple[float, float]]) -> None:
    tidy(axes, x="factor on the nominal value [-]", grid="x")
    rows = np.arange(len(factors))
    value = np.array([v for v, _ in factors.values()], dtype=float)
    sigma = np.array([s for _, s in factors.values()], dtype=float)
    axes.axvline(1.0, color=MUTED, linewidth=0.9, zorder=1.2)
    axes.hlines(rows, np.ones_like(value), value, color=FAINT, linewidth=2.2, zorder=2)
    axes.errorbar(
        value,
        rows,
        xerr=2 * np.where(np.isfinite(sigma), sigma, 0.0),
        fmt="o",
        color=BLUE,
        markersize=7,
        capsize=3,
        zorder=3,
    )
    for row, (v, s) in enumerate(zip(value, sigma, strict=True)):
        text = f"{v:.3f}" + (f" ± {s:.3f}" if np.isfinite(s) else "")
        axes.annotate(text, (1, row), xycoords=("axes fraction", "data"), xytext=(8, 0), textcoords="offset points",
                      va="center", fontsize=TEXT, color=INK, annotation_clip=False)  # fmt: skip
    axes.set_yticks(rows, list(factors))
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    axes.margins(x=0.12)
