"""Nodes and supports of a CalculiX (or Abaqus) input deck: ``*NODE``, ``*NSET``, ``*BOUNDARY``, ``*INCLUDE``."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError

REFUSED = ("*PART", "*INSTANCE", "*NCOPY", "*NGEN")
"""What moves or makes nodes in ways that are not followed here."""


@dataclass(frozen=True, eq=False)
class Deck:
    """What a deck says of nodes.

    Parameters
    ----------
    nodes : dict of int to (3,) array
        Coordinates [m].
    sets : dict of str to list of int
        Node sets, in capitals.
    held : set of (node, direction)
        What supports hold; directions 1 to 6.
    """

    nodes: dict[int, FloatArray] = field(default_factory=dict)
    sets: dict[str, list[int]] = field(default_factory=dict)
    held: set[tuple[int, int]] = field(default_factory=set)

    def members(self, name: str, where: str) -> list[int]:
        """Return the nodes that a number or the name of a set stands for."""
        if name.lstrip("-").isdigit():
            return [int(name)]
        if name.upper() not in self.sets:
            raise StudyError(
                f"{where}: no *NSET {name}; define it before, or write a node table (CSV) instead"
            )
        return self.sets[name.upper()]


def read_deck(path: Path) -> Deck:
    """Read nodes, node sets and supports of a deck and of the files it includes.

    Raises
    ------
    StudyError
        If there is no node, or a card that moves nodes or makes some.
    """
    deck, turned = Deck(), set[int]()
    for card, options, line, where in _lines(path, depth=0):
        if card == "*NODE":
            number, place = _node(line, where)
            deck.nodes[number] = place
            if "NSET" in options:
                deck.sets.setdefault(options["NSET"], []).append(number)
        elif card == "*NSET" and "NSET" in options:
            deck.sets.setdefault(options["NSET"], []).extend(_listed(line, options, deck, where))
        elif card == "*BOUNDARY":
            deck.held.update(_held(line, deck, where))
        elif card == "*TRANSFORM":
            turned.update(deck.members(options.get("NSET", ""), where))
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


def _lines(path: Path, *, depth: int) -> Iterator[tuple[str, dict[str, str], str, str]]:
    """Yield every data line with its card, the card's options, and where it stands."""
    card, options = "", dict[str, str]()
    try:
        text = path.read_text(encoding="latin-1")
    except OSError as error:
        raise StudyError(f"{path}: cannot be read ({error.strerror})") from error
    for number, raw in enumerate(text.splitlines(), start=1):
        line, where = raw.strip(), f"{path}, line {number}"
        if line.startswith("**") or not line:
            continue
        if not line.startswith("*"):
            yield card, options, line, where
            continue
        card, options = _card(line)
        if card in REFUSED or (card == "*NODE" and options.get("SYSTEM", "R") != "R"):
            raise StudyError(f"{where}: {line} is not followed; write a node table (CSV) instead")
        if card == "*INCLUDE" and depth < 8:
            yield from _lines(path.parent / line.partition("=")[2].strip().strip("\"'"), depth=depth + 1)


def _card(line: str) -> tuple[str, dict[str, str]]:
    card, *options = (part.strip().upper() for part in line.split(","))
    pairs = (option.partition("=") for option in options)
    return card, {key.strip(): value.strip() for key, _, value in pairs}


def _node(line: str, where: str) -> tuple[int, FloatArray]:
    try:
        number, *place = (part for part in line.replace(" ", "").split(",") if part)
        coordinates = [float(p.upper().replace("D", "E")) for p in place[:3]]
        return int(number), np.array([*coordinates, 0.0, 0.0, 0.0][:3])
    except ValueError as error:
        raise StudyError(f"{where}: {line!r} is no node, number and x, y, z") from error


def _listed(line: str, options: dict[str, str], deck: Deck, where: str) -> list[int]:
    parts = [part.strip() for part in line.split(",") if part.strip()]
    if "GENERATE" in options:
        try:
            first, last, *step = (int(part) for part in parts)
        except ValueError as error:
            raise StudyError(f"{where}: {line!r} is no first, last and step") from error
        return list(range(first, last + 1, step[0] if step else 1))
    return [node for part in parts for node in deck.members(part, where)]


def _held(line: str, deck: Deck, where: str) -> Iterator[tuple[int, int]]:
    name, *numbers = (part.strip() for part in line.split(","))
    try:
        first = int(numbers[0])
        last = int(numbers[1]) if len(numbers) > 1 and numbers[1] else first
    except (ValueError, IndexError) as error:
        raise StudyError(f"{where}: {line!r} is no node or set with its first and last direction") from error
    for node in deck.members(name, where):
        yield from ((node, direction) for direction in range(first, min(last, 6) + 1))
