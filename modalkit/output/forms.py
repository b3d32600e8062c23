"""Which parameters of an explanation are numbers that were found, and which only number the form that an effect has."""

from __future__ import annotations

from updating.diagnosis.answer.ranked import ParameterEstimate


def numbers_a_form(name: str, estimate: ParameterEstimate) -> bool:
    """Return whether a parameter selects the form of an effect, which its sentence states in words.

    That is a number without an interval, or a whole one without a unit whose interval has no width; points are none.

    Parameters
    ----------
    name : str
        Of the parameter.
    estimate : ParameterEstimate
        Its value.
    """
    value = estimate.value
    if isinstance(value, str | tuple) or "point" in name.rpartition(".")[2]:
        return False
    if estimate.low95 is None or estimate.high95 is None:
        return True
    return estimate.unit == "-" and estimate.low95 == estimate.high95 == value == round(value)
