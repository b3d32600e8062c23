"""From the units of a file to SI: data set 164, data type codes, and labels where codes are missing."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal

from acquisition.errors import InputError
from acquisition.uff.functions.header58 import Axis
from acquisition.units import FOOT, FORCES, GRAVITY, INCH, LENGTHS, POUND, POUNDAL

Quantity = Literal["receptance", "mobility", "accelerance", "force", "pressure", "other"]

# data types of records 8 to 11 -> what is measured, exponent of length and of force (I-DEAS, data set 58)
_KINDS: dict[int, tuple[Quantity, int, int]] = {
    8: ("receptance", 1, 0),
    9: ("force", 0, 1),
    11: ("mobility", 1, 0),
    12: ("accelerance", 1, 0),
    13: ("force", 0, 1),
    15: ("pressure", -2, 1),
}
# units code of data set 164 -> factors of length and force (divide by them to reach SI)
_SYSTEMS: dict[int, tuple[float, float]] = {
    1: (1.0, 1.0),
    2: (1 / FOOT, 1 / POUND),
    3: (1.0, 1 / GRAVITY),
    4: (1 / FOOT, 1 / POUNDAL),
    5: (1e3, 1e3),
    6: (1e2, 1e2),
    7: (1 / INCH, 1 / POUND),
    8: (1e3, 1 / GRAVITY),
}
_LENGTHS = LENGTHS | {"inch": INCH}
_TIMES = {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6}
_FREQUENCIES = {"hz": 1.0, "khz": 1e3, "rad/s": 0.15915494309189535}


@dataclass(frozen=True)
class Units:
    """Factors of a file's unit system; numbers divided by them are SI.

    Parameters
    ----------
    length, force : float
        Units of length in a metre and units of force in a newton [-].
    known : bool
        Whether the file states them.
    """

    length: float = 1.0
    force: float = 1.0
    known: bool = False


def units_of(code: int, length: float, force: float) -> tuple[Units, str]:
    """Return the units that a data set 164 states, and a warning if it contradicts itself.

    Raises
    ------
    InputError
        If factors are missing or not positive and the code does not help.
    """
    if length > 0 and force > 0:
        if not (1e-9 < length < 1e9 and 1e-9 < force < 1e9):
            raise InputError(f"factors of length {length:g} and force {force:g} belong to no unit system")
        named = _SYSTEMS.get(code)
        agrees = named is None or (abs(length / named[0] - 1) < 1e-2 and abs(force / named[1] - 1) < 1e-2)
        note = (
            ""
            if agrees
            else f"units code {code} and the factors {length:g}, {force:g} differ; the factors are used"
        )
        return Units(length, force, True), note
    if code in _SYSTEMS:
        return Units(*_SYSTEMS[code], known=True), f"no factors, those of units code {code} are used"
    raise InputError(
        f"units code {code} with factors of length {length:g} and force {force:g} defines no unit system"
    )


def to_si(axis: Axis, units: Units, *, rotation: bool = False) -> tuple[Quantity, float]:
    """Return what an axis carries and the factor that makes its numbers SI.

    Parameters
    ----------
    axis : Axis
        Ordinate or its denominator.
    units : Units
        The file's units.
    rotation : bool
        Whether the degree of freedom is a rotation, so that angles and moments stand there.
    """
    stated = unit_of(axis.unit)
    quantity, length, force = _KINDS.get(axis.kind, ("other", axis.length, axis.force))
    if quantity == "other" and stated is not None:
        quantity, factor = stated
        return quantity, factor
    if quantity == "other" and "force" in axis.label.lower():
        quantity, length, force = _KINDS[13]
    if rotation and quantity != "other":
        length, force = (1, 1) if quantity == "force" else (0, 0)
    if max(abs(length), abs(force)) > 20:
        return "other", 1.0
    agrees = stated is not None and stated[0] == quantity
    if (
        stated is not None
        and agrees
        and ((stated[1] == GRAVITY and quantity == "accelerance") or not units.known)
    ):
        return quantity, stated[1]
    return quantity, units.length**-length * units.force**-force


def unit_of(label: str) -> tuple[Quantity, float] | None:
    """Return the quantity and the SI factor of a unit such as ``m/s^2``, ``g``, ``lbf``; None if unknown."""
    text = _bare(label)
    if text in FORCES:
        return "force", FORCES[text]
    text = text.lower()
    if text in ("g", "gn", "g's", "gs"):
        return "accelerance", GRAVITY
    match = re.fullmatch(r"([a-z]+)(?:/(?:s|sec)(2|/s|/sec)?)?", text)
    if match is None or match[1] not in _LENGTHS:
        return None
    if "/" not in text:
        return "receptance", _LENGTHS[match[1]]
    return "accelerance" if match[2] else "mobility", _LENGTHS[match[1]]


def ratio_of(label: str) -> tuple[Quantity, float] | None:
    """Return the FRF form and the SI factor of a unit such as ``(m/s)/N`` or ``(1/N)*(m/s2)``."""
    text = _bare(label)
    turned = re.fullmatch(r"1/([A-Za-z]+)[*.](.+)", text)
    top, _, bottom = text.rpartition("/") if turned is None else (turned[2], "", turned[1])
    force, motion = unit_of(bottom), unit_of(top)
    if force is None or force[0] != "force" or motion is None or motion[0] == "force":
        return None
    return motion[0], motion[1] / force[1]


def square_of(label: str) -> tuple[Quantity, float, str] | None:
    """Return the quantity, the SI factor and the unit itself of a square such as ``N^2/Hz``, ``(m/s^2)^2``, ``g2``."""
    text = re.sub(r"(?:rms|pk)$", "", _without_hertz(label))
    powers = re.fullmatch(r"([A-Za-z]+)2(?:/s(2|4))?", text)
    root = f"{powers[1]}{'/s2' if powers[2] == '4' else '/s' if powers[2] else ''}" if powers else ""
    for unit in (root, text.removesuffix("2") if text.endswith("22") else "", text):
        found = unit_of(unit) if unit else None
        if found is not None:
            return *found, unit
    return None


def product_of(label: str) -> tuple[Quantity, float] | None:
    """Return the motion and the SI factor of a product with a force such as ``(m/s^2)*N`` or ``g N/Hz``."""
    text = re.sub(r"\*\*", "^", label)
    parts = [
        unit_of(part) for part in re.split(r"[*.·]|(?<=[\w)])\s+(?=[\w(])", _cut_hertz(text)) if part.strip()
    ]
    if len(parts) != 2 or parts[0] is None or parts[1] is None:
        return None
    motion, force = parts if parts[1][0] == "force" else parts[::-1]
    if motion is None or force is None or force[0] != "force" or motion[0] == "force":
        return None
    return motion[0], motion[1] * force[1]


def is_density(label: str) -> bool | None:
    """Return whether a spectrum is per hertz; None if its label does not state it."""
    return None if not _bare(label) else _without_hertz(label) != _bare(label)


def _without_hertz(label: str) -> str:
    return _bare(_cut_hertz(label))


def _cut_hertz(label: str) -> str:
    return re.sub(r"/\s*\(?\s*hz\s*\)?\s*$", "", label.strip(), flags=re.IGNORECASE)


def abscissa_factor(axis: Axis) -> float:
    """Return the factor that turns an abscissa into seconds or hertz."""
    text = _bare(axis.unit).lower()
    return _TIMES.get(text, _FREQUENCIES.get(text, 1.0))


def _bare(label: str) -> str:
    text = label.replace("²", "2").replace("µ", "u").replace("μ", "u")
    return re.sub(r"[\s()\[\]{}^]|\*\*", "", text)
