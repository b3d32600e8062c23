"""Figures of a diagnosis: the whole answer on one page, and its parts on pages of their own."""

from modalkit.figures.diagnosis.figure import diagnosis_figure
from modalkit.figures.diagnosis.frfs import overlaid_figure
from modalkit.figures.diagnosis.gap import gap_figure
from modalkit.figures.diagnosis.shrink import shrink_figure

__all__ = ["diagnosis_figure", "gap_figure", "overlaid_figure", "shrink_figure"]
