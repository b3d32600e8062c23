"""Real structures of which more is known than the diagnosis is given."""

from modalkit.papers.real.case import Case, Fact, Source
from modalkit.papers.real.cases import CASES
from modalkit.papers.real.document import counts, real_document
from modalkit.papers.real.judging import RULES, Judgement, judge
from modalkit.papers.real.running import RealOutcome, diagnose_together_by, run_real
from modalkit.papers.real.table import real_table

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
    "real_document",
    "real_table",
    "run_real",
]
