"""What damps the structure beside what the model expects: all over, or where something sticks to it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import nnls

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.mechanism import DAMPING_RATIO, Size
from updating.effects.obstacles import Obstacle, damping_obstacle
from updating.models.base import supports_at
from updating.models.state import Loss, State
from updating.prediction.predict import Predictor

RATIOS = (5e-5, 0.1)
"""Range of the damping ratio that beta and the loss factor add at the middle of the measured band [-]."""

DECAYS = (0.1, 70.0)
"""Range of the decay rate that alpha adds: that of an exponential window, which no data separate from it [1/s]."""


NAMES = ("alpha", "beta", "loss_factor")
"""Coefficients."""

LESS, MORE = (0.0, 0.5), (0.5, 1.0)
"""Halves of the quantiles of a coefficient: a share of what is expected taken away, all of it first; and added."""

SHARE_LESS = 0.2
"""Prior of less damping than expected [-]: data sheets and guesses err on the safe side less often than they leave out
what damps. Judged; doubled, less gains ln 2."""

NOTHING_LEFT = 1e-3
"""Share of a mode's damping that is none [-]: of a mechanism with less in every mode, and taken beyond all of it."""


class UniformDamping(Effect):
    """Damping of the whole structure beside what the model expects: proportional to mass, to stiffness, or structural.

    alpha M + beta K + i loss_factor K (paper B, Eqs. 1 and 3). Alpha alone is exactly an exponential window of the
    decay rate alpha / 2. Less damping than expected is a form of its own: a share of all that is expected, the same of
    each mechanism, so that no mode is left with less than none.
    """

    name = "uniform_damping"
    channel = "damping"
    summary = "The whole structure damps more, or less, than the model expects."
    footprint = (
        "Damping ratios rise in inverse proportion to frequency (alpha), in proportion to it (beta), or all by the"
        " same amount (loss factor); or all fall by the same share of the expected damping."
    )
    models = ("beam", "plate", "matrices")
    equivalent_to = ("exponential_window", "fluid_damping", "damping_patch")
    phrase = "damping spread over the whole structure"
    separated_by = "a repeat without window, on softer suspension, or in vacuum"

    def damps(self, parameter: str = "") -> bool:
        """State that it does nothing else."""
        return True

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the coefficients."""
        middle = _middle(predictor)
        less = "; or negative, down to minus the expected damping"
        lossy = f"damping ratios of {RATIOS[0]:g} to {RATIOS[1]:g} in the middle of the band{less}"
        decays = f"decays as those of windows{less}"
        low, high = (2 * ratio / middle for ratio in RATIOS)
        return (
            Parameter("alpha", "1/s", 2 * DECAYS[0], 2 * DECAYS[1], decays, log=True, signed=True),
            Parameter("beta", "s", low, high, lossy, log=True, signed=True),
            Parameter("loss_factor", "-", 2 * RATIOS[0], 2 * RATIOS[1], lossy, log=True, signed=True),
        )

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return each coefficient alone, all three, and a share less of what is expected."""
        more = 1 - SHARE_LESS
        alone = tuple(
            Variant({other: 0.0 for other in NAMES if other != name}, 0.27 * more, {name: MORE})
            for name in NAMES
        )
        together = Variant(weight=0.19 * more, within=dict.fromkeys(NAMES, MORE))
        expected = _expected(predictor)
        if not expected.any():
            return (*alone, together)
        lead = _lead(predictor)
        others = {other: 0.0 for other in NAMES if other != lead}
        return (*alone, together, Variant(others, SHARE_LESS, {lead: LESS}))

    def values(self, predictor: Predictor, coordinates: Sequence[float]) -> dict[str, float]:
        """Take prior quantiles to values: below the middle shares of what is expected, above it logarithms."""
        expected = dict(zip(NAMES, _expected(predictor).tolist(), strict=True))
        return {
            p.name: p.value(2 * u - 1) if u >= MORE[0] else -(1 - 2 * u) * expected[p.name]
            for p, u in zip(self.parameters(predictor), coordinates, strict=True)
        }

    def quantiles(self, predictor: Predictor, values: Values) -> list[float]:
        """Take values to prior quantiles."""
        found = []
        for p, expected in zip(self.parameters(predictor), _expected(predictor).tolist(), strict=True):
            value = float(values.get(p.name, p.value(0.5)))
            left = 1 - min(-value / expected, 1.0) if expected else 0.5
            found.append(left / 2 if value <= 0 else (1 + p.coordinate(value)) / 2)
        return found

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from two sizes, and from half of what is expected."""
        lead = NAMES.index(_lead(predictor))
        less = tuple(0.25 if i == lead else 0.75 for i in range(len(NAMES)))
        return (*((0.5 + u / 2,) * len(NAMES) for u in (0.3, 0.7)), less)

    def settled(self, predictor: Predictor, values: Values) -> Values:
        """Return the same share less of every mechanism where the one that leads is less than nothing."""
        lead = _lead(predictor)
        if not values[lead] < 0:
            return values
        expected = dict(zip(NAMES, _expected(predictor).tolist(), strict=True))
        share = values[lead] / expected[lead]
        return {**values, **{name: share * expected[name] for name in NAMES}}

    def sentence(self, values: Values) -> str:
        """Return whether it is more or less."""
        less = any(isinstance(values.get(name), float) and values[name] < 0 for name in NAMES)
        return f"The whole structure damps {'less' if less else 'more'} than the model expects."

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return what of the other mechanisms is missing where there is less than expected."""
        lead = _lead(predictor)
        if not values[lead] < 0:
            return {}
        units = {p.name: p.unit for p in self.parameters(predictor)}
        return {n: (values[n], units[n]) for n in NAMES if n != lead and values[n] < 0}

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return the damping ratio that it adds in the middle of the band."""
        alpha, beta, loss = (float(values.get(name, 0.0)) for name in NAMES)
        middle = _middle(predictor)
        return (Size(DAMPING_RATIO, (alpha / middle + beta * middle + loss) / 2, "-"),)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need an expectation of the damping."""
        return damping_obstacle(predictor)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the damping added.

        Raises
        ------
        StudyError
            If a mode were left with less than none.
        """
        _check(predictor, values)
        stiffness = predictor.once("whole stiffness", lambda: _whole(predictor)[0])
        mass = predictor.once("whole mass", lambda: _whole(predictor)[1])
        viscous = values["alpha"] * mass + values["beta"] * stiffness
        losses = [Loss(viscous, 0.0)] if values["alpha"] or values["beta"] else []
        if values["loss_factor"]:
            losses.append(Loss(values["loss_factor"] * stiffness, -1.0))
        return State(losses=tuple(losses))


def _middle(predictor: Predictor) -> float:
    """Return the middle of the measured band [rad/s]."""
    hertz = predictor.measured.frequency
    return 2 * np.pi * float(np.sqrt(hertz.min() * hertz.max()))


def _decays(predictor: Predictor) -> tuple[FloatArray, FloatArray]:
    """Return decay rates 2 zeta omega of the modes expected, and what each coefficient adds to them, (n, 3) [1/s]."""
    small = predictor.on(predictor.reduced.small) if predictor.reduced.whole else predictor
    known = small.predict(count=max(len(predictor.measured.frequency), 1))
    omega = 2 * np.pi * known.frequency
    adds = np.stack([np.ones_like(omega), omega**2, omega], axis=1)
    return 2 * known.damping * omega, adds


def _expected(predictor: Predictor) -> FloatArray:
    """Return the coefficients, none negative, that come nearest to the damping expected, zeros where none is, (3,)."""

    def nearest() -> FloatArray:
        rates, adds = _decays(predictor)
        if not np.isfinite(rates).all() or not (rates > 0).all():
            return np.zeros(len(NAMES))
        relative = adds / rates[:, None]
        size = np.linalg.norm(relative, axis=0)
        found = nnls(relative / size, np.ones(len(rates)))[0] / size
        found[(relative * found).max(axis=0) < NOTHING_LEFT] = 0.0
        # what fits on average must not take more than there is from any mode
        return np.asarray(found / max(float((relative @ found).max()), 1.0))

    return predictor.once("expected damping", nearest)


def _lead(predictor: Predictor) -> str:
    """Return the coefficient that adds most to the modes expected."""

    def weights() -> FloatArray:
        rates, adds = _decays(predictor)
        return np.asarray(_expected(predictor) * (adds / np.abs(rates[:, None])).sum(axis=0))

    return NAMES[int(np.argmax(np.nan_to_num(predictor.once("leading damping", weights))))]


def _check(predictor: Predictor, values: Values) -> None:
    if min(values[name] for name in NAMES) >= 0:
        return
    rates, adds = (
        predictor.once(*item)
        for item in (
            ("decays expected", lambda: _decays(predictor)[0]),
            ("decays added", lambda: _decays(predictor)[1]),
        )
    )
    share = adds @ np.array([values[name] for name in NAMES]) / rates
    if np.isfinite(share).all() and share.min() < -1 - NOTHING_LEFT:
        number = int(np.argmin(share)) + 1
        raise StudyError(f"uniform_damping removes more than the expected damping from mode {number}")


def _whole(predictor: Predictor) -> tuple[FloatArray, FloatArray]:
    """Return stiffness and mass of everything that accepted effects leave, over all columns of the basis [SI].

    Springs that effects put under clamps are not damped; masses that they add are, so that alpha remains a window.
    """
    most = max(predictor.reduced.ranks, key=len)
    base = predictor.base
    stiffness, mass = predictor.reduced.matrices(replace(base, stiffness=(), absorbers=(), released=most))
    for support in supports_at(predictor.reduced.structure, base):
        springs = support.springs[: stiffness.shape[0], : stiffness.shape[1]]
        stiffness = stiffness - springs
    return stiffness, mass
