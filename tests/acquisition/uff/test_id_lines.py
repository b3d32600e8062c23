"""What ID lines say, and nearly say, of windows and averages."""

from __future__ import annotations

import numpy as np
import pytest

from acquisition import InputError, layout_from
from acquisition.uff.functions.id_lines import averages_of, decay_of
from acquisition.uff.writing import write


@pytest.mark.parametrize(
    "text",
    [
        "exponental window decay 8",
        "Beam, Exponential windw decay: 8 1/s",
        "exponential window dcay = 8",
        "FRF 2+Z exponential widow decay =8",
    ],
)
def test_a_misspelt_window_is_named_with_what_is_read(text: str) -> None:
    decay, message = decay_of([text])
    assert decay == 0.0
    assert "not taken" in message and "'exponential window decay 8'" in message


def test_misspelt_averages_are_named_with_what_is_read() -> None:
    assert averages_of(["averges 5"]) == (
        0,
        "its ID lines state 'averges': not taken; what is read is 'averages 5'",
    )
    assert averages_of(["averages 5"]) == (5, "")
    for lost in ("averages", " Averages : "):
        assert averages_of(["beam", lost, "NONE"]) == (0, "its ID lines mention averages without a number")


@pytest.mark.parametrize(
    "text",
    [
        "",
        "beam 5",
        "range 5",
        "average beam",
        "linear averages",
        "measured 2024 window 5",
        "coverage map 12",
        "exponential 8",
    ],
)
def test_other_words_are_left_alone(text: str) -> None:
    assert decay_of([text])[1] == averages_of([text])[1] == ""


def test_what_was_right_stays_right() -> None:
    assert decay_of(["Exponential window decay 8 1/s"]) == (8.0, "")
    assert decay_of(["exponential window decay -8"])[0] == 8.0


@pytest.mark.parametrize("decay", [-8.0, float("nan"), 1e300])
def test_a_layout_has_no_window_that_grows(decay: float) -> None:
    column = {"name": "F", "quantity": "force", "node": 1}
    with pytest.raises(InputError, match="decay = "):
        layout_from({"rate": 1000.0, "decay": decay, "column": [column]})


def test_a_window_that_is_written_is_read_again() -> None:
    assert decay_of([write._window(np.float64(3.25))]) == (3.25, "")
