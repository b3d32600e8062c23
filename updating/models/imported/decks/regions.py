"""Regions of a deck, element sets, and the deck in which one of them alone has stiffness and mass."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from acquisition.errors import StudyError
from updating.models.imported.decks.cards import Card, Cards, card
from updating.models.imported.decks.mesh import MODULI, OF_MATERIAL, SECTIONS, Mesh

NEXT_TO_NOTHING = 1e-12
"""Factor on modulus and density of what is left out of a part: the rows stay, the matrices vanish [-]."""

LINE = 12
"""Numbers on a line of a set [-]."""


@dataclass(frozen=True, eq=False)
class DeckRegion:
    """A part of a deck.

    Parameters
    ----------
    name : str
        As the user writes it.
    elements : frozenset of int
        Its elements; all of them have a section.
    materials : tuple of str
        Its materials, in capitals.
    """

    name: str
    elements: frozenset[int]
    materials: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Division:
    """A deck divided into regions that share no element and together hold all that has a section.

    Parameters
    ----------
    mesh : Mesh
        The deck.
    regions : tuple of DeckRegion
        The regions.
    """

    mesh: Mesh
    regions: tuple[DeckRegion, ...]

    def made_of(self, material: str) -> tuple[int, ...]:
        """Return the regions made of a material; empty where there is no such material.

        Raises
        ------
        StudyError
            If one of them holds another material, too.
        """
        own = tuple(i for i, region in enumerate(self.regions) if material.upper() in region.materials)
        mixed = [self.regions[i] for i in own if len(self.regions[i].materials) > 1]
        if mixed:
            raise StudyError(
                f"{material}: region {mixed[0].name!r} consists of {' and '.join(mixed[0].materials)}; to change "
                "one of them alone, give each material a region of its own"
            )
        return own

    def part(self, region: int) -> Cards:
        """Return the deck in which every other region, and every mass and spring, is next to nothing."""
        points = ("*MASS", "*SPRING", "*DASHPOT")
        names = {name: f"MKM{number}" for number, name in enumerate(self.mesh.materials)}
        others = [c for name in names for c in _lessened_material(self.mesh.materials[name], names[name])]
        cards = tuple(_lessened(one) if one.name in points else one for one in self.mesh.cards)
        rest = frozenset(self.mesh.elements) - self.regions[region].elements

        def lessened(section: Card) -> Card:
            return _section(section, section.options["ELSET"], names[section.options["MATERIAL"]])

        return cells_of((*cards, *others), self.mesh, rest, lessened)


def cells_of(cards: Cards, mesh: Mesh, elements: frozenset[int], change: Callable[[Card], Card]) -> Cards:
    """Return a deck in which the sections of some elements are changed, those of all others as they are.

    Parameters
    ----------
    cards : Cards
        The deck, whose sections hold the elements that ``mesh`` states.
    mesh : Mesh
        The deck as it was read.
    elements : frozenset of int
        Elements whose sections change.
    change : callable
        Takes the card of a section to another.
    """
    order = [one for one in cards if one.name in SECTIONS]
    kept = [one for one in cards if one.name not in SECTIONS]
    added, taken = list[Card](), frozenset[int]()
    for number, one in reversed(list(enumerate(order))):
        own = _elements_of(one.options["ELSET"], cards, mesh)
        own, taken = own - taken, taken | own
        for inside, cell in ((own & elements, "A"), (own - elements, "B")):
            if inside:
                name = f"MKC{len(cards)}N{number}{cell}"
                new = _section(one, name, one.options.get("MATERIAL", ""))
                added = [_set(name, inside), change(new) if cell == "A" else new, *added]
    return (*kept, *added)


def _elements_of(name: str, cards: Cards, mesh: Mesh) -> frozenset[int]:
    """Return the elements of a set of the deck, or of one that was added since it was read."""
    if name in mesh.sets:
        return mesh.sets[name]
    own = (one for one in cards if one.name == "*ELSET" and one.options.get("ELSET") == name)
    return frozenset(int(word) for one in own for row in one.rows() for word in row)


def divide(mesh: Mesh, stated: Sequence[tuple[str, str]]) -> Division:
    """Divide a deck as a study states, and what the study leaves out by its sections.

    Parameters
    ----------
    mesh : Mesh
        The deck.
    stated : sequence of (name, set)
        Regions, and the element set or material each of them is.

    Raises
    ------
    StudyError
        If there is no such set, two regions share an element, one has no section, or a deck has none.
    """
    if not mesh.sections:
        raise StudyError(
            f"{mesh.source}: no section gives an element a material; regions are made of *SOLID, *SHELL, *BEAM or "
            "*MEMBRANE SECTION"
        )
    if layered := [s for s in mesh.sections if not s.material]:
        raise StudyError(
            f"{layered[0].card.where}: a section of several layers has no one material; export its matrices and use "
            'type = "matrices"'
        )
    for section in mesh.sections:
        if section.material not in mesh.materials:
            raise StudyError(f"{section.card.where}: no *MATERIAL {section.material}{mesh.choice()}")
    made = frozenset[int]().union(*(s.elements for s in mesh.sections))
    regions, taken = list[DeckRegion](), dict[int, str]()
    for name, wanted in stated:
        elements = _wanted(mesh, name, wanted) & made
        if not elements:
            raise StudyError(
                f"[[model.region]] {name!r}: no element of {wanted} has a section in {mesh.source}"
            )
        if twice := sorted(elements & taken.keys()):
            raise StudyError(
                f"[[model.region]] {name!r} and {taken[twice[0]]!r} share element {twice[0]} ({len(twice)} in all); "
                "regions may not overlap"
            )
        taken |= dict.fromkeys(elements, name)
        regions.append(_region(mesh, name, elements))
    for section in mesh.sections:
        if rest := section.elements - taken.keys():
            regions.append(_region(mesh, _spare(section.card, [r.name for r in regions]), rest))
    return Division(mesh, tuple(regions))


def _wanted(mesh: Mesh, name: str, wanted: str) -> frozenset[int]:
    """Return the elements of a set, or of what is made of a material."""
    if wanted.upper() in mesh.sets:
        return mesh.sets[wanted.upper()]
    if wanted.upper() in mesh.materials:
        own = [s.elements for s in mesh.sections if s.material == wanted.upper()]
        return frozenset[int]().union(*own)
    raise StudyError(f"[[model.region]] {name!r}: no element set or material {wanted}{mesh.choice()}")


def _region(mesh: Mesh, name: str, elements: frozenset[int]) -> DeckRegion:
    made = dict.fromkeys(s.material for s in mesh.sections if s.elements & elements)
    return DeckRegion(name, elements, tuple(made))


def _spare(section: Card, taken: Sequence[str]) -> str:
    """Return a name for what no region of the study holds: its element set, as the deck writes it."""
    written = next(
        value.strip()
        for key, _, value in (part.partition("=") for part in section.head.split(","))
        if key.strip().upper() == "ELSET"
    )
    name, number = written, 2
    while name in taken:
        name, number = f"{written}#{number}", number + 1
    return name


def _lessened(one: Card) -> Card:
    """Return a card of masses or springs with next to nothing in it."""
    line = 0 if one.name == "*MASS" else len(one.lines) - 1
    return one.with_number(line, 0, NEXT_TO_NOTHING * one.number(line, 0)) if one.lines else one


def _lessened_material(cards: Cards, name: str) -> list[Card]:
    """Return a material that weighs and resists next to nothing."""
    return [card(f"*MATERIAL, NAME={name}"), *scaled(cards[1:], NEXT_TO_NOTHING, NEXT_TO_NOTHING)]


def scaled(cards: Cards, stiffness: float, mass: float) -> list[Card]:
    """Return the cards of a material, its moduli and its density multiplied, whatever else is in them left out."""
    found = []
    for one in cards:
        if one.name == "*DENSITY":
            found.append(_multiplied(one, 1, {0}, mass))
        elif one.name == "*ELASTIC":
            kind = one.options.get("TYPE", "ISO")
            if kind not in MODULI:
                raise StudyError(
                    f"{one.where}: *ELASTIC, TYPE={kind} is not supported; known: {', '.join(MODULI)}"
                )
            found.append(_multiplied(one, *MODULI[kind], stiffness))
        elif one.name not in OF_MATERIAL:
            found.append(one)
    return found


def _multiplied(one: Card, each: int, which: set[int], factor: float) -> Card:
    """Return a card with some of the numbers of every ``each`` lines of eight multiplied."""
    changed = one
    for line, row in enumerate(one.rows()):
        first = 8 * (line % each)
        for column, word in enumerate(row):
            if word and first + column in which:
                changed = changed.with_number(line, column, factor * one.number(line, column))
    return changed


def _set(name: str, elements: frozenset[int]) -> Card:
    numbers = sorted(elements)
    lines = [", ".join(map(str, numbers[i : i + LINE])) + "," for i in range(0, len(numbers), LINE)]
    return card(f"*ELSET, ELSET={name}", *lines)


def _section(one: Card, elements: str, material: str) -> Card:
    """Return a section for other elements of another material, all else as it is."""
    options = {**one.options, "ELSET": elements, "MATERIAL": material}
    head = ", ".join([one.name, *(f"{k}={v}" if v else k for k, v in options.items())])
    return replace(card(head), lines=one.lines)
