"""What the ID lines of a function speak of: the decay of an exponential window, averages, the hit's number and time."""

from __future__ import annotations

import re
from collections.abc import Sequence

_DECAY = re.compile(
    r"exponential window decay\s*+[:=]?\s*+(-?)\s*+"
    r"([+-]?(?:\d++\.?\d*+|\.\d++)(?:[eE][+-]?\d++)?+(?=\s|[,;](?!\d)|(?:1?/s)|\Z))?+(\S{0,20})",
    re.IGNORECASE,
)
_WINDOW = re.compile(r"exponential window|window decay|\bdecay\b", re.IGNORECASE)
_NO_WINDOW = ("", "none", "no", "off", "n/a", ",", ";")
_AVERAGES = re.compile(r"averages\s*+[:=]?\s*+(\d++)", re.IGNORECASE)
_STAMP = re.compile(r"\b\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?\b")
_NUMBERED = re.compile(
    r"\b(?:hit|impact|blow|shot|strike|stroke)\s*+(?:no\.?|nr\.?|number)?\s*+[:=#]?\s*+(\d{1,6})\b",
    re.IGNORECASE,
)
# Characters of an ID line that are searched; the format has 80. Doubling it doubles the time of a search.
LENGTH = 400
# The fastest decay that can be meant [1/s]: a record windowed so is over after ten microseconds. Doubling it would
# take a few more misprints for windows.
_FASTEST = 1e6
# The most averages that can be meant: thirty years of one a second. Doubling it changes nothing.
_MOST_AVERAGES = 10**9


def decay_of(lines: Sequence[str]) -> tuple[float, str]:
    """Return the decay of the exponential window that ID lines state [1/s], 0 if none, and what is odd about it."""
    text = _joined(lines)
    found = _DECAY.search(text)
    if found is None:
        named = _WINDOW.search(text)
        return 0.0, f"its ID lines speak of {named[0]!r} without a rate that can be read" if named else ""
    dash, number, rest = found.groups()
    if number is None:
        word = "" if rest.lower().strip(".") in _NO_WINDOW else rest
        return 0.0, f"its exponential window decay {word!r} is no number: not taken" if word else ""
    decay = float(number)
    if not abs(decay) <= _FASTEST:
        return 0.0, f"its exponential window decay {number[:20]} cannot be meant: not taken"
    if dash or decay < 0:
        decay = abs(decay)
        return decay, f"its exponential window decay is given as {dash}{number}; taken for {decay:g} 1/s"
    return decay, ""


def averages_of(lines: Sequence[str]) -> tuple[int, str]:
    """Return the number of averages that ID lines state, 0 if none, and what is odd about it."""
    found = _AVERAGES.search(_joined(lines))
    count = int(found[1][:12]) if found else 0
    if found is None or count <= _MOST_AVERAGES:
        return count, ""
    return 0, f"its ID lines speak of {found[1][:20]} averages: not taken"


def hit_of(lines: Sequence[str]) -> str:
    """Return the number of the hit that ID lines state; empty if they do not."""
    found = _NUMBERED.search(_joined(lines))
    return found[1] if found else ""


def stamp_of(lines: Sequence[str]) -> str:
    """Return the ID line with the time of day; empty if there is none."""
    return next((line for line in lines if _STAMP.search(line[:LENGTH])), "")


def _joined(lines: Sequence[str]) -> str:
    return " ".join(line[:LENGTH] for line in lines)
