"""Which nodes of imported matrices promise most: where a mass or a spring comes nearest to the frequencies."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.sparse import vstack
from scipy.spatial import KDTree

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.effects.structure.attachment import Attachment, attachment_of
from updating.effects.structure.frequency_gap import common_metric, frequency_gap
from updating.models.absorbers import structural
from updating.models.fields import Sparse
from updating.models.imported.matrices import Imported
from updating.models.state import State
from updating.prediction.assignment import match
from updating.prediction.predict import Predictor

SOLVED = 40
"""Of so many nodes, the best in the lowest modes, frequencies are predicted. Doubled: at twice the time, a change that
bends a node's surroundings is found more surely."""

BEYOND, STEPS, SAMPLED = 12, 12, 2000
"""Modes beyond the measured ones in which changes are solved first, at so many sizes, at so many places spread over the
structure before those near the best [-]. Doubled: a change's own bending is held better, its size met better, a change
between the places is missed less; at eight times, twice, twice the time."""

TRIED = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Quantiles of the prior of a size, from end to end, at which frequencies are predicted before the best is refined [-].
Doubled: at twice the time, two sizes that fit by chance are distinguished."""

CLOSE = 0.02
"""A size refined so far is near enough, relative [-]: what is left of a gap of 10 % is then some 0.1 % in error, less
than neighbouring nodes differ by. Doubled, one prediction of ten is saved."""

PROMISING = 6
"""So many of these are compared by all data. Doubled: at twice the time, neighbours further off are among them."""


def promising_nodes(
    predictor: Predictor,
    imported: Imported,
    free: IntArray,
    change: Callable[[Attachment, float], State],
    sizes: Sequence[float],
    along: BoolArray | None = None,
) -> list[tuple[dict[str, float], int]]:
    """Return the nodes at which a change of some size comes nearest to the frequencies, the best first.

    What a mass or a spring does is first solved in the lowest modes, which it couples (to first order a heavy one
    misleads: it turns modes into each other). There the measured modes are the lowest, or those that they are in the
    model as it is: a change that is large enough makes shapes that it does not have. Of the nodes that are the best so
    far frequencies are predicted, each at the size that suits it best.

    Parameters
    ----------
    predictor : Predictor
        The specimen.
    imported : Imported
        Its matrices.
    free : (n,) int array
        Nodes that are asked about.
    change : callable
        Takes a place and a size to the state of the model.
    sizes : sequence of float
        Sizes tried, ascending, between which the best is found [SI].
    along : (3, n) bool array, optional
        Of springs, along which axes each node is asked about; left out, it is bodies, which move along all.

    Returns
    -------
    list of (coordinates by name, axis)
        The axis is that of a spring; -1 of a body, which moves along all.
    """

    def build() -> FloatArray:
        chosen = _best_in_modes(predictor, imported, free, sizes, along)
        best = sorted(chosen, key=lambda node: _misfit(predictor, imported, node, change, sizes))[:PROMISING]
        return np.array(best, dtype=float).reshape(-1, 2)

    kind = "bodies" if along is None else "springs"
    found = predictor.once(f"promising nodes of {kind}", build).astype(int)
    return [
        (dict(zip("xyz", imported.places.at[index].tolist(), strict=True)), axis)
        for index, axis in found.tolist()
    ]


def _best_in_modes(
    predictor: Predictor,
    imported: Imported,
    free: IntArray,
    sizes: Sequence[float],
    along: BoolArray | None,
) -> list[tuple[int, int]]:
    """Return nodes, and axes of springs, whose change, solved in the lowest modes, comes nearest to the frequencies."""
    test, count = predictor.measured, len(predictor.measured.frequency)
    nominal = predictor.predict(at_least=count + test.below + BEYOND)
    ranks = np.arange(count) + test.below
    likely = {tuple(ranks.tolist()), tuple(np.sort(match(test, nominal, ranks)).tolist())}
    rigid = predictor.reduced.structure.rigid_modes
    values, states = predictor.reduced.eigen(predictor.base)
    states = structural(states[:, : rigid + len(nominal.frequency)], predictor.base.absorbers)
    vectors = predictor.reduced.basis[:, : len(states)] @ states
    stiff = np.append(np.maximum(values[:rigid], 0.0), (2 * np.pi * nominal.frequency) ** 2)
    moves = np.stack([np.asarray(motion[free] @ vectors) for motion in imported.places.moves[:3]], axis=1)
    asked = [(node, -1) for node in range(len(free))]
    if along is not None:
        asked = [(node, axis) for axis in range(3) for node in np.flatnonzero(along[axis]).tolist()]
    if not asked:  # all nodes are test points or in node sets
        return []
    tried = np.geomspace(sizes[0], sizes[-1], STEPS)
    whitening = np.linalg.cholesky(common_metric(count))

    def left(chosen: IntArray) -> FloatArray:
        rows = np.stack(
            [moves[node] if axis < 0 else moves[node, [axis]] for node, axis in np.take(asked, chosen, 0)]
        )
        values = _changed(stiff, rows, tried, spring=along is not None)
        known = np.log(np.maximum(values[..., rigid:], 1e-300)) / 2
        offs = (np.log(2 * np.pi * test.frequency) - known[..., list(partner)] for partner in likely)
        return np.asarray(np.min([_nearest(off @ whitening) for off in offs], axis=0))

    nodes = np.arange(len(asked), dtype=np.intp)
    coarse = nodes[:: 1 + len(nodes) // SAMPLED]
    best = coarse[np.argsort(left(coarse), kind="stable")[:SOLVED]]
    if len(coarse) < len(nodes):
        at = imported.places.at[free[[node for node, _ in asked]]]
        spacing = np.cbrt(len(nodes) / len(coarse)) * 2 * np.median(KDTree(at).query(at[best], k=[5])[0])
        near = np.unique(np.concatenate(KDTree(at).query_ball_point(at[best], spacing)).astype(np.intp))
        best = near[np.argsort(left(near), kind="stable")[:SOLVED]]
    return [(int(free[asked[i][0]]), asked[i][1]) for i in best.tolist()]


def _changed(stiff: FloatArray, rows: FloatArray, sizes: FloatArray, *, spring: bool) -> FloatArray:
    """Return eigenvalues in modes that a mass or a spring couples, ascending, (n_sizes, n, n_modes) [rad^2/s^2].

    With rows a, those of a mass m are the eigenvalues of L^1/2 (1 + m a^T a)^-1 L^1/2, where (1 + m a^T a)^-1 = 1 - m
    a^T (1 + m a a^T)^-1 a: a rigid-body mode, whose L is zero, moves the mass along.

    Parameters
    ----------
    stiff : (n_modes,) array
        L of the modes, mass-normalised, rigid-body modes included [rad^2/s^2].
    rows : (n, n_axes, n_modes) array
        How they move where something sits [1/sqrt(kg)].
    sizes : (n_sizes,) array
        Masses [kg] or stiffnesses [N/m].
    spring : bool
        Which of the two.
    """
    across = rows.transpose(0, 2, 1)
    if spring:
        changes = (size * across @ rows for size in sizes)
    else:
        strained = rows * np.sqrt(stiff)
        shares = (np.linalg.inv(np.eye(rows.shape[1]) / size + rows @ across) for size in sizes)
        changes = (-strained.transpose(0, 2, 1) @ share @ strained for share in shares)
    return np.stack([np.linalg.eigvalsh(np.diag(stiff) + change) for change in changes])


def _nearest(path: FloatArray) -> FloatArray:
    """Return the least square of what lies on the lines between successive points (n_points, n, n_modes), (n,)."""
    start, step = path[:-1], np.diff(path, axis=0)
    share = -np.sum(start * step, axis=-1) / np.maximum(np.sum(step**2, axis=-1), 1e-300)
    left = start + np.clip(share, 0, 1)[..., None] * step
    return np.asarray(np.sum(left**2, axis=-1).min(axis=0))


def _misfit(
    predictor: Predictor,
    imported: Imported,
    node: tuple[int, int],
    change: Callable[[Attachment, float], State],
    sizes: Sequence[float],
) -> float:
    """Return what a change at a node leaves of the gap in frequency, at the size that suits it best [-]."""
    index, axis = node

    def motions() -> Sparse:
        return Sparse(vstack([imported.places.moves[a][[index]] for a in (range(3) if axis < 0 else [axis])]))

    attachment = attachment_of(predictor, ("node", index, axis), motions)

    def left(power: float | np.floating) -> float:
        value = frequency_gap(predictor, change(attachment, float(np.exp(power)))).misfit
        return value if np.isfinite(value) else np.inf

    powers = np.log(sizes)
    found = [left(power) for power in powers]
    best = int(np.argmin(found))
    ends = float(powers[max(best - 1, 0)]), float(powers[min(best + 1, len(sizes) - 1)])
    finer = minimize_scalar(left, bounds=ends, method="bounded", options={"xatol": CLOSE})
    return min(found[best], float(finer.fun))
