"""The eleven header lines of data set 58, read column by column and, where columns are off, word by word."""

from __future__ import annotations

import re
from dataclasses import dataclass

from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.uff.functions.id_lines import averages_of, decay_of, hit_of, stamp_of

_NAME = re.compile(r"\W*(\d+)\W*?([+-]?)([XYZ])([+-]?)\W*$", re.IGNORECASE)
# a number as programs print it: one digit before the point if there is an exponent
_PRINTED = re.compile(r"[+-]?(?:\d\.\d*+[eEdD][+-]?\d++|\d++(?:\.\d*+)?)")
# where the fields of records 6, 7 and 8 to 11 end
IDENTITY = (5, 15, 20, 30, 41, 51, 55, 66, 76, 80)
FORM = (10, 20, 30, 43, 56, 69)
_NAMED = (0, 5, 6, 8, 9)  # of these, type, nodes and directions, which no program leaves blank
_LONGEST = 200  # characters of a field, as of the last column
_WHOLE = (0, 1, 2, 3, 5, 6, 8, 9)  # the fields of record 6 that are whole numbers
AXIS = (10, 15, 20, 25, 46, 200)
PRECISION = {2: (False, 4), 4: (False, 8), 5: (True, 4), 6: (True, 8)}


@dataclass(frozen=True)
class Axis:
    """What an axis of data set 58 carries: data type, exponents of length and force, and labels."""

    kind: int
    length: int
    force: int
    label: str
    unit: str


@dataclass(frozen=True)
class Header58:
    """The header of a function.

    Parameters
    ----------
    title : tuple of str
        The five ID lines.
    function_type : int
        1 time record, 4 FRF, 6 coherence, and so on.
    response, reference : Dof
        Degrees of freedom.
    is_complex : bool
        Whether values are complex.
    item_size : int
        Bytes of one real number, 4 or 8.
    points : int
        Number of values announced.
    even : bool
        Whether the abscissa is evenly spaced.
    minimum, increment : float
        First abscissa and its spacing, in the file's unit.
    resolution : float
        Half a unit in the last printed place of ``increment``.
    abscissa, ordinate, denominator : Axis
        Records 8, 9 and 10.
    odd : tuple of str
        Fields that do not fill their columns.
    """

    title: tuple[str, ...]
    function_type: int
    response: Dof
    reference: Dof
    is_complex: bool
    item_size: int
    points: int
    even: bool
    minimum: float
    increment: float
    resolution: float
    abscissa: Axis
    ordinate: Axis
    denominator: Axis
    odd: tuple[str, ...] = ()

    @property
    def decay(self) -> float:
        """Decay of an exponential window stated in the ID lines [1/s]."""
        return decay_of(self.title)[0]

    @property
    def averages(self) -> int:
        """Number of averages stated in the ID lines, 0 for none."""
        return averages_of(self.title)[0]

    @property
    def notes(self) -> list[str]:
        """What is odd about the header and had to be assumed."""
        return [note for note in (*self.odd, decay_of(self.title)[1], averages_of(self.title)[1]) if note]

    @property
    def hit(self) -> str:
        """Number of the hit stated in the ID lines; empty for none."""
        return hit_of(self.title)

    @property
    def stamp(self) -> str:
        """ID line with the time of day; empty if there is none."""
        return stamp_of(self.title)


def parse_header(raw: bytes) -> Header58:
    """Read the eleven header lines.

    Raises
    ------
    InputError
        If there are fewer lines or a number cannot be read.
    """
    lines = [_text(line) for line in raw.splitlines()[:11]]
    if len(lines) < 11:
        raise InputError(f"the header has {len(lines)} lines instead of 11: the file is cut off here")
    identity, form = _fields(lines[5], IDENTITY), _fields(lines[6], FORM)
    ordinate, points = _whole(form[0]), _whole(form[1])
    if ordinate not in PRECISION:
        raise InputError(f"ordinate data type {ordinate} does not exist (2, 4, 5 or 6 are known)")
    if points <= 0:
        raise InputError(f"it announces {points} points")
    spacing = _whole(form[2])
    if spacing not in (0, 1):
        raise InputError(f"abscissa spacing {spacing} does not exist (0 uneven and 1 even are known)")
    even = spacing == 1
    step = _real(form[4])
    if even and not 1e-12 < step < 1e12:
        raise InputError(f"the abscissa has an increment of {step:g}")
    axes = [_axis(line) for line in lines[7:10]]
    return Header58(
        title=tuple(line.strip() for line in lines[:5]),
        function_type=_whole(identity[0]),
        response=_dof(identity[5], identity[6], identity[4]),
        reference=_dof(identity[8], identity[9], identity[7]),
        is_complex=PRECISION[ordinate][0],
        item_size=PRECISION[ordinate][1],
        points=points,
        even=even,
        minimum=_real(form[3]),
        increment=step,
        resolution=_resolution(form[4]),
        abscissa=axes[0],
        ordinate=axes[1],
        denominator=axes[2],
        odd=_odd(lines),
    )


def _text(line: bytes) -> str:
    try:
        return line.decode("utf-8")
    except UnicodeDecodeError:
        return line.decode("latin-1")


def _fields(line: str, ends: tuple[int, ...]) -> list[str]:
    """Cut a line at its columns or, where tabs stand in it, at blanks."""
    words = line.split()
    if "\t" in line:
        return ([word[:_LONGEST] for word in words] + [""] * len(ends))[: len(ends)]
    return [line[a:b] for a, b in zip((0, *ends), ends, strict=False)]


def _odd(lines: list[str]) -> tuple[str, ...]:
    """State which fields of the header do not fill their columns: a character may be lost there."""
    wrong: list[str] = []
    for line, ends, whole in ((lines[5], IDENTITY, _WHOLE), (lines[6], FORM, (0, 1, 2)), *_axis_lines(lines)):
        fields = _fields(line, ends)
        if "\t" in line:
            wrong += [line.strip()[:40]] if len(line.split()) != len(ends) else []
            continue
        given = [fields[i] for i in whole if not fields[i].rstrip().endswith(".")]
        wrong += [field for field in given if field.strip() and field != field.rstrip()]
        wrong += [""] if line is lines[5] and any(not fields[i].strip() for i in _NAMED) else []
    reals = [field for field in _fields(lines[6], FORM)[3:] if field.strip()] if "\t" not in lines[6] else []
    wrong += [field for field in reals if _PRINTED.fullmatch(field.strip()) is None]
    ends_at = [len(field) - len(field.rstrip()) for field in reals]
    wrong += [field for field, gap in zip(reals, ends_at, strict=True) if gap != min(ends_at)]
    return tuple(
        f"{field.strip()!r} in its header does not fill its column: a character may be lost"
        for field in dict.fromkeys(wrong)
    )


def _axis_lines(lines: list[str]) -> list[tuple[str, tuple[int, ...], tuple[int, ...]]]:
    return [(line, AXIS, (0, 1, 2, 3)) for line in lines[7:10]]


def _whole(field: str) -> int:
    """Read a whole number; some programs write ``11.``, and blanks mean 0."""
    value = _real(field)
    if value != int(value):
        raise InputError(f"{field.strip()!r} stands where a whole number is expected")
    return int(value)


def _real(field: str) -> float:
    text = field.strip().replace("D", "E").replace("d", "e")
    try:
        value = float(text or "0")
    except ValueError:
        raise InputError(f"{field.strip()!r} stands in the header where a number is expected") from None
    if value - value != 0 or "_" in text or abs(value) > 1e30:
        raise InputError(f"{field.strip()!r} stands in the header where a finite number is expected")
    return value


def _resolution(field: str) -> float:
    """Return half a unit in the last printed place."""
    mantissa, _, exponent = field.strip().upper().replace("D", "E").partition("E")
    decimals = len(mantissa.partition(".")[2])
    return float(0.5 * 10.0 ** (int(exponent or 0) - decimals))


def _dof(node: str, direction: str, name: str) -> Dof:
    """Return the degree of freedom; names such as ``.1.Z-`` or ``7+X`` serve where the numbers are 0."""
    number, code = _whole(node), _whole(direction)
    found = _NAME.match(name)
    if number == 0 and code == 0 and found:
        sign = -1 if "-" in (found[2], found[4]) else 1
        return Dof(int(found[1]), sign * ("XYZ".index(found[3].upper()) + 1))
    if abs(code) > 6:
        raise InputError(f"direction code {code} does not exist (-6 to 6 are known)")
    return Dof(number, code)


def _axis(line: str) -> Axis:
    kind, length, force, _, label, unit = _fields(line, AXIS)
    return Axis(_whole(kind), _whole(length), _whole(force), _label(label), _label(unit))


def _label(text: str) -> str:
    text = text.strip()
    return "" if text.upper() == "NONE" else text
