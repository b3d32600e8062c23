"""Kinds of numbers in a study file: each in SI units, or a text with its unit, as ``"376 mm"``."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from acquisition.si_units import si_value


def in_unit(unit: str) -> BeforeValidator:
    """Return what lets a number of a table be written with a unit [``unit`` where it has none]."""
    return BeforeValidator(lambda value: si_value(value, unit))


def share_or(word: str) -> BeforeValidator:
    """Return what lets a share from 0 to below 1 be written as a word instead, which stays as it is."""

    def read(value: Any) -> Any:
        if value == word:
            return word
        share = si_value(value, "")
        if isinstance(share, int | float) and not 0 <= share < 1:
            raise ValueError(f"{share:g} must be at least 0 and below 1; write such a share, or {word!r}")
        return share

    return BeforeValidator(read)


Share = Annotated[float, in_unit(""), Field(ge=0, lt=1)]
Length = Annotated[float, in_unit("m")]
Size = Annotated[float, in_unit("m"), Field(gt=0)]
Hertz = Annotated[float, in_unit("Hz"), Field(gt=0)]
Rate = Annotated[float, in_unit("1/s"), Field(ge=0)]
Mass = Annotated[float, in_unit("kg"), Field(ge=0)]
Density = Annotated[float, in_unit("kg/m^3"), Field(gt=0)]
Modulus = Annotated[float, in_unit("Pa"), Field(gt=0)]
