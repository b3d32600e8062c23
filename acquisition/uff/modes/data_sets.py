"""The bodies of data sets 55 and 2414 that hold modes, as they stand there."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

import numpy as np

from acquisition.arrays import AnyArray, ComplexArray, FloatArray, IntArray
from acquisition.errors import InputError
from acquisition.uff.functions.id_lines import LENGTH
from acquisition.uff.functions.units import Units
from acquisition.uff.text.columns import check_columns, check_digits
from acquisition.uff.text.numbers import numbers_of
from acquisition.uff.text.record_lines import check_record_lines

# How far the MAC of a mode with its copy, printed with five digits, may be from 1. Doubling it changes nothing: the
# shapes of different modes at the very same frequency are far apart.
_ROUNDING = 1e-6
NORMAL, COMPLEX = 2, (3, 7)
_AMOUNT = r"((?<![\d.])[\d.]{1,40}(?:[eE][-+]?\d{1,4})?+)\s*+"
_HERTZ = re.compile(rf"{_AMOUNT}(?:Hz\b|:d=)", re.IGNORECASE)
_DAMPING = re.compile(rf"damping ratio\s*+[:=]?\s*+{_AMOUNT}", re.IGNORECASE)
_SIGMA = re.compile(rf"(?<!damping )sigma\s*+[:=]?\s*+{_AMOUNT}Hz\b", re.IGNORECASE)
_DAMPING_SIGMA = re.compile(rf"damping sigma\s*+[:=]?\s*+{_AMOUNT}", re.IGNORECASE)
_OF_SHAPE = re.compile(rf"shape sigma of mode (\d{{1,6}}): {_AMOUNT}Hz\s*")
_SIGMAS = re.compile(r"(?<!\w)sigma\s*+[:=]?\s*+\S{1,40}+\s*+Hz", re.IGNORECASE)


@dataclass(frozen=True, eq=False)
class SigmaSet:
    """Standard deviations of one mode's shape: its number and frequency [Hz], nodes (n,), values (n, 6) [as shapes]."""

    mode: int
    frequency: float
    nodes: IntArray
    values: FloatArray


@dataclass(frozen=True)
class Stated:
    """What the ID lines say: frequency and its sigma [Hz], damping ratio and its sigma [-]; nan if nothing."""

    frequency: float
    frequency_sigma: float
    damping: float
    damping_sigma: float


@dataclass(frozen=True, eq=False)
class ModeSet:
    """One mode as its data set states it.

    Parameters
    ----------
    place : str
        File, data set and line, for messages.
    file : int
        Which file it is from.
    frequency, damping : float
        Of a normal mode [Hz, -]; nan for a complex one.
    eigenvalue : complex
        Of a complex mode, in whatever unit; 0 for a normal one.
    mass, modal_a, modal_b : complex
        Modal mass of a normal mode, modal A and B of a complex one [file's units]; 0 where not stated.
    nodes : (n,) int array
        Node numbers.
    shape : (n, 6) complex array
        Translations and rotations.
    stated_values : Stated
        What the ID lines say.
    units : Units
        The file's units.
    """

    place: str
    file: int
    frequency: float
    damping: float
    eigenvalue: complex
    mass: complex
    modal_a: complex
    modal_b: complex
    nodes: IntArray
    shape: ComplexArray
    stated_values: Stated
    units: Units = field(default_factory=Units)

    @property
    def is_complex(self) -> bool:
        """Whether an eigenvalue is stated."""
        return self.eigenvalue != 0

    @property
    def key(self) -> tuple[float, ...]:
        """What a mode given twice has in common: frequency, damping or eigenvalue, and those of the ID lines."""
        stated = (
            (self.eigenvalue.real, self.eigenvalue.imag)
            if self.is_complex
            else (self.frequency, self.damping)
        )
        return (*stated, *np.nan_to_num([self.stated_values.frequency, self.stated_values.damping]).tolist())


def same_shape(one: ModeSet, other: ModeSet) -> bool:
    """Return whether two modes have the same nodes and, but for a factor, the same shape."""
    if not np.array_equal(one.nodes, other.nodes):
        return False
    across = abs(np.vdot(one.shape, other.shape)) ** 2
    squares = np.vdot(one.shape, one.shape).real * np.vdot(other.shape, other.shape).real
    return bool(across >= (1 - _ROUNDING) * squares)


def read_mode(number: int, body: bytes, units: Units, place: str, file: int) -> ModeSet | None:
    """Read one data set 55 or 2414 of a normal (2) or complex mode (3, 7); None if it holds something else.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    lines = body.splitlines()
    first = 0 if number == 55 else 3
    if len(lines) < (8 if number == 55 else 13):
        raise InputError(f"its header has {len(lines)} lines: the file is cut off here")
    kinds = _integers(lines[first + 5])
    if len(kinds) < 6:
        raise InputError("its data definition (model, analysis, data type, ...) is incomplete")
    analysis, characteristic, data_type, width = kinds[1], kinds[2], kinds[4], kinds[5]
    at_nodes = number == 55 or _integers(lines[2])[:1] == [1]
    if analysis not in (NORMAL, *COMPLEX) or characteristic not in (2, 3) or not at_nodes:
        return None
    if data_type not in (2, 4, 5, 6) or width not in (3, 6):
        raise InputError(
            f"data type {data_type} with {width} values a node; 3 or 6 real or complex ones are known"
        )
    reals, rest = _parameters55(lines) if number == 55 else _parameters2414(lines)
    nodes, shape = _shape(b"\n".join(rest), width, is_complex=data_type > 4)
    stated_values = _stated(b" ".join(line[:LENGTH] for line in lines[first : first + 5]).decode("latin-1"))
    return _mode(analysis, reals, (place, file), (nodes, shape), stated_values, units)


def read_sigma(body: bytes) -> SigmaSet | None:
    """Read the standard deviations of a shape from a data set 55 of unknown analysis type; None if it holds others.

    Raises
    ------
    InputError
        If it cannot be read.
    """
    lines = body.splitlines()
    found = _OF_SHAPE.match(lines[0][:LENGTH].decode("latin-1")) if lines else None
    if found is None:
        return None
    kinds = _integers(lines[5]) if len(lines) > 8 else []
    if len(kinds) != 6 or kinds[4] != 2 or kinds[5] not in (3, 6):
        raise InputError("its standard deviations are cut off or garbled")
    nodes, values = _shape(b"\n".join(lines[8:]), kinds[5], is_complex=False)
    if np.any(values.real < 0):
        raise InputError("it holds standard deviations below zero")
    return SigmaSet(int(found[1]), float(found[2]), nodes, values.real.copy())


def _parameters55(lines: list[bytes]) -> tuple[dict[str, float], list[bytes]]:
    """Return the parameters of record 8 by name, and the lines behind it."""
    counts = _integers(lines[6])
    wanted = counts[1] if len(counts) > 1 else 0
    values, used = numbers_of(lines[7]), 8
    while 6 <= len(values) < wanted and used < len(lines):
        values, used = np.concatenate([values, numbers_of(lines[used])]), used + 1
    check_digits(b"\n".join(lines[7:used]))
    if len(values) != wanted and len(counts) > 1:
        raise InputError(
            f"its record 8 holds {len(values)} numbers and record 7 announces {wanted}: one is lost or broken in two"
        )
    values = np.concatenate([values, np.zeros(6)])
    normal = ("frequency", "mass", "damping")
    complex_ = ("re", "im", "a_re", "a_im", "b_re", "b_im")
    names = normal if _integers(lines[5])[1] == NORMAL else complex_
    return dict(zip(names, values.tolist(), strict=False)), lines[used:]


def _parameters2414(lines: list[bytes]) -> tuple[dict[str, float], list[bytes]]:
    """Return the parameters of records 12 and 13 by name, and the lines behind them."""
    first, second = numbers_of(lines[11]), numbers_of(lines[12])
    check_digits(lines[11] + b"\n" + lines[12])
    if len(first) != 6 or len(second) != 6:
        raise InputError("its real parameters (records 12 and 13) are incomplete")
    values = [*first[:6].tolist(), *second[:6].tolist()]
    names = ("time", "frequency", "eigenvalue", "mass", "damping", "hysteretic")
    return dict(zip((*names, "re", "im", "a_re", "a_im", "b_re", "b_im"), values, strict=True)), lines[13:]


def _mode(
    analysis: int,
    reals: dict[str, float],
    origin: tuple[str, int],
    table: tuple[IntArray, ComplexArray],
    stated_values: Stated,
    units: Units,
) -> ModeSet:
    normal = analysis == NORMAL
    leading = reals["frequency"] if normal else abs(complex(reals["re"], reals["im"]))
    if not all(np.isfinite(v) and abs(v) < 1e30 for v in reals.values()) or not leading > 1e-12:
        raise InputError(f"its frequency or eigenvalue is {leading:g}: it must be above zero")
    if normal and not 0 <= reals["damping"] < 1:
        raise InputError(f"its damping ratio is {reals['damping']:g}; it must be between 0 and 1")
    return ModeSet(
        place=origin[0],
        file=origin[1],
        frequency=reals["frequency"] if normal else np.nan,
        damping=reals["damping"] if normal else np.nan,
        eigenvalue=0j if normal else complex(reals["re"], reals["im"]),
        mass=complex(reals["mass"]) if normal else 0j,
        modal_a=0j if normal else complex(reals["a_re"], reals["a_im"]),
        modal_b=0j if normal else complex(reals["b_re"], reals["b_im"]),
        nodes=table[0],
        shape=table[1],
        stated_values=stated_values,
        units=units,
    )


def _shape(text: bytes, width: int, *, is_complex: bool) -> tuple[IntArray, ComplexArray]:
    """Return node numbers and what stands at each, from a stream of numbers."""
    numbers: FloatArray = numbers_of(text)
    columns = 1 + width * (2 if is_complex else 1)
    if len(numbers) == 0 or len(numbers) % columns:
        raise InputError(
            f"its shape holds {len(numbers)} numbers, not a multiple of {columns}: it is cut off or garbled"
        )
    check_columns(text)
    check_digits(text)
    check_record_lines(text, columns=columns, first=(1, columns))
    table = numbers.reshape(-1, columns)
    labels = table[:, 0]
    if not np.isfinite(table).all() or np.any(labels % 1) or np.any(np.abs(labels) > 1e15):
        raise InputError("its node numbers are not whole, or values are not finite")
    if np.abs(table).max() > 1e30 and np.abs(table[:, 1:]).max() > 1e30:
        raise InputError("its shape holds implausible values")
    values: AnyArray = np.ascontiguousarray(table[:, 1:])
    shape = np.zeros((len(table), 6), dtype=np.complex128)
    shape[:, :width] = values.view(np.complex128) if is_complex else values
    nodes = labels.astype(np.int64)
    if len(np.unique(nodes)) < len(nodes):
        raise InputError("its shape names a node twice")
    return nodes, shape


def _integers(line: bytes) -> list[int]:
    values = numbers_of(line)
    if not np.isfinite(values).all() or np.any(np.abs(values) > 1e15):
        raise InputError("its header has something else where a whole number is expected")
    return [int(v) for v in values]


def _stated(text: str) -> Stated:
    def number(pattern: re.Pattern[str]) -> float:
        found = pattern.search(text)
        try:
            return float(found[1]) if found else np.nan
        except ValueError:
            return np.nan

    plain = _SIGMAS.sub("", text)
    hertz = _HERTZ.search(plain)
    try:
        frequency = float(hertz[1]) if hertz else np.nan
    except ValueError:
        frequency = np.nan
    return Stated(frequency, number(_SIGMA), number(_DAMPING), number(_DAMPING_SIGMA))
