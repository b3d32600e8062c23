"""Numbers of a deck that can be turned: thicknesses, springs, masses, where a node set lies."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from scipy.spatial import KDTree

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.models.imported.deck import Deck
from updating.models.imported.decks.cards import Card, Cards, number_word
from updating.models.imported.decks.mesh import Mesh, edges_of, family_of
from updating.models.imported.decks.regions import cells_of

AXES = ("x", "y", "z")

GAUGES = (0.6, 0.8, 1.0, 1.25, 1.6)
"""Factors on a thickness for which a deck is run [-]. On a flat shell, K holds the powers -1 to 3 of the thickness and
M 1 to 3 (expanded to a solid: strains across it over t, rotations of joined edges times t, volume), so five runs are
exact; they reach from the next gauge down to the next one up, beyond which rounding grows."""

SHARE = 0.3
"""How far a node set may be moved, of the distance to the nearest node that stays [-]: at 1 an element is flat; beyond
a third the shape of the elements, not that of the part, begins to show in the frequencies."""

BY_POSITION = ("*TIE", "*MPC", "*RIGID BODY", "*COUPLING", "*DISTRIBUTING COUPLING")
"""Constraints whose coefficients follow from where nodes are."""

WIDE = (1e-3, 1e3)
"""Bounds of factors on springs, whose stiffness is often known to no order of magnitude [-]."""

USUAL = (0.05, 20.0)
"""Bounds of factors on masses [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DeckParameter:
    """A number of a deck, and how the matrices follow it.

    Parameters
    ----------
    name : str
        As the user writes it, ``web.thickness``.
    kind : str
        What it is: ``thickness``, ``thickness_1``, ``thickness_2``, ``stiffness``, ``mass``, ``x``, ``y``, ``z``.
    unit : str
        Of ``nominal`` times a factor, or of a shift.
    nominal : float
        What a factor multiplies [unit]; 1 for a shift.
    relative : bool
        Whether the value is a factor, 1 in the deck; else a shift, 0 in the deck.
    low, high : float
        Bounds of the value.
    samples : (n,) tuple of float
        Values for which the deck is run; the matrices at others are combinations of these.
    powers : (n,) tuple of int
        Powers of the value that the matrices are made of.
    changed : callable
        Takes the cards of a deck and a value to cards.
    elements : frozenset of int
        Elements whose material it goes with: those of a thickness, or those that a move of nodes changes.
    scale : float
        What values are divided by before they are raised to powers [unit].
    """

    name: str
    kind: str
    unit: str
    nominal: float
    relative: bool
    low: float
    high: float
    samples: tuple[float, ...]
    powers: tuple[int, ...]
    changed: Callable[[Cards, float], Cards]
    elements: frozenset[int] = frozenset()
    scale: float = 1.0

    @property
    def start(self) -> float:
        """The value that leaves the deck as it is."""
        return 1.0 if self.relative else 0.0

    def weights(self, value: float) -> FloatArray:
        """Return the shares of the samples in the matrices at a value, shape (n,) [-]."""
        samples, powers = np.array(self.samples) / self.scale, np.array(self.powers)
        table = samples[:, None] ** powers
        return np.asarray(np.linalg.solve(table.T, (value / self.scale) ** powers))


def parameter_of(
    mesh: Mesh, deck: Deck, name: str, units: Mapping[str, float], named: Mapping[str, frozenset[int]]
) -> DeckParameter | None:
    """Return the number of a deck that a name stands for, None where it is no such name.

    Parameters
    ----------
    mesh, deck : Mesh, Deck
        Elements and nodes of the deck.
    name : str
        ``SET.thickness`` of shells, ``SET.thickness_1``, ``SET.thickness_2`` of rectangular beams,
        ``SET.stiffness`` of springs, ``SET.mass`` of point masses, ``NODESET.x`` (y, z).
    units : mapping
        ``length`` [m] and ``stiffness`` [N/m] and ``mass`` [kg] of the deck's units.
    named : mapping of str to frozenset
        Elements of the study's regions by their names.

    Raises
    ------
    StudyError
        If the set does not exist, or holds nothing of the kind.
    """
    head, _, tail = name.rpartition(".")
    if not head:
        return None
    if tail in AXES:
        return _moved(mesh, deck, name, head, tail, units["length"])
    if tail in ("stiffness", "mass"):
        return _point(mesh, name, head, tail, units[tail])
    if tail in ("thickness", "thickness_1", "thickness_2"):
        elements = named.get(head, frozenset()) or mesh.set_named(head, name)
        return _thickness(mesh, name, tail, elements, units["length"])
    return None


SECTION_OF = MappingProxyType(
    {
        "thickness": (("*SHELL SECTION", "*MEMBRANE SECTION"), 0),
        "thickness_1": (("*BEAM SECTION",), 0),
        "thickness_2": (("*BEAM SECTION",), 1),
    }
)
"""Cards that hold a thickness, and the number in their first line."""


def _thickness(mesh: Mesh, name: str, kind: str, elements: frozenset[int], length: float) -> DeckParameter:
    """Return the thickness of the shells, or a side of the beams, among some elements."""
    cards, column = SECTION_OF[kind]
    own = [s for s in mesh.sections if s.card.name in cards and s.elements & elements]
    if not own:
        raise StudyError(f"{name}: no element of it has a {' or '.join(cards)}; it has no {kind} to change")
    nominal = own[0].card.number(0, column)

    def changed(deck: Cards, value: float) -> Cards:
        return cells_of(
            deck, mesh, elements,
            lambda card: (
                card.with_number(0, column, value * card.number(0, column)) if card.name in cards else card
            ),
        )  # fmt: skip

    return DeckParameter(
        name=name,
        kind=kind,
        unit="m",
        nominal=nominal * length,
        relative=True,
        low=GAUGES[0],
        high=GAUGES[-1],
        samples=GAUGES,
        powers=(-1, 0, 1, 2, 3),
        changed=changed,
        elements=elements & frozenset[int]().union(*(s.elements for s in own)),
    )


def _point(mesh: Mesh, name: str, head: str, kind: str, unit: float) -> DeckParameter:
    """Return the constant of springs, or the mass of point masses: matrices are linear in them."""
    wanted = {"stiffness": "*SPRING", "mass": "*MASS"}[kind]
    cards = [one for one in mesh.cards if one.name == wanted]
    own = [one for one in cards if one.options.get("ELSET") == head.upper() and one.lines]
    if not own:
        known = ", ".join(one.options.get("ELSET", "") for one in cards) or "none"
        raise StudyError(f"{name}: no {wanted}, ELSET={head} in {mesh.source}; there are: {known}")
    if any("NONLINEAR" in one.options for one in own):
        raise StudyError(f"{name}: {own[0].where}: a nonlinear spring has no single stiffness to change")
    line = len(own[0].lines) - 1 if kind == "stiffness" else 0
    nominal = own[0].number(line, 0)

    def changed(deck: Cards, value: float) -> Cards:
        return tuple(
            one.with_number(line, 0, value * nominal)
            if one.name == wanted and one.options.get("ELSET") == head.upper() and one.lines
            else one
            for one in deck
        )

    low, high = WIDE if kind == "stiffness" else USUAL
    symbol = {"stiffness": "N/m", "mass": "kg"}[kind]
    return DeckParameter(
        name=name,
        kind=kind,
        unit=symbol,
        nominal=nominal * unit,
        relative=True,
        low=low,
        high=high,
        samples=(1.0, 2.0),
        powers=(0, 1),
        changed=changed,
    )


def _moved(mesh: Mesh, deck: Deck, name: str, head: str, axis: str, length: float) -> DeckParameter:
    """Return where a node set lies: a shift of all its nodes along an axis."""
    if head.upper() not in deck.sets:
        known = ", ".join(list(deck.sets)[:8]) or "none"
        raise StudyError(f"{name}: no node set {head}; there are: {known}")
    moved = _with_middles(mesh, dict.fromkeys(deck.members(head, name), 1.0))
    rest = np.array([at for node, at in deck.nodes.items() if node not in moved]).reshape(-1, 3)
    if not len(rest) or not moved:
        raise StudyError(
            f"{name}: the set contains {'every' if moved else 'no'} node, so moving it changes no shape"
        )
    near, _ = KDTree(rest).query(
        np.array([deck.nodes[node] for node, share in moved.items() if share == 1.0])
    )
    ends = SHARE * float(np.min(near)) * length
    column = AXES.index(axis)

    def changed(cards: Cards, value: float) -> Cards:
        return tuple(
            _shifted(one, moved, column, value / length) if one.name == "*NODE" else one for one in cards
        )

    samples = tuple((ends * np.array([-1.0, -0.6, 0.0, 0.6, 1.0])).tolist())
    return DeckParameter(
        name=name, kind=axis, unit="m", nominal=1.0, relative=False, low=-ends, high=ends, samples=samples,
        powers=(0, 1, 2, 3, 4), changed=changed,
        elements=_reshaped(mesh, moved.keys()), scale=ends,
    )  # fmt: skip


def _reshaped(mesh: Mesh, moved: Collection[int]) -> frozenset[int]:
    """Return the elements whose matrices a move of nodes changes.

    A shell or beam also turns the normals that it shares with its neighbours; constraints by position may change any.
    """
    if any(one.name in BY_POSITION for one in mesh.cards):
        return frozenset(n for n, (kind, _) in mesh.elements.items() if _has_shape(kind))
    touched = _touching(mesh, frozenset(moved))
    thin = (mesh.elements[n][1] for n in touched if family_of(mesh.elements[n][0]) in ("S", "B"))
    around = _touching(mesh, frozenset(node for nodes in thin for node in nodes))
    return touched | frozenset(n for n in around if family_of(mesh.elements[n][0]) in ("S", "B"))


def _touching(mesh: Mesh, nodes: frozenset[int]) -> frozenset[int]:
    """Return the elements with a shape that have one of some nodes."""
    return frozenset(
        n for n, (kind, own) in mesh.elements.items() if _has_shape(kind) and not nodes.isdisjoint(own)
    )


def _has_shape(kind: str) -> bool:
    """Return whether the matrices of a type of element depend on where its nodes are."""
    return bool(family_of(kind)) or kind == "SPRINGA"


def _with_middles(mesh: Mesh, moved: dict[int, float]) -> dict[int, float]:
    """Let nodes in the middle of elements' edges follow the ends: shares of the shift by node."""
    shares = dict(moved)
    for kind, nodes in mesh.elements.values():
        for middle, one, other in edges_of(kind, nodes):
            share = (moved.get(one, 0.0) + moved.get(other, 0.0)) / 2
            if share and middle not in moved:
                shares[middle] = share
    return shares


def _shifted(one: Card, moved: Mapping[int, float], column: int, shift: float) -> Card:
    """Return a ``*NODE`` card with some nodes moved."""
    lines = []
    for line, words in zip(one.lines, one.rows(), strict=True):
        share = moved.get(int(words[0]), 0.0)
        if share:
            numbers = [float(w.upper().replace("D", "E") or 0.0) for w in (*words[1:4], "0", "0")][:3]
            numbers[column] += share * shift
            lines.append(", ".join([words[0], *(number_word(n) for n in numbers)]))
        else:
            lines.append(line)
    return replace(one, lines=tuple(lines))
