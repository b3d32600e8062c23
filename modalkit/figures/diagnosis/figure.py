"""The whole answer on one page."""

from __future__ import annotations

from dataclasses import dataclass

from matplotlib.figure import Figure

from modalkit.figures.chart import draw_chart
from modalkit.figures.diagnosis.causes import draw_causes
from modalkit.figures.diagnosis.where import draw_channels, draw_where
from modalkit.figures.style import (
    INK,
    MARGIN,
    MUTED,
    SMALL,
    TEXT,
    bare,
    broken,
    caption,
    caption_height,
    heading,
    new_figure,
    place,
)
from modalkit.output.summary import separated
from modalkit.output.words import answer, evidence
from modalkit.views.charts.causes import closing_chart, rivals
from modalkit.views.charts.gap import gap_chart
from modalkit.views.mode_errors import ModeErrors, mode_errors
from modalkit.workflow.fitted import Fitted
from updating import Case, Diagnosis

LEFT, MIDDLE, RIGHT = (1.3, 2.5), (4.5, 3.3), (8.35, 3.3)
"""Left edge and width of the three panels [in]."""

CHANNELS = 0.92
"""Height of the channels under the structure [in]."""


def diagnosis_figure(diagnosis: Diagnosis, case: Case | None = None, *, best: Fitted | None = None) -> Figure:
    """Draw how large the gap is, what causes it, where that sits, and whether it holds on modes held out.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    case : Case, optional
        What was diagnosed. With it the errors after the effect, the test points, the sensor and the clamps are
        drawn; without it only what the diagnosis itself holds.
    best : Fitted, optional
        Its best explanation, where that is known already.

    Returns
    -------
    Figure
    """
    errors = mode_errors(diagnosis, case, best=best)
    title, note = answer(diagnosis), evidence(diagnosis)
    rows = _Rows.of(caption_height(title, note), len(errors.frequency), len(rivals(diagnosis)))
    figure = new_figure(rows.total)
    caption(figure, title, note)
    _upper(figure, diagnosis, case, errors, rows)
    _lower(figure, diagnosis, rows)
    return figure


@dataclass(frozen=True)
class _Rows:
    """Heights and tops of the two rows of panels, counted from above [in]."""

    upper: float
    tall: float
    lower: float
    low: float
    total: float

    @classmethod
    def of(cls, above: float, modes: int, rivals: int) -> _Rows:
        tall = max(3.3, 0.26 * modes)
        upper, low = above + 0.72, 0.36 * rivals + 0.5
        lower = upper + tall + 1.12
        return cls(upper, tall, lower, low, lower + low + 0.62)


def _upper(figure: Figure, diagnosis: Diagnosis, case: Case | None, errors: ModeErrors, rows: _Rows) -> None:
    top, tall = rows.upper, rows.tall
    draw_chart(
        figure, gap_chart(errors), left=LEFT[0], top=top + 0.2, width=LEFT[1], height=tall - 0.2, name="gap"
    )
    heading(figure, MARGIN, top - 0.42, "How large it is, mode by mode")
    draw_causes(
        place(figure, MIDDLE[0], top - 0.2, MIDDLE[1], tall + 0.2, name="causes"),
        diagnosis,
        width=MIDDLE[1],
        height=tall + 0.2,
    )
    heading(figure, MIDDLE[0], top - 0.42, "What causes it")
    high = tall - CHANNELS + 0.2
    draw_where(figure, diagnosis, case, left=RIGHT[0], top=top - 0.2, width=RIGHT[1], height=high)
    heading(figure, RIGHT[0], top - 0.42, "Where it sits")
    channels = place(figure, RIGHT[0], top + tall - CHANNELS, RIGHT[1], CHANNELS, name="channels")
    draw_channels(channels, diagnosis, width=RIGHT[1], height=CHANNELS)


def _lower(figure: Figure, diagnosis: Diagnosis, rows: _Rows) -> None:
    heading(figure, MARGIN, rows.lower - 0.12, "Whether it predicts modes left out of the fit")
    draw_chart(
        figure,
        closing_chart(diagnosis),
        left=3.15,
        top=rows.lower + 0.3,
        width=4.1,
        height=rows.low - 0.3,
        name="held out",
    )
    heading(figure, RIGHT[0], rows.lower - 0.12, "What to measure next")
    axes = bare(place(figure, RIGHT[0], rows.lower, RIGHT[1], rows.low, name="next"))
    axes.set_xlim(0, RIGHT[1])
    axes.set_ylim(-rows.low, 0)
    down, before = 0.0, True
    for line, strong in _advice(diagnosis, int((rows.low + 0.3) / 0.21)):
        down += 0.29 if strong and not before else 0.21
        axes.text(0, -down, line, fontsize=TEXT if strong else SMALL, color=INK if strong else MUTED)
        before = strong


def _advice(diagnosis: Diagnosis, most: int) -> list[tuple[str, bool]]:
    """Return the lines on what to measure next, at most so many, and whether each is the advice itself."""
    if not diagnosis.next_test:
        nothing = {
            "none": "Nothing: there is no gap.",
            "named": "Nothing: no rival is left to separate.",
        }.get(diagnosis.verdict, "No measurement in the library would separate the remaining causes.")
        return [(line, True) for line in broken(nothing, 72 * RIGHT[1], TEXT)]
    lines: list[tuple[str, bool]] = []
    for measure in dict.fromkeys(test.measure for test in diagnosis.next_test):
        tests = [test for test in diagnosis.next_test if test.measure == measure]
        stated = "; ".join(dict.fromkeys(filter(None, map(separated, tests))))
        here = [(line, True) for line in broken(measure[:1].upper() + measure[1:], 72 * RIGHT[1], TEXT)]
        here += [(line, False) for line in broken(stated.replace("_", " "), 72 * RIGHT[1], SMALL)]
        if lines and len(lines) + len(here) > most:
            break
        lines += here
    return lines[:most]
