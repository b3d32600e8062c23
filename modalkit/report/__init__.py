"""The report of a diagnosis: one HTML file that needs nothing else, and the figures in it."""

from modalkit.report.drawings import Drawing, drawings
from modalkit.report.page import diagnosis_report
from modalkit.report.place import check_report_place, write_report

__all__ = ["Drawing", "check_report_place", "diagnosis_report", "drawings", "write_report"]
