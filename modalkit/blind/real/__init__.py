"""Real structures of which more is known than the diagnosis is told."""

from modalkit.blind.real.case import Case, Fact, Source
from modalkit.blind.real.cases import CASES
from modalkit.blind.real.judging import RULES, Judgement, judge
from modalkit.blind.real.record import counts, put_between_markers, real_markdown, real_record
from modalkit.blind.real.running import RealOutcome, diagnose_together_by, run_real
from modalkit.blind.real.table import real_table

__all__ = [
    "CASES",
    "RULES",
    "Case",
    "Fact",
    "Judgement",
    "RealOutcome",
    "Source",
    "counts",
    "diagnose_together_by",
    "judge",
    "put_between_markers",
    "real_markdown",
    "real_record",
    "real_table",
    "run_real",
]
