"""Units and nodes: data sets 164, 15 and 2411, read with pyuff where it reads rightly and counted again."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pyuff

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import InputError
from acquisition.uff.functions.units import Units, units_of
from acquisition.uff.text.columns import check_columns, check_digits
from acquisition.uff.text.numbers import numbers_of
from acquisition.uff.text.record_lines import check_record_lines

_FACTORS = 4  # of length, force and temperature, and the offset of temperature
_NEEDED = 3  # the factors: the offset, which is not used, often has other digits (2.7315E+02 beside 1.0E+00)
_ON_FIRST_LINE = {15: 7, 2411: 4}
"""Numbers on the first line of a node's record."""


def read_units(body: bytes) -> tuple[Units, str]:
    """Return the units of a data set 164, and a warning if something was odd.

    Raises
    ------
    InputError
        If neither factors nor a known code stand there.
    """
    lines = body.decode("latin-1").splitlines()
    try:
        code = int(float(lines[0][:10] or 0))
        words = " ".join(lines[1:]).upper().replace("D", "E").split()
        factors = [float(word) for word in words]
    except (ValueError, IndexError, OverflowError):
        raise InputError("data set 164 cannot be read: units code or factors are not numbers") from None
    if len(factors) > _FACTORS:
        raise InputError(
            f"data set 164 holds {len(factors)} factors, at most {_FACTORS} are expected: one is broken in two"
        )
    check_digits("\n".join(words[:_NEEDED]).encode())
    length, force = (*factors, 0.0, 0.0)[:2]
    return units_of(code, length, force)


def read_with_pyuff(number: int, body: bytes) -> dict[str, Any]:
    """Return what pyuff makes of the body of one data set.

    Raises
    ------
    InputError
        If pyuff cannot read it.
    """
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "one.uff"
        text = body.decode("latin-1").encode("ascii", "replace")
        path.write_bytes(b"    -1\n%6d\n" % number + text.rstrip() + b"\n    -1\n")
        try:
            found = pyuff.UFF(str(path)).read_sets(0)
        except Exception as error:  # pyuff raises nothing more specific
            raise InputError(f"data set {number} cannot be read ({error})") from error
    return dict(found)


def read_nodes(number: int, body: bytes) -> tuple[IntArray, FloatArray]:
    """Return the nodes of a data set 15 or 2411.

    Parameters
    ----------
    number : int
        Data set number.
    body : bytes
        What stands between the delimiters.

    Returns
    -------
    labels : (n, 3) int array
        Node, system of its coordinates, system of its displacements.
    coordinates : (n, 3) array
        As in the file [file's unit].

    Raises
    ------
    InputError
        If entries are missing or are not numbers.
    """
    entries = numbers_of(body)
    if len(entries) % 7 or len(entries) == 0:
        raise InputError(
            f"data set {number} holds {len(entries)} entries, not a multiple of seven: it is cut off or garbled"
        )
    check_columns(body)
    check_digits(body)
    check_record_lines(body, columns=7, first=(_ON_FIRST_LINE[number],))
    if len(body.split()) == len(entries):
        labels, coordinates = _nodes_of_pyuff(number, body)
    else:  # columns that touch, which pyuff does not part
        table = entries.reshape(-1, 7)
        labels, coordinates = table[:, :3], table[:, 4:]
    if (
        len(labels) != len(entries) // 7
        or not np.isfinite(labels).all()
        or not np.isfinite(coordinates).all()
    ):
        raise InputError(f"data set {number}: node numbers or coordinates are not numbers")
    if np.any(labels % 1) or np.any(np.abs(labels) > 1e15) or np.any(np.abs(coordinates) > 1e15):
        raise InputError(f"data set {number}: node numbers or coordinates are implausible")
    return labels.astype(np.int64), coordinates


def _nodes_of_pyuff(number: int, body: bytes) -> tuple[FloatArray, FloatArray]:
    found = read_with_pyuff(number, body)
    names = ("node_nums", "def_cs", "disp_cs", "x", "y", "z")
    columns = [np.asarray(found[name], dtype=np.float64) for name in names]
    if len({len(column) for column in columns}) > 1:
        raise InputError(f"data set {number}: columns of different lengths")
    table = np.stack(columns, axis=-1)
    return table[:, :3], table[:, 3:]
