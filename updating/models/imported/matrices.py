"""Stiffness and mass as another program wrote them, with the places of their rows."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.checks import check_mass, check_size, check_sum, symmetric, with_mass_everywhere
from updating.models.imported.cords import Cords, cords_of
from updating.models.imported.groups import (
    Group,
    Joint,
    Support,
    groups_of,
    joints_of,
    rigid_motions,
    supports_of,
)
from updating.models.imported.hollow import hold_hollow_rows
from updating.models.imported.nodes import NodeTable
from updating.models.imported.placing import Places
from updating.models.imported.rigid import free_motions, rank, without_forces
from updating.models.imported.rounding import decimal_rounding, relative_rounding

if TYPE_CHECKING:
    from updating.models.imported.decks.model import DeckModel


@dataclass(frozen=True, eq=False)
class Imported:
    """A structure given by its matrices.

    Parameters
    ----------
    stiffness, mass : (n, n) sparse arrays
        Of the whole structure on its supports [N/m, kg]; rows of rotations accordingly.
    nodes : NodeTable
        Where the rows are.
    stiffness_parts, mass_parts : tuple of (n, n) sparse arrays
        One of each region, in the order of the regions, or none; what the whole has beyond their sum belongs to
        no region.
    source : str
        For messages.
    deck : DeckModel, optional
        The deck that CalculiX made them of.
    decimal : float, optional
        Half a unit of the last digit of the stiffness's file, relative to the entry, 0 where it was not rounded; left
        out, that of the digits that the entries need [-].

    Attributes
    ----------
    left : float
        Relative error of the stiffness's entries in motions of a rigid body: ``decimal`` where these do not follow from
        the places of the rows, else what is left after rounding has been taken from them [-].
    unassigned : tuple of str
        ``E`` where the stiffness, ``density`` where the mass has something beyond the sum of its parts.

    Raises
    ------
    StudyError
        If the matrices differ in order, are not symmetric, singular or indefinite, or smaller than their parts.
    """

    stiffness: Sparse
    mass: Sparse
    nodes: NodeTable
    stiffness_parts: tuple[Sparse, ...] = ()
    mass_parts: tuple[Sparse, ...] = ()
    source: str = "model"
    deck: DeckModel | None = None
    decimal: float = -1.0
    left: float = field(init=False, default=0.0)
    massless: bool = field(init=False, default=False)
    unassigned: tuple[str, ...] = field(init=False, default=())
    rest: dict[str, Sparse | None] = field(init=False, default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("stiffness", "mass"):
            object.__setattr__(self, name, symmetric(getattr(self, name), f"{self.source}: {name}"))
            parts = tuple(
                symmetric(part, f"{self.source}: part {i + 1} of the {name}")
                for i, part in enumerate(getattr(self, f"{name}_parts"))
            )
            object.__setattr__(self, f"{name}_parts", parts)
        orders = self.stiffness.shape[0], self.mass.shape[0]
        if orders[0] != orders[1]:
            raise StudyError(
                f"{self.source}: the stiffness is of order {orders[0]} and the mass of order {orders[1]}; export both "
                "from one job"
            )
        check_size(self.stiffness, self.mass, self.source)
        self.nodes.check(orders[0])
        named = tuple(
            f"{self.source}: part {i + 1}"
            for i in range(max(len(self.stiffness_parts), len(self.mass_parts)))
        )
        for name, parts in (("stiffness", self.stiffness_parts), ("mass", self.mass_parts)):
            whole: Sparse = getattr(self, name)
            self.rest[name] = check_sum(whole, parts, named[: len(parts)], name)
        beyond = [
            factor
            for factor, name in (("E", "stiffness"), ("density", "mass"))
            if self.rest[name] is not None
        ]
        object.__setattr__(self, "unassigned", tuple(beyond))
        object.__setattr__(self, "massless", bool((self.mass.diagonal() == 0).any()))
        if self.decimal < 0:
            object.__setattr__(self, "decimal", decimal_rounding(self.stiffness))
        settled, unbalanced = self._settled_stiffness()
        object.__setattr__(self, "left", unbalanced)
        object.__setattr__(self, "stiffness", settled)
        bare = self.mass
        object.__setattr__(self, "mass", with_mass_everywhere(self.stiffness, bare, self.source))
        self.rest["given mass"] = bare
        if self.massless and self.mass_parts:
            left = self.rest["mass"]
            self.rest["mass"] = Sparse(self.mass - bare if left is None else left + self.mass - bare)
        if self.deck is None:  # a deck's is a sum of elements', each of positive mass
            check_mass(self.mass, self.source, self.row_places)

    def _settled_stiffness(self) -> tuple[Sparse, float]:
        """Return the stiffness without rounding in motions of a rigid body, and what is left of it.

        What has neither stiffness nor mass is held.
        """
        given, relative = self.stiffness, relative_rounding(self.stiffness, self.decimal)
        settled, left = self._without_rounding(relative) if self.decimal else (given, 0.0)
        empty = np.flatnonzero(abs(self.mass).sum(axis=1) == 0)
        if len(empty) and (settled.diagonal()[empty] > 0).all():
            settled = hold_hollow_rows(settled, empty, relative)
        if settled is not given:
            rest = self.rest["stiffness"]
            self.rest["stiffness"] = Sparse(settled - given if rest is None else rest + settled - given)
        return settled, left

    def _without_rounding(self, relative: float) -> tuple[Sparse, float]:
        """Return the stiffness without forces in the motions of a rigid body that nothing holds, and what is left.

        A body that nothing holds along any axis can turn as well; where the places deny that, they are rounded.
        """
        motions = rigid_motions(self.places, self.order)
        if motions is None:
            return self.stiffness, self.decimal
        free = free_motions(self.stiffness, motions, relative)
        if not free.size:
            return self.stiffness, 0.0
        settled, left = without_forces(self.stiffness, free)
        shifts = rank(motions[:, :3], self.stiffness)
        loose = free_motions(self.stiffness, motions[:, :3], relative).shape[1] == shifts
        denied = loose and free.shape[1] == shifts < rank(motions, self.stiffness)
        return settled, self.decimal if denied else left

    @property
    def order(self) -> int:
        """Number of degrees of freedom."""
        return int(self.stiffness.shape[0])

    @property
    def bare_mass(self) -> Sparse:
        """The mass as it was given, without what stands in for none [kg]."""
        bare = self.rest["given mass"]
        return self.mass if bare is None else bare

    def divided(self, kind: str) -> tuple[Sparse, ...]:
        """Return the parts of the stiffness or the mass, and what lies in none of them [SI]."""
        whole = self.stiffness if kind == "stiffness" else self.mass
        parts = self.stiffness_parts if kind == "stiffness" else self.mass_parts
        if not parts:
            return (whole,)
        rest = self.rest[kind]
        return (*parts, Sparse(whole.shape) if rest is None else rest)

    @cached_property
    def row_places(self) -> FloatArray:
        """Where the rows are, (n, 3), not a number where that is not known [m]."""
        found = np.full((self.order, 3), np.nan)
        there = self.nodes.row >= 0
        found[self.nodes.row[there]] = self.nodes.places[there]
        return found

    @cached_property
    def places(self) -> Places:
        """The nodes, as places at which the structure's motion is known."""
        places = Places.of(self.nodes, self.order)
        return places if self.deck is None else replace(places, elements=self.deck.elements)

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """The node sets that are places; of a joint, whose two sides are at one place, the first."""
        seconds = {joint.sides[1] for joint in self.joints}
        return tuple(group for group in groups_of(self.places, self.nodes.sets) if group.name not in seconds)

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """The joints between two node sets."""
        return joints_of(self.places, self.nodes.sets, self.stiffness)

    @cached_property
    def cords(self) -> tuple[Cords, ...]:
        """The suspensions that the structure may have, if it is free."""
        return cords_of(self.places, self.nodes.sets, self.groups)

    @cached_property
    def supports(self) -> tuple[Support, ...]:
        """The supports whose rows the matrices have lost."""
        parts = self.divided("stiffness"), self.divided("mass")
        return supports_of(self.places, self.nodes.sets, self.stiffness, self.mass, parts)

    @cached_property
    def extents(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest coordinates of the nodes, each (3,) [m]."""
        return self.nodes.places.min(axis=0), self.nodes.places.max(axis=0)

    @property
    def reach(self) -> float:
        """The largest of its extents [m]."""
        return float((self.extents[1] - self.extents[0]).max())

    @cached_property
    def main_axis(self) -> int:
        """The axis, 0 to 2, along which most rows move."""
        return int(
            np.argmax([np.sum((self.nodes.direction == a) & (self.nodes.row >= 0)) for a in (1, 2, 3)])
        )

    @cached_property
    def total_mass(self) -> float:
        """Mass that moves when everything moves along the axis of most rows; held nodes are not in it [kg]."""
        along = np.zeros(self.order)
        chosen = (self.nodes.direction == 1 + self.main_axis) & (self.nodes.row >= 0)
        along[self.nodes.row[chosen]] = 1.0
        return float(along @ (self.mass @ along))

    def obstacle(self, factor: str, *, regional: bool = False) -> str | None:
        """Return why a factor cannot be turned, or None."""
        if factor not in ("E", "density"):
            return f"imported matrices have no {factor}; they scale with E and density"
        name, parts = {
            "E": ("stiffness_parts", self.stiffness_parts),
            "density": ("mass_parts", self.mass_parts),
        }[factor]
        return f"needs {name} in [model], one file per region" if regional and not parts else None

    def box(self, region: int) -> tuple[FloatArray, FloatArray] | None:
        """Return the box of the nodes that a region's parts touch, each (3,) [m]; None without parts."""
        found = [parts[region] for parts in (self.stiffness_parts, self.mass_parts) if region < len(parts)]
        if not found:
            return None
        touched = np.zeros(self.order + 1, dtype=bool)
        for part in found:
            size = np.abs(part.diagonal())
            touched[:-1] |= size > 1e-9 * size.max(initial=1e-300)
        places = self.nodes.places[touched[self.nodes.row]]
        return (places.min(axis=0), places.max(axis=0)) if len(places) else None
