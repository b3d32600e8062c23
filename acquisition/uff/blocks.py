"""Where the data sets of a universal file begin and end."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from mmap import mmap

from acquisition.uff.source import Source

_DELIMITER = re.compile(rb"^[ \t]{0,6}-1[ \t]*\r?$", re.MULTILINE)
_IDENTITY = re.compile(rb"[ \t]{0,6}(\d{1,6})(b?)([ \t\d]*)\r?\n")
_CLOSING = re.compile(rb"[ \t\r\n]*-1[ \t\x00\x1a]*(?:\r?\n|\Z)")
_HERE = re.compile(rb"[ \t]*-1[ \t]*\r?(?=\n)")
_BINARY_END = re.compile(
    rb"    -1[ \t]*(?:\r?\n[ \t]*-1|[ \t\r\n\x00\x1a]*\Z|(\r?\n[ \t]{0,5}\d{1,5}b?[ \t\d]*\r?\n))"
)
_GLUED = re.compile(  # the next data set begins in the middle of a line that was cut off
    rb"    -1[ \t]*\r?\n[ \t]{0,4}(?:15|55|58|82|151|164|2411|2412|2414)b?[ \t\d]*\r?\n"
)
HEADER_LINES = 11


@dataclass(frozen=True)
class Block:
    """One data set: its number and where its body lies in the file.

    Parameters
    ----------
    number : int
        Data set number.
    binary : tuple of int or None
        The fields after ``58b`` (byte order, number format, header lines, bytes, ...), None for text.
    line : int
        Line of the opening delimiter, from 1.
    start, stop : int
        Where the body lies, without delimiters and the line with the number [byte].
    closed : bool
        Whether a closing delimiter was found where it belongs.
    """

    number: int
    binary: tuple[int, ...] | None
    line: int
    start: int
    stop: int
    closed: bool


def split_blocks(source: Source) -> Iterator[Block]:
    """Find the data sets of a file one after the other; rubbish between them is skipped.

    A data set that lacks its closing delimiter ends where the next one begins.
    """
    data = source.data
    opening = _DELIMITER.search(data)
    line, counted = 1, 0
    while opening is not None:
        identity = _IDENTITY.match(data, opening.end() + 1)
        if identity is None:
            opening = _DELIMITER.search(data, opening.end())
            continue
        line += source.newlines(counted, opening.start())
        counted = opening.start()
        fields = tuple(int(v) for v in identity[3].split()) if identity[2] else None
        stop, closed = _end_of_body(data, identity.end(), fields, int(identity[1]))
        yield Block(int(identity[1]), fields, line, identity.end(), stop, closed)
        opening = _next_opening(data, stop, closed)


def header_end(data: mmap, start: int) -> int:
    """Return where the numbers of a data set 58 begin: after its eleven header lines."""
    for _ in range(HEADER_LINES):
        newline = data.find(b"\n", start)
        if newline < 0:
            return len(data)
        start = newline + 1
    return start


def _end_of_body(data: mmap, start: int, fields: tuple[int, ...] | None, number: int) -> tuple[int, bool]:
    """Return where the body ends, and whether it is closed by a delimiter of its own."""
    if fields is None:
        found = _DELIMITER.search(data, start)
        limit = len(data) if found is None else found.start()
        glued = _GLUED.search(data, start, limit) if number == 58 else None
        if glued is not None:
            return glued.start(), False
        if found is None:
            return len(data), False
        return found.start(), _IDENTITY.match(data, found.end() + 1) is None
    payload = header_end(data, start)
    if len(fields) >= 4 and _CLOSING.match(data, payload + fields[3]):
        return payload + fields[3], True
    # the announced number of bytes is wrong: the next delimiter in the bytes decides
    end = _BINARY_END.search(data, payload)
    return (len(data), False) if end is None else (end.start(), end[1] is None)


def _next_opening(data: mmap, stop: int, closed: bool) -> re.Match[bytes] | None:
    if not closed:
        return _HERE.match(data, stop) or _DELIMITER.search(data, stop)
    closing = _CLOSING.match(data, stop)
    return _DELIMITER.search(data, stop if closing is None else closing.end())
