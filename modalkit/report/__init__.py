"""Reports: one HTML file of an identification, an update, a diagnosis or a plan, which needs nothing else."""

from modalkit.report.diagnosis import diagnosis_report
from modalkit.report.identification import identification_report
from modalkit.report.place import REPORT, write_report
from modalkit.report.planning import plan_report
from modalkit.report.provenance import Basis
from modalkit.report.updating import update_report

__all__ = [
    "REPORT",
    "Basis",
    "diagnosis_report",
    "identification_report",
    "plan_report",
    "update_report",
    "write_report",
]
