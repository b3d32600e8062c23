"""Where the gap sits, on a page of its own: the structure with its zones, and what every mode adds."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from acquisition.arrays import FloatArray
from acquisition.quantities import hertz, probability
from modalkit.figures.diagnosis.where import draw_where
from modalkit.figures.style import (
    BLUE,
    GRID,
    INK,
    MARGIN,
    MUTED,
    SIGNED,
    SMALL,
    TEXT,
    WIDTH,
    bare,
    caption,
    caption_height,
    heading,
    ink_on,
    new_figure,
    place,
    shortened,
    text_width,
)
from modalkit.output.location import localisation_title
from modalkit.output.names import zone_in_words
from modalkit.views.outline import outline
from updating import Case, Diagnosis
from updating.diagnosis.answer.contributions import columns_of

LEFT, RIGHT = 7.1, 3.6
"""Widths of the structure and of the list of zones [in]."""

TALL, FLAT, DEEP = 2.7, 2.0, 4.4
"""Height of both for a plate, for a beam, and in space [in]."""


LISTED = 8
"""Most zones in the list."""

ROW = 0.34
"""Height of a row of the table of modes [in]."""

FAR = 10.0
"""Standard deviations at which the colour of a cell is full."""


def localisation_figure(diagnosis: Diagnosis, case: Case | None = None) -> Figure:
    """Draw the probability of each zone, the places found, the points concerned, and what each mode adds to the gap.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    case : Case, optional
        What was diagnosed; without it neither test points nor clamps are drawn.

    Returns
    -------
    Figure
    """
    where = diagnosis.where
    title, note = localisation_title(diagnosis), _note(diagnosis)
    columns = _columns(diagnosis)
    above, low = caption_height(title, note), ROW * (len(columns) + 1)
    top = above + 0.75
    tall = _tall(diagnosis, case)
    figure = new_figure(top + tall + (0.8 + low + 0.35 if columns else 0.3))
    caption(figure, title, note)
    draw_where(figure, diagnosis, case, left=MARGIN, top=top - 0.2, width=LEFT, height=tall + 0.2)
    heading(figure, MARGIN, top - 0.42, "Where it sits")
    heading(figure, WIDTH - MARGIN - RIGHT, top - 0.42, "Probability of each zone")
    _list(place(figure, WIDTH - MARGIN - RIGHT, top - 0.2, RIGHT, tall + 0.2, name="zones"), diagnosis, tall)
    if columns and where.modes is not None:
        under = top + tall + 0.8
        heading(
            figure,
            MARGIN,
            under - 0.16,
            "What every mode adds, in standard deviations of noise and tolerances",
        )
        table = place(figure, MARGIN, under, WIDTH - 2 * MARGIN, low, name="modes")
        _table(table, diagnosis, columns, low)
    return figure


def _tall(diagnosis: Diagnosis, case: Case | None) -> float:
    """Return the height of the structure [in]."""
    if case is not None and case.spec.imported is not None:
        return DEEP
    return TALL if outline(diagnosis, case).width else FLAT


def _note(diagnosis: Diagnosis) -> str:
    where = diagnosis.where
    by = "zones as if one of them alone were changed" if where.zones_by == "regions" else ""
    return "  ·  ".join(part for part in (where.band.rstrip("."), by) if part)


def _columns(diagnosis: Diagnosis) -> dict[str, str]:
    """Return the kinds of data that the table of modes holds, each with its column."""
    modes = diagnosis.where.modes
    return {} if modes is None else columns_of(modes)


def _list(axes: Axes, diagnosis: Diagnosis, tall: float) -> None:
    """Draw the most probable zones as bars; where all are alike, the first ones."""
    bare(axes)
    height = tall + 0.2
    axes.set_xlim(0, RIGHT)
    axes.set_ylim(-height, 0)
    if diagnosis.verdict == "none":
        axes.text(0, -0.35, "none: there is no cause to place", fontsize=TEXT, color=MUTED)
        return
    # zones whose probabilities differ by less are in no order
    alike = np.ptp([z.probability for z in diagnosis.where.zones] or [0.0]) < 0.01
    zones = sorted(diagnosis.where.zones, key=lambda z: 0.0 if alike else -z.probability)
    longest = max((text_width(zone_in_words(zone.name), SMALL) for zone in zones[:LISTED]), default=0.0) / 72
    left, right = min(max(1.1, longest + 0.2), 1.9), 0.75
    full = RIGHT - left - right
    for i, zone in enumerate(zones[:LISTED]):
        y = -(i + 0.5) * height / (LISTED + 1)
        name = shortened(zone_in_words(zone.name), 72 * (left - 0.15), SMALL)
        axes.text(left - 0.1, y, name, fontsize=SMALL, color=INK, ha="right", va="center")
        axes.barh(y, full, left=left, height=0.1, color=GRID)
        axes.barh(y, full * min(zone.probability, 1.0), left=left, height=0.1, color=BLUE)
        axes.text(RIGHT, y, probability(zone.probability), fontsize=SMALL, color=INK, ha="right", va="center")
    if len(zones) > LISTED:
        rest = (
            f"{len(zones) - LISTED} more, together {probability(sum(z.probability for z in zones[LISTED:]))}"
        )
        axes.text(
            left, -(LISTED + 0.5) * height / (LISTED + 1), rest, fontsize=SMALL, color=MUTED, va="center"
        )


def _table(axes: Axes, diagnosis: Diagnosis, columns: dict[str, str], height: float) -> None:
    """Draw modes from left to right, kinds of data from above to below."""
    bare(axes)
    modes = diagnosis.where.modes
    assert modes is not None
    wide = WIDTH - 2 * MARGIN
    axes.set_xlim(0, wide)
    axes.set_ylim(-height, 0)
    # most modes in the table: those that add the most
    kept = np.sort(np.argsort(-modes["share [%]"].to_numpy(float), kind="stable")[:20])
    left = max(text_width(name, TEXT) for name in [*columns, "mode"]) / 72 + 0.15
    cell = min((wide - left) / max(len(kept), 1), 1.1)
    tested = modes["test [Hz]"].to_numpy(float)
    labels = [f"{mode + 1}: {hertz(tested[mode])}" for mode in kept.tolist()]
    if max(text_width(label, SMALL) for label in labels) > 72 * cell - 4:
        labels = [f"{mode + 1}" for mode in kept.tolist()]
    for i, label in enumerate(labels):
        x = left + (i + 0.5) * cell
        axes.text(x, -0.5 * ROW, label, fontsize=SMALL, color=MUTED, ha="center", va="center")
    axes.text(left - 0.12, -0.5 * ROW, "mode", fontsize=TEXT, color=MUTED, ha="right", va="center")
    for k, (name, column) in enumerate(columns.items()):
        y = -(k + 1.5) * ROW
        axes.text(left - 0.12, y, name, fontsize=TEXT, color=INK, ha="right", va="center")
        _cells(axes, modes[column].to_numpy(float)[kept], left, y, cell)


def _cells(axes: Axes, values: FloatArray, left: float, y: float, cell: float) -> None:
    for i, value in enumerate(values.tolist()):
        known = bool(np.isfinite(value))
        colour = SIGNED(0.5 + 0.5 * float(np.clip(value / FAR, -1, 1))) if known else "white"
        corner = (left + i * cell, y - 0.5 * ROW)
        axes.add_patch(Rectangle(corner, cell, ROW, facecolor=colour, edgecolor="white", linewidth=1.5))
        text = f"{value:.1f}" if abs(value) < 99.5 else f"{value:.0f}"
        text = "0.0" if text == "-0.0" else text
        axes.text(
            left + (i + 0.5) * cell,
            y,
            text.replace("-", "−") if known else "–",
            fontsize=SMALL,
            color=ink_on(colour),
            ha="center",
            va="center",
        )
