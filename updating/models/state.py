"""A departure from the nominal model: the one language in which tolerances, effects and updates speak."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import reduce
from types import MappingProxyType

from acquisition.arrays import FloatArray
from updating.models.spec import Theory


def _nothing() -> Mapping[str, float]:
    return MappingProxyType({})


@dataclass(frozen=True, eq=False)
class State:
    """What differs from the nominal model and the nominal measurement.

    Parameters
    ----------
    factors : mapping of str to float
        Factors on E, density, thickness, width and length of the whole structure [-].
    regional : mapping of (region index, factor name) to float
        Factors on one region [-].
    dampers : mapping of (region index, coefficient) to float
        Values that take the place of alpha [1/s], beta [s] or loss_factor [-]; index -1 is the whole structure.
    ratios : tuple of float, optional
        Damping ratios of the elastic modes in place of all coefficients, the last for all modes above: those
        identified, for instance [-].
    stiffness, mass, damping : tuple of (r, r) arrays
        Matrices added in the coordinates of the reduced basis [SI].
    released : frozenset of str
        Parts of the clamps that no longer hold by themselves: ``rotation``, ``translation``.
    theory : str, optional
        Theory in place of the nominal one.
    gain : float
        Factor of the measured level over the true one [-].
    decay : float
        Decay rate that the measurement adds to every mode [1/s].
    """

    factors: Mapping[str, float] = field(default_factory=_nothing)
    regional: Mapping[tuple[int, str], float] = field(default_factory=lambda: MappingProxyType({}))
    dampers: Mapping[tuple[int, str], float] = field(default_factory=lambda: MappingProxyType({}))
    ratios: tuple[float, ...] | None = None
    stiffness: tuple[FloatArray, ...] = ()
    mass: tuple[FloatArray, ...] = ()
    damping: tuple[FloatArray, ...] = ()
    released: frozenset[str] = frozenset()
    theory: Theory | None = None
    gain: float = 1.0
    decay: float = 0.0

    def plus(self, other: State) -> State:
        """Return both departures together: factors multiply, matrices add, later dampers win."""
        factors = dict(self.factors)
        for name, value in other.factors.items():
            factors[name] = factors.get(name, 1.0) * value
        regional = dict(self.regional)
        for key, value in other.regional.items():
            regional[key] = regional.get(key, 1.0) * value
        return State(
            MappingProxyType(factors),
            MappingProxyType(regional),
            MappingProxyType({**self.dampers, **other.dampers}),
            self.ratios if other.ratios is None else other.ratios,
            self.stiffness + other.stiffness,
            self.mass + other.mass,
            self.damping + other.damping,
            self.released | other.released,
            other.theory or self.theory,
            self.gain * other.gain,
            self.decay + other.decay,
        )


NOMINAL = State()


def combine(states: Iterable[State]) -> State:
    """Return all departures together."""
    return reduce(State.plus, states, NOMINAL)
