"""What damps the structure beside what the model expects: all over, or where something sticks to it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.obstacles import Obstacle, damping_obstacle
from updating.models.state import Loss, State
from updating.prediction.predict import Predictor

RATIOS = (5e-5, 0.1)
"""Range of the damping ratio that beta and the loss factor add at the middle of the measured band [-]."""

DECAYS = (0.1, 70.0)
"""Range of the decay rate that alpha adds: that of an exponential window, which no data tell from it [1/s]."""


class UniformDamping(Effect):
    """Damping of the whole structure beside what the model expects: proportional to mass, to stiffness, or structural.

    alpha M + beta K + i loss_factor K (paper B, Eqs. 1 and 3). Alpha alone is exactly an exponential window of the
    decay rate alpha / 2.
    """

    name = "uniform_damping"
    channel = "damping"
    summary = "The whole structure damps more than the model expects."
    footprint = "Damping ratios rise: as one over frequency (alpha), with frequency (beta), or all alike (loss factor)."
    models = ("beam", "plate", "matrices")
    equivalent_to = ("exponential_window", "fluid_damping", "damping_patch")
    phrase = "damping spread over the whole structure"
    separated_by = "a repeat without window, on softer suspension, or in vacuum"

    def damps(self, parameter: str = "") -> bool:
        """Tell that it does nothing else."""
        return True

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the coefficients."""
        hertz = predictor.measured.frequency
        middle = 2 * np.pi * float(np.sqrt(hertz.min() * hertz.max()))
        lossy = f"damping ratios of {RATIOS[0]:g} to {RATIOS[1]:g} in the middle of the band"
        return (
            Parameter("alpha", "1/s", 2 * DECAYS[0], 2 * DECAYS[1], "decays as those of windows", log=True),
            Parameter("beta", "s", 2 * RATIOS[0] / middle, 2 * RATIOS[1] / middle, lossy, log=True),
            Parameter("loss_factor", "-", 2 * RATIOS[0], 2 * RATIOS[1], lossy, log=True),
        )

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return each coefficient alone, and all three."""
        names = [p.name for p in self.parameters(predictor)]
        alone = tuple(Variant({other: 0.0 for other in names if other != name}, 0.27) for name in names)
        return (*alone, Variant(weight=0.19))

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need an expectation of the damping."""
        return damping_obstacle(predictor)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the damping added."""
        stiffness = predictor.once("whole stiffness", lambda: _whole(predictor)[0])
        mass = predictor.once("whole mass", lambda: _whole(predictor)[1])
        viscous = values["alpha"] * mass + values["beta"] * stiffness
        losses = [Loss(viscous, 0.0)] if values["alpha"] or values["beta"] else []
        if values["loss_factor"]:
            losses.append(Loss(values["loss_factor"] * stiffness, -1.0))
        return State(losses=tuple(losses))


def _whole(predictor: Predictor) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and mass of everything that accepted effects leave, over all columns of the basis [SI].

    Springs that effects put under clamps are not damped; masses that they add are, so that alpha remains a window.
    """
    most = max(predictor.reduced.ranks, key=len)
    return predictor.reduced.matrices(replace(predictor.base, stiffness=(), released=most))
