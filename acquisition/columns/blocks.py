"""From the text of a file to blocks of numbers with headings."""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.columns.layout import Layout
from acquisition.errors import InputError
from acquisition.recorders.channels import Channels

SEPARATORS = {"tab": "\t", "space": None, "comma": ",", "semicolon": ";"}


@dataclass(frozen=True)
class Style:
    """How numbers are separated and written; separator None is any run of blanks."""

    separator: str | None
    decimal: str

    def split(self, line: str) -> list[str]:
        """Return the fields of a line, without blanks and pairs of quotes around them."""
        return [_unquoted(field.strip()) for field in line.split(self.separator)]

    def number(self, field: str) -> float:
        """Return the number in a field; ValueError if it is none."""
        return float(field.replace(self.decimal, ".")) if self.decimal != "." else float(field)

    def is_number(self, field: str) -> bool:
        """Return whether a field holds a number."""
        try:
            self.number(field)
        except ValueError:
            return False
        return True


def _unquoted(field: str) -> str:
    """Return a field without a pair of quotes; one alone is a fault, and stays."""
    return field[1:-1] if len(field) > 1 and field[0] == field[-1] == '"' else field


@dataclass(frozen=True, eq=False, kw_only=True)
class Block(Channels):
    """Lines of numbers under one heading.

    Parameters
    ----------
    lines : tuple of str
        The lines of numbers.
    first : int
        Number of the first of them in the file, from 1.
    style : Style
        How they are written.
    strict : bool
        Whether every line must have as many fields as the first.
    """

    lines: tuple[str, ...]
    first: int
    style: Style
    strict: bool = True

    @property
    def width(self) -> int:
        """How many columns the first line has."""
        return len(self.style.split(self.lines[0]))

    @property
    def where(self) -> str:
        """The file and the first line of numbers."""
        return f"{self.path}, line {self.first}"

    @property
    def where_names(self) -> str:
        """The file and the line of the headings."""
        return f"{self.path}, line {self.first - 1}"

    def line(self, sample: int) -> str:
        """Return the file and the line of a sample, from 0."""
        return f"{self.path}, line {self.first + sample}"

    def numbers(self, index: Sequence[int]) -> FloatArray:
        """Return columns as numbers, shape (n_lines, len(index)).

        Raises
        ------
        InputError
            If a line is short, a field is not a number, or a number is not finite.
        """
        between = self.style.separator or " "
        rows = self.lines[: self.count_of(index)]
        lines = [between.join(self.style.split(line)) if '"' in line else line for line in rows]
        if self.style.decimal != ".":
            lines = [line.replace(self.style.decimal, ".") for line in lines]
        try:
            values = np.loadtxt(
                lines, delimiter=self.style.separator, usecols=list(index), comments=None, ndmin=2
            )
        except ValueError:
            values = None
        if values is None or not np.isfinite(values).all() or (self.strict and self._ragged()):
            raise self._first_fault(index)
        return np.asarray(values, dtype=np.float64)

    def _ragged(self) -> bool:
        separator = self.style.separator
        if separator is None:
            return len({len(line.split()) for line in self.lines}) > 1
        return len({line.count(separator) for line in self.lines}) > 1

    def _first_fault(self, index: Sequence[int]) -> InputError:
        """Return the error for the first line that cannot be used."""
        width = self.width
        for number, line in enumerate(self.lines[: self.count_of(index)], start=self.first):
            fields = self.style.split(line)
            if len(fields) <= max(index) or (self.strict and len(fields) != width):
                return InputError(
                    f"{self.path}, line {number}: {len(fields)} columns, but the block began with {width}; "
                    "correct the line, or set separator and decimal in the layout"
                )
            for i in index:
                try:
                    value = self.style.number(fields[i])
                except ValueError:
                    value = np.nan
                if not np.isfinite(value):
                    return InputError(
                        f"{self.path}, line {number}, column {i}: {fields[i]!r} is not a number; correct "
                        "or remove the line, or set separator and decimal in the layout"
                    )
        return InputError(
            f"{self.path}, line {self.first}: the numbers cannot be read; check separator and decimal"
        )


_CONTROL = bytes({*range(32)} - {*b"\t\n\r\f"})
"""Characters that no text holds; DOS ends a file with one."""


def read_text(path: Path) -> list[str]:
    """Return the lines of a text file in UTF-8, UTF-16 with a mark, or Latin-1.

    Raises
    ------
    InputError
        If it cannot be read or holds no text.
    """
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from error
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        try:
            return raw.decode("utf-16").splitlines()
        except UnicodeDecodeError as error:
            raise InputError(
                f"{path}: marked as UTF-16, but is not ({error.reason}); export it again"
            ) from error
    raw = raw.rstrip(b"\x1a")
    if len(raw.translate(None, _CONTROL)) < len(raw):
        raise InputError(
            f"{path}: damaged or binary, not column text; export it as text, or write a reader "
            "(docs/howto/own_reader.md)"
        )
    try:
        return raw.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        return raw.decode("latin-1").splitlines()


def plain_blocks(
    path: Path, lines: Sequence[str], layout: Layout, least: int, wanted: Collection[str] = ()
) -> list[Block]:
    """Return the blocks of a plain text file; blank lines part them, headings and comments may precede each.

    Parameters
    ----------
    path : Path
        The file.
    lines : sequence of str
        Its lines.
    layout : Layout
        What is stated about separator, decimal and lines to skip.
    least : int
        Columns that a line of numbers must have.
    wanted : collection of str
        Headings that are asked for; they identify the line above the numbers that is the heading.

    Raises
    ------
    InputError
        If there is no line of numbers.
    """
    blocks: list[Block] = []
    above: list[str] = []
    style: Style | None = None
    body: list[str] = []
    first = 0
    for number, line in enumerate([*lines[layout.skip :], ""], start=layout.skip + 1):
        blank = not line.strip(" \t;,\r")
        if body and not blank:
            body.append(line)
        elif body and style is not None:
            _check_above(above, first - 1, style, least, path)
            _check_behind_heading(above, style, wanted, path, first - 1)
            names = _heading(above, style, wanted) or (blocks[-1].names if blocks else ())
            rows = _without_trailer(body, style)
            blocks.append(Block(path=path, names=names, lines=rows, first=first, style=style))
            body, above = [], []
        elif not blank:
            found = _style(line, layout, least) if style is None else _same(line, style, least)
            if found is None:
                above.append(line)
            else:
                style, body, first = found, [line], number
    if not blocks:
        raise InputError(
            f"{path}: no line contains {least} or more numbers; check skip, separator and decimal in the layout"
        )
    _check_below(above, len(lines), blocks[-1].style, path)
    return blocks


def _without_trailer(body: Sequence[str], style: Style) -> tuple[str, ...]:
    """Return the lines of numbers without the lines of words that some programs write right behind them."""
    stop = len(body)
    while stop > 1 and _is_of_words(body[stop - 1], style):
        stop -= 1
    return tuple(body[:stop])


def _is_of_words(line: str, style: Style) -> bool:
    """Return whether a line begins with a word and has one number at most: a faulty row has more, or begins so."""
    fields = [entry for entry in style.split(line) if entry]
    numbers = sum(style.is_number(entry) for entry in fields)
    return _WORD.match(line) is not None and not style.is_number(fields[0]) and numbers < 2


_WORD = re.compile(r"[^\w+-.]*[^\W\d_]{2}")
"""How a line of words begins."""


def _check_below(below: Sequence[str], number: int, style: Style, path: Path) -> None:
    """Refuse a line of numbers behind the last block that is none of it: a row that was cut."""
    for line_number, line in enumerate(below, start=number - len(below) + 1):
        fields = [field for field in style.split(line) if field]
        if all(style.is_number(field) for field in fields):
            raise InputError(
                f"{path}, line {line_number}: {line.strip()[:60]!r} after the last line of numbers is cut "
                "off or damaged; correct or remove it"
            )


def _check_above(above: Sequence[str], number: int, style: Style, least: int, path: Path) -> None:
    """Refuse a row of numbers with a fault above the others: taken as a heading, it would be lost."""
    for line_number, line in enumerate(above, start=number - len(above) + 1):
        fields = [field for field in style.split(line) if field]
        alike = [field for field in fields if _LIKE.fullmatch(field)]
        numbers = [field for field in alike if style.is_number(field)]
        last = line_number == number
        whole = len(fields) >= least
        row = (whole or last) and len(alike) >= 2 and 2 * len(alike) >= len(fields)
        bare = bool(numbers) and len(numbers) == len(fields) < len(style.split(line)) + (len(fields) > 1)
        mixed = last and whole and bool(numbers) and all(any(c.isdigit() for c in field) for field in fields)
        touching = last and bool(numbers) and all(_nearly(field) for field in fields)
        joined = last and whole and len(numbers) >= max(2, least - 1)
        ending = last and bool(numbers) and all(f in numbers or _ENDS_LIKE.fullmatch(f) for f in fields)
        begun = bool(alike) or (bool(fields) and fields[0][0] in "0123456789.+-" and _nearly(fields[0]))
        broken = last and len(fields) == 1 and not numbers and begun and "e" in line.lower()
        if row or bare or mixed or touching or joined or broken or ending:
            raise InputError(
                f"{path}, line {line_number}: {line.strip()[:60]!r} is almost a line of numbers; correct "
                "it, or leave it out with skip in the layout"
            )


def _check_behind_heading(
    above: Sequence[str], style: Style, wanted: Collection[str], path: Path, number: int
) -> None:
    """Refuse a number between the headings that are asked for and the first row: what holds it is a broken row.

    One digit alone may be a unit, that of numbers without dimension.
    """
    if not above or not wanted or all(not _holds(line, style, wanted) for line in above[:-1]):
        return
    fields = style.split(above[-1])
    if any(len(field) > 1 and style.is_number(field) for field in fields) and len(fields) >= len(wanted):
        raise InputError(
            f"{path}, line {number}: {above[-1].strip()[:60]!r} contains a number but is not a row of "
            "numbers; correct or remove it"
        )


_OF_NUMBERS = frozenset("0123456789.,eE+-")
_LIKE = re.compile(r"(?=[^\d]*+\d)[\s\d.,eE+-]*+")
"""Words of characters that numbers have."""


_ENDS_LIKE = re.compile(r".*\d[eE][+-]\d+")
"""Words that end as a number with an exponent does: something ran into it."""


def _nearly(field: str) -> bool:
    """Return whether a field is a number, or one but for a character that none has, which may part it from a second."""
    return any(c.isdigit() for c in field) and sum(c not in _OF_NUMBERS for c in field) <= 1


def _heading(above: Sequence[str], style: Style, wanted: Collection[str]) -> tuple[str, ...]:
    """Return the headings among the lines above numbers: the last line that holds what is asked for, or the last."""
    fitting = [line for line in above if _holds(line, style, wanted)] or above
    return _names(fitting[-1], style) if fitting else ()


def _names(line: str, style: Style) -> tuple[str, ...]:
    return tuple(style.split(line.lstrip("#% ")))


def _holds(line: str, style: Style, wanted: Collection[str]) -> bool:
    """Return whether a line holds every heading that is asked for."""
    return set(wanted) <= set(_names(line, style))


def _style(line: str, layout: Layout, least: int) -> Style | None:
    """Return the style in which a line is all numbers, at least ``least`` of them; None if there is none."""
    separators: list[str | None] = ["\t", ";", ",", None]
    if layout.separator != "auto":
        separators = [SEPARATORS.get(layout.separator, layout.separator)]
    decimals = [".", ","] if layout.decimal == "auto" else [layout.decimal]
    for separator in separators:
        for decimal in decimals:
            style = None if separator == decimal else _same(line, Style(separator, decimal), least)
            if style is not None:
                return style
    return None


def _same(line: str, style: Style, least: int) -> Style | None:
    fields = style.split(line)
    numbers = 0
    for field in fields:
        if not field:
            continue
        try:
            style.number(field)
        except ValueError:
            return None
        numbers += 1
    return style if len(fields) >= least and numbers else None
