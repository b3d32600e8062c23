"""What names, units and numbers of a channel let one guess; the user corrects it in the layout that is written."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.columns.units import factor_to_si
from acquisition.errors import InputError

QUANTITIES = ("force", "acceleration", "velocity", "displacement")
_WORDS = {
    "force": r"force|hammer|impact|kraft|load|\bf\d*\b|excit",
    "acceleration": r"acc|beschl|\ba\d*[xyz]?\b|\ba[xyz]\d*\b",
    "velocity": r"vel|laser|ldv|vibrom|\bv\d*[xyz]?\b",
    "displacement": r"disp|\bd\d*\b|\bu\d*\b",
}
_TIME = re.compile(r"time|zeit|\bt\b|x_value", re.IGNORECASE)
_FREQUENCY = re.compile(r"freq|\bhz\b|\bf\b", re.IGNORECASE)
_PARTS = {"real": r"\bre", "imag": r"\bim", "phase": r"phase|arg|deg", "magnitude": r"mag|abs|amp"}
_UNIT = re.compile(r"[\[(]\s*([^\[\]()]*(?:\([^()]*\)[^\[\]()]*)?)\s*[\])]")
_SECONDS = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6}
_NODE = re.compile(r"(?:^|[^a-z])(?:p|pt|pnt|point|punkt|n|node|pos|loc|dof|m)[ _.-]*$", re.IGNORECASE)
_HIT = re.compile(
    r"(?:hit|run|rec|record|take|shot|impact|schlag|test|trial|no|nr|avg)[ _.-]*$", re.IGNORECASE
)
_DIRECTION = re.compile(r"(?<![a-z])([+-]?)([xyz])(?![a-z])", re.IGNORECASE)
_RATES = ("fs", "rate", "samplingrate", "samplerate", "samplingfrequency", "fsample")
"""Names of an array that is a sampling rate, without blanks and dashes."""
_ENDS = 16
"""Numbers at either end of a column whose digits are counted: one may end in zeros that are not written."""
EVEN = 0.01
"""Steps of a column of times or lines differ by less than this part of their mean; those of a signal do not [-]."""


@dataclass(frozen=True, eq=False)
class Channel:
    """A channel whose meaning is to be guessed.

    Parameters
    ----------
    index : int
        Number in its file.
    name : str
        Its heading; "" where it has none.
    unit : str
        Unit that the file states; "" where it states none.
    stated : bool
        Whether the file states it where the reader finds it, so that the layout need not.
    values : array, shape (n_samples,)
        The numbers of its first record.
    """

    index: int
    name: str
    unit: str
    stated: bool
    values: FloatArray


@dataclass(frozen=True)
class Guess:
    """A value of a layout and why it was guessed."""

    value: str
    why: str


def unit_in(heading: str) -> str:
    """Return the unit that a heading has in brackets; "" for none."""
    found = _UNIT.findall(heading)
    return str(found[-1]).strip() if found else ""


def quantity_of_unit(unit: str) -> str | None:
    """Return what is measured in a unit; None if it belongs to nothing that a hammer test measures."""
    if not unit:
        return None
    for quantity in QUANTITIES:
        try:
            factor_to_si(unit, quantity, "")
        except InputError:
            continue
        return quantity
    return None


def quantity_of(channel: Channel) -> Guess | None:
    """Return what a channel measures, by its unit or its name."""
    by_unit = quantity_of_unit(channel.unit)
    if by_unit is not None:
        return Guess(by_unit, f"by its unit, {channel.unit}")
    plain = re.sub(r"[_\W]+", " ", _UNIT.sub("", channel.name)).strip()
    for quantity, words in _WORDS.items():
        if re.search(words, plain, re.IGNORECASE):
            return Guess(quantity, f"by its name, {channel.name}")
    return None


def is_even(values: FloatArray) -> bool:
    """Return whether numbers rise in even steps, as times and lines do."""
    steps = np.diff(values)
    return len(steps) > 1 and bool(
        steps.mean() > 0 and np.ptp(steps) < EVEN * steps.mean() + 2 * _digit(values)
    )


def _digit(values: FloatArray) -> float:
    """Return the last digit in which numbers are written, as far as float32 has it."""
    return float(np.finfo(np.float32).eps * np.abs(values).max())


def time_among(channels: Sequence[Channel]) -> Channel | None:
    """Return the channel of times or numbers of lines: even, and named so or the first."""
    even = [c for c in channels if is_even(c.values)]
    named = [c for c in even if _TIME.search(c.name)]
    return next(iter(named or [c for c in even if c.index == 0 and quantity_of(c) is None]), None)


def lines_among(channels: Sequence[Channel]) -> Channel | None:
    """Return the channel of frequencies: even, and named so or in Hz."""
    even = [c for c in channels if is_even(c.values) and not _TIME.search(c.name)]
    return next((c for c in even if _FREQUENCY.search(c.name) or c.unit.lower() == "hz"), None)


def is_rate(name: str) -> bool:
    """Return whether an array is called as a sampling rate is."""
    return "".join(filter(str.isalpha, name.rpartition(".")[2].lower())) in _RATES


def roundest_rate(times: FloatArray, unit: float) -> tuple[float, float, float]:
    """Return the rate of the fewest digits that the last digit of times allows, the least and the largest [Hz].

    Parameters
    ----------
    times : array, shape (n_samples,)
        Times in even steps, each rounded by half its last digit [unit].
    unit : float
        One unit of the times [s].
    """
    span, steps = unit * float(times[-1] - times[0]), len(times) - 1
    error = min(unit * _written_digit(times), 0.5 * span / steps)
    least, largest = steps / (span + error), steps / (span - error)
    usual = steps / span
    rounds = (float(f"{usual:.{digits}g}") for digits in range(1, 17))
    return next((r for r in rounds if least <= r <= largest), usual), least, largest


def _written_digit(values: FloatArray) -> float:
    """Return the last digit in which the first and last numbers are written, or what binary numbers have."""
    ends = np.concatenate([values[:_ENDS], values[-_ENDS:]])
    kind = np.float32 if np.array_equal(ends, ends.astype(np.float32)) else np.float64
    exponents = [int(Decimal(repr(float(v))).as_tuple().exponent) for v in ends if v]
    return max(10.0 ** min(exponents, default=0), float(np.finfo(kind).eps * np.abs(ends).max()))


def text_of(value: str) -> str:
    """Return a text as TOML has it."""
    return json.dumps(value, ensure_ascii=False)


def seconds(channel: Channel) -> float | None:
    """Return how many seconds one unit of a channel of times is; None for a unit that is none."""
    return _SECONDS.get(channel.unit.lower() or "s")


def part_of(channel: Channel) -> str | None:
    """Return which part of an FRF a name states."""
    return next(
        (part for part, words in _PARTS.items() if re.search(words, channel.name, re.IGNORECASE)), None
    )


def most_impulsive(channels: Sequence[Channel]) -> Channel:
    """Return the channel whose peak is highest above its r.m.s.: a hit is short, what it sets in motion rings."""

    def crest(channel: Channel) -> float:
        centred = channel.values - np.median(channel.values)
        scale = float(np.sqrt(np.mean(centred**2)))
        return float(np.abs(centred).max()) / scale if scale else 0.0

    return max(channels, key=crest)


def number_in(name: str) -> int | None:
    """Return the last number in a name outside its unit; None for none."""
    found = re.findall(r"\d{1,9}", _UNIT.sub("", name))
    return int(found[-1]) if found else None


def direction_in(name: str) -> str | None:
    """Return the direction that stands in a name by itself, as ``acc 1 +z`` or ``3_x``; None for none."""
    found = _DIRECTION.findall(re.sub(r"[_\d]", " ", _UNIT.sub("", name)))
    return f"{found[-1][0] or '+'}{found[-1][1].lower()}" if found else None


def node_pattern(paths: Sequence[Path]) -> Guess | None:
    """Return the pattern of file names that states the node, ``P{node}_*.csv``; None if the names state none.

    Files of several folders are named with theirs where these differ in digits alone, ``P{node}/hit*.csv``.
    """
    folders = len({path.parent for path in paths}) > 1
    with_folder = _node_pattern([f"{p.parent.name}/{p.name}" for p in paths]) if folders else None
    return with_folder or _node_pattern([path.name for path in paths])


def _node_pattern(names: Sequence[str]) -> Guess | None:
    words = [re.split(r"(\d+)", name) for name in names]
    if len({tuple(w[::2]) for w in words}) > 1 or len(words[0]) < 3:
        return None
    numbers = range(1, len(words[0]), 2)
    marked = [i for i in numbers if _NODE.search(words[0][i - 1])]
    varying = [i for i in numbers if len({w[i] for w in words}) > 1]
    free = [i for i in varying if not _HIT.search(words[0][i - 1])]
    chosen = marked or free
    if not chosen:
        return None
    why = "it follows a word for points" if marked else "it differs from file to file"
    parts = [
        "{node}" if i == chosen[0] else "*" if i in varying else _literal(word)
        for i, word in enumerate(words[0])
    ]
    return Guess("".join(parts), why)


def _literal(word: str) -> str:
    return re.sub(r"([*?\[])", r"[\1]", word)
