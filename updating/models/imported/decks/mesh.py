"""Elements, element sets, sections and materials of a deck."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.errors import StudyError
from updating.models.imported.decks.cards import Card, Cards

SECTIONS = ("*SOLID SECTION", "*SHELL SECTION", "*BEAM SECTION", "*MEMBRANE SECTION")
"""Cards that give elements a material."""

NODES = {
    "B21": 2, "B31": 2, "B31R": 2, "B32": 3, "B32R": 3, "T2D2": 2, "T3D2": 2, "T3D3": 3, "MASS": 1,
    "SPRING1": 1, "SPRING2": 2, "SPRINGA": 2, "DASHPOTA": 2, "GAPUNI": 2, "DCOUP3D": 1,
}  # fmt: skip
"""Number of nodes of the elements whose names do not end in it."""

_COUNTED = re.compile(r"(?:C3D|CPS|CPE|CAX|M3D|S)(\d+)[A-Z]*")
"""Names of elements that hold the number of their nodes."""

EDGES = {
    "C3D20": ((1, 2), (2, 3), (3, 4), (4, 1), (5, 6), (6, 7), (7, 8), (8, 5), (1, 5), (2, 6), (3, 7), (4, 8)),
    "C3D15": ((1, 2), (2, 3), (3, 1), (4, 5), (5, 6), (6, 4), (1, 4), (2, 5), (3, 6)),
    "C3D10": ((1, 2), (2, 3), (3, 1), (1, 4), (2, 4), (3, 4)),
    "S8": ((1, 2), (2, 3), (3, 4), (4, 1)),
    "S6": ((1, 2), (2, 3), (3, 1)),
}
"""Ends of the edges of elements with nodes in the middle of them, in the order of these nodes, counted from 1."""

MODULI = {"ISO": (1, {0}), "ORTHO": (2, set(range(9))), "ANISO": (3, set(range(21))),
          "ENGINEERING CONSTANTS": (2, {0, 1, 2, 6, 7, 8})}  # fmt: skip
"""Lines of eight numbers under ``*ELASTIC`` by its type, and which of the numbers are moduli."""


@dataclass(frozen=True, eq=False)
class Section:
    """A section: which elements are made of which material.

    Parameters
    ----------
    card : Card
        Its card.
    elements : frozenset of int
        Elements that no later section takes over.
    """

    card: Card
    elements: frozenset[int]

    @property
    def name(self) -> str:
        """The element set, in capitals."""
        return self.card.options["ELSET"]

    @property
    def material(self) -> str:
        """The material, in capitals; empty for layers of several."""
        return self.card.options.get("MATERIAL", "")


@dataclass(frozen=True, eq=False)
class Mesh:
    """What a deck states about elements.

    Parameters
    ----------
    cards : Cards
        The model of the deck.
    source : str
        The file, for messages.
    """

    cards: Cards
    source: str

    @cached_property
    def sets(self) -> dict[str, frozenset[int]]:
        """Elements of every element set, by its name in capitals."""
        return {name: frozenset(numbers) for name, numbers in self._read[1].items()}

    @cached_property
    def elements(self) -> dict[int, tuple[str, tuple[int, ...]]]:
        """Type and nodes of every element."""
        return self._read[0]

    @cached_property
    def _read(self) -> tuple[dict[int, tuple[str, tuple[int, ...]]], dict[str, list[int]]]:
        elements: dict[int, tuple[str, tuple[int, ...]]] = {}
        sets: dict[str, list[int]] = {}
        for one in self.cards:
            if one.name == "*ELEMENT":
                found = _elements(one)
                elements |= found
                if "ELSET" in one.options:
                    sets.setdefault(one.options["ELSET"], []).extend(found)
            elif one.name == "*ELSET":
                if not one.options.get("ELSET"):
                    raise StudyError(f"{one.where}: {one.head[:60]} names no set; write *ELSET, ELSET=name")
                sets.setdefault(one.options["ELSET"], []).extend(_members(one, sets))
        return elements, sets

    @cached_property
    def sections(self) -> tuple[Section, ...]:
        """The sections, each with the elements that it has in the end: a later card takes over from an earlier one.

        Raises
        ------
        StudyError
            If one names no element set that there is.
        """
        found, taken = list[Section](), frozenset[int]()
        for one in reversed([c for c in self.cards if c.name in SECTIONS]):
            own = self.set_named(one.options.get("ELSET", ""), one.where)
            found.append(Section(one, own - taken))
            taken |= own
        return tuple(reversed([s for s in found if s.elements]))

    @cached_property
    def materials(self) -> dict[str, Cards]:
        """The cards of every material by its name in capitals, ``*MATERIAL`` first."""
        found: dict[str, list[Card]] = {}
        current: list[Card] | None = None
        for one in self.cards:
            if one.name == "*MATERIAL":
                current = found.setdefault(one.options.get("NAME", ""), [])
                current.append(one)
            elif one.name in OF_MATERIAL and current is not None:
                current.append(one)
            else:
                current = None
        return {name: tuple(cards) for name, cards in found.items()}

    def set_named(self, name: str, where: str) -> frozenset[int]:
        """Return the elements of a set.

        Raises
        ------
        StudyError
            If there is none of that name.
        """
        if name.upper() not in self.sets:
            raise StudyError(f"{where}: no element set {name or '(none named)'}{self.choice()}")
        return self.sets[name.upper()]

    def choice(self) -> str:
        """Return the element sets and materials there are, for messages."""
        sets, materials = (", ".join(list(names)[:8]) for names in (self.sets, self.materials))
        return f" in {self.source}; element sets: {sets or 'none'}; materials: {materials or 'none'}"

    def property_of(self, material: str, card: str) -> float | None:
        """Return the modulus (``*ELASTIC``, isotropic) or density (``*DENSITY``) of a material, None without one."""
        for one in self.materials.get(material, ()):
            if one.name == card and one.options.get("TYPE", "ISO") == "ISO" and one.lines:
                return one.number(0, 0)
        return None


OF_MATERIAL = {
    "*ELASTIC", "*DENSITY", "*EXPANSION", "*CONDUCTIVITY", "*SPECIFIC HEAT", "*DAMPING", "*PLASTIC", "*CREEP",
    "*HYPERELASTIC", "*DEPVAR", "*USER MATERIAL", "*ELECTRICAL CONDUCTIVITY", "*CYCLIC HARDENING",
}  # fmt: skip
"""Cards that belong to the ``*MATERIAL`` before them."""


def family_of(kind: str) -> str:
    """Return ``C3D`` for solids, ``S`` for shells and membranes, ``B`` for beams and trusses, else nothing."""
    if kind in ("MASS", "GAPUNI", "DCOUP3D") or kind.startswith(("SPRING", "DASHPOT")):
        return ""
    return "C3D" if kind.startswith("C3D") else "B" if kind[0] in "BT" else "S"


def edges_of(kind: str, nodes: tuple[int, ...]) -> list[tuple[int, int, int]]:
    """Return the edges of an element that have a node in their middle: that node, and both ends."""
    family = family_of(kind)
    if family == "B" and len(nodes) == 3:
        return [(nodes[1], nodes[0], nodes[2])]
    ends = EDGES.get(f"{family}{len(nodes)}", ())
    corners = len(nodes) - len(ends)
    return [(nodes[corners + i], nodes[a - 1], nodes[b - 1]) for i, (a, b) in enumerate(ends)]


def _elements(one: Card) -> dict[int, tuple[str, tuple[int, ...]]]:
    """Return the elements of a card; one may run over several lines."""
    kind = one.options.get("TYPE", "")
    counted = _COUNTED.fullmatch(kind)
    count = NODES.get(kind) or (int(counted[1]) if counted else 0)
    if not count:
        raise StudyError(
            f"{one.where}: elements of type {kind or '(none named)'} are not supported; export the matrices and use "
            'type = "matrices"'
        )
    words = [word for row in one.rows() for word in row if word]
    try:
        table = np.array(words, dtype=np.int64).reshape(-1, count + 1)
    except (ValueError, OverflowError) as error:
        raise StudyError(
            f"{one.where}: {one.head[:60]}: {len(words)} words are not elements of {count} nodes each"
        ) from error
    return {row[0]: (kind, tuple(row[1:])) for row in table.tolist()}


def _members(one: Card, sets: dict[str, list[int]]) -> Iterable[int]:
    """Return the elements that an ``*ELSET`` names, by number, by range, or by another set."""
    found: list[int] = []
    for row in one.rows():
        if "GENERATE" in one.options:
            if not (2 <= len(row) <= 3 and all(word.isdecimal() for word in row)):
                raise StudyError(
                    f"{one.where}: {', '.join(row)[:60]!r} is not a range of first, last and step"
                )
            first, last, step = (*(int(word) for word in row), 1)[:3]
            found += range(first, last + 1, max(step, 1))
            continue
        for word in (w for w in row if w):
            if word.isdecimal():
                found.append(int(word))
            elif word.upper() in sets:
                found += sets[word.upper()]
            else:
                raise StudyError(f"{one.where}: no *ELSET {word[:40]} before this")
    return found
