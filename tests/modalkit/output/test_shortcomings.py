"""What an answer may lack is stated twice, since the blind rig reads documents and loads no model."""

from __future__ import annotations

from typing import get_args, get_type_hints

from modalkit.output.schemas.diagnosis import CauseEntry
from updating.diagnosis.answer.result import Shortcoming


def test_a_document_has_a_word_for_whatever_an_answer_may_lack() -> None:
    literal, nothing = get_args(get_type_hints(CauseEntry)["lacks"])
    assert set(get_args(literal)) == set(get_args(Shortcoming))
    assert nothing is type(None)
