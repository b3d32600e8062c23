"""Data sets as bytes: delimiters, headers, numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from acquisition.arrays import AnyArray, FloatArray
from acquisition.dof import Dof
from acquisition.frf import Form

Format = Literal["binary", "ascii"]
Precision = Literal["double", "single"]

FORCE = (13, "Force", "N")
MOTIONS: dict[Form, tuple[int, str, str]] = {
    "receptance": (8, "Displacement", "m"),
    "mobility": (11, "Velocity", "m/s"),
    "accelerance": (12, "Acceleration", "m/s^2"),
}
NOTHING = (0, "NONE", "NONE")
TIME = (17, "Time", "s")
FREQUENCY = (18, "Frequency", "Hz")
UNITY = (1, "Coherence", "NONE")


@dataclass(frozen=True, eq=False)
class Record58:
    """A function to be written.

    Parameters
    ----------
    title : tuple of str
        Up to five ID lines.
    function_type : int
        1 time record, 4 FRF, 6 coherence.
    response, reference : Dof
        Degrees of freedom.
    minimum, increment : float
        First abscissa and spacing [s or Hz].
    values : (n,) array
        Ordinate, real or complex [SI].
    axes : tuple of three (type, label, unit)
        Abscissa, ordinate, denominator.
    """

    title: tuple[str, ...]
    function_type: int
    response: Dof
    reference: Dof
    minimum: float
    increment: float
    values: AnyArray
    axes: tuple[tuple[int, str, str], tuple[int, str, str], tuple[int, str, str]]


def function_set(record: Record58, *, form: Format, precision: Precision) -> bytes:
    """Return a data set 58 (text) or 58b (binary) with its delimiters."""
    is_complex = np.iscomplexobj(record.values)
    plain = np.ascontiguousarray(record.values, dtype=np.complex128 if is_complex else np.float64).view(
        np.float64
    )
    numbers = plain.astype("<f4" if precision == "single" else "<f8")
    header = _header58(record, is_complex, precision)
    if form == "binary":
        identity = f"{58:6d}b{1:6d}{2:6d}{11:12d}{numbers.nbytes:12d}{0:6d}{0:6d}{0:12d}{0:12d}"
        return (
            b"    -1\n" + f"{identity}\n{header}".encode("ascii", "replace") + numbers.tobytes() + b"    -1\n"
        )
    text = _table(plain, *((6, "%13.5e") if precision == "single" else (4, "%20.12e")))
    return f"    -1\n    58\n{header}{text}    -1\n".encode("ascii", "replace")


def _header58(record: Record58, is_complex: bool, precision: Precision) -> str:
    titles = [*record.title, *["NONE"] * 5][:5]
    kind = {(False, "single"): 2, (False, "double"): 4, (True, "single"): 5, (True, "double"): 6}
    response, reference = record.response, record.reference
    lines = [f"{line[:80] or 'NONE':<80s}" for line in titles]
    lines.append(
        f"{record.function_type:5d}{0:10d}{0:5d}{0:10d} "
        f"{'NONE':10s}{response.node:10d}{response.direction:4d} "
        f"{'NONE':10s}{reference.node:10d}{reference.direction:4d}"
    )
    spacing = "".join(field13(v) for v in (record.minimum, record.increment, 0.0))
    lines.append(f"{kind[is_complex, precision]:10d}{len(record.values):10d}{1:10d}{spacing}")
    for number, label, unit in (*record.axes, NOTHING):
        lines.append(f"{number:10d}{0:5d}{0:5d}{0:5d} {label:20.20s} {unit:20.20s}")
    return "".join(line + "\n" for line in lines)


def field13(value: float) -> str:
    """Return a number in thirteen columns, a leading blank among them, with all the digits that fit."""
    texts = [f"{value:.{digits}e}" for digits in range(5, 11)]
    texts += [
        f"{float(t.partition('e')[0]):.{d}f}E{int(t.partition('e')[2])}" for d, t in enumerate(texts, 5)
    ]
    fitting = [text for text in texts if len(text) <= 12]
    return f"{min(fitting, key=lambda text: abs(float(text) - value)):>13s}"


def _table(numbers: FloatArray, columns: int, pattern: str) -> str:
    """Return numbers as lines of fixed columns."""
    whole = len(numbers) // columns * columns
    line = pattern * columns + "\n"
    text = (line * (whole // columns)) % tuple(numbers[:whole].tolist())
    rest = numbers[whole:].tolist()
    return text + ((pattern * len(rest) + "\n") % tuple(rest) if rest else "")


def header_set(title: str) -> bytes:
    """Return a data set 151."""
    blank = " " * 80
    lines = [f"{title[:80] or 'NONE':<80s}", f"{'NONE':<80s}", f"{'modalkit':<80s}", *[blank] * 3, blank]
    return _text_set(151, lines)


def units_set() -> bytes:
    """Return a data set 164 that says SI."""
    one, zero = "   1.00000000000000000D+00", "   0.00000000000000000D+00"
    return _text_set(
        164, [f"{1:10d}{'SI: Meter (newton)':20s}{2:10d}", f"{one[1:]}{one[1:]}{one[1:]}", zero[1:]]
    )


def nodes_set(nodes: tuple[int, ...], coordinates: FloatArray) -> bytes:
    """Return a data set 2411 with coordinates in double precision [m]."""
    lines = []
    for node, place in zip(nodes, coordinates.tolist(), strict=True):
        lines.append(f"{node:10d}{1:10d}{1:10d}{11:10d}")
        lines.append("".join(f"{x:25.16E}".replace("E", "D") for x in place))
    return _text_set(2411, lines)


def _text_set(number: int, lines: list[str]) -> bytes:
    body = "".join(line + "\n" for line in lines)
    return f"    -1\n{number:6d}\n{body}    -1\n".encode("ascii", "replace")
