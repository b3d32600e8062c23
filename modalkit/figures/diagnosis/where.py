"""Where the cause sits: the structure with its zones, points, sensors, and the place found."""

from __future__ import annotations

from dataclasses import replace

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from acquisition.quantities import probability
from modalkit.figures.chart import above, draw_chart
from modalkit.figures.diagnosis.structure import draw_structure
from modalkit.figures.style import BLUE, FAINT, GRID, INK, MUTED, ORANGE, SMALL, TEXT, bare, place
from modalkit.output.location import spans
from modalkit.output.words import located
from modalkit.views.charts.place import place_chart
from updating import Case, Diagnosis


def draw_where(
    figure: Figure,
    diagnosis: Diagnosis,
    case: Case | None,
    *,
    left: float,
    top: float,
    width: float,
    height: float,
) -> None:
    """Draw the structure, coloured by probability.

    Parameters
    ----------
    figure : Figure
        The figure.
    diagnosis : Diagnosis
        The answer.
    case : Case or None
        The structure and its test points, if known.
    left, top, width, height : float
        The panel, from the figure's top left corner [in].
    """
    axes = bare(place(figure, left, top, width, height, name="where"))
    axes.set_xlim(0, width)
    axes.set_ylim(0, height)
    chart = place_chart(diagnosis, case)
    if chart is None:
        assert case is not None
        draw_structure(axes, diagnosis, case, width=width, height=height)
        return
    plain = [one for one in chart.series if one.kind != "line" and one.name != "place found"]
    others = [replace(one, name="") for one in chart.series if one not in plain]
    chart = replace(chart, series=[*plain, *others])
    text, found = _place(diagnosis, plate=case is not None and case.spec.kind == "plate")
    weight, colour = ("bold", ORANGE) if found else ("normal", MUTED)
    axes.text(0.0, height - 0.18, text, fontsize=TEXT, fontweight=weight, color=colour)
    over = 0.32 + above(chart, width) + 0.1  # height of the line that names the place
    if diagnosis.verdict != "none":
        axes.text(width, height + 0.22, "probability, %", fontsize=SMALL, color=MUTED, ha="right")
    tall = min(float(chart.more["equal"]) * width, height - over)
    wide = tall / float(chart.more["equal"])
    draw_chart(figure, chart, left=left, top=top + over, width=wide, height=tall)


def _place(diagnosis: Diagnosis, *, plate: bool) -> tuple[str, bool]:
    """Name the first of the places found, or state why there is none; and whether there is one."""
    where = diagnosis.where
    if diagnosis.verdict == "unknown":
        return "no place is known: no explanation was found", False
    if where.location is not None:
        others = len(where.locations) - 1
        return located(diagnosis, plate=plate) + (f"  (one of {others + 1})" if others > 0 else ""), True
    if spans(diagnosis):
        return "in the measurement and in the structure", False
    nowhere = {"none": "no gap, so no place", "measurement": "in the measurement, not in the structure"}
    return nowhere.get(where.channel, "no single place: it acts on all of it"), False


def draw_channels(axes: Axes, diagnosis: Diagnosis, *, width: float, height: float) -> None:
    """Draw how the probability divides among stiffness, mass, damping and measurement.

    Parameters
    ----------
    axes : Axes
        The panel; its units become inches.
    diagnosis : Diagnosis
        The answer.
    width, height : float
        Size of the panel [in].
    """
    bare(axes)
    axes.set_xlim(0, width)
    axes.set_ylim(-height, 0)
    shares = {n: v for n, v in diagnosis.where.channels.items() if n != "none"}
    step = height / max(len(shares), 1)
    left, right = 1.08, 0.68
    full = width - left - right
    for i, (name, value) in enumerate(shares.items()):
        y, top = -(i + 0.5) * step, name == diagnosis.where.channel
        axes.text(left - 0.12, y, name, fontsize=SMALL, ha="right", va="center", color=INK if top else MUTED)
        axes.barh(y, full, left=left, height=0.09, color=GRID)
        axes.barh(y, full * value, left=left, height=0.09, color=BLUE if top else FAINT)
        axes.text(
            width, y, probability(value), fontsize=SMALL, ha="right", va="center", color=INK if top else MUTED
        )
