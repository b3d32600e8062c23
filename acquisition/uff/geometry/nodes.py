"""The nodes of several data sets as one geometry, in the global system."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.geometry import Geometry
from acquisition.uff.functions.units import Units
from acquisition.uff.geometry.systems import Placed, System, place_system


@dataclass(frozen=True, eq=False, kw_only=True)
class NodeSet:
    """Nodes as they stand in a data set 15 or 2411.

    Parameters
    ----------
    number : int
        Data set number.
    place : str
        File, data set and line, for messages.
    nodes : (n,) int array
        Node numbers.
    coordinates : (n, 3) array
        As in the file [file's unit].
    given, moving : (n,) int arrays
        Labels of the systems of the coordinates and of the displacements.
    systems : dict
        Coordinate systems of the same file, filled in while it is read.
    units : Units
        The file's units.
    placed : dict
        Those systems in global terms, kept as they are worked out.
    """

    number: int
    place: str
    nodes: IntArray
    coordinates: FloatArray
    given: IntArray
    moving: IntArray
    systems: Mapping[int, System]
    units: Units
    placed: dict[int, Placed | str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Nodes:
    """One geometry, which nodes are turned by right angles, and what was odd."""

    geometry: Geometry
    right: Mapping[int, FloatArray]
    notes: tuple[str, ...]

    def turn(self, dof: Dof) -> Dof:
        """Return a degree of freedom with its direction in the global system, where that is an axis."""
        axes = self.right.get(dof.node)
        if axes is None or dof.axis < 0:
            return dof
        row = dof.sign * axes[dof.axis % 3]
        axis = int(np.abs(row).argmax())
        code = axis + 1 + (3 if dof.axis > 2 else 0)
        return Dof(dof.node, code if row[axis] > 0 else -code)


def merge_nodes(sets: Iterable[NodeSet], lines: Sequence[IntArray]) -> Nodes:
    """Return the nodes of all sets; where one is given two places, the first counts and a warning is given."""
    places: dict[int, FloatArray] = {}
    axes: dict[int, FloatArray] = {}
    notes: list[str] = []
    twice: dict[int, str] = {}
    for one in sets:
        where = _global_places(one, notes)
        for row in np.flatnonzero(np.isfinite(where).all(axis=-1)):
            node, place = int(one.nodes[row]), where[row]
            known = places.setdefault(node, place)
            if not np.allclose(known, place, rtol=1e-6, atol=1e-9):
                twice.setdefault(node, f"{known.tolist()} and at {place.tolist()}")
        _gather_axes(one, places, axes, notes)
    if twice:
        first, where_else = next(iter(twice.items()))
        others = f"; so are nodes {_named([n for n in twice if n != first])}" if len(twice) > 1 else ""
        notes.append(f"node {first} is given at {where_else} [m]; the first is used{others}")
    right = {n: a for n, a in axes.items() if np.array_equal(np.abs(a), np.abs(a).round())}
    skew = {n: a for n, a in axes.items() if n not in right}
    own = np.array([skew.get(n, np.eye(3)) for n in places]).reshape(-1, 3, 3) if skew else None
    if skew:
        notes.append(
            f"nodes {_named(list(skew))} have local axes that are not parallel to the global ones: there the codes +X, "
            "+Y, +Z mean local directions"
        )
    drawn, lost = _known_lines(lines, places)
    if lost:
        notes.append(f"{lost} lines end at nodes without coordinates; they are left out")
    coordinates = np.array(list(places.values()), dtype=np.float64).reshape(-1, 3)
    return Nodes(Geometry(tuple(places), coordinates, drawn, own), right, tuple(notes))


def turned(nodes: Nodes, dofs: Iterable[Dof]) -> str:
    """State which of the nodes of some degrees of freedom had their directions turned; empty if none."""
    which = sorted({dof.node for dof in dofs if nodes.turn(dof) != dof})
    if not which:
        return ""
    return f"directions at nodes {_named(which)} are turned from their own coordinate systems into the global one"


def _named(nodes: Sequence[int]) -> str:
    return ", ".join(map(str, nodes[:8])) + (f" and {len(nodes) - 8} others" if len(nodes) > 8 else "")


def _global_places(one: NodeSet, notes: list[str]) -> FloatArray:
    """Return global coordinates [m]; nan where they are not determined."""
    places = one.coordinates / one.units.length
    for label in np.unique(one.given).tolist():
        rows = one.given == label
        system = _find(one, label, rows, notes)
        if system is None or system.is_global:
            continue
        if one.number == 2411:  # its coordinates are those of the part, whatever the export system
            notes.append(
                f"{one.place}: nodes {_named(one.nodes[rows].tolist())} name export system {label}; their coordinates "
                "are taken as global, as data set 2411 has it"
            )
            continue
        local = one.coordinates[rows].copy()
        local /= (
            np.array([1, 1, 1]) * one.units.length
            if system.kind == 0
            else one.units.length ** np.array([1, 0, 1])
        )
        try:
            places[rows] = system.to_global(local)
        except InputError as error:
            notes.append(
                f"{one.place}: nodes {_named(one.nodes[rows].tolist())} are given in {error}; left out"
            )
            places[rows] = np.nan
    return places


def _gather_axes(
    one: NodeSet, places: Mapping[int, FloatArray], axes: dict[int, FloatArray], notes: list[str]
) -> None:
    """Collect the axes of the nodes whose displacements are not given in the global system."""
    for label in np.unique(one.moving).tolist():
        rows = one.moving == label
        system = _find(one, label, rows, notes)
        if system is None:
            continue
        for node in one.nodes[rows].tolist():
            try:
                own = system.directions(places[node]) if node in places else np.eye(3)
            except InputError as error:
                notes.append(f"{one.place}: directions at node {node} are given in {error}; taken as global")
                continue
            if np.abs(own - own.round()).max() < 1e-4:
                own = own.round() + 0.0
            if not np.array_equal(own, np.eye(3)):
                axes.setdefault(node, own)


def _find(one: NodeSet, label: int, rows: FloatArray, notes: list[str]) -> Placed | None:
    """Return a system of the file; 0, and 1 where the file defines none, are the global one."""
    if label == 0 or (label not in one.systems and label == 1):
        return None
    try:
        return place_system(one.systems, label, one.placed)
    except InputError as error:
        nodes = _named(one.nodes[rows].tolist())
        notes.append(f"{one.place}: nodes {nodes}: {error}; the global one is taken")
        return None


def _known_lines(lines: Sequence[IntArray], places: Mapping[int, FloatArray]) -> tuple[IntArray, int]:
    """Return the lines between nodes that have coordinates, each once, and how many others there are."""
    every = np.unique(np.concatenate([np.zeros((0, 2), np.int64), *lines]), axis=0)
    known = np.isin(every, np.array(list(places), dtype=np.int64)).all(axis=1)
    return every[known], int((~known).sum())
