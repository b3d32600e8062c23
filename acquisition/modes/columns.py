"""The columns of a table of modes: their headings, the units in these, and the numbers below."""

from __future__ import annotations

import difflib
import re
from pathlib import Path

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray
from acquisition.dof import Dof
from acquisition.errors import InputError

_SHAPE = re.compile(r"(\d{1,18})([+-])(R?[XYZ])(?: (imag|sigma))?$", re.IGNORECASE)
_AXES = ("X", "Y", "Z", "RX", "RY", "RZ")
PERCENT = 0.01
_NUMBER = re.compile(r"[+-]?(?:\d++\.?\d*+|\.\d++)(?:[eE][+-]?\d++)?")

_UNIT = re.compile(r"\s*[A-Za-z%°][A-Za-z0-9/^%° -]{0,20}")

HEADINGS: dict[str, dict[str, float]] = {
    "frequency": dict.fromkeys(("frequency", "frequency_hz", "frequency [hz]", "f"), 1.0),
    "sigma": dict.fromkeys(("sigma", "frequency_sigma", "frequency_sigma_hz", "sigma [hz]"), 1.0),
    "damping": {
        **dict.fromkeys(("damping", "damping_ratio", "zeta", "damping [-]"), 1.0),
        **dict.fromkeys(("damping_percent", "damping [%]", "zeta_percent", "zeta [%]"), PERCENT),
    },
    "damping_sigma": {
        **dict.fromkeys(("damping_sigma", "damping_sigma [-]"), 1.0),
        **dict.fromkeys(("damping_sigma_percent", "damping_sigma [%]", "sigma [%]"), PERCENT),
    },
    "scaled": {"scaled": 1.0},
}
"""Headings of each column, and what their numbers are multiplied by."""

PASSED = ("mode", "no", "nr", "number", "name", "note", "comment", "description", "remark", "mpc", "mpc [-]")
"""Headings of what modes may have besides, which is not read."""

ASIDE = "note "
"""What a heading begins with whose column is passed over on purpose."""

KNOWN = "frequency, sigma, damping, damping_sigma, damping_percent, damping_sigma_percent, scaled"
"""Headings to choose from, for messages."""

_RESEMBLES = 0.6
"""So much like a known heading is one that may have been misspelt: two letters in five [-]."""


def check_headings(table: pd.DataFrame, path: Path) -> None:
    """Refuse a heading that means nothing here: what its column holds would be lost without a word.

    Raises
    ------
    InputError
        If there is such.
    """
    known = [heading for headings in HEADINGS.values() for heading in headings]
    for name in map(str, table.columns):
        first, _, copy = name.rpartition(".")
        if copy.isdigit() and first in table.columns:  # as pandas names a heading that was there before
            raise InputError(f"{path}: column {first[:40]!r} is given twice; leave one out")
        if plain(name) in (*known, *PASSED) or part_of(name) is not None or plain(name).startswith(ASIDE):
            continue
        begins = name.strip().lower().startswith(("damping", "zeta"))
        close = difflib.get_close_matches(plain(name)[:40], known, n=1, cutoff=0.0 if begins else _RESEMBLES)
        meant = f"; is {close[0]!r} meant?" if close else "."
        raise InputError(
            f"{path}: column {name[:40]!r} is unknown{meant} Correct the heading; to skip the column, write "
            f"{ASIDE + name[:40]!r} or delete it. Known: {KNOWN}; degrees of freedom, as 3+Z, 3+Z imag, "
            f"3+Z sigma; ignored: {', '.join(PASSED[:-1])}"
        )


def plain(heading: object) -> str:
    """Return a heading in small letters, units in square brackets."""
    return re.sub(r" ?[\[(] ?", " [", " ".join(str(heading).lower().split())).replace(")", "]")


def column(table: pd.DataFrame, name: str, path: Path) -> FloatArray | None:
    """Return a quantity of every mode, None where the table does not have it [Hz, or - for ratios].

    Raises
    ------
    InputError
        If two columns give it, or an entry is not a number.
    """
    found = [column for column in table.columns if plain(column) in HEADINGS[name]]
    if len(found) > 1:
        raise InputError(f"{path}: {' and '.join(map(repr, found))} both give the {name}; leave one out")
    if not found:
        return None
    column = found[0]
    return numbers(table[column], str(column), path, HEADINGS[name][plain(column)])


def numbers(column: pd.Series[str], name: str, path: Path, scale: float = 1.0) -> FloatArray:
    """Return a column as numbers times a scale; what is written with a sign of per cent is in per cent.

    Raises
    ------
    InputError
        If an entry is not a number.
    """
    ratios = plain(name) in {**HEADINGS["damping"], **HEADINGS["damping_sigma"]}
    entries = [entry.strip() if isinstance(entry, str) else "" for entry in column.tolist()]
    share = [ratios and entry.endswith("%") for entry in entries]
    words = [e.rstrip("% ") if percent else e for e, percent in zip(entries, share, strict=True)]
    words = ["nan" if word.lower() in ("nan", "") else word for word in words]
    for entry, word in zip(entries, words, strict=True):
        if word != "nan" and _NUMBER.fullmatch(word) is None:
            raise InputError(f"{path}: {entry[:40]!r} in column {name!r} {_fault(entry)}")
    numbers = np.array([float(word) for word in words], dtype=np.float64)
    if np.isinf(numbers).any():
        raise InputError(f"{path}: a number in column {name!r} is too large; correct it")
    return numbers * np.where(share, PERCENT, scale)


def _fault(entry: str) -> str:
    """Return what is wrong with an entry that is not a number, and what to do."""
    number = _NUMBER.match(entry)
    if number is not None and _UNIT.fullmatch(entry, number.end()):
        unit = entry[number.end() :].strip()
        return (
            f"is not a number but has a unit, {unit}; write {number[0]} alone, in the unit of the heading, "
            "as in 'frequency [Hz]'"
        )
    return "is not a number (use decimal points)"


def dof(name: str) -> Dof | None:
    """Return the degree of freedom that heads a shape column, as ``3+Z``, or None."""
    found = _SHAPE.match(str(name))
    if found is None or found[4]:
        return None
    direction = _AXES.index(found[3].upper()) + 1
    return Dof(int(found[1]), -direction if found[2] == "-" else direction)


def part_of(name: str) -> str | None:
    """Return which part of a shape a column holds: "", "imag" or "sigma"; None if it is no shape's."""
    found = _SHAPE.match(str(name))
    return None if found is None else (found[4] or "").lower()


def components(table: pd.DataFrame, dofs: list[str], part: str, path: Path) -> FloatArray | None:
    """Return one part of all shapes, shape (n_dofs, n_modes); None if no degree of freedom has it.

    Raises
    ------
    InputError
        If some have it and others have not, or it belongs to none.
    """
    names = [name for name in table.columns if part_of(name) == part]
    wanted = [f"{dof} {part}".strip() for dof in dofs]
    if names and sorted(names) != sorted(wanted):
        odd = sorted(set(names).symmetric_difference(wanted))[0]
        raise InputError(
            f"{path}: column {odd!r} is missing or belongs to no shape; give such a column for every shape or for none"
        )
    return np.array([numbers(table[name], name, path) for name in wanted]) if names else None
