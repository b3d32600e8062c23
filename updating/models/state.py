"""A departure from the nominal model: the one language in which tolerances, effects and updates are stated."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import reduce
from itertools import zip_longest
from types import MappingProxyType
from typing import TypeVar

from acquisition.arrays import FloatArray
from acquisition.display import Displayed
from updating.models.absorbers import Absorber
from updating.models.spec import Theory
from updating.models.yielding import Yielding, together


def _nothing() -> Mapping[str, float]:
    return MappingProxyType({})


Key = TypeVar("Key")

Role = tuple[str, int]
"""Part of a point in an FRF, ``"seen"`` or ``"hit"``, and the point's index."""


@dataclass(frozen=True, eq=False)
class Loss:
    """Something that damps: mode r decays at the rate omega_r^power phi_r^T matrix phi_r.

    Parameters
    ----------
    matrix : (r, r) array
        In the coordinates of the reduced basis [SI].
    power : float
        0 for a viscous matrix C, -1 for a structural one D (stiffness times loss factor), 1/2 for Stokes' layer
        of a viscous fluid [-].
    """

    matrix: FloatArray
    power: float = 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class State(Displayed):
    """What differs from the nominal model and the nominal measurement.

    Parameters
    ----------
    factors : mapping of str to float
        Factors on E, density, thickness, width and length of the whole structure, and on what its terms name
        besides: the stiffness across of an orthotropic plate [-].
    regional : mapping of (region index, factor name) to float
        Factors on one region [-].
    dampers : mapping of (region index, coefficient) to float
        Values that take the place of alpha [1/s], beta [s] or loss_factor [-]; index -1 is the whole structure.
    ratios : tuple of float, optional
        Damping ratios of the elastic modes in place of all coefficients, the last for all modes above: those
        identified, for instance [-].
    stiffness, mass : tuple of (r, r) arrays
        Matrices added in the coordinates of the reduced basis [SI].
    damping : tuple of (r, r) arrays
        Viscous matrices that take the place of the damping the model expects: what a baseline measured [SI].
    losses : tuple of Loss
        What damps beside all that.
    released : frozenset of str
        Parts of the clamps that no longer hold by themselves: ``rotation``, ``translation``.
    theory : str, optional
        Theory in place of the nominal one.
    gain : float
        Factor of the measured level over the true one [-].
    decay : float
        Decay rate that the measurement adds to every mode [1/s].
    delay : float
        By how much the responses lag the force [s].
    point_gains : mapping of (role, point) to float
        Factor of the measured level over the true one at one point; -1 for a reversed sign [-].
    exchanged : tuple of (role, point, point)
        Points whose labels were exchanged.
    moved : mapping of (role, point) to tuple of float
        How far from its stated place, along the in-plane axes, a point was really hit or seen [m].
    slope : float
        Relative change of the frequencies per newton of the hammer's peak force [1/N].
    per_newton : tuple of (r, r) arrays
        What the stiffness, which is that at the level of the test, gains per newton of that force [SI/N].
    fluid : mapping of str to float
        The fluid whose inertia is among ``mass``: ``fluid_density`` [kg/m^3], ``free_surface`` and ``bottom`` [m],
        infinite where there is none.
    absorbers : tuple of Absorber
        Masses on springs that hang on the structure: each adds a degree of freedom behind those of the basis.
    yielding : mapping of str to Yielding
        Supports of imported matrices that give way, by name, as the nominal model pulls at them.
    carried : mapping of str to float
        Factors on the mass that each of these carries along, which is estimated [-].
    drift : float
        Relative change of all frequencies from the first point of the test to the last, about the state itself, which
        is that in the middle of the test [-].
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
    losses: tuple[Loss, ...] = ()
    delay: float = 0.0
    point_gains: Mapping[Role, float] = field(default_factory=lambda: MappingProxyType({}))
    exchanged: tuple[tuple[str, int, int], ...] = ()
    moved: Mapping[Role, tuple[float, ...]] = field(default_factory=lambda: MappingProxyType({}))
    slope: float = 0.0
    per_newton: tuple[FloatArray, ...] = ()
    fluid: Mapping[str, float] = field(default_factory=_nothing)
    absorbers: tuple[Absorber, ...] = ()
    yielding: Mapping[str, Yielding] = field(default_factory=lambda: MappingProxyType({}))
    carried: Mapping[str, float] = field(default_factory=_nothing)
    drift: float = 0.0

    def plus(self, other: State) -> State:
        """Return both departures together: factors multiply, matrices add, later dampers win."""
        if other is NOMINAL or self is NOMINAL:
            return self if other is NOMINAL else other
        return State(
            factors=MappingProxyType(_multiplied(self.factors, other.factors)),
            regional=MappingProxyType(_multiplied(self.regional, other.regional)),
            dampers=MappingProxyType({**self.dampers, **other.dampers}),
            ratios=self.ratios if other.ratios is None else other.ratios,
            stiffness=self.stiffness + other.stiffness,
            mass=self.mass + other.mass,
            damping=self.damping + other.damping,
            released=self.released | other.released,
            theory=other.theory or self.theory,
            gain=self.gain * other.gain,
            decay=self.decay + other.decay,
            losses=self.losses + other.losses,
            delay=self.delay + other.delay,
            point_gains=MappingProxyType(_multiplied(self.point_gains, other.point_gains)),
            exchanged=self.exchanged + other.exchanged,
            moved=MappingProxyType(_added(self.moved, other.moved)),
            slope=self.slope + other.slope,
            per_newton=self.per_newton + other.per_newton,
            fluid=MappingProxyType({**self.fluid, **other.fluid}),
            absorbers=self.absorbers + other.absorbers,
            yielding=MappingProxyType(together(self.yielding, other.yielding)),
            carried=MappingProxyType(_multiplied(self.carried, other.carried)),
            drift=self.drift + other.drift,
        )


def _multiplied(first: Mapping[Key, float], second: Mapping[Key, float]) -> dict[Key, float]:
    product = dict(first)
    for key, value in second.items():
        product[key] = product.get(key, 1.0) * value
    return product


def _added(
    first: Mapping[Key, tuple[float, ...]], second: Mapping[Key, tuple[float, ...]]
) -> dict[Key, tuple[float, ...]]:
    total = dict(first)
    for key, value in second.items():
        there = total.get(key, ())
        total[key] = tuple(a + b for a, b in zip_longest(there, value, fillvalue=0.0))
    return total


NOMINAL = State()


def combine(states: Iterable[State]) -> State:
    """Return all departures together."""
    return reduce(State.plus, states, NOMINAL)
