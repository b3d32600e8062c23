"""What the ID lines of a function state: the decay of an exponential window, averages, the hit's number and time."""

from __future__ import annotations

import re
from collections.abc import Sequence
from difflib import SequenceMatcher

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
_AMOUNT = re.compile(r"[+-]?(?:\d++\.?\d*+|\.\d++)(?:[eE][+-]?\d++)?+")
# So much alike words and a key are one misspelt: four letters in five. Doubled, only the key itself would be.
_NEARLY = 0.8
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
        if near := _misspelt(text, "exponential window decay"):
            return 0.0, near
        named = _WINDOW.search(text)
        return 0.0, f"its ID lines mention {named[0]!r} without a readable rate" if named else ""
    dash, number, rest = found.groups()
    if number is None:
        word = "" if rest.lower().strip(".") in _NO_WINDOW else rest
        return 0.0, f"its exponential window decay {word!r} is not a number: ignored" if word else ""
    decay = float(number)
    if not abs(decay) <= _FASTEST:
        return 0.0, f"its exponential window decay {number[:20]} is implausible: ignored"
    if dash or decay < 0:
        decay = abs(decay)
        return decay, f"its exponential window decay is given as {dash}{number}; taken for {decay:g} 1/s"
    return decay, ""


def averages_of(lines: Sequence[str]) -> tuple[int, str]:
    """Return the number of averages that ID lines state, 0 if none, and what is odd about it."""
    found = _AVERAGES.search(_joined(lines))
    if found is None:
        if any(line[:LENGTH].strip(" :=").lower() == "averages" for line in lines):
            return 0, "its ID lines mention averages without a number"
        return 0, _misspelt(_joined(lines), "averages")
    count = int(found[1][:12])
    if count <= _MOST_AVERAGES:
        return count, ""
    return 0, f"its ID lines state {found[1][:20]} averages: ignored"


def hit_of(lines: Sequence[str]) -> str:
    """Return the number of the hit that ID lines state; empty if they do not."""
    found = _NUMBERED.search(_joined(lines))
    return found[1] if found else ""


def _misspelt(text: str, key: str) -> str:
    """Return what to say of words before a number that are nearly a key; empty where there are none."""
    words, length = text.split(), len(key.split())
    for i in range(length, len(words)):
        number = _AMOUNT.fullmatch(words[i].lstrip("=:"))
        before = [word for word in words[max(0, i - length - 1) : i] if word not in ("=", ":")][-length:]
        found = " ".join(before).rstrip("=:").lower()
        if number and found != key and SequenceMatcher(None, found, key).ratio() >= _NEARLY:
            return f"its ID lines state {found[:40]!r}: not taken; what is read is '{key} {number[0][:20]}'"
    return ""


def stamp_of(lines: Sequence[str]) -> str:
    """Return the ID line with the time of day; empty if there is none."""
    return next((line for line in lines if _STAMP.search(line[:LENGTH])), "")


def _joined(lines: Sequence[str]) -> str:
    return " ".join(line[:LENGTH] for line in lines)
