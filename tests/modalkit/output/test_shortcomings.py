"""What an answer may lack is stated twice, since the blind rig reads documents and loads no model."""

from __future__ import annotations

from typing import get_args, get_type_hints

from modalkit.output.schemas.diagnosis import CauseEntry
from modalkit.output.shortcomings import WORDINGS
from updating.diagnosis.answer.result import Shortcoming


def test_a_document_has_a_word_for_whatever_an_answer_may_lack() -> None:
    literal, nothing = get_args(get_type_hints(CauseEntry)["lacks"])
    assert set(get_args(literal)) == set(get_args(Shortcoming))
    assert nothing is type(None)


def test_each_has_a_reason_of_its_own_beside_the_set_that_it_keeps_from_being_the_answer() -> None:
    assert set(WORDINGS) == set(get_args(Shortcoming))
    rows = {wording.row for wording in WORDINGS.values()}
    assert len(rows) == len(WORDINGS)
