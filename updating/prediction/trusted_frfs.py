"""By which FRFs modes are paired: without the few points or fixed sensors that spoil the shapes of all modes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.prediction.assignment import mac_of_constants, match
from updating.prediction.prediction import Prediction
from updating.test_data.measured import Measured

SPOILT = 0.8
"""Mean MAC of the pairs under which points and sensors that spoil it are sought..."""

MENDED = 0.05
"""...and by how much leaving one out must raise it [-]."""

SPOILS = 2
"""Fewest modes whose MAC rises by as much where points are bad: a bad point spoils most shapes, while a mode that is
none, or one that the model lacks, spoils its own MAC alone. Doubled, a bad point in a test of few modes goes unseen."""

LOST = 0.4
"""A MAC under which a mode has no partner, however near: where `SPOILS` modes lie under it, a faulty channel is sought
whatever the mean. Doubled, it would be sought in most tests, in vain."""

OPPOSITE = 0.02
"""By how much the mean MAC may be lower with the other sign of a channel that disagrees with the model's and still
count against it, not its neighbour: of two sensors, either with the other's sign agrees. Doubled, a point hit from
behind beside it may be taken for it [-]."""

FEWEST = 3
"""Points that have to be left for shapes to be compared: fewer resemble everything."""

ROUNDING = 1e-9
"""How far rounding may put a bound of MACs below them [-], some million times what it does."""

KEPT = 0.6
"""Share of the points, and half of the fixed sensors, that have to be left: a test is not judged by its minority."""


@dataclass(frozen=True)
class _Channel:
    """A point of the end that roved, or of the one that stayed, and its rows."""

    moved: bool
    rows: BoolArray


def trusted_rows(measured: Measured, prediction: Prediction) -> BoolArray | None:
    """Return the rows left when the few points and fixed sensors that spoil all shapes are out, None where none does.

    A sensor mounted upside down, or a point hit from the other side, turns the sign of its rows alike in all modes, so
    that modes are strangers to their own partners by MAC; with the other sign they are not. What is wrong with a point
    in another way is found by leaving it out.

    Parameters
    ----------
    measured, prediction
        Test and model.

    Returns
    -------
    (n_frf,) bool array or None
    """
    rows = np.ones(len(measured.seen), dtype=bool)
    before = _macs(measured, prediction, rows)
    if before.mean() >= SPOILT and (before < LOST).sum() < SPOILS:
        return None
    channels = _channels(measured)
    turned, kept = measured, rows
    while (found := _reversed(turned, prediction, kept, channels)) is not None:
        turned, kept = _turned(turned, found), kept & ~found
    # signs alone, two points exchanged, points left out alone, and with signs: what asks for the least is taken
    trials = [(turned, kept, False), (measured, rows, True), (turned, kept, True)]
    if (pair := _exchanged(measured, prediction, channels)) is not None:
        trials.insert(1, (_swapped(measured, *pair), rows & ~pair[0] & ~pair[1], False))
    for test, start, spoil in trials:
        compared, left = rows, start
        while spoil and (found := _spoiling(test, prediction, compared, left, channels)) is not None:
            compared, left = compared & ~found, left & ~found
        after = _macs(test, prediction, compared)
        if not left.all() and after.mean() >= SPOILT and (after - before > MENDED).sum() >= SPOILS:
            return left
    return None


def _reversed(
    measured: Measured, prediction: Prediction, rows: BoolArray, channels: tuple[_Channel, ...]
) -> BoolArray | None:
    """Return the rows of the channel whose other sign raises the mean MAC most, None where none does by much."""
    every = np.ones(len(rows), dtype=bool)
    reached = float(_macs(measured, prediction, every).mean())
    trials = [c.rows for c in channels if (rows & c.rows).any() and _enough(measured, rows & ~c.rows)]
    means = [float(_macs(_turned(measured, t), prediction, every).mean()) for t in trials]
    best = max(means, default=0.0)
    if best < reached + MENDED:
        return None
    alike = [i for i, mean in enumerate(means) if mean >= best - OPPOSITE]
    against = [i for i in alike if _agreement(measured, prediction, trials[i]) < 0]
    return trials[max(against or alike, key=lambda i: means[i])]


def _spoiling(
    measured: Measured,
    prediction: Prediction,
    compared: BoolArray,
    rows: BoolArray,
    channels: tuple[_Channel, ...],
) -> BoolArray | None:
    """Return the rows of the point without which the mean MAC rises most, None where none does by much."""
    reached = float(_macs(measured, prediction, compared).mean())
    trials = [c.rows for c in channels if c.moved and _enough(measured, rows & ~c.rows)]
    means = [float(_macs(measured, prediction, compared & ~t).mean()) for t in trials]
    best = max(means, default=0.0)
    return None if best < reached + MENDED or reached >= SPOILT else trials[means.index(best)]


def _exchanged(
    measured: Measured, prediction: Prediction, channels: tuple[_Channel, ...]
) -> tuple[BoolArray, BoolArray] | None:
    """Return the rows of the two points that, exchanged, raise the mean MAC most, None where none do by much.

    Two ends of a structure that changed places leave shapes even about its middle as they are, and of odd ones hardly
    anything: neither of the two alone mends these.
    """
    every = np.ones(len(measured.seen), dtype=bool)
    least = float(_macs(measured, prediction, every).mean()) + MENDED
    moved = [c.rows for c in channels if c.moved]
    pairs = [
        (a, b)
        for a, b in _promising(measured, prediction, moved, least - ROUNDING)
        if _enough(measured, every & ~a & ~b)
    ]
    means = [float(_macs(_swapped(measured, a, b), prediction, every).mean()) for a, b in pairs]
    best = max(means, default=0.0)
    return None if not pairs or best < least else pairs[means.index(best)]


def _promising(
    measured: Measured, prediction: Prediction, points: Sequence[BoolArray], least: float
) -> list[tuple[BoolArray, BoolArray]]:
    """Return the pairs of points of as many rows that, exchanged, let the mean MAC be so high with any partners.

    An exchange changes what two shapes have in common by their differences between the two points alone.
    """
    a, b = np.nan_to_num(measured.constants), np.nan_to_num(prediction.constants)
    power = np.maximum(np.outer(np.sum(a**2, axis=0), np.sum(b**2, axis=0)), 1e-300)
    common, rows, found = a.T @ b, [np.flatnonzero(point) for point in points], []
    for i, one in enumerate(rows):
        others = [j for j in range(i + 1, len(rows)) if len(rows[j]) == len(one)]
        two = np.array([rows[j] for j in others], dtype=np.intp).reshape(-1, len(one))
        changed = (a[two] - a[one]).transpose(0, 2, 1) @ (b[one] - b[two])
        most = ((common + changed) ** 2 / power).max(axis=2).mean(axis=1)
        found += [(points[i], points[others[k]]) for k in np.flatnonzero(most > least)]
    return found


def _swapped(measured: Measured, first: BoolArray, second: BoolArray) -> Measured:
    """Return a test with the rows of two points exchanged."""
    order = np.arange(len(first))
    order[first], order[second] = np.flatnonzero(second), np.flatnonzero(first)
    return replace(measured, constants=measured.constants[order])


def _turned(measured: Measured, rows: BoolArray) -> Measured:
    """Return a test with the other sign in some rows."""
    return replace(measured, constants=np.where(rows[:, None], -1.0, 1.0) * measured.constants)


def _macs(measured: Measured, prediction: Prediction, rows: BoolArray) -> FloatArray:
    """Return the MAC of every measured mode with its partner by some rows, (n_modes,) [-]."""
    order = match(measured, prediction, np.zeros(0, dtype=np.int64), rows)
    return np.asarray(mac_of_constants(measured, prediction, rows)[np.arange(len(order)), order])


def _agreement(measured: Measured, prediction: Prediction, rows: BoolArray) -> float:
    """Return the mean cosine over modes between test and model in some rows, paired with these turned [-].

    The sign of a mode is that of its other rows where only shapes are known.
    """
    order = match(_turned(measured, rows), prediction, np.zeros(0, dtype=np.int64), np.ones_like(rows))
    a, b = measured.constants, prediction.constants[:, order]
    size = np.linalg.norm(a[rows], axis=0) * np.linalg.norm(b[rows], axis=0)
    cosine = np.sum(a[rows] * b[rows], axis=0) / np.maximum(size, 1e-300)
    if not measured.absolute:
        cosine = cosine * np.sign(np.sum(a[~rows] * b[~rows], axis=0))
    return float(cosine.mean())


def _ends(measured: Measured) -> tuple[IntArray, IntArray]:
    """Return the point that roved and the one that stayed of every row, (n_frf,) each."""
    return (measured.hit, measured.seen) if measured.roving == "hit" else (measured.seen, measured.hit)


def _channels(measured: Measured) -> tuple[_Channel, ...]:
    return tuple(
        _Channel(moved, end == point)
        for moved, end in zip((True, False), _ends(measured), strict=True)
        for point in np.unique(end[end >= 0])
    )


def _enough(measured: Measured, rows: BoolArray) -> bool:
    """Return whether enough points, and half of the fixed sensors, are left to compare shapes by."""
    moved, stayed = _ends(measured)
    points, sensors = len(np.unique(moved)), len(np.unique(stayed))
    left = len(np.unique(moved[rows]))
    return left >= max(FEWEST, math.ceil(KEPT * points)) and 2 * len(np.unique(stayed[rows])) >= sensors


def left_out(measured: Measured, trusted: BoolArray) -> str:
    """Name the points and the fixed sensors whose rows are not trusted."""
    words = ("hits at point", "sensor at point") if measured.roving == "hit" else ("point", "hits at point")
    parts = []
    for word, end in zip(words, _ends(measured), strict=True):
        lost = sorted(
            {str(measured.nodes[p]) for p in set(end.tolist()) - set(end[trusted].tolist()) if p >= 0}
        )
        parts += [f"{word}{'s' * (len(lost) > 1)} {', '.join(lost)}"] if lost else []
    return " and ".join(parts)
