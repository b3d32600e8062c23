"""The numbers of data set 58, counted and checked, in text and in binary."""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from mmap import mmap

import numpy as np

from acquisition.arrays import AnyArray, FloatArray
from acquisition.errors import InputError
from acquisition.uff.blocks import Block, header_end
from acquisition.uff.header58 import Header58, parse_header

_TOUCHING = re.compile(rb"(?<=[\d.])(?=[+-])")
_FORTRAN = re.compile(rb"[dD](?=[+\-\d ])")


@dataclass(frozen=True, eq=False)
class Function58:
    """A function as it stands in the file, in the file's own units.

    Parameters
    ----------
    header : Header58
        Its header.
    abscissa : (n,) array
        Abscissa [file's unit].
    values : (n,) array
        Ordinate, real or complex [file's unit].
    notes : tuple of str
        What was odd but could be read.
    """

    header: Header58
    abscissa: FloatArray
    values: AnyArray
    notes: tuple[str, ...] = ()


def read_function(data: bytes | mmap, block: Block) -> Function58:
    """Read one data set 58 or 58b.

    Raises
    ------
    InputError
        If the header cannot be read, values are missing or are no numbers, or the number format is unknown.
    """
    body = header_end(data, block.start)
    header = parse_header(data[block.start : min(body, block.stop)])
    notes: list[str] = []
    numbers = (
        _binary(data, block, body, header, notes) if block.binary else _text(data, block, body, header, notes)
    )
    abscissa, values = numbers
    if not header.even and len(abscissa) > 1 and np.any(np.diff(abscissa) <= 0):
        notes.append("its abscissa does not rise from point to point")
    if not block.closed:
        notes.append("its closing delimiter -1 is missing")
    return Function58(header, abscissa, values, tuple(notes))


def _binary(
    data: bytes | mmap, block: Block, body: int, header: Header58, notes: list[str]
) -> tuple[FloatArray, AnyArray]:
    order, number_format = (*(block.binary or ()), 0, 0)[:2]
    if number_format != 2 or order not in (1, 2):
        raise InputError(
            f"binary number format {number_format}, byte order {order}; only IEEE 754 (2), little (1) "
            "or big (2) endian, can be read: export it again as text"
        )
    mark = "<" if order == 1 else ">"
    columns = 2 if header.is_complex else 1
    fields = [] if header.even else [("x", f"{mark}f4")]
    layout = np.dtype([*fields, ("y", f"{mark}f{header.item_size}", (columns,))])
    _enough((block.stop - body) // layout.itemsize, header.points)
    surplus = block.stop - body - header.points * layout.itemsize
    announced = (*(block.binary or ()), 0, 0, 0, 0)[3]
    if surplus and np.frombuffer(data[block.stop - surplus : block.stop], np.uint8).any():
        if body + announced != block.stop:
            raise InputError(
                f"it announces {announced} bytes and holds {block.stop - body}: bytes are missing or lost"
            )
        notes.append(f"{surplus} bytes after its {header.points} points are left out")
    table = np.frombuffer(data, layout, count=header.points, offset=body)
    values = np.ascontiguousarray(table["y"]).astype(np.float64)
    return _abscissa(header, None if header.even else table["x"]), _ordinate(values, header)


def _text(
    data: bytes | mmap, block: Block, body: int, header: Header58, notes: list[str]
) -> tuple[FloatArray, AnyArray]:
    columns = (2 if header.is_complex else 1) + (not header.even)
    numbers = _numbers(data[body : block.stop])
    _enough(len(numbers) // columns, header.points)
    surplus = numbers[header.points * columns :]
    if surplus.any():
        notes.append(f"{len(surplus)} numbers after its {header.points} points are left out")
    table = numbers[: header.points * columns].reshape(header.points, columns)
    abscissa = _abscissa(header, None if header.even else table[:, 0])
    return abscissa, _ordinate(table if header.even else table[:, 1:], header)


def _numbers(text: bytes) -> FloatArray:
    """Return all numbers of a text, which may touch each other or carry Fortran's D."""
    text = _FORTRAN.sub(b"E", _TOUCHING.sub(b" ", text))
    if not text.strip():
        return np.zeros(0)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return np.asarray(np.fromstring(text, dtype=np.float64, sep=" "))
    except (DeprecationWarning, ValueError):
        raise InputError(f"{_first_bad(text)!r} stands among its values and is no number") from None


def _first_bad(text: bytes) -> str:
    for word in text.split():
        try:
            float(word)
        except ValueError:
            return word.decode("latin-1")[:40]
    return "something"


def _enough(found: int, announced: int) -> None:
    if found < announced:
        raise InputError(
            f"it announces {announced} points and holds {found}: the file is cut off or wrong here"
        )


def _abscissa(header: Header58, column: AnyArray | None) -> FloatArray:
    if column is not None:
        return np.asarray(column, dtype=np.float64)
    return np.asarray(header.minimum + header.increment * np.arange(header.points), dtype=np.float64)


def _ordinate(table: FloatArray, header: Header58) -> AnyArray:
    if header.is_complex:
        return np.asarray(np.ascontiguousarray(table).view(np.complex128)[:, 0])
    return np.ascontiguousarray(table[:, 0])
