"""How a test reads a structure: which points each FRF really joins, and by what factor its level is off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import AnyArray, FloatArray, IntArray
from updating.models.state import State
from updating.test_data.measured import Measured


@dataclass(frozen=True, eq=False)
class MeasurementChain:
    """The FRFs of a test as a state of the measurement has them.

    Parameters
    ----------
    points : (n_points, dim) array
        Places that are read: the test's points, and behind them those that were really hit or seen [m].
    seen, hit : (n_frf,) int arrays
        Which of them each FRF joins; ``hit`` is -1 where only a shape is known.
    gain : (n_frf,) array
        Factor of the measured level over the true one [-].
    """

    points: FloatArray
    seen: IntArray
    hit: IntArray
    gain: FloatArray

    def product(self, at_seen: AnyArray, at_hit: AnyArray) -> AnyArray:
        """Multiply what is read at the responses with what is read at the forces; 1 where there is none.

        Parameters
        ----------
        at_seen, at_hit : (n_points, ...) arrays
            A quantity at the places.

        Returns
        -------
        (n_frf, ...) array
        """
        return np.asarray(at_seen[self.seen] * self.at_hit(at_hit, 1.0))

    def at_hit(self, values: AnyArray, otherwise: float) -> AnyArray:
        """Return a quantity (n_points, ...) at the force of every FRF, or what stands there where none is known."""
        bare = (self.hit < 0).reshape(-1, *[1] * (values.ndim - 1))
        return np.where(bare, otherwise, values[self.hit])


def measurement_chain(measured: Measured, state: State) -> MeasurementChain:
    """Return what a test reads under a state of its measurement."""
    gain = np.full(len(measured.seen), level_of(state.gain, measured))
    if not (state.exchanged or state.point_gains or state.moved):
        return MeasurementChain(measured.points, measured.seen, measured.hit, gain)
    stated = {"seen": measured.seen, "hit": measured.hit}
    ends = {role: relabelled(points, role, state) for role, points in stated.items()}
    for (role, point), factor in state.point_gains.items():
        gain[stated[role] == point] *= factor
    points = [measured.points]
    for i, ((role, point), away) in enumerate(state.moved.items()):
        dim = measured.points.shape[1]
        points.append((measured.points[point] + np.resize(np.asarray([*away, 0.0, 0.0]), 3)[:dim])[None, :])
        ends[role] = np.where(ends[role] == point, len(measured.points) + i, ends[role])
    return MeasurementChain(np.concatenate(points), ends["seen"], ends["hit"], gain)


def relabelled(points: IntArray, end: str, state: State) -> IntArray:
    """Return which points these really were at one end of the FRFs, where a state has labels exchanged."""
    for role, a, b in state.exchanged:
        if role == end:
            points = np.where(points == a, b, np.where(points == b, a, points))
    return points


def level_of(gain: float, measured: Measured) -> float:
    """Return by what factor a gain of the FRFs changes the constants: that of shapes is its root [-]."""
    return float(np.sqrt(gain)) if measured.bare and len(measured.hit) else gain
