"""What a function measures, by its axes: quantity, factor to SI, whether per hertz."""

from __future__ import annotations

from acquisition.uff.functions.header58 import Axis, Header58
from acquisition.uff.functions.units import (
    Quantity,
    Units,
    is_density,
    product_of,
    ratio_of,
    square_of,
    to_si,
)

MOTIONS = ("receptance", "mobility", "accelerance")
Found = tuple[Quantity, float, bool | None, list[str]]


def quantity_of(header: Header58, units: Units) -> Found:
    """Return what a function measures, its SI factor, whether it is per hertz, and what had to be assumed."""
    rotation = abs(header.response.direction) > 3
    if header.function_type in (2, 9):
        return _auto(header, units, rotation)
    if header.function_type == 3:
        return _cross(header, units, rotation)
    if header.function_type == 6:
        return "other", 1.0, None, []
    quantity, factor = to_si(header.ordinate, units, rotation=rotation)
    if header.function_type == 4:
        quantity, factor, notes = _frf(header, units, quantity, factor)
        return quantity, factor, None, notes
    if quantity == "other" and header.function_type == 1:
        return _untyped(header)
    return quantity, factor, None, []


def _untyped(header: Header58) -> Found:
    """Return what a time record without a data type is taken for."""
    if header.response == header.reference:
        note = "its ordinate has no type; taken for the force, as response and reference are the same"
        return "force", 1.0, None, [note]
    if header.ordinate.kind in (0, 1):
        return "accelerance", 1.0, None, ["its ordinate has no type; taken for an acceleration in m/s^2"]
    return "other", 1.0, None, []


def _frf(
    header: Header58, units: Units, quantity: Quantity, factor: float
) -> tuple[Quantity, float, list[str]]:
    rotation = abs(header.reference.direction) > 3
    below, divisor = to_si(header.denominator, units, rotation=rotation)
    if quantity in MOTIONS and below == "force":
        return quantity, factor / divisor, []
    stated = ratio_of(header.ordinate.unit)
    if stated is not None:
        return stated[0], stated[1], [f"no data types; its unit {header.ordinate.unit} decides"]
    if quantity in MOTIONS and header.denominator.kind == 0:
        return quantity, factor * units.force, ["its denominator has no type; taken for a force"]
    if quantity == "other" and header.ordinate.kind in (0, 1):
        return "accelerance", 1.0, ["neither data types nor units; taken for accelerance in 1/kg"]
    return "other", 1.0, []


def _auto(header: Header58, units: Units, rotation: bool) -> Found:
    """Return the quantity whose square an auto-spectrum is, and the square of its factor."""
    axis = header.ordinate
    stated = square_of(axis.unit)
    plain = Axis(axis.kind, 0, 0, axis.label, axis.unit if stated is None else stated[2])
    quantity, factor = to_si(plain, units, rotation=rotation)
    density = True if header.function_type == 9 else is_density(axis.unit)
    return quantity, factor**2, density, []


def _cross(header: Header58, units: Units, rotation: bool) -> Found:
    """Return the quantity of the response of a cross-spectrum with a force, and the product of both factors."""
    label = header.ordinate.unit
    stated = product_of(label)
    if stated is not None:
        return stated[0], stated[1], is_density(label), []
    quantity, factor = to_si(header.ordinate, units, rotation=rotation)
    if quantity not in MOTIONS:
        return "other", 1.0, is_density(label), []
    turned = abs(header.reference.direction) > 3
    below, divisor = to_si(header.denominator, units, rotation=turned)
    if below == "force":
        return quantity, factor * divisor, is_density(label), []
    if header.denominator.kind == 0:
        note = "its denominator has no type; taken for a force"
        return quantity, factor / units.force, is_density(label), [note]
    return "other", 1.0, is_density(label), []
