"""Documents are filled from results as their classes declare it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Literal, TypedDict

import numpy as np
import pandas as pd
import pytest

from modalkit.output.fields import Of, fill


class Line(TypedDict):
    """A row of a table."""

    test_hz: Annotated[float | None, "frequency [Hz]", Of("test [Hz]")]
    mode: Annotated[int, "number [-]"]


class Inner(TypedDict):
    """What the result holds itself."""

    low95: Annotated[float | None, "lower end [-]", Of("low")]


class Whole(TypedDict):
    """A document."""

    schema: Annotated[Literal["modalkit.trial/1"], "kind"]
    lines: Annotated[Sequence[Line], "row by row", Of("table")]
    inner: Annotated[Inner, "of the result itself", Of("")]
    none: Annotated[Inner | None, "null"]
    reasons: Annotated[Mapping[str, str], "in words"]
    matrix: Annotated[Sequence[Sequence[float | None]], "numbers [-]"]
    extra: Annotated[Sequence[str], "given"]


class Reason:
    def __str__(self) -> str:
        return "too thick"


@dataclass(frozen=True)
class Result:
    table: pd.DataFrame
    low: float
    reasons: dict[str, Reason]
    matrix: np.ndarray
    none: None = None


RESULT = Result(
    pd.DataFrame({"test [Hz]": [1.5, np.nan], "mode": [1, 2], "beside": [0, 0]}),
    np.float64(-np.inf),
    {"shear": Reason()},
    np.array([[1.0, np.nan]]),
)


def test_a_field_is_taken_from_where_its_class_says() -> None:
    found = fill(Whole, RESULT, extra=["a"])
    assert found == {
        "schema": "modalkit.trial/1",
        "lines": [{"test_hz": 1.5, "mode": 1}, {"test_hz": None, "mode": 2}],
        "inner": {"low95": None},
        "none": None,
        "reasons": {"shear": "too thick"},
        "matrix": [[1.0, None]],
        "extra": ["a"],
    }
    assert list(found) == list(Whole.__annotations__)


def test_what_is_neither_there_nor_declared_is_an_error() -> None:
    with pytest.raises(AttributeError, match="extra"):
        fill(Whole, RESULT)
    with pytest.raises(TypeError, match="Whole has no field surplus"):
        fill(Whole, RESULT, extra=[], surplus=1)
