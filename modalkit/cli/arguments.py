"""Checks of the words of a command before the command is loaded: options, files, band, study.

A command loads the numerical libraries, which takes seconds; a misspelt option, a file that is not there, a band in the
wrong order or a key that a study does not have is refused without them.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from acquisition.errors import InputError, cannot_open

HELP = ("--help", "-h")


@dataclass(frozen=True)
class Words:
    """What is typed behind a command.

    Parameters
    ----------
    positional : tuple of str
        Files, studies and folders.
    values : mapping of str to tuple of str
        The values of each option.
    """

    positional: tuple[str, ...]
    values: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def options_of(spelt: str) -> dict[str, int]:
    """Return how many values each option of a command takes, from ``"--band 2, --check, --output -o 1"``."""
    table: dict[str, int] = {}
    for entry in filter(None, spelt.split(", ")):
        names = [word for word in entry.split() if word.startswith("-")]
        count = entry.split()[-1]
        table |= dict.fromkeys(names, int(count) if count.isdigit() else 0)
    return table


def words_of(arguments: Sequence[str], options: Mapping[str, int]) -> Words | None:
    """Return the words of a command by their meaning; None where help is asked for.

    Raises
    ------
    InputError
        If an option is none of the command.
    """
    positional: list[str] = []
    values: dict[str, tuple[str, ...]] = {}
    rest = list(arguments)
    while rest:
        word = rest.pop(0)
        if word in HELP:
            return None
        if word == "--":
            return Words((*positional, *rest), values)
        name, given, value = word.partition("=")
        if name in options:
            count = options[name] - bool(given)
            values[name] = (*([value] if given else []), *rest[: max(count, 0)])
            del rest[: max(count, 0)]
        elif not _OPTION.match(word):
            positional.append(word)
        elif word[:2] not in options:  # else one of a letter with its value, -oFILE
            close = difflib.get_close_matches(name, options, n=1)
            raise InputError(f"No such option: {name}" + (f"; is {close[0]} meant?" if close else ""))
    return Words(tuple(positional), values)


def check_words(words: Words) -> None:
    """Refuse files that are not there, a band in the wrong order, and a study with a mistake in it.

    Raises
    ------
    InputError
        If a file is not there, or the band is none.
    StudyError
        If a study cannot be read.
    """
    for name in (*words.positional, *words.values.get("--layout", ())):
        _check_there(Path(name))
    if band := words.values.get("--band"):
        _check_band(band)
    for path in (Path(name) for name in words.positional):
        if path.suffix.lower() == ".toml":
            from modalkit.study.read import read_study

            read_study(path)


def _check_there(path: Path) -> None:
    try:
        path.stat()
    except (OSError, ValueError) as error:
        raise cannot_open(path, error) from None


def _check_band(band: Sequence[str]) -> None:
    """Refuse two limits of which the first is not the lower one; other words are for the command to read."""
    found = [_LIMIT.fullmatch(limit) for limit in band]
    if len(found) != 2 or not all(found):
        return
    low, high = (float(one[1]) * (1e3 if one[2] == "kHz" else 1.0) for one in found if one is not None)
    if not low < high:
        raise InputError(f"Invalid band {low:g} to {high:g} Hz: the lower limit comes first")


_OPTION = re.compile(r"-(?!$|\.?\d)")
"""What an option begins with; a lone ``-`` and a negative number are none."""

_LIMIT = re.compile(r"(\d+\.?\d*(?:[eE][+-]?\d+)?)\s*(|Hz|kHz)")
"""A limit of a band without the table of units, which takes a second to load."""
