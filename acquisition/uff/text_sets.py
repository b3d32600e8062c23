"""Data sets in text other than functions, read with pyuff and counted again."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pyuff

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import InputError
from acquisition.uff.units import Units, units_of


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


def read_units(body: bytes) -> tuple[Units, str]:
    """Return the units of a data set 164, and a remark if something was odd.

    Raises
    ------
    InputError
        If neither factors nor a known code stand there.
    """
    lines = body.decode("latin-1").splitlines()
    try:
        code = int(float(lines[0][:10] or 0))
        words = " ".join(lines[1:]).upper().replace("D", "E").split()
        factors = [float(word) for word in words[:2]]
    except (ValueError, IndexError):
        raise InputError("data set 164 cannot be read: units code or factors are no numbers") from None
    length, force = (*factors, 0.0, 0.0)[:2]
    return units_of(code, length, force)


def read_nodes(number: int, body: bytes, units: Units) -> tuple[IntArray, FloatArray]:
    """Return node numbers (n,) and coordinates (n, 3) [m] of a data set 15 or 2411.

    Raises
    ------
    InputError
        If entries are missing or are no numbers.
    """
    words = len(body.split())
    if words % 7:
        raise InputError(f"data set {number} holds {words} entries, not a multiple of seven: it is cut off")
    found = read_with_pyuff(number, body)
    nodes = np.asarray(found["node_nums"], dtype=np.float64)
    coordinates = np.stack([np.asarray(found[axis], dtype=np.float64) for axis in "xyz"], axis=-1)
    if len(nodes) != words // 7 or not np.isfinite(coordinates).all() or np.any(nodes % 1):
        raise InputError(f"data set {number}: node numbers or coordinates are no numbers")
    return nodes.astype(np.int64), coordinates / units.length
