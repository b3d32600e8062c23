"""Names of effects for readers: words in place of identifiers, and which of two alike is meant."""

from __future__ import annotations

import re
from collections.abc import Iterator

from acquisition.quantities import place
from modalkit.output.forms import numbers_a_form
from updating import LIBRARY
from updating.diagnosis.answer.ranked import ParameterEstimate, Ranked

ORDINALS = ("first", "second", "third", "fourth")
"""Which of several effects of one name."""

_CODE = re.compile(
    rf"(?<![\w.\"'`])({'|'.join(sorted(LIBRARY, key=len, reverse=True))})(?:#(\d))?(?![\w\"'`]|\.\w)"
)
"""An effect as it is typed, of a second one ``name#2``; in quotation marks it is what the user shall type."""

_NUMBERED = re.compile(r"zone(\d+)([abc]?)")
"""A region that the model numbered because the study names none."""


def in_words(text: str) -> str:
    """Return a text with the identifiers of effects in words: ``sensor_mass`` as ``sensor mass``."""
    return _CODE.sub(lambda found: _words(found[1], int(found[2] or 1)), text)


def _words(name: str, occurrence: int) -> str:
    ordinal = f"{ORDINALS[occurrence - 1]} " if 1 < occurrence <= len(ORDINALS) else ""
    return f"{ordinal}{name.replace('_', ' ')}"


def zone_in_words(name: str) -> str:
    """Return the name of a region; one that only has a number is called by it: ``zone4`` as ``zone 4``."""
    found = _NUMBERED.fullmatch(name)
    return f"zone {found[1]}{found[2]}" if found else name


def is_numbered(name: str) -> bool:
    """Return whether a region has a number only, which the model gave it."""
    return _NUMBERED.fullmatch(name) is not None


def owners(row: Ranked) -> Iterator[tuple[str, dict[str, ParameterEstimate]]]:
    """Yield each effect of a set with its parameters; of two alike, each by its place or its number.

    Parameters
    ----------
    row : Ranked
        A set of effects.
    """
    keys = list(dict.fromkeys(name.rpartition(".")[0] for name in row.parameters))
    names = [key.partition("#")[0] for key in keys]
    for key, name in zip(keys, names, strict=True):
        own = row.of(key)
        yield (name if names.count(name) == 1 else _distinct(key, own)), own


def _distinct(key: str, own: dict[str, ParameterEstimate]) -> str:
    """Return the name of one of several alike effects, with its place where it has one."""
    name, _, number = key.partition("#")
    at = [own[axis].value for axis in "xy" if axis in own]
    known = [value for value in at if isinstance(value, float)]
    if known and len(known) == len(at):
        return f"{name} at {place(known, plate=len(known) > 1)}"
    return f"{ORDINALS[int(number or 1) - 1]} {name}"


def sizes(row: Ranked) -> list[str]:
    """Return the sizes of a set in words, a text for each effect; its name is left out where it is the only one.

    Parameters
    ----------
    row : Ranked
        A set of effects.
    """
    found = []
    several = len(row.effects) > 1
    for owner, own in owners(row):
        parts = [
            f"{name.replace('_', ' ')} {estimate}" + (" at the end of its range" if estimate.at_bound else "")
            for name, estimate in sorted(own.items(), key=lambda item: item[1].aside)
            if not numbers_a_form(name, estimate)
        ]
        if parts:
            found.append((f"{in_words(owner)}: " if several else "") + ", ".join(parts))
    return found
