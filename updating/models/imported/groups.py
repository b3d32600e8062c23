"""Places of imported matrices that node sets name, and joints between two of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from scipy import sparse
from scipy.spatial import KDTree

from acquisition.arrays import BoolArray, FloatArray, IntArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.placing import Places
from updating.models.imported.sets import NodeSets

COMPACT = 0.25
"""A node set that reaches farther than this, of the structure, is no place at which something sits [-]: a foot, a
flange or a bolt circle is smaller. Doubled, sides and edges of a structure count as places."""

TOGETHER = 1e-6
"""Two nodes so near to each other, of the structure's size, are at one place [-]."""

FELT = 1e-6
"""A support is held in a direction by more than this share of what holds it most [-]: the rest is rounding."""

NUMBERED = "support "
"""What a support without a node set of its own is called, before its number."""

SEPARATORS = "_-. "
"""Marks between the words of a name."""

ANY_STIFFNESS = 1e-12
"""What is left of a spring below this share of the largest stiffness is none [-]."""


@dataclass(frozen=True, eq=False)
class Group:
    """A node set that is a place.

    Parameters
    ----------
    name : str
        Its name.
    centre : (3,) array
        Its middle [m].
    rows : tuple of 6 sparse arrays, each (1, n_dofs)
        Mean motion of its nodes along x, y, z and about them; empty where the matrices do not have it.
    """

    name: str
    centre: FloatArray
    rows: tuple[Sparse, ...]

    def moves(self, axis: int) -> bool:
        """Return whether it can move along an axis 0, 1, 2, or turn about it, 3, 4, 5."""
        return bool(self.rows[axis].nnz)

    def motions(self, axes: Sequence[int]) -> Sparse:
        """Return its mean motions along, or about, some axes (n_axes, n_dofs)."""
        return Sparse(sparse.vstack([self.rows[axis] for axis in axes]))


@dataclass(frozen=True, eq=False)
class Joint:
    """Nodes of two sets that are at the same places, and the springs between them.

    Parameters
    ----------
    name : str
        What the names of the two sets have in common, or both.
    sides : tuple of str
        The two sets.
    centre : (3,) array
        Its middle [m].
    springs : tuple of two sparse arrays, each (n_dofs, n_dofs)
        Springs of the translations and of the rotations: those of the matrices where there are some, else of 1 N/m or
        1 N m/rad in every direction in which both sides can move; empty where they cannot.
    stiffness : tuple of two float
        Of these, the mean over directions of the sum over nodes; zero where the matrices have none [N/m, N m/rad].
    """

    name: str
    sides: tuple[str, str]
    centre: FloatArray
    springs: tuple[Sparse, Sparse]
    stiffness: tuple[float, float]


def set_nodes(places: Places, sets: NodeSets, name: str) -> IntArray:
    """Return the indices, among the places, of the nodes of a set.

    Raises
    ------
    StudyError
        If there is no such set.
    """
    if name not in sets:
        raise StudyError(f"no node set {name!r}; the model has {', '.join(sets) or 'none'}")
    return np.flatnonzero(np.isin(places.node, sets[name]))


def group_of(places: Places, sets: NodeSets, name: str) -> Group:
    """Return a node set as a place."""
    return group_of_nodes(places, name, set_nodes(places, sets, name))


def group_of_nodes(places: Places, name: str, index: IntArray) -> Group:
    """Return nodes (n,), by their indices among the places, as one place."""
    mean = Sparse(np.full((1, len(index)), 1 / max(len(index), 1)))
    rows = []
    for motion in (*places.moves, *places.turns):
        row = Sparse(mean @ motion[index])
        row.eliminate_zeros()
        rows.append(row)
    return Group(name, places.at[index].mean(axis=0), tuple(rows))


def groups_of(places: Places, sets: NodeSets) -> tuple[Group, ...]:
    """Return the node sets that are places: compact, and free to move."""
    reach = COMPACT * float(np.ptp(places.at, axis=0).max())
    found = []
    for name in sets:
        index = set_nodes(places, sets, name)
        if len(index) and float(np.ptp(places.at[index], axis=0).max()) <= reach:
            group = group_of(places, sets, name)
            found += [group] if any(group.moves(axis) for axis in range(3)) else []
    return tuple(found)


def joints_of(places: Places, sets: NodeSets, stiffness: Sparse) -> tuple[Joint, ...]:
    """Return the joints: pairs of node sets with every node of one at the place of a node of the other."""
    found = []
    nodes = {name: set_nodes(places, sets, name) for name in sets}
    for first, second in combinations(sets, 2):
        pairs = _pairs(places, nodes[first], nodes[second])
        if pairs:
            sides = [_springs(places, pairs, axes, stiffness) for axes in (range(3), range(3, 6))]
            centre = places.at[[a for a, _ in pairs]].mean(axis=0)
            springs, sizes = zip(*sides, strict=True)
            found.append(Joint(common_name(first, second), (first, second), centre, springs, sizes))
    names = [joint.name for joint in found]
    return tuple(
        replace(joint, name="/".join(joint.sides)) if names.count(joint.name) > 1 else joint
        for joint in found
    )


def _pairs(places: Places, first: IntArray, second: IntArray) -> list[tuple[int, int]]:
    """Return which nodes of two sets are at one place, nothing unless all of one of the sets are."""
    if not len(first) or not len(second) or len(np.intersect1d(first, second)):
        return []
    near = TOGETHER * float(np.ptp(places.at, axis=0).max())
    trees = [KDTree(places.at[nodes]) for nodes in (first, second)]
    alike = trees[0].query_ball_tree(trees[1], near)
    pairs = [(int(a), int(second[j])) for a, own in zip(first, alike, strict=True) for j in sorted(own)]
    whole = len({a for a, _ in pairs}) == len(first) or len({b for _, b in pairs}) == len(second)
    return pairs if whole else []


def _springs(
    places: Places, pairs: Sequence[tuple[int, int]], axes: range, stiffness: Sparse
) -> tuple[Sparse, float]:
    """Return springs (n_dofs, n_dofs) between pairs of nodes along or about axes, and their size."""
    every = (*places.moves, *places.turns)
    ways = [(a, b, axis) for axis in axes for a, b in pairs if every[axis][[a]].nnz and every[axis][[b]].nnz]
    total = Sparse(stiffness.shape)
    if not ways:
        return total, 0.0
    least = ANY_STIFFNESS * float(np.abs(stiffness.diagonal()).max())
    found = [
        -float((every[axis][[a]] @ stiffness @ every[axis][[b]].T).toarray()[0, 0]) for a, b, axis in ways
    ]
    held = any(size > least for size in found)
    for (a, b, axis), size in zip(ways, found, strict=True):
        across = every[axis][[a]] - every[axis][[b]]
        total = Sparse(total + (max(size, 0.0) if held else 1.0) * (across.T @ across))
    directions = len({axis for (_, _, axis), size in zip(ways, found, strict=True) if size > least})
    return total, sum(size for size in found if size > least) / max(directions, 1)


def common_name(first: str, second: str) -> str:
    """Return what two names begin with, up to the last separator that they share; both where that is nothing."""
    same = next((i for i, (a, b) in enumerate(zip(first, second, strict=False)) if a != b), 0)
    whole = max((first.rfind(mark, 0, same) for mark in SEPARATORS), default=-1)
    begin = first[: max(whole, 0)].rstrip(SEPARATORS)
    return begin or f"{first}/{second}"


@dataclass(frozen=True, eq=False, kw_only=True)
class Support:
    """Nodes that a support holds, and what the structure pulls at it when it moves as one body.

    Parameters
    ----------
    name : str
        Of the node set that holds most of them, or a number.
    centre : (3,) array
        Its middle [m].
    loads : (n_dofs, 6) array
        Forces on the structure, negative, when the support shifts along x, y, z or turns about them by one.
    own : (6, 6) array
        Forces on the support at the same.
    mass : (6, 6) array
        Mass of the rows that are held, when they move so [kg, kg m, kg m^2].
    inertia : (n_dofs, 6) array
        Their mass in common with the rows beside them.
    held_by, carried_by : (n_parts + 1,) arrays
        Share of each part in ``own`` and in ``mass``, the last that of none; the mean over the directions [-].
    """

    name: str
    centre: FloatArray
    loads: FloatArray
    own: FloatArray
    mass: FloatArray
    inertia: FloatArray
    held_by: FloatArray
    carried_by: FloatArray

    def holds(self, axis: int) -> bool:
        """Return whether the structure resists its shift along an axis 0, 1, 2, or its turn about it, 3, 4, 5."""
        alike = np.diag(self.own)[:3] if axis < 3 else np.diag(self.own)[3:]
        return bool(self.own[axis, axis] > FELT * alike.max())


def supports_of(
    places: Places,
    sets: NodeSets,
    stiffness: Sparse,
    mass: Sparse,
    parts: tuple[Sequence[Sparse], Sequence[Sparse]],
) -> tuple[Support, ...]:
    """Return the supports whose rows the matrices have lost, each as it would move if it were one body.

    A structure that moves as a rigid body together with its supports feels no force: with the rows f that are left and
    h that are held, K_ff R_f + K_fh R_h = 0. So what K_fh R_h was is known from what is left, and where several groups
    of nodes are held, each has the rows next to it.
    """
    moves = np.array([np.asarray(m.sum(axis=1)).ravel() > 0 for m in places.moves])
    held = np.flatnonzero(places.known[:3].any(axis=0) & ~moves.any(axis=0))
    rigid = rigid_motions(places, stiffness.shape[0])
    if not len(held) or rigid is None:
        return ()
    gathered = list(neighbourhoods(places, held))
    middles = np.array([places.at[group].mean(axis=0) for group in gathered])
    at, nodes = places_of_rows(places, stiffness.shape[0]), nodes_of_rows(places, stiffness.shape[0])
    away = np.stack([KDTree(places.at[group]).query(at)[0] for group in gathered])
    owner = away.argmin(axis=0)
    found = []
    for number, (group, centre) in enumerate(zip(gathered, middles, strict=True)):
        about = rigid_motions(places, stiffness.shape[0], centre)
        assert about is not None
        loads = np.where((owner == number)[:, None], stiffness @ about, 0.0)
        if np.abs(loads).max() > 0:
            own = loads.T @ about
            near = np.where((owner == number)[:, None], about, 0.0)
            pulled = (np.abs(loads[:, :3]) > FELT * np.abs(loads[:, :3]).max()).any(axis=1)
            beside = np.isin(nodes, nodes[pulled])
            moved, heavy, inertia = _mirrored(places, mass, at, (group, centre), beside)
            name = _named(places, sets, group, number)
            support = Support(
                name=name,
                centre=centre,
                loads=loads,
                own=(own + own.T) / 2,
                mass=heavy,
                inertia=inertia,
                held_by=_shares(near, parts[0], about),
                carried_by=_shares(moved, parts[1], moved),
            )
            found.append(support)
    return tuple(found)


def _shares(left: FloatArray, parts: Sequence[Sparse], right: FloatArray) -> FloatArray:
    """Return each part's share in the diagonal of left^T A right, the mean over its directions, (n_parts,) [-]."""
    each = np.array([np.sum(left * (part @ right), axis=0) for part in parts])
    whole = each.sum(axis=0)
    there = whole > FELT**2 * whole.max()
    return np.asarray((each[:, there] / whole[there]).mean(axis=1))


def _mirrored(
    places: Places, mass: Sparse, at: FloatArray, support: tuple[IntArray, FloatArray], beside: BoolArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return how the rows beside a support move with it, what its held rows weigh, and what they do with those beside.

    A rigid body has no more force in its mass than it has mass, so that, unlike their stiffness, the mass of the rows
    that are lost is not known. It is taken from the rows ``beside`` them as if the mesh went on evenly: they carry
    twice what the held ones do, and have as much in common with those inside as with those held. So in frames, whose
    nodes turn; beside the face of a brick there are more nodes than are held, and it is so node for node.
    """
    group, centre = support
    nearest = places.at[group][KDTree(places.at[group]).query(at)[1]]
    held = rigid_motions(places, mass.shape[0], centre, nearest)
    assert held is not None
    mirror = np.where(held[:, :3].any(axis=1), 1.0, -1.0)[:, None]  # a rotation is the other way round in it
    own, inside = np.where(beside[:, None], held, 0.0), np.where(beside[:, None], 0.0, held)
    turning = any(np.asarray(turn.sum(axis=0)).ravel()[beside].any() for turn in places.turns)
    neighbours = np.unique(nodes_of_rows(places, mass.shape[0])[beside])
    share = 1.0 if turning else min(1.0, len(group) / max(len(neighbours), 1))
    inertia = share * np.where(beside[:, None], mirror * (mass @ (mirror * inside)), 0.0)
    return own, share * own.T @ (mass @ own) / 2, inertia


def rigid_motions(
    places: Places, order: int, centre: FloatArray | None = None, at: FloatArray | None = None
) -> FloatArray | None:
    """Return the motions of a rigid body, along x, y, z and about them through a point, (n_dofs, 6).

    With rows at other places ``at`` (n_dofs, 3) [m], where these are given. None where some row is at no place.
    """
    found, seen = np.zeros((order, 6)), np.zeros(order, dtype=bool)
    middle = np.zeros(3) if centre is None else centre
    for axis in range(3):
        for motion, turn in ((places.moves[axis], False), (places.turns[axis], True)):
            entries = motion.tocoo()
            seen[entries.col] = True
            if turn:
                found[entries.col, 3 + axis] = 1.0
                continue
            arm = (places.at[entries.row] if at is None else at[entries.col]) - middle
            found[entries.col, axis] = 1.0
            for about in range(3):
                found[entries.col, 3 + about] = np.cross(np.eye(3)[about], arm)[:, axis]
    return found if seen.all() else None


def places_of_rows(places: Places, order: int) -> FloatArray:
    """Return where every row of the matrices is, nan where that is not known, (n_dofs, 3) [m]."""
    at = np.full((order, 3), np.nan)
    for motion in (*places.moves, *places.turns):
        entries = motion.tocoo()
        at[entries.col] = places.at[entries.row]
    return at


def nodes_of_rows(places: Places, order: int) -> IntArray:
    """Return to which of the places every row of the matrices belongs, -1 where that is not known, (n_dofs,)."""
    node = np.full(order, -1)
    for motion in (*places.moves, *places.turns):
        entries = motion.tocoo()
        node[entries.col] = entries.row
    return node


def neighbourhoods(places: Places, nodes: IntArray) -> Iterator[IntArray]:
    """Gather nodes that are near each other: nearer than a share of the structure."""
    reach = COMPACT * float(np.ptp(places.at, axis=0).max())
    left = nodes
    while len(left):
        group, edge = left[:1], left[:1]
        left = left[1:]
        while len(edge) and len(left):
            near = KDTree(places.at[edge]).query(places.at[left])[0] <= reach / 2
            edge, left = left[near], left[~near]
            group = np.concatenate([group, edge])
        yield np.sort(group)


def _named(places: Places, sets: NodeSets, group: IntArray, number: int) -> str:
    numbers = places.node[group]
    alike = {
        name: len(np.intersect1d(nodes, numbers)) / len(np.union1d(nodes, numbers))
        for name, nodes in sets.items()
    }
    best = max(alike, key=lambda name: alike[name], default="")
    return best if best and alike[best] > 0.5 else f"{NUMBERED}{number + 1}"
