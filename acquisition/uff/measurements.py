"""Functions in SI units: what each data set 58 measures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.uff.header58 import Header58
from acquisition.uff.units import Quantity, Units, abscissa_factor, ratio_of, to_si
from acquisition.uff.values58 import Function58

FUNCTION_TYPES = {
    0: "general function",
    1: "time record",
    2: "auto-spectrum",
    3: "cross-spectrum",
    4: "FRF",
    5: "transmissibility",
    6: "coherence",
    7: "auto-correlation",
    8: "cross-correlation",
    9: "power spectral density",
    10: "energy spectral density",
    11: "probability density",
    12: "spectrum",
    25: "orders",
}


@dataclass(frozen=True, eq=False)
class Measurement:
    """One function in SI units.

    Parameters
    ----------
    function_type : int
        1, 4 or 6.
    quantity : str
        Form of the motion or FRF, or "force"; "other" for a coherence.
    response, reference : Dof
        Degrees of freedom.
    minimum, step : float
        First abscissa and spacing [s or Hz].
    values : (n,) array or None
        Ordinate [SI]; None where the data set is broken, so that its place in the count of hits is kept.
    decay : float
        Decay of an exponential window, as the data set states it [1/s].
    place : str
        File, data set and line, for messages.
    averages : int
        Number of averages, 0 if not stated.
    """

    function_type: int
    quantity: Quantity
    response: Dof
    reference: Dof
    minimum: float
    step: float
    values: AnyArray | None
    decay: float
    place: str
    averages: int = 0


def measure(function: Function58, units: Units, place: str) -> tuple[Measurement, list[str]]:
    """Return a function in SI units, and what had to be assumed.

    Raises
    ------
    InputError
        If its abscissa is uneven or it holds values that are not finite.
    """
    header = function.header
    quantity, factor, notes = quantity_of(header, units)
    minimum, step = _even_abscissa(function)
    values = function.values * factor
    wrong = np.flatnonzero(~np.isfinite(values))
    if len(wrong) and not (header.function_type in (4, 6) and wrong.tolist() == [0] and minimum == 0):
        raise InputError(
            f"{len(wrong)} of its {len(values)} values are not finite, the first at point {wrong[0] + 1}"
        )
    seconds = abscissa_factor(header.abscissa)
    found = Measurement(
        function_type=header.function_type,
        quantity=quantity,
        response=header.response,
        reference=header.reference,
        minimum=minimum * seconds,
        step=step * seconds,
        values=values,
        decay=header.decay,
        place=place,
        averages=header.averages,
    )
    return found, notes


def quantity_of(header: Header58, units: Units) -> tuple[Quantity, float, list[str]]:
    """Return what a function measures, its SI factor, and what had to be assumed."""
    rotation = abs(header.response.direction) > 3
    quantity, factor = to_si(header.ordinate, units, rotation=rotation)
    notes: list[str] = []
    if header.function_type == 6:
        return "other", 1.0, notes
    if header.function_type == 4:
        return _frf_quantity(header, units, quantity, factor)
    if quantity == "other" and header.function_type == 1 and header.response == header.reference:
        notes.append("its ordinate has no type; taken for the force, as response and reference are the same")
        return "force", 1.0, notes
    if quantity == "other" and header.function_type == 1 and header.ordinate.kind in (0, 1):
        notes.append("its ordinate has no type; taken for an acceleration in m/s^2")
        return "accelerance", 1.0, notes
    return quantity, factor, notes


def _frf_quantity(
    header: Header58, units: Units, quantity: Quantity, factor: float
) -> tuple[Quantity, float, list[str]]:
    rotation = abs(header.reference.direction) > 3
    below, divisor = to_si(header.denominator, units, rotation=rotation)
    if quantity in ("receptance", "mobility", "accelerance") and below == "force":
        return quantity, factor / divisor, []
    stated = ratio_of(header.ordinate.unit)
    if stated is not None:
        return stated[0], stated[1], [f"no data types; its unit {header.ordinate.unit} decides"]
    if quantity in ("receptance", "mobility", "accelerance") and header.denominator.kind == 0:
        return quantity, factor * units.force, ["its denominator has no type; taken for a force"]
    if quantity == "other" and header.ordinate.kind in (0, 1):
        return "accelerance", 1.0, ["neither data types nor units; taken for accelerance in 1/kg"]
    return "other", 1.0, []


def _even_abscissa(function: Function58) -> tuple[float, float]:
    header, abscissa = function.header, function.abscissa
    if header.even:
        return header.minimum, simplest_within(header.increment, header.resolution)
    steps = np.diff(abscissa)
    step = float((abscissa[-1] - abscissa[0]) / max(len(steps), 1))
    printed = np.spacing(np.float32(np.abs(abscissa).max()))
    if len(steps) == 0 or step <= 0 or np.ptp(steps) > 1e-4 * step + 4 * printed:
        raise InputError("its abscissa is unevenly spaced: resample it evenly")
    return float(abscissa[0]), step


def simplest_within(value: float, tolerance: float) -> float:
    """Return a spacing with the digits that a short printed field cut off.

    A rate of 4096 Hz is printed as an increment of 2.44141e-04. Within the rounding of the field,
    the value whose reciprocal is the simplest fraction is taken.
    """
    if tolerance <= 0 or tolerance >= 1e-3 * value:
        return value
    low, high = 1 / (value + tolerance * 1.0001), 1 / (value - tolerance * 1.0001)
    numerator, denominator = _simplest_fraction(low, high)
    return denominator / numerator


def _simplest_fraction(low: float, high: float) -> tuple[int, int]:
    """Return the fraction with the smallest denominator in [low, high] (Stern-Brocot descent)."""
    whole = int(np.floor(low))
    if whole == low:
        return whole, 1
    if whole + 1 <= high:
        return whole + 1, 1
    numerator, denominator = _simplest_fraction(1 / (high - whole), 1 / (low - whole))
    return whole * numerator + denominator, numerator
