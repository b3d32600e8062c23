"""The score of a blind run in figures."""

from __future__ import annotations

from collections.abc import Callable

from matplotlib.figure import Figure

from modalkit.blind.scoring.abstention import KNOWN
from modalkit.blind.scoring.calibration import CAME_TRUE
from modalkit.blind.scoring.closing import comparable
from modalkit.blind.scoring.rates import headline
from modalkit.blind.scoring.score import Score
from modalkit.figures.blind.confidence import abstention_figure, curve_of
from modalkit.figures.blind.confusion import confusion_figure
from modalkit.figures.blind.truth import severity_figure
from modalkit.figures.chart import sheet_figure
from modalkit.views.charts.blind import closing_sheet, rates_sheet, reliability_sheet

SIDE = 4.6
"""Height of a panel [in]."""


def blind_figures(score: Score) -> dict[str, Figure]:
    """Draw the score of a blind run.

    Parameters
    ----------
    score : Score
        As :func:`modalkit.blind.score` returns it.

    Returns
    -------
    dict of str to Figure
        ``blind_rates``, ``blind_confusion``, ``blind_abstention``, ``blind_reliability``, ``blind_severity`` and
        ``blind_closing``; those that the run has nothing for are left out.
    """
    stated = comparable(score.closing)
    drawn: dict[str, tuple[bool, Callable[[], Figure]]] = {
        "blind_rates": (bool(headline(score.rates)), lambda: sheet_figure(rates_sheet(score), columns=1)),
        "blind_confusion": (True, lambda: confusion_figure(score.answers)),
        "blind_abstention": (len(curve_of(score, KNOWN).points) > 0, lambda: abstention_figure(score)),
        "blind_reliability": (
            bool(score.rates.of(CAME_TRUE)),
            lambda: sheet_figure(reliability_sheet(score), tall=SIDE),
        ),
        "blind_severity": (
            bool(score.severity["error"].notna().any()),
            lambda: severity_figure(score.severity),
        ),
        "blind_closing": (
            len(stated) > 0 or bool(score.places["held"].astype(bool).any()),
            lambda: sheet_figure(closing_sheet(score.closing, score.places), tall=SIDE),
        ),
    }
    return {name: make() for name, (wanted, make) in drawn.items() if wanted}
