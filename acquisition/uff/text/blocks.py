"""Where the data sets of a universal file begin and end."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from mmap import mmap

from acquisition.uff.text.source import Source

_DELIMITER = re.compile(rb"^[ \t]{0,6}-1[ \t]*+\r?$", re.MULTILINE)
_IDENTITY = re.compile(rb"[ \t]{0,6}(\d{1,6})(?:[ \t]*+|b([ \t\d]*+))\r?\n")
_TEXT = re.compile(rb"[^\s\x00\x1a]")
# behind binary numbers: the delimiter right there in its six columns, or on a line of its own
_CLOSING = re.compile(rb"(?:    |\r?\n[ \t]{0,6})-1[ \t\x00\x1a]*+(?:\r?\n|\Z)")
_AFTER = re.compile(rb"[ \t\r\n]*+-1[ \t\x00\x1a]*+(?:\r?\n|\Z)")
_HERE = re.compile(rb"[ \t]*+-1[ \t]*+\r?(?=\n)")
_BINARY_END = re.compile(
    rb"    -1(?:[\s\x00\x1a]*+(?:-1|\Z)|[ \t]*+(\r?\n[ \t]{0,5}\d{1,5}(?:[ \t]*+|b[ \t\d]*+)\r?\n))"
)
_GLUED = re.compile(  # the next data set begins in the middle of a line that was cut off
    rb"    -1[ \t]*+\r?\n[ \t]{0,4}(?:15|55|58|82|151|164|2411|2412|2414)(?:[ \t]*+|b[ \t\d]*+)\r?\n"
)
HEADER_LINES = 11
_DIGITS = 18  # of a whole number that still fits into a file's length


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
    fault : str
        Why it is none that can be read: its number line or a delimiter is garbled; empty if it can.
    """

    number: int
    binary: tuple[int, ...] | None
    line: int
    start: int
    stop: int
    closed: bool
    fault: str = ""


def split_blocks(source: Source) -> Iterator[Block]:
    """Find the data sets of a file one after the other.

    A data set that lacks its closing delimiter ends where the next one begins. What stands between data sets
    and is not blank, and a data set without a number, come as blocks with a fault: none is passed over.
    """
    data = source.data
    counter = _Lines(source)
    place, opening = 0, _DELIMITER.search(data)
    while True:
        until = len(data) if opening is None else opening.start()
        stray = _TEXT.search(data, place, until)
        if stray is not None:
            yield _fault(data, counter.at(stray.start()), stray.start(), until, _STRAY)
        if opening is None:
            return
        identity = _identity(data, opening)
        if identity is None and stray is not None:  # the delimiter that closes what has lost its opening
            place, opening = opening.end(), _DELIMITER.search(data, opening.end())
        elif identity is None:
            block, place, opening = _unnumbered(data, opening, counter.at(opening.start()))
            yield block
        else:
            fields = None if identity[2] is None else _whole_numbers(identity[2])
            stop, closed = _end_of_body(data, identity.end(), fields, int(identity[1]))
            yield Block(int(identity[1]), fields, counter.at(opening.start()), identity.end(), stop, closed)
            place, opening = _next_opening(data, stop, closed)


_STRAY = "stands outside any data set: a delimiter -1 is missing or garbled"


class _Lines:
    """Counts lines on the way through a file."""

    def __init__(self, source: Source) -> None:
        self._source, self._line, self._counted = source, 1, 0

    def at(self, place: int) -> int:
        """Return the line of a place that is no earlier than the last one, from 1."""
        self._line += self._source.newlines(self._counted, place)
        self._counted = place
        return self._line


def _identity(data: mmap, delimiter: re.Match[bytes]) -> re.Match[bytes] | None:
    return _IDENTITY.match(data, delimiter.end() + 1)


def _whole_numbers(text: bytes) -> tuple[int, ...]:
    """Return the fields of the line ``58b``; digits beyond what a file can hold are cut off."""
    return tuple(int(word[:_DIGITS]) for word in text.split()[:8])


def _fault(data: mmap, line: int, start: int, stop: int, what: str) -> Block:
    quoted = data[start : min(start + 200, stop)].partition(b"\n")[0].strip()[:24].decode("latin-1")
    return Block(0, None, line, start, stop, False, f"{quoted!r} {what}")


def _unnumbered(data: mmap, opening: re.Match[bytes], line: int) -> tuple[Block, int, re.Match[bytes] | None]:
    """Return what stands behind a delimiter and has no number, where it is over, and the next delimiter."""
    end = _DELIMITER.search(data, opening.end())
    stop = len(data) if end is None else end.start()
    first = _TEXT.search(data, opening.end(), stop)
    if first is None:
        reason = "the file is cut off here" if end is None else "it is empty or one too many"
        block = Block(0, None, line, stop, stop, False, f"no data set follows its delimiter -1: {reason}")
    else:
        block = _fault(data, line, first.start(), stop, "stands where the number of a data set is expected")
        block = replace(block, start=data.find(b"\n", first.start(), stop) + 1 or stop)
    if end is None or _identity(data, end) is not None:
        return block, stop, end
    return block, end.end(), _DELIMITER.search(data, end.end())


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
    if len(fields) >= 4:
        closing = _CLOSING.match(data, payload + fields[3])
        if closing is not None and _IDENTITY.match(data, closing.end()) is None:
            return payload + fields[3], True
    # the announced number of bytes is wrong: the next delimiter in the bytes decides
    end = _BINARY_END.search(data, payload)
    return (len(data), False) if end is None else (end.start(), end[1] is None)


def _next_opening(data: mmap, stop: int, closed: bool) -> tuple[int, re.Match[bytes] | None]:
    """Return where the data set is over, and the delimiter that opens the next one."""
    if not closed:
        return stop, _HERE.match(data, stop) or _DELIMITER.search(data, stop)
    closing = _AFTER.match(data, stop)
    place = stop if closing is None else closing.end()
    return place, _DELIMITER.search(data, place)
