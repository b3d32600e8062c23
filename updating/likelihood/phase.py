"""Phases of the modal constants: by how much each measurement chain turns each mode."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray
from updating.likelihood.base import Quantity, View
from updating.likelihood.comparison import Block
from updating.prediction.window_left import window_turns
from updating.thresholds import COMPLEXITY_PER_DAMPING, LARGEST_NODE_RATIO, PHASE_DOUBT, PHASE_UNEVENNESS


@dataclass(frozen=True, eq=False)
class Phases(Quantity):
    """By how much the constants of each chain are turned, beyond what the state explains."""

    @property
    def present(self) -> bool:
        """Whether the test has such data."""
        return self.setting.measured.phase is not None and self.setting.measured.has_shapes

    def block(self, view: View) -> Block:
        """Return how far each chain turns each mode beyond what the state does [rad].

        Filters turn all alike in proportion to frequency, which is as a delay does; the rest is each mode's.
        """
        left, turns = self._turned(view)
        return replace(self._unturned, residual=(left + np.pi * turns).ravel())

    @cached_property
    def _unturned(self) -> Block:
        """The block beside a state that turns nothing; no state changes more of it than the residual."""
        test = self.setting.measured
        assert test.phase is not None
        assert test.phase_sigma is not None
        n_chains, n_modes = test.phase.shape
        columns = np.repeat(PHASE_DOUBT * np.eye(n_modes)[None], n_chains, axis=0).reshape(-1, n_modes)
        late = PHASE_DOUBT * np.tile(test.frequency / test.frequency.max(), n_chains)
        judged = (PHASE_UNEVENNESS * PHASE_DOUBT) ** 2 + self._complexity**2
        return Block(
            channel="phase",
            residual=test.phase.ravel(),
            variance=(test.phase_sigma**2 + judged).ravel(),
            factors=np.zeros((test.phase.size, len(self.setting.names))),
            named=late[:, None],
            own=columns,
            mode=np.tile(np.arange(n_modes), n_chains),
            judged=judged.ravel(),
            judged_own=True,
        )

    def factor(self, view: View) -> FloatArray:
        """Return what a state makes of real constants, (n_frf, n_modes): a sign, and of a delay some growth [-]."""
        test = self.setting.measured
        assert test.channel_group is not None
        _, turns = self._turned(view)
        # the residue of exp(-s tau) H(s) holds exp(-s tau) at the pole, whose decay makes it larger
        signs = np.where(turns % 2 == 0, 1.0, -1.0)[test.channel_group]
        if not view.state.delay:
            return signs
        return signs * np.exp(2 * np.pi * test.frequency * np.nan_to_num(test.damping) * view.state.delay)

    def _turned(self, view: View) -> tuple[FloatArray, FloatArray]:
        """Return the phases beyond the state's [rad], and by how many half turns these are nearest to zero.

        A delay turns constants, a window left in does, and dampers that couple modes do.
        """
        test = self.setting.measured
        assert test.phase is not None
        expected = -2 * np.pi * test.frequency * view.state.delay
        expected = expected + window_turns(test.frequency, view.state.decay, test.recorded_power)
        if view.now.phase is not None:
            expected = expected + view.now.phase
        return test.phase - expected, np.round((expected - test.phase) / np.pi)

    @cached_property
    def _complexity(self) -> FloatArray:
        """Return how far damping may turn the constants that a chain sees, (n_chains, n_modes) [rad].

        Whether damping is viscous or structural turns them by the damping ratio; where it is not proportional, a
        mode takes on imaginary parts of about the damping ratio times its size, which weigh most where the sensor
        sits near a node of it.
        """
        test = self.setting.measured
        assert test.channel_group is not None
        member = (test.channel_group == np.arange(int(test.channel_group.max()) + 1)[:, None]).astype(float)
        ratio = np.where(np.isfinite(test.damping), test.damping, 0.0)
        prediction = self.setting.nominal
        rows = self.setting.predictor.nominal_rows["w"][:, : len(prediction.vectors)] @ prediction.vectors
        seen = np.stack(
            [np.abs(rows[test.seen[test.channel_group == c]]).mean(axis=0) for c in range(len(member))]
        )
        typical = np.sqrt(np.mean(rows**2, axis=0))
        away = typical / np.maximum(seen, typical / LARGEST_NODE_RATIO)
        return np.asarray(ratio * np.hypot(1.0, COMPLEXITY_PER_DAMPING * away))
