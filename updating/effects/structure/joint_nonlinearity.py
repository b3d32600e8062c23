"""A joint whose stiffness depends on how hard the structure is hit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from updating.effects.base import Effect, Parameter, Values
from updating.effects.obstacles import Lack, Obstacle
from updating.models.state import State
from updating.prediction.predict import Predictor

LARGEST, SMALLEST = 0.2, 1e-4
"""Range of the relative change of frequency between no force and the level of the test [-]."""

COMMON_LEVEL = 100.0
"""Level that stands in for one that is not known, where only the prior is listed [N]."""


@dataclass(frozen=True)
class EitherSign(Parameter):
    """A parameter of unknown sign: log-uniform from ``least`` to the end of the range on either side of zero.

    Parameters
    ----------
    least : float
        Smallest size [unit].
    """

    least: float = 0.0

    def value(self, coordinate: float) -> float:
        """Take a prior quantile in [0, 1] to the parameter's value [unit]."""
        side = -1.0 if coordinate < 0.5 else 1.0
        return float(side * self.least * (self.high / self.least) ** abs(2 * coordinate - 1))

    def coordinate(self, value: float) -> float:
        """Take a value to its prior quantile, clipped to [0, 1]."""
        size = np.log(max(abs(value), self.least) / self.least) / np.log(self.high / self.least)
        return float(np.clip(0.5 + 0.5 * np.copysign(size, value), 0.0, 1.0))


class JointNonlinearity(Effect):
    """A joint that softens (it slips) or stiffens (it closes) the harder the structure is hit.

    To first order a soft clamp shifts all modes of a uniform cantilever by one factor, as E does, and so does its
    change with the level; how far the modes of other structures differ is in ``fidelity``.
    """

    name = "joint_nonlinearity"
    channel = "stiffness"
    summary = "A joint softens or stiffens with the force: frequencies follow the level of the hits."
    footprint = (
        "Frequencies of single hits change in proportion to their peak force, much alike in all modes."
    )
    models = ("beam", "plate", "matrices")
    equivalent_to = ()
    separated_by = "hits at each point over a wider range of levels, softest and hardest some 1 : 5"
    phrase = "a joint that is not linear"
    undone_by = frozenset({"unclamped"})
    fidelity = 0.15

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the slope."""
        level = predictor.measured.level or COMMON_LEVEL
        why = (
            f"from {100 * SMALLEST:g} to {100 * LARGEST:g} % over the level of the test, either sign; uniform in "
            "the logarithm of the size"
        )
        return (EitherSign("slope", "1/N", -LARGEST / level, LARGEST / level, why, least=SMALLEST / level),)

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from both signs, faint and plain."""
        return tuple((u,) for u in (0.1, 0.3, 0.7, 0.9))

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need hits of different levels."""
        test = predictor.measured
        if test.slope is not None and test.level and np.isfinite(test.slope).any():
            return None
        what = "no points were hit several times with levels that span 2 : 1, or there are no raw hits"
        return Obstacle(Lack.DATA, what)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the dependence on the level."""
        return State(slope=values["slope"])
