"""The numbers of data set 58, counted and checked, in text and in binary."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from mmap import mmap
from typing import IO

import numpy as np

from acquisition.arrays import AnyArray, FloatArray
from acquisition.errors import InputError
from acquisition.uff.functions.header58 import Header58, parse_header
from acquisition.uff.functions.stored import Stored
from acquisition.uff.text.blocks import HEADER_LINES, Block, header_end
from acquisition.uff.text.columns import LineForms, form_of
from acquisition.uff.text.numbers import numbers_of
from acquisition.uff.text.source import Source

_CHUNK = 1 << 22
_PER_LINE = {4: 6, 8: 4}  # real numbers on a line of single and of double precision, as the format has it


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
        Ordinate, real or complex, in the file's precision [file's unit].
    notes : tuple of str
        What was odd but could be read.
    """

    header: Header58
    abscissa: FloatArray
    values: AnyArray
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Located:
    """A function whose numbers have been counted but not yet read into memory."""

    header: Header58
    stored: Stored
    notes: tuple[str, ...]
    raw_header: bytes

    def abscissa(self) -> FloatArray:
        """Return the abscissa [file's unit]."""
        if not self.header.even:
            with np.errstate(invalid="ignore"):  # nan is searched for later
                return np.asarray(self.stored.read("x"), dtype=np.float64)
        steps = np.arange(self.header.points, dtype=np.float64)
        return np.asarray(self.header.minimum + self.header.increment * steps)


def locate(source: Source, block: Block, spool: IO[bytes]) -> Located:
    """Find the numbers of one data set 58 or 58b and count them; those in text go to a temporary file.

    Raises
    ------
    InputError
        If the header cannot be read, values are missing or are not numbers, or the number format is unknown.
    """
    data = source.data
    body = header_end(data, block.start)
    raw = data[block.start : min(body, block.stop)]
    header = parse_header(raw)
    notes: list[str] = []
    if block.binary is None:
        stored = _text(data, (body, block.stop), block.line + 2 + HEADER_LINES, header, spool, notes)
    else:
        stored = _binary(source, block, body, header, notes)
    if not block.closed:
        notes.append("its closing delimiter -1 is missing")
    return Located(header, stored, tuple(notes), raw)


def read_function(source: Source, block: Block, spool: IO[bytes]) -> Function58:
    """Read one data set 58 or 58b; raises as `locate` does."""
    located = locate(source, block, spool)
    return Function58(located.header, located.abscissa(), located.stored.read(), located.notes)


def _binary(source: Source, block: Block, body: int, header: Header58, notes: list[str]) -> Stored:
    order, number_format = (*(block.binary or ()), 0, 0)[:2]
    if number_format != 2 or order not in (1, 2):
        raise InputError(
            f"binary number format {number_format}, byte order {order}; only IEEE 754 (2), little (1) "
            "or big (2) endian, can be read: export it again as text"
        )
    layout = _layout(header, "<" if order == 1 else ">", "f4", f"f{header.item_size}")
    announced = (*(block.binary or ()), 0, 0, 0, 0)[3]
    needed = header.points * layout.itemsize
    _accounted(source.data, (body, block.stop), announced, needed, notes, little=order == 1)
    _enough((block.stop - body) // layout.itemsize, header.points)
    return Stored(source.file, body, layout, header.points)


def _accounted(
    data: mmap, place: tuple[int, int], announced: int, needed: int, notes: list[str], *, little: bool
) -> None:
    """Compare the bytes between header and delimiter with those announced and those the points need."""
    body, stop = place
    held = stop - body
    if held > needed and announced != held and data[body + needed : stop] in (b"\n", b"\r\n"):
        held = needed  # the delimiter has a line of its own
    if held > needed and announced != held:
        raise InputError(
            f"it announces {announced} bytes, its points need {needed}, but {held} are there: "
            "bytes are missing or lost"
        )
    if held > needed:
        notes.append(f"{held - needed} bytes after its points are left out")
    elif held == needed and announced not in (0, held):
        notes.append(f"it announces {announced} bytes and holds the {held} that its points need")
    if held == stop - body and data[stop - 1 : stop + 1] in (b"\n ", b"\r\n"):
        note = "its last byte is a line end: a byte before it is missing"
        if little:  # the exponent's byte, of numbers under 1e-30
            raise InputError(note)
        notes.append(note.replace("is missing", "may be missing"))


def _layout(header: Header58, mark: str, x: str, y: str) -> np.dtype[np.void]:
    values = ("y", mark + y, (2 if header.is_complex else 1,))
    return np.dtype([values] if header.even else [("x", mark + x), values])


def _text(
    data: mmap, place: tuple[int, int], line: int, header: Header58, spool: IO[bytes], notes: list[str]
) -> Stored:
    """Put the numbers of a text into the temporary file, as doubles.

    ``line`` is that of its first number.
    """
    layout = _layout(header, "=", "f8", "f8")
    wanted = header.points * layout.itemsize // 8
    offset, found, lost, forms, strays = spool.seek(0, 2), 0, False, LineForms(), 0
    for text in _pieces(data, *place):
        strays += _strays(text)
        numbers = numbers_of(text)
        forms.add(text)
        keep = numbers[: max(wanted - found, 0)]
        spool.write(keep.tobytes())
        lost = lost or bool(numbers[len(keep) :].any())
        found += len(numbers)
    if found < wanted:
        spool.truncate(offset)
    _enough(found * 8 // layout.itemsize, header.points)
    _in_columns(data, place, line, forms)
    surplus = found - wanted
    if strays:
        notes.append(
            f"{strays} tabs or line ends of another kind among its numbers: a sign may be lost there"
        )
    uneven = forms.uneven(_PER_LINE[header.item_size])
    if uneven and not surplus:
        notes.append("its lines hold unequal counts of numbers: a line may be broken in two where a sign was")
    if surplus and uneven:
        raise InputError(
            f"{surplus} numbers more than its {header.points} points need, on lines of unequal length: "
            "one is broken in two or one too many"
        )
    if lost or surplus >= forms.on_last:  # zeros that fill the last line are not numbers
        notes.append(f"{surplus} numbers after its {header.points} points are left out")
    return Stored(spool, offset, layout, header.points)


def _strays(text: bytes) -> int:
    """Count carriage returns within lines, and tabs where most lines have none."""
    returns, tabs = text.count(b"\r") - text.count(b"\r\n"), text.count(b"\t")
    return returns + (tabs if tabs < text.count(b"\n") else 0)


def _in_columns(data: mmap, place: tuple[int, int], line: int, forms: LineForms) -> None:
    broken = forms.broken()
    if broken is None:
        return
    for text in _pieces(data, *place):
        for row in text.split(b"\n"):
            if form_of(row) == broken:
                quoted = row.strip()[:80].decode("latin-1")
                raise InputError(
                    f"line {line} ({quoted!r}) does not keep to the columns of the others: "
                    "a character is lost or damaged"
                )
            line += 1
        line -= text.endswith(b"\n")


def _pieces(data: mmap, start: int, stop: int) -> Iterator[bytes]:
    """Yield a text some whole lines at a time."""
    while start < stop:
        end = stop
        if stop - start > _CHUNK:
            newline = data.rfind(b"\n", start, start + _CHUNK)
            end = newline + 1 if newline >= 0 else min(start + 64 * _CHUNK, stop)
        yield data[start:end]
        start = end


def _enough(found: int, announced: int) -> None:
    if found < announced:
        raise InputError(
            f"it announces {announced} points and holds {found}: the file is cut off or wrong here"
        )
