"""Nodes of imported matrices at which something may sit: test points and node sets, and the most promising others."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.spatial import KDTree

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.effects.structure.frequency_gap import frequency_gap
from updating.models.imported.groups import Group
from updating.models.imported.matrices import Imported
from updating.models.state import State
from updating.prediction.predict import Predictor

NAMED_SHARE = 0.5
"""Prior share of the places that somebody thought of, test points and node sets, the rest that of all other nodes [-]:
judged. Doubled, nothing sits between them."""

SOLVED = 40
"""Of so many nodes, the best to first order, frequencies are predicted. Doubled: at twice the time, a change so large
that first order misleads is found more surely."""

TRIED = (0.2, 0.4, 0.6, 0.8)
"""Quantiles of the prior of a size at which frequencies are predicted [-]."""

PROMISING = 6
"""So many of these are weighed by all data. Doubled: at twice the time, neighbours further off are among them."""

SAME = 1e-6
"""So near to each other, of the structure's size, two places are one [-]."""


def distinct(imported: Imported, places: FloatArray, others: FloatArray) -> IntArray:
    """Return the indices of places (n, 3) that are none of the others (m, 3) [m]."""
    if not len(others):
        return np.arange(len(places))
    away, _ = KDTree(others).query(places)
    return np.flatnonzero(away > SAME * imported.reach)


def distinct_groups(imported: Imported) -> tuple[Group, ...]:
    """Return the node sets that are places, of the two sides of a joint that the matrices tie the first alone."""
    tied = {joint.sides[1] for joint in imported.joints if joint.stiffness[0] > 0}
    return tuple(group for group in imported.groups if group.name not in tied)


def group_centres(imported: Imported) -> FloatArray:
    """Return the middles of the node sets that are places, (n, 3) [m]."""
    return np.array([group.centre for group in imported.groups]).reshape(-1, 3)


def free_nodes(imported: Imported, known: FloatArray) -> IntArray:
    """Return the nodes that move and are at none of the known places (n, 3) [m], of several at one place the first."""
    places = imported.places
    moving = np.flatnonzero(sum(np.asarray(m.sum(axis=1)).ravel() for m in places.moves) > 0)
    _, first = np.unique(np.round(places.at[moving] / (SAME * imported.reach)), axis=0, return_index=True)
    unlike = moving[np.sort(first)]
    found: IntArray = unlike[distinct(imported, places.at[unlike], known)]
    return found


def promising_nodes(
    predictor: Predictor,
    imported: Imported,
    free: IntArray,
    change: Callable[[FloatArray, float], State],
    sizes: Sequence[float],
    along: BoolArray | None = None,
) -> list[tuple[dict[str, float], int]]:
    """Return the nodes at which a change of some size comes nearest to the frequencies, the best first.

    To first order a mass m lowers ln f of a mode by m phi^2 / 2 where it sits, and a spring k raises it by k phi^2 / 2
    lambda; of the nodes that are the best so far frequencies are predicted at every size.

    Parameters
    ----------
    predictor : Predictor
        The specimen.
    imported : Imported
        Its matrices.
    free : (n,) int array
        Nodes that are asked about.
    change : callable
        Takes rows of the basis (n, r) and a size to the state of the model.
    sizes : sequence of float
        Sizes tried [SI].
    along : (3, n) bool array, optional
        Of springs, along which axes each node is asked about; left out, it is bodies, which move along all.

    Returns
    -------
    list of (coordinates by name, axis)
        The axis is that of a spring; -1 of a body, which moves along all.
    """

    def build() -> FloatArray:
        chosen = _best_to_first_order(predictor, imported, free, along)
        best = sorted(chosen, key=lambda node: _misfit(predictor, imported, node, change, sizes))[:PROMISING]
        return np.array(best, dtype=float).reshape(-1, 2)

    kind = "bodies" if along is None else "springs"
    found = predictor.once(f"promising nodes of {kind}", build).astype(int)
    return [
        (dict(zip("xyz", imported.places.at[index].tolist(), strict=True)), axis)
        for index, axis in found.tolist()
    ]


def _best_to_first_order(
    predictor: Predictor, imported: Imported, free: IntArray, along: BoolArray | None
) -> list[tuple[int, int]]:
    """Return nodes, and axes of springs, in whose pattern of shifts the gap is."""
    gap = frequency_gap(predictor)
    nominal = gap.prediction
    vectors = predictor.reduced.basis[:, : len(nominal.vectors)] @ nominal.vectors
    squares = np.stack([np.asarray(motion[free] @ vectors) ** 2 for motion in imported.places.moves])
    stiff = (2 * np.pi * nominal.frequency) ** 2
    if along is None:
        shifts = -squares.sum(axis=0) / 2
    else:
        shifts = (squares * along[:, :, None] / stiff).reshape(-1, len(stiff)) / 2
    size, gained = gap.sizes(shifts)
    gain = np.where(size > 0, gained, 0.0)
    best = np.argsort(-gain, kind="stable")[:SOLVED]
    return [
        (int(free[i % len(free)]), -1 if along is None else i // len(free))
        for i in best.tolist()
        if gain[i] > 0
    ]


def _misfit(
    predictor: Predictor,
    imported: Imported,
    node: tuple[int, int],
    change: Callable[[FloatArray, float], State],
    sizes: Sequence[float],
) -> float:
    """Return what a change at a node leaves of the gap in frequency, at the best of some sizes [-]."""
    index, axis = node
    motions = [imported.places.moves[a][[index]] for a in (range(3) if axis < 0 else [axis])]
    rows = np.vstack([np.asarray(motion @ predictor.reduced.basis) for motion in motions])
    found = [frequency_gap(predictor, change(rows, size)).misfit for size in sizes]
    return min((value for value in found if np.isfinite(value)), default=np.inf)
