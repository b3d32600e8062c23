"""The figure of a diagnosis."""

from modalkit.figures.diagnosis.figure import diagnosis_figure

__all__ = ["diagnosis_figure"]
