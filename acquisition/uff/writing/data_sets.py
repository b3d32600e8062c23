"""Data sets as bytes: delimiters, headers, numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np

from acquisition.arrays import AnyArray, FloatArray, IntArray
from acquisition.dof import Dof
from acquisition.form import Form
from acquisition.geometry import Geometry

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


@dataclass(frozen=True, eq=False, kw_only=True)
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


def function_set(record: Record58, *, form: Format, precision: Precision) -> Iterator[bytes | memoryview]:
    """Yield the parts of a data set 58 (text) or 58b (binary) with its delimiters."""
    is_complex = np.iscomplexobj(record.values)
    double = np.complex128 if is_complex else np.float64
    plain = np.ascontiguousarray(record.values)
    header = _header58(record, is_complex, precision)
    if form == "binary":
        kind = {(False, "single"): "<f4", (False, "double"): "<f8", (True, "single"): "<c8"}
        numbers = plain.astype(kind.get((is_complex, precision), "<c16"), copy=False)
        identity = f"{58:6d}b{1:6d}{2:6d}{11:12d}{numbers.nbytes:12d}{0:6d}{0:6d}{0:12d}{0:12d}"
        yield b"    -1\n" + f"{identity}\n{header}".encode("ascii", "replace")
        yield numbers.data.cast("B")
        yield b"    -1\n"
        return
    flat = plain.astype(double, copy=False).view(np.float64)
    text = _table(flat, *((6, "%13.5e") if precision == "single" else (4, "%20.12e")))
    yield f"    -1\n    58\n{header}{text}    -1\n".encode("ascii", "replace")


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
    return "".join(line + "\n" for line in lines) + _axes(record.axes)


@lru_cache(maxsize=64)
def _axes(axes: tuple[tuple[int, str, str], ...]) -> str:
    """Return records 8 to 11."""
    return "".join(
        f"{number:10d}{0:5d}{0:5d}{0:5d} {label:20.20s} {unit:20.20s}\n"
        for number, label, unit in (*axes, NOTHING)
    )


@lru_cache(maxsize=256)
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
    """Return a data set 164 with SI units."""
    one, zero = "   1.00000000000000000D+00", "   0.00000000000000000D+00"
    return _text_set(
        164, [f"{1:10d}{'SI: Meter (newton)':20s}{2:10d}", f"{one[1:]}{one[1:]}{one[1:]}", zero[1:]]
    )


def nodes_sets(geometry: Geometry) -> Iterator[bytes]:
    """Yield data set 2411 in double precision [m], the lines, and the systems of nodes with axes of their own."""
    systems: dict[bytes, int] = {np.eye(3).tobytes(): 1}
    axes = np.broadcast_to(np.eye(3), (len(geometry.nodes), 3, 3)) if geometry.axes is None else geometry.axes
    lines = []
    for node, place, own in zip(geometry.nodes, geometry.coordinates.tolist(), axes, strict=True):
        system = systems.setdefault(own.tobytes(), len(systems) + 10)
        lines.append(f"{node:10d}{1:10d}{system:10d}{11:10d}")
        lines.append(_row25(place))
    if len(systems) > 1:
        yield _systems_set(systems)
    yield _text_set(2411, lines)
    yield from trace_sets(geometry.lines)


def _systems_set(systems: dict[bytes, int]) -> bytes:
    """Return a data set 2420 with Cartesian systems at the origin."""
    lines = [f"{1:10d}", f"{'modalkit':<80s}"]
    for axes, label in systems.items():
        rows = np.frombuffer(axes, dtype=np.float64).reshape(3, 3).tolist()
        lines += [f"{label:10d}{0:10d}{8:10d}", f"{'CS' + str(label):<80s}"]
        lines += [_row25(row) for row in [*rows, [0.0, 0.0, 0.0]]]
    return _text_set(2420, lines)


def _row25(values: list[float]) -> str:
    return "".join(f"{x:25.16E}".replace("E", "D") for x in values)


def trace_sets(lines: IntArray) -> Iterator[bytes]:
    """Yield the lines of a geometry as data sets 82, in pieces of at most 249 entries."""
    way: list[int] = []
    number = 0
    for first, second in [*lines.tolist(), (0, 0)]:
        step = [second] if way and way[-1] == first else [0, first, second] if way else [first, second]
        if first == 0 or len(way) + len(step) > 249:
            if way:
                number += 1
                head = [f"{number:10d}{len(way):10d}{0:10d}", f"{'NONE':<80s}"]
                rows = ["".join(f"{n:10d}" for n in way[i : i + 8]) for i in range(0, len(way), 8)]
                yield _text_set(82, [*head, *rows])
            way, step = [], [first, second]
        way += step


def _text_set(number: int, lines: list[str]) -> bytes:
    body = "".join(line + "\n" for line in lines)
    return f"    -1\n{number:6d}\n{body}    -1\n".encode("ascii", "replace")
