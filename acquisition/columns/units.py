"""Units of the numbers in column text, to SI."""

from __future__ import annotations

import re

from acquisition.errors import InputError
from acquisition.form import Form
from acquisition.units import FORCES, GRAVITY, LENGTHS

QUANTITIES: dict[str, Form | None] = {
    "force": None,
    "acceleration": "accelerance",
    "velocity": "mobility",
    "displacement": "receptance",
    "accelerance": "accelerance",
    "mobility": "mobility",
    "receptance": "receptance",
}
_GRAVITIES = {"g": GRAVITY, "mg": 1e-3 * GRAVITY}
_NEWTONS = {"newton": 1.0, "newtons": 1.0}
_TABLES = {
    "force": {name.lower(): factor for name, factor in FORCES.items()} | _NEWTONS,
    "acceleration": {f"{name}/s2": factor for name, factor in LENGTHS.items()} | _GRAVITIES,
    "velocity": {f"{name}/s": factor for name, factor in LENGTHS.items()},
    "displacement": LENGTHS,
}
RESPONSES = {"accelerance": "acceleration", "mobility": "velocity", "receptance": "displacement"}


def factor_to_si(unit: str, quantity: str, where: str) -> float:
    """Return what numbers in a unit are multiplied by to be in SI units [-].

    Parameters
    ----------
    unit : str
        "N", "g", "m/s^2", "mm/s", ...; of an FRF "m/s2/N", "g/lbf", "1/kg"; "" for SI.
    quantity : str
        What is measured, see `Column`.
    where : str
        File and column, for messages.

    Raises
    ------
    InputError
        If the unit is not one of the quantity.
    """
    text = (
        re.sub(r"[\s()\[\]]|\^|\*\*", "", unit).lower().replace("²", "2").replace("µ", "u").replace("μ", "u")
    )
    text = text.replace("/s/s", "/s2").replace("m/sec", "m/s")
    if text in ("", "1/kg") and (not text or quantity == "accelerance"):
        return 1.0
    if quantity in RESPONSES:
        response, _, force = text.rpartition("/")
        return factor_to_si(response, RESPONSES[quantity], where) / factor_to_si(force, "force", where)
    table = _TABLES[quantity]
    if text not in table:
        raise InputError(
            f"{where}: {unit!r} is not a known unit of {quantity}; use one of {', '.join(table)}"
            + (", and scale = ... for the value of one volt in it" if text.endswith("v") else "")
        )
    return table[text]
