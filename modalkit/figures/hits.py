"""Hammer hits: pulses, spectra, and which are not to be used."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition import Dof, HammerTest, HitVerdict, verdicts_of
from acquisition.arrays import AnyArray, BoolArray, FloatArray
from acquisition.display import counted
from acquisition.quantities import hertz
from modalkit.figures.style import (
    BLUE,
    FAINT,
    GRID,
    INK,
    MARGIN,
    MUTED,
    ORANGE,
    SMALL,
    TEXT,
    WIDTH,
    bare,
    caption,
    caption_height,
    heading,
    new_figure,
    place,
    shortened,
    tidy,
)

REASONS = 10
"""Most rejected hits listed with their reason."""

LINE = 0.23
"""Height of a line of the list [in]."""


@dataclass(frozen=True, eq=False)
class _Row:
    """All hits of a test in the order they were made, one row each."""

    names: tuple[str, ...]
    force: FloatArray
    used: BoolArray
    reasons: tuple[str, ...]
    start: tuple[int, ...]
    points: tuple[str, ...]


def hits_figure(test: HammerTest, verdicts: Sequence[HitVerdict] = ()) -> Figure:
    """Draw the force pulses, their spectra and their peaks, rejected hits marked with the reason.

    Parameters
    ----------
    test : HammerTest
        The records.
    verdicts : sequence of HitVerdict
        What is thought of the hits; a hit without a verdict counts as used.

    Returns
    -------
    Figure
    """
    hits = _gather(test, verdicts)
    bad = np.flatnonzero(~hits.used)
    n = len(hits.used)
    title = f"{counted(n, 'hit')} at {counted(len(test.points), 'point')}, {_used(n, len(bad))}"
    note = f"{test.rate:g} samples/s, records of {test.duration:.3g} s  ·  blue: used, orange: not to be used"
    lines = min(len(bad), REASONS) + (1 if len(bad) > REASONS else 0)
    top = caption_height(title, note) + 0.55
    lower = top + 3.1 + 1.15
    listed = lower + 1.5 + 0.95
    figure = new_figure(listed + LINE * lines + (0.35 if lines else -0.25))
    caption(figure, title, note)
    heading(figure, MARGIN, top - 0.2, "Pulses")
    _pulses(place(figure, MARGIN + 0.7, top, 4.7, 3.1, name="pulses"), test, hits)
    heading(figure, 6.45, top - 0.2, "Spectra")
    _spectra(place(figure, 6.45 + 0.7, top, WIDTH - 7.15 - MARGIN, 3.1, name="spectra"), test, hits, verdicts)
    heading(figure, MARGIN, lower - 0.2, "Peaks")
    _peaks(place(figure, MARGIN + 0.7, lower, WIDTH - 2 * MARGIN - 0.7, 1.5, name="peaks"), hits)
    if lines:
        heading(figure, MARGIN, listed - 0.1, "Not to be used")
        _list(figure, hits, bad, listed, LINE * lines)
    return figure


def _used(count: int, bad: int) -> str:
    if bad == count:
        return "none of them used" if count > 1 else "not used"
    if count == 1:
        return "used"
    return "all of them used" if not bad else f"{count - bad} of them used"


def _gather(test: HammerTest, verdicts: Sequence[HitVerdict]) -> _Row:
    seen: dict[Dof, int] = {}
    names: list[str] = []
    used: list[bool] = []
    reasons: list[str] = []
    start: list[int] = []
    for point, stated in zip(test.points, verdicts_of(test, verdicts), strict=True):
        start.append(len(names))
        first = seen.get(point.reference, 0)
        seen[point.reference] = first + point.count
        for number, verdict in enumerate(stated, start=first + 1):
            names.append(f"{point.reference} hit {number if verdict is None else verdict.hit}")
            used.append(verdict is None or verdict.used)
            reasons.append("" if verdict is None else "; ".join(verdict.reasons))
    force = np.concatenate([point.force for point in test.points])
    points = tuple(str(point.reference) for point in test.points)
    return _Row(tuple(names), force, np.array(used, dtype=bool), tuple(reasons), tuple(start), points)


def _pulses(axes: Axes, test: HammerTest, hits: _Row) -> None:
    """Overlay the pulses, each about its peak."""
    tidy(axes, x="time from the peak [ms]", y="force [N]")
    before, after = _window(test, hits)
    offsets = np.arange(-before, after + 1)
    peak = np.abs(hits.force).argmax(axis=1)
    index = peak[:, None] + offsets
    inside = (index >= 0) & (index < test.samples)
    pulses = np.take_along_axis(hits.force, np.clip(index, 0, test.samples - 1), axis=1)
    pulses = np.where(inside, pulses, np.nan)
    time = 1e3 * offsets / test.rate
    _overlay(axes, time, pulses, hits.used, width=1.5)
    axes.set_xlim(float(time[0]), float(time[-1]))


def _window(test: HammerTest, hits: _Row) -> tuple[int, int]:
    """Return how many samples before and after the peak show the pulses and what may follow them."""
    size = np.abs(hits.force)
    above = np.count_nonzero(size > 0.1 * size.max(axis=1, keepdims=True), axis=1)
    width = max(int(np.median(above)), 3)
    return min(3 * width, test.samples // 2), min(10 * width, test.samples // 2)


def _overlay(axes: Axes, x: AnyArray, curves: AnyArray, used: BoolArray, *, width: float) -> None:
    """Draw the curves of used hits thin and pale, and those of the others over them."""
    if used.any():
        axes.plot(x, curves[used].T, color=BLUE, linewidth=0.9, alpha=0.45, zorder=2)
    if not used.all():
        axes.plot(x, curves[~used].T, color=ORANGE, linewidth=width, alpha=0.85, zorder=3)


def _spectra(axes: Axes, test: HammerTest, hits: _Row, verdicts: Sequence[HitVerdict]) -> None:
    """Draw the force spectra over the median level of the used hits at the lowest frequencies."""
    tidy(axes, x="frequency [Hz]", y="force spectrum [dB]")
    lines = np.fft.rfftfreq(test.samples, 1 / test.rate)
    spectrum = np.abs(np.fft.rfft(hits.force, axis=1))
    start = spectrum[:, 1 : max(3, len(lines) // 100)].max(axis=1)
    reference = float(np.median(start[hits.used] if hits.used.any() else start))
    level = 20 * np.log10(np.maximum(spectrum, 1e-12) / max(reference, 1e-12))
    step = max(1, len(lines) // 2000)
    _overlay(axes, lines[1::step], level[:, 1::step], hits.used, width=0.9)
    axes.set_xlim(0, float(lines[-1]))
    axes.set_ylim(-62, 12)
    good = [v for v in verdicts if v.used]
    for name, down in (("10 dB", -10), ("20 dB", -20)):
        reach = [v.band10 if down == -10 else v.band20 for v in good]
        edge = float(np.median(reach)) if reach else np.nan
        if np.isfinite(edge) and 0 < edge < lines[-1]:
            axes.plot(
                [0, edge, edge],
                [down, down, -62],
                color=MUTED,
                linewidth=0.9,
                linestyle=(0, (3, 3)),
                zorder=4,
            )
            far = edge > 0.55 * lines[-1]
            axes.annotate(
                f"{name} down at {hertz(edge)}",
                (edge, down),
                xytext=(-4 if far else 5, 4),
                textcoords="offset points",
                ha="right" if far else "left",
                fontsize=SMALL,
                color=INK,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.8},
                zorder=5,
            )


def _peaks(axes: Axes, hits: _Row) -> None:
    """Draw the peak of every hit, points side by side."""
    tidy(axes, y="peak force [N]", grid="y")
    peak, number = np.abs(hits.force).max(axis=1), np.arange(len(hits.used))
    axes.scatter(number[hits.used], peak[hits.used], s=20, color=BLUE, zorder=3)
    axes.scatter(
        number[~hits.used], peak[~hits.used], s=42, marker="X", color=ORANGE, linewidth=0.4, zorder=4
    )
    edges = [*hits.start, len(number)]
    for i in range(0, len(hits.start), 2):
        axes.axvspan(edges[i] - 0.5, edges[i + 1] - 0.5, color=GRID, alpha=0.45, linewidth=0, zorder=0.5)
    every = max(1, -(-len(hits.points) // 22))
    middle = [(edges[i] + edges[i + 1] - 1) / 2 for i in range(len(hits.points))]
    axes.set_xticks(middle[::every], hits.points[::every])
    axes.tick_params(axis="x", length=0)
    axes.set_xlim(-0.5, len(number) - 0.5)
    axes.set_ylim(0, 1.1 * float(peak.max()) or 1.0)
    axes.set_xlabel("point hit, its hits from left to right", fontsize=TEXT, color=INK)


def _list(figure: Figure, hits: _Row, bad: np.ndarray, top: float, height: float) -> None:
    axes = bare(place(figure, MARGIN, top, WIDTH - 2 * MARGIN, height, name="reasons"))
    axes.set_xlim(0, WIDTH - 2 * MARGIN)
    axes.set_ylim(-height, 0)
    for i, row in enumerate(bad[:REASONS]):
        y = -LINE * (i + 0.72)
        axes.scatter([0.07], [y + 0.05], s=36, marker="X", color=ORANGE, linewidth=0.4, clip_on=False)
        axes.text(0.25, y, hits.names[row], fontsize=TEXT, color=INK)
        reason = hits.reasons[row] or "no reason given"
        axes.text(
            1.75, y, shortened(reason, 72 * (WIDTH - 2 * MARGIN - 1.8), TEXT), fontsize=TEXT, color=MUTED
        )
    if len(bad) > REASONS:
        axes.text(
            0.25, -LINE * (REASONS + 0.72), f"and {len(bad) - REASONS} more", fontsize=TEXT, color=FAINT
        )
