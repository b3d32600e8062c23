"""What the most probable set lacks where none is an answer, in the words of the summary, the report and the app."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from updating.diagnosis.answer.result import Shortcoming


class Wording(NamedTuple):
    """The same shortcoming in three sentences.

    Parameters
    ----------
    but : str
        Ends "<set> fits best, but ..."; empty where the summary states it otherwise.
    headline : str
        Ends "A real gap, and ...".
    row : str
        Stands beside the set in a table: why it is not the answer.
    """

    but: str
    headline: str
    row: str


WORDINGS: Mapping[Shortcoming, Wording] = {
    "fit": Wording(
        but="",
        headline="nothing in the library of effects explains it",
        row="fits only at an end of its plausible range",
    ),
    "closing": Wording(
        but="closes too little of the gap and leaves more than noise",
        headline="no cause closes enough of it",
        row="fits best, but closes too little of the gap and leaves more than noise",
    ),
    "evidence": Wording(
        but="",
        headline="no cause is clearly more probable than tolerances or data worse than stated",
        row="fits, but hardly better than a discrepancy without any effect",
    ),
    "samples": Wording(
        but="its probability is not known: the likelihood is too rough for samples to determine it",
        headline="the probability of its likeliest cause is not known",
        row="fits best, but its probability is not known",
    ),
    "partners": Wording(
        but="",
        headline="most measured modes have no partner in the model",
        row="most measured modes have no partner in the model",
    ),
    "one size": Wording(
        but="parts of the data require different sizes of it",
        headline="no cause explains all parts of the data with one size",
        row="fits best, but parts of the data require different sizes of it",
    ),
    "library": Wording(
        but="a cause outside the library is as likely",
        headline="nothing in the library of effects explains it",
        row="fits, but a cause outside the library is as likely",
    ),
}
"""Each shortcoming by its name in the contract."""
