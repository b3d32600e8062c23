"""Text files of OUTPUT4: the matrices that they hold, their lines followed to the end of the file.

The layout is that of the binary files. A line stands for each record; the numbers of a column or of a string follow
in fields of the width that the first line of the matrix states.
"""

from __future__ import annotations

import itertools
import re
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.imported.nastran.contents import WIDEST, Held, Run
from updating.models.imported.nastran.records import Matrix

_FORMAT = re.compile(rb"(?:1P,)?(\d{1,3})[EDed](\d{1,3})\.\d{1,3}")
_LONG = b"|I16"
_WHOLE = re.compile(rb"-?\d{1,15}")
_OF_NUMBERS = b"0123456789+-.EeDd "
"""Characters of numbers in fields."""
_EXPONENTS = bytes.maketrans(b"dD", b"EE")
_OF_THREE = re.compile(rb"([\d.])([+-]\d{3} *)")
"""An exponent of three digits, in front of which Fortran leaves out the letter."""


@dataclass(frozen=True)
class _Fields:
    """How many numbers stand on a line, in how many characters each, and whether all have a digit before the point."""

    per_line: int = 5
    width: int = 16
    led: bool = True

    def numbers(self, raw: bytes) -> FloatArray:
        """Return the numbers of fields, whose exponents begin with E, D, or the sign."""
        words = np.frombuffer(raw.translate(_EXPONENTS), dtype=f"S{self.width}")
        if self.led and np.char.startswith(np.char.lstrip(words, b" +-"), b".").any():
            raise ValueError("a number has no digit before its point, against the format 1P")
        try:
            return words.astype(np.float64)
        except ValueError:
            spelt = [_whole_exponent(word) for word in words.tolist()]
            return np.array(spelt, dtype=np.float64)


class _Lines:
    """The lines of a file, one after the other."""

    def __init__(self, raw: bytes) -> None:
        self._lines = raw.splitlines()
        self.at = 0

    @property
    def more(self) -> bool:
        """Whether a line follows; a blank one must be the last."""
        left = self._lines[self.at :]
        if not any(line.strip() for line in left):
            return False
        if not left[0].strip():
            raise ValueError(f"line {self.at + 1} is blank, and others follow")
        return True

    def take(self) -> bytes:
        """Return the next line."""
        if self.at >= len(self._lines):
            raise ValueError(f"it ends at line {self.at}, in the middle of a matrix")
        self.at += 1
        return self._lines[self.at - 1]

    def numbers(self, count: int, fields: _Fields) -> bytes:
        """Return the fields of so many numbers, which fill the next lines."""
        lines = -(-count // fields.per_line)
        block = self._lines[self.at : self.at + lines]
        if count < 1 or len(block) < lines:
            raise ValueError(f"{count} numbers behind line {self.at}, and {len(self._lines) - self.at} lines")
        full = fields.per_line * fields.width
        last = (count - (lines - 1) * fields.per_line) * fields.width
        whole = [line.rstrip() for line in block]
        for number, (line, size) in enumerate(zip(whole, [full] * (lines - 1) + [last], strict=True)):
            if len(line) != size or line.translate(None, _OF_NUMBERS):
                raise ValueError(
                    f"line {self.at + 1 + number} is not of numbers in {fields.width} characters"
                )
        self.at += lines
        return b"".join(whole)


def _whole_exponent(word: bytes) -> float:
    return float(_OF_THREE.sub(rb"\1E\2", word))


def contents(raw: bytes) -> list[Matrix]:
    """Return the matrices of a file.

    Raises
    ------
    ValueError
        If a line is not whole, or does not belong where it is.
    """
    lines, found = _Lines(raw), list[Matrix]()
    while lines.more:
        held, fields, wide = _header(lines.take(), lines.at)
        held = replace(held, runs=tuple(_runs(held, lines, fields, wide=wide)))
        found.append((held, fields.numbers))
    return found


def _header(line: bytes, number: int) -> tuple[Held, _Fields, bool]:
    """Return what the first line of a matrix states, and whether rows of strings are numbers of their own."""
    line = line.rstrip()
    long = line.endswith(_LONG)
    ends = (0, 16, 32, 40, 48, 56) if long else (0, 8, 16, 24, 32, 40)
    columns, rows, _, kind, name = (line[a:b] for a, b in itertools.pairwise(ends))
    layout = line.removesuffix(_LONG)[ends[-1] :].strip()
    found = _FORMAT.fullmatch(layout)
    if layout and (found is None or not int(found[1]) or not int(found[2])):
        raise ValueError(f"line {number} has {layout.decode('latin-1')[:20]!r} in place of a format")
    fields = _Fields() if found is None else _Fields(int(found[1]), int(found[2]), layout.startswith(b"1P"))
    height = _whole(rows, number)
    held = Held(
        name.decode("latin-1").replace(" ", ""), abs(height), _whole(columns, number), _whole(kind, number)
    )
    return held, fields, height < 0 or height >= WIDEST


def _runs(held: Held, lines: _Lines, fields: _Fields, *, wide: bool) -> list[Run]:
    """Return the entries of a matrix, all its columns checked."""
    before, runs, strings = 0, list[Run](), None
    while True:
        line = lines.take()
        column, row, count = (_whole(line[a : a + 8], lines.at) for a in (0, 8, 16))
        if not held.check_column(column, before):
            lines.take()
            return runs
        if strings is not None and strings != (row == 0):
            raise ValueError(f"line {lines.at}: a column of another layout than those before it")
        before, strings = column, row == 0
        if row:
            if held.real:
                held.check_rows(row, count, 0)
            runs.append(Run(column, row, count, lines.numbers(count, fields)))
        else:
            runs += _strings(held, lines, fields, (column, count), wide=wide)


def _strings(held: Held, lines: _Lines, fields: _Fields, stated: tuple[int, int], *, wide: bool) -> list[Run]:
    """Return the strings of a column, of which its line states number and words."""
    column, words = stated
    end, runs, per_value = 0, list[Run](), 1 if held.type % 2 else 2
    while words > 0:
        line = lines.take()
        if wide:
            size, row = _whole(line[:8], lines.at) - 1, _whole(line[8:16], lines.at)
        else:
            packed = _whole(line, lines.at)
            size, row = (packed >> 16) - 1, packed & 0xFFFF
        words -= (2 if wide else 1) + size
        count, odd = divmod(size, per_value)
        if odd:
            raise ValueError(f"line {lines.at}: {size} words in numbers of {per_value}")
        if held.real:
            end = held.check_rows(row, count, end)
        runs.append(Run(column, row, count, lines.numbers(count, fields)))
    if words:
        raise ValueError(f"line {lines.at}: strings of {-words} words more than their column has")
    return runs


def _whole(text: bytes, number: int) -> int:
    word = text.strip()
    if not _WHOLE.fullmatch(word):
        raise ValueError(f"line {number} has {word.decode('latin-1')[:20]!r} in place of a whole number")
    return int(word)
