"""Where a free structure given by matrices hangs, or lies: the places of its cords."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy import sparse
from scipy.spatial import KDTree

from acquisition.arrays import FloatArray, IntArray
from updating.models.fields import Sparse
from updating.models.imported.groups import COMPACT, Group, group_of_nodes, neighbourhoods, set_nodes
from updating.models.imported.placing import Places
from updating.models.imported.sets import NodeSets

MOST = 8
"""Cords of one suspension at most: a set of more places is a face, an edge or a row of bolts. Doubled, such sets count
as suspensions, too, and each costs a form for every direction."""

NUMBERED = re.compile(r"(.+?)[_\-. ]*\d+")
"""A name and its number: ``cord_1`` and ``cord_2`` are a suspension of two; a number alone names nothing."""

ENDS, CORNERS = "ends", "corners"
"""Name of a suspension without a name of its own: at both ends, or at the four corners."""


@dataclass(frozen=True, eq=False)
class Cords:
    """The places at which one suspension holds.

    Parameters
    ----------
    name : str
        Of the node set, or what the names of several have in common; ``ends`` or ``corners`` where it has no name.
    places : (n, 3) array
        Where its cords are [m].
    rows : tuple of 3 sparse arrays, each (n, n_dofs)
        Motion of each along x, y and z; empty where the matrices do not have it.
    named : bool
        Whether it has a name of its own.
    """

    name: str
    places: FloatArray
    rows: tuple[Sparse, ...]
    named: bool

    def moves(self, axis: int) -> bool:
        """Return whether each of its places can move along an axis 0, 1, 2."""
        return bool((np.diff(self.rows[axis].indptr) > 0).all())


def cords_of(places: Places, sets: NodeSets, groups: Sequence[Group]) -> tuple[Cords, ...]:
    """Return the suspensions that a structure may have.

    They are node sets of several places, places whose names differ in a number alone, and, where they have no names,
    the ends and the corners.

    Parameters
    ----------
    places : Places
        The nodes.
    sets : mapping of str to int array
        Node sets: the numbers of their nodes.
    groups : sequence of Group
        Those that are places.
    """
    single = {group.name for group in groups}
    spread = {name: _spread(places, set_nodes(places, sets, name)) for name in sets if name not in single}
    alike: dict[str, list[Group]] = {}
    for group in groups:
        if number := NUMBERED.fullmatch(group.name):
            alike.setdefault(number[1], []).append(group)
    alike, spread = (
        {name: held for name, held in some.items() if 2 <= len(held) <= MOST} for some in (alike, spread)
    )
    found = alike | spread
    unnamed = {name: held for name, held in _outermost(places) if name not in found}
    return (
        *(_together(name, held, named=True) for name, held in found.items()),
        *(_together(name, held, named=False) for name, held in unnamed.items()),
    )


def _spread(places: Places, nodes: IntArray) -> list[Group]:
    """Return the places into which the nodes of a set fall; none where one of them is no place."""
    reach = COMPACT * float(np.ptp(places.at, axis=0).max())
    found = list(neighbourhoods(places, nodes))
    if any(float(np.ptp(places.at[own], axis=0).max()) > reach for own in found):
        return []
    return [group_of_nodes(places, "", own) for own in found]


def _outermost(places: Places) -> Iterator[tuple[str, list[Group]]]:
    """Yield the nodes nearest to the middles of both ends, and to the corners of the two longest sides."""
    moving = np.flatnonzero(sum(np.asarray(m.sum(axis=1)).ravel() for m in places.moves) > 0)
    at = places.at[moving]
    low, high = at.min(axis=0), at.max(axis=0)
    longest = np.argsort(low - high, kind="stable")
    for name, axes in ((ENDS, longest[:1]), (CORNERS, longest[:2])):
        corners = np.tile((low + high) / 2, (2 ** len(axes), 1))
        corners[:, axes] = list(product(*zip(low[axes], high[axes], strict=True)))
        nearest = moving[np.unique(KDTree(at).query(corners)[1])]
        if len(nearest) == len(corners):
            yield name, [group_of_nodes(places, name, nearest[[i]]) for i in range(len(nearest))]


def _together(name: str, held: Sequence[Group], *, named: bool) -> Cords:
    rows = tuple(Sparse(sparse.vstack([group.rows[axis] for group in held])) for axis in range(3))
    return Cords(name, np.array([group.centre for group in held]), rows, named)
