"""All cases: first with the whole library, then with the true effects taken out of it."""

from modalkit.papers.real.case import Case
from modalkit.papers.real.changed import CHANGED
from modalkit.papers.real.measured import MEASURED_CASES, MEASURED_LEFT_OUT
from modalkit.papers.real.paper_a import PAPER_A, PAPER_A_LEFT_OUT
from modalkit.papers.real.paper_b import PAPER_B, PAPER_B_LEFT_OUT
from modalkit.papers.real.printed import PRINTED, PRINTED_LEFT_OUT

CASES: tuple[Case, ...] = (
    *MEASURED_CASES,
    *CHANGED,
    *PRINTED,
    *PAPER_A,
    *PAPER_B,
    *MEASURED_LEFT_OUT,
    *PRINTED_LEFT_OUT,
    *PAPER_A_LEFT_OUT,
    *PAPER_B_LEFT_OUT,
)
"""Every case of ``blind --real``."""
