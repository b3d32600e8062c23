"""A deck as a model: its matrices, regions, materials and parameters, each made by CalculiX once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.checks import symmetric
from updating.models.imported.deck import Deck, read_deck
from updating.models.imported.decks.cards import Cards, read_cards, text_of
from updating.models.imported.decks.mesh import Mesh, family_of
from updating.models.imported.decks.parameters import DeckParameter, parameter_of
from updating.models.imported.decks.program import Stored, stored
from updating.models.imported.decks.regions import Division, divide
from updating.models.imported.elements import Elements
from updating.models.imported.nodes import NodeTable, deck_table
from updating.models.imported.units import SI, matrix_in_si, units_of


@dataclass(frozen=True, eq=False)
class DeckModel:
    """A deck that CalculiX turns into matrices, as it is and with other numbers in it.

    Parameters
    ----------
    path : Path
        The deck.
    nodes : Deck
        Nodes, node sets and supports.
    division : Division
        Its regions.
    units : str
        What it is written in.
    """

    path: Path
    nodes: Deck
    division: Division
    units: str = SI

    @property
    def mesh(self) -> Mesh:
        """Elements, sets, sections and materials."""
        return self.division.mesh

    @property
    def cards(self) -> Cards:
        """The model of the deck."""
        return self.mesh.cards

    @cached_property
    def base(self) -> Stored:
        """The matrices of the deck as it is, in its units."""
        return stored(text_of(self.cards), str(self.path))

    @cached_property
    def table(self) -> NodeTable:
        """Where the rows are, in the deck's units."""
        return deck_table(self.nodes, self.base.node, self.base.direction, str(self.path))

    @cached_property
    def elements(self) -> Elements:
        """The elements between the nodes [m]."""
        length, _ = units_of(self.units)
        members = [(family_of(kind), nodes) for kind, nodes in self.mesh.elements.values()]
        known = [(family, nodes) for family, nodes in members if family]
        return Elements({n: length * at for n, at in self.nodes.nodes.items()}, tuple(known))

    @property
    def whole(self) -> tuple[Sparse, Sparse]:
        """Stiffness and mass of the deck as it is [SI]."""
        return self._in_si(self.base)

    def part(self, region: int) -> tuple[Sparse, Sparse]:
        """Return stiffness and mass of a region alone [SI]."""
        return self._in_si(self._same_rows(self.division.part(region), self.division.regions[region].name))

    def regions_of(self, parameter: DeckParameter) -> frozenset[int | None]:
        """Return the regions that a number changes; None among them where it changes what belongs to no region."""
        shared = [len(parameter.elements & region.elements) for region in self.division.regions]
        inside = frozenset(i for i, count in enumerate(shared) if count)
        return inside if parameter.elements and sum(shared) == len(parameter.elements) else inside | {None}

    def parameter(self, name: str) -> DeckParameter | None:
        """Return the number of the deck that a name stands for; see :func:`parameter_of`."""
        length, force = units_of(self.units)
        scale = {"length": length, "stiffness": force / length, "mass": force / length}
        named = {region.name: region.elements for region in self.division.regions}
        return parameter_of(self.mesh, self.nodes, name, scale, named)

    def matrices(
        self, values: Mapping[DeckParameter, float], region: int | None = None
    ) -> tuple[Sparse, Sparse]:
        """Return stiffness and mass of the deck, or of a region alone, with other numbers in it [SI].

        Parameters
        ----------
        values : mapping of DeckParameter to float
            A factor or a shift of each.
        region : int, optional
            The region; left out, the deck.

        Raises
        ------
        StudyError
            If CalculiX does not solve it.
        """
        cards, words = self.cards if region is None else self.division.part(region), list[str]()
        for parameter, value in values.items():
            cards = parameter.changed(cards, value)
            words.append(f"{parameter.name} = {parameter.nominal * value:.4g} {parameter.unit}")
        return self._in_si(self._same_rows(cards, ", ".join(words)))

    def change(
        self, values: Mapping[DeckParameter, float], region: int | None = None
    ) -> tuple[Sparse, Sparse]:
        """Return what other numbers add to stiffness and mass of the deck, or of a region alone [SI]."""
        stiffness, mass = self.matrices(values, region)
        before = self.whole if region is None else self.part(region)
        return Sparse(stiffness - before[0]), Sparse(mass - before[1])

    def _same_rows(self, cards: Cards, what: str) -> Stored:
        found = stored(text_of(cards), f"{self.path} ({what})" if what else str(self.path))
        if not found.same_rows(self.base):
            raise StudyError(
                f"{self.path}: with {what}, ccx eliminates other degrees of freedom, because it joins shells of equal "
                "and of different thickness in different ways; make the deck's own thicknesses differ by a thousandth"
            )
        return found

    def _in_si(self, found: Stored) -> tuple[Sparse, Sparse]:
        return (
            matrix_in_si(symmetric(found.stiffness, f"{self.path}: stiffness"), self.table, self.units),
            matrix_in_si(symmetric(found.mass, f"{self.path}: mass"), self.table, self.units),
        )


def read_deck_model(path: Path, regions: Sequence[tuple[str, str]] = (), *, units: str = SI) -> DeckModel:
    """Read a deck; CalculiX runs when matrices are asked for.

    Parameters
    ----------
    path : Path
        The deck.
    regions : sequence of (name, set)
        Regions, and the element set or material each of them is; what they leave out becomes a region for each
        section.
    units : {"m-kg-s", "mm-t-s", "in-lbf-s"}
        What the deck is written in.

    Raises
    ------
    StudyError
        If the deck cannot be read, or a set does not exist.
    """
    units_of(units)
    mesh = Mesh(read_cards(path), str(path))
    model = DeckModel(path, read_deck(path), divide(mesh, regions), units)
    _check_nodes(model)
    return model


def _check_nodes(model: DeckModel) -> None:
    """See that the nodes of elements are there, without which CalculiX dies and does not say of what."""
    known = model.nodes.nodes.keys()
    for element, (_, nodes) in model.mesh.elements.items():
        if missing := [node for node in nodes if node not in known]:
            raise StudyError(
                f"{model.path}: element {element} has node {missing[0]}, which is in no *NODE card; add it "
                "or correct its number"
            )


def deck_matrices(path: Path, like: DeckModel) -> tuple[Sparse, Sparse]:
    """Return stiffness and mass of another deck on the rows of one: a hypothesis ``deck = "loose.inp"`` [SI].

    Raises
    ------
    StudyError
        If it cannot be read or solved, or has other rows.
    """
    other = read_deck_model(path, units=like.units)
    if not other.base.same_rows(like.base):
        raise StudyError(
            f"{path}: its matrices ({len(other.base.node)} rows) and those of {like.path} ({len(like.base.node)} rows) "
            "do not belong to the same nodes; give a deck on the same mesh and supports"
        )
    return other.whole


def parameter_matrices(model: DeckModel, name: str, value: float) -> tuple[Sparse, Sparse]:
    """Return stiffness and mass with one number changed: a hypothesis ``parameter = "web.thickness"`` [SI].

    Parameters
    ----------
    model : DeckModel
        The deck.
    name : str
        As in ``[update] parameters``.
    value : float
        In its unit, not as a factor: a thickness in m, a stiffness in N/m; of a coordinate the shift in m.

    Raises
    ------
    StudyError
        If there is no such number, or CalculiX does not solve the deck with it.
    """
    parameter = model.parameter(name)
    if parameter is None:
        raise StudyError(f"{model.path}: no parameter {name!r}; known: {KNOWN}")
    return model.matrices({parameter: value / parameter.nominal})


KNOWN = "SET.thickness, SET.thickness_1, SET.thickness_2, SET.stiffness, SET.mass, NODESET.x, NODESET.y, NODESET.z"
"""Numbers of a deck, for messages."""
