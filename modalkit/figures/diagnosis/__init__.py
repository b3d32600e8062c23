"""Figures of a diagnosis: the whole answer on one page, and its parts on pages of their own."""

from modalkit.figures.diagnosis.errors import mode_errors
from modalkit.figures.diagnosis.figure import diagnosis_figure
from modalkit.figures.diagnosis.fitted import Fitted, fitted
from modalkit.figures.diagnosis.frfs import Overlaid, overlaid, overlaid_figure
from modalkit.figures.diagnosis.gap import gap_figure
from modalkit.figures.diagnosis.shrink import shrink_figure

__all__ = [
    "Fitted",
    "Overlaid",
    "diagnosis_figure",
    "fitted",
    "gap_figure",
    "mode_errors",
    "overlaid",
    "overlaid_figure",
    "shrink_figure",
]
