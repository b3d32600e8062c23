"""Nodes and supports of a CalculiX (or Abaqus) input deck: ``*NODE``, ``*NSET``, ``*BOUNDARY``, ``*INCLUDE``."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.models.imported.include import deck_lines, is_include
from updating.models.imported.numerals import NUMBER

REFUSED = ("*PART", "*INSTANCE", "*NCOPY", "*NGEN")
"""What moves or makes nodes in ways that are not followed here."""

FOLLOWED = ("*NODE", "*NSET", "*BOUNDARY", "*TRANSFORM", "*INCLUDE")
"""What is followed."""

ALIKE = ("*BOUNDARYF", "*NODEFILE", "*NODEPRINT", "*NODEOUTPUT", "*INCLUDES")
"""Cards of other meaning whose names are as close to those that are followed as a slip of the pen."""

_NAME = re.compile(r"\*[^\W\d_][^\d]*")
"""Names of cards: words, without a digit."""

OPTIONS = ("NSET", "GENERATE", "SYSTEM", "INPUT")
"""Options that are followed."""

KNOWN_OPTIONS = {
    "*NODE": {"NSET", "SYSTEM", "INPUT"},
    "*NSET": {"NSET", "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED"},
    "*BOUNDARY": {"OP", "AMPLITUDE", "TIME DELAY", "LOAD CASE", "FIXED", "TYPE", "USER"},
    "*TRANSFORM": {"NSET", "TYPE"},
    "*INCLUDE": {"INPUT"},
}
"""Options that the cards followed may have, of CalculiX and Abaqus; any other one is refused, since lines that ran
into each other look like it."""

DIRECTIONS = range(1, 12)
"""Directions of a support: 1 to 6 are motions, the rest temperatures and pressures, which are passed over."""


@dataclass(frozen=True, eq=False)
class Deck:
    """What a deck states about nodes.

    Parameters
    ----------
    nodes : dict of int to (3,) array
        Coordinates [m].
    sets : dict of str to list of range
        Node sets, in capitals; what a set names beyond the nodes is nothing.
    held : set of (node, direction)
        What supports hold; directions 1 to 6.
    """

    nodes: dict[int, FloatArray] = field(default_factory=dict)
    sets: dict[str, list[range]] = field(default_factory=dict)
    held: set[tuple[int, int]] = field(default_factory=set)

    def ranges(self, name: str, where: str) -> list[range]:
        """Return the numbers that a node's number or the name of a set stands for."""
        if name.isdecimal() and len(name) < 19:
            return [range(int(name), int(name) + 1)]
        if name.upper() not in self.sets:
            raise StudyError(
                f"{where}: no *NSET {name} above this line; define it there, or write a node table (CSV) instead"
            )
        return self.sets[name.upper()]

    def members(self, name: str, where: str) -> Iterator[int]:
        """Yield the nodes among them; as many steps as there are nodes or numbers, whichever are fewer."""
        for numbers in self.ranges(name, where):
            if len(numbers) == 1 and numbers[0] not in self.nodes:
                raise StudyError(f"{where}: node {numbers[0]} is in no *NODE card above this line")
            few, many = (
                (numbers, self.nodes) if len(numbers) < len(self.nodes) else (self.nodes.keys(), numbers)
            )
            yield from (node for node in few if node in many)


def read_deck(path: Path) -> Deck:
    """Read nodes, node sets and supports of a deck and of the files it includes.

    Raises
    ------
    StudyError
        If there is no node, a card that moves nodes or makes some, or a file that includes itself.
    """
    deck, turned = Deck(), set[int]()
    card, options, filled, seen = "", dict[str, str](), True, set[tuple[str, ...]]()
    in_step = False
    for line, where in deck_lines(path):
        if is_include(line):  # its text stands here: the card before it goes on
            _check_card(*_card(line), line, where)
            continue
        if line.startswith("*"):
            _check_filled(card, options, filled, where)
            card, options = _card(line)
            _check_card(card, options, line, where)
            in_step = _step(card, where, in_step=in_step)
            filled = False
            continue
        if card == "*END STEP":
            raise StudyError(f"{where}: {line[:40]!r} stands after *END STEP and belongs to no card")
        filled = True
        if card in ("*BOUNDARY", "*TRANSFORM"):  # a line stated twice holds nothing more
            if (once := (card, options.get("NSET", ""), line.upper())) in seen:
                continue
            seen.add(once)
        if card == "*NODE":
            number = _place(deck, line, where)
            if "NSET" in options:
                deck.sets.setdefault(options["NSET"], []).append(range(number, number + 1))
        elif card == "*NSET":
            deck.sets.setdefault(options["NSET"], []).extend(_listed(line, options, deck, where))
            seen.clear()
        elif card == "*BOUNDARY":
            deck.held.update(_held(line, deck, where))
        elif card == "*TRANSFORM":
            turned.update(deck.members(options.get("NSET", ""), where))
    _check_filled(card, options, filled, str(path))
    if not deck.nodes:
        raise StudyError(f"{path}: no *NODE card; give the deck that holds the mesh, or a node table (CSV)")
    _forget_turned(deck, turned)
    return deck


def _forget_turned(deck: Deck, turned: set[int]) -> None:
    """Leave out supports along a node's own axes unless they hold all three; the matrices' rows stay along x, y, z."""
    for node in turned:
        along = {(node, direction) for direction in (1, 2, 3)}
        if not along <= deck.held:
            deck.held.difference_update(along)


def _card(line: str) -> tuple[str, dict[str, str]]:
    card, *options = (part.strip().upper() for part in line.split(","))
    pairs = (option.partition("=") for option in options)
    return card, {key.strip(): value.strip() for key, _, value in pairs}


def _check_filled(card: str, options: dict[str, str], filled: bool, where: str) -> None:
    """Refuse a card of nodes or supports without a line: what stood under it is lost."""
    needed = card in ("*NODE", "*NSET") or (card == "*BOUNDARY" and "OP" not in options)
    if needed and not filled:
        raise StudyError(f"{where}: {card} without a line before this; the deck is damaged or cut short")


def _step(card: str, where: str, *, in_step: bool) -> bool:
    """Return whether a step is open behind a card, and refuse the end of one that never began."""
    if card == "*END STEP" and not in_step:
        raise StudyError(
            f"{where}: {card} without a *STEP before it; the deck is damaged, lines of it are lost"
        )
    return card == "*STEP" or (in_step and card != "*END STEP")


def _check_card(card: str, options: dict[str, str], line: str, where: str) -> None:
    """Refuse what is not followed, and a card whose name is a slip of the pen away from one that is."""
    if not _NAME.fullmatch(card) or any(option.isdecimal() for option in options):
        raise StudyError(f"{where}: {line[:40]!r} is not a card; the file is damaged or cut short")
    if card in REFUSED or (card == "*NODE" and options.get("SYSTEM", "R") != "R"):
        raise StudyError(f"{where}: {line[:80]} is not supported; write a node table (CSV) instead")
    for word, known in ((card, FOLLOWED), *((option, OPTIONS) for option in options)):
        plain = " ".join(word.split())[:40]
        close = [one for one in known if _lost_a_piece(plain, one)] or difflib.get_close_matches(
            plain, known, n=1, cutoff=0.75
        )
        if plain and close and word not in known and plain.replace(" ", "") not in ALIKE:
            raise StudyError(f"{where}: {plain} is unknown; is {close[0]} meant?")
    strange = [option for option in options if option and option not in KNOWN_OPTIONS.get(card, options)]
    if strange:
        raise StudyError(
            f"{where}: {card} with {strange[0][:40]} is not supported; write a node table (CSV) instead"
        )
    if card == "*NSET" and not options.get("NSET"):
        raise StudyError(f"{where}: {line[:80]} names no set; write *NSET, NSET=name")
    if card in FOLLOWED and "" in options:
        raise StudyError(f"{where}: {line[:80]} ends in a comma; what follows it is missing")


def _lost_a_piece(word: str, whole: str) -> bool:
    """Return whether a word is another without one piece of it."""
    lost = len(whole) - len(word)
    return lost > 0 and any(word == whole[:i] + whole[i + lost :] for i in range(1, len(word) + 1))


def _place(deck: Deck, line: str, where: str) -> int:
    """Put a node down, once or where it stands, and return its number; coordinates left out are zero."""
    word, *place = (part.strip() for part in line.rstrip(", ").split(","))
    right = word.isdecimal() and len(word) < 19 and 1 <= len(place) <= 3
    if not right or not all(NUMBER.fullmatch(p) for p in place):
        raise StudyError(f"{where}: {line[:80]!r} is not a node line (number, x, y, z)")
    number, found = int(word), [float(p.upper().replace("D", "E")) for p in place]
    coordinates = np.array([*found, 0.0, 0.0][:3])
    if number in deck.nodes and not np.array_equal(deck.nodes[number], coordinates):
        raise StudyError(f"{where}: node {number} was defined before at another place; keep one of the two")
    deck.nodes[number] = coordinates
    return number


def _listed(line: str, options: dict[str, str], deck: Deck, where: str) -> Iterable[range]:
    parts = [part.strip() for part in line.rstrip(", ").split(",")]
    if "GENERATE" not in options:
        return [numbers for part in parts if part for numbers in deck.ranges(part, where)]
    if not 2 <= len(parts) <= 3 or not all(part.isdecimal() and len(part) < 19 for part in parts):
        raise StudyError(f"{where}: {line[:80]!r} is not a range of first, last and step")
    first, last, step = (*(int(part) for part in parts), 1)[:3]
    if first > last or not step:
        raise StudyError(f"{where}: {line[:80]!r} contains no node: it runs from {first} to {last} by {step}")
    return [range(first, last + 1, step)]


def _held(line: str, deck: Deck, where: str) -> Iterator[tuple[int, int]]:
    name, *numbers = (part.strip() for part in line.split(","))
    ends = numbers[:1] + [number for number in numbers[1:2] if number or len(numbers) == 2]
    if not ends or not all(end.isdecimal() and len(end) < 3 and int(end) in DIRECTIONS for end in ends):
        raise StudyError(
            f"{where}: {line[:80]!r} is not a node or set with its first and last direction, 1 to 6"
        )
    if [
        value for value in numbers[2:] if value and not re.fullmatch(r"[+-]?0*\.?0*([EeDd][+-]?\d+)?", value)
    ]:
        raise StudyError(
            f"{where}: {line[:80]!r} prescribes a displacement other than zero; leave the value out"
        )
    first, last = int(ends[0]), int(ends[-1])
    if first > last:
        raise StudyError(f"{where}: {line[:80]!r} has its last direction ({last}) before its first ({first})")
    for node in deck.members(name, where):
        yield from ((node, direction) for direction in range(first, min(last, 6) + 1))
