"""Reports of an identification, an update, a diagnosis or a plan: one HTML file that needs nothing else, or Word."""

from modalkit.report.diagnosis import diagnosis_report
from modalkit.report.document import Document
from modalkit.report.identification import identification_report
from modalkit.report.page import page
from modalkit.report.place import write_report
from modalkit.report.planning import plan_report
from modalkit.report.provenance import Basis
from modalkit.report.updating import update_report

__all__ = [
    "Basis",
    "Document",
    "diagnosis_report",
    "identification_report",
    "page",
    "plan_report",
    "update_report",
    "write_report",
]
