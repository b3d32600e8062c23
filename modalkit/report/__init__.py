"""The report of a diagnosis: one HTML file that needs nothing else, and the figures in it."""

from modalkit.report.drawings import Drawing, drawings
from modalkit.report.page import diagnosis_report
from modalkit.report.place import REPORT, write_report

__all__ = ["REPORT", "Drawing", "diagnosis_report", "drawings", "write_report"]
