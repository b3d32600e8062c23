"""What every effect defines: its parameters, what it does to the model, where it sits, what it resembles."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import KW_ONLY, dataclass, field
from types import MappingProxyType
from typing import Any, ClassVar, Literal, Self

import numpy as np

from updating.effects.mechanism import Channel, Extent, Size
from updating.effects.obstacles import Lack, Obstacle
from updating.models.spec import Kind, Spec
from updating.models.state import State
from updating.prediction.predict import Predictor

Undoing = Literal["unclamped", "in air"]
"""Tests of the same specimen in which an effect may be gone: hung up free, and out of the fluid."""


AT_END = 0.01
"""Prior quantiles this near to an end of the range count as lying there [-]."""

EDGES = ("low", "high")
"""Both ends, for a place: the edges of the structure."""

PLACING = frozenset({"x", "y", "z", "extent", "extent_y", "from", "to"})
"""Parameters that say where an effect sits and how far it reaches, not how large it is."""

ALL_OVER = 0.5
"""What reaches over so much of the length is no place [-]."""


@dataclass(frozen=True)
class Parameter:
    """One parameter of an effect and its prior: uniform, or uniform in the logarithm, over a range.

    Parameters
    ----------
    name : str
        Name within the effect.
    unit : str
        Its unit; ``-`` for a ratio.
    low, high : float
        Range of the prior [unit].
    why : str
        Why this range.
    log : bool
        Whether the prior is uniform in the logarithm.
    default : float, optional
        What is taken where an effect is put into a model and this is not stated; left out, it must be stated.
    natural : tuple of {"low", "high"}
        Ends of the range that are nature's and no judgement: an edge of the structure, nothing, everything.
    or_none : bool
        Whether it may be zero beside this range, which is a form of its own.
    signed : bool
        Whether less than nothing may be, too: then the range is that of the size, or what :meth:`Effect.values` states.
    like : str
        Parameter whose value it takes where it is put into a model and not stated, or ``nothing``; empty where it must
        be stated.
    scale_doubt : float
        Relative standard deviation of the scale that the value is read on, which no datum shows, as that of the force
        on a slope per newton [-].
    """

    name: str
    unit: str
    low: float
    high: float
    why: str
    _: KW_ONLY
    log: bool = False
    default: float | None = None
    natural: tuple[str, ...] = ()
    or_none: bool = False
    like: str = ""
    signed: bool = False
    scale_doubt: float = 0.0

    @property
    def needed(self) -> bool:
        """Whether it must be stated where the effect is put into a model."""
        return self.default is None and not self.like

    def extreme(self, coordinate: float) -> bool:
        """Return whether a prior quantile lies at an end of the range that is a judgement."""
        at_low, at_high = coordinate < AT_END, coordinate > 1 - AT_END
        return (at_low and "low" not in self.natural) or (at_high and "high" not in self.natural)

    def value(self, coordinate: float) -> float:
        """Take a prior quantile in [0, 1] to the parameter's value [unit]."""
        if self.log:
            return float(self.low * (self.high / self.low) ** coordinate)
        return float(self.low + (self.high - self.low) * coordinate)

    def coordinate(self, value: float) -> float:
        """Take a value to its prior quantile, clipped to [0, 1]."""
        if self.log:
            u = np.log(max(value, 1e-300) / self.low) / np.log(self.high / self.low)
        else:
            u = (value - self.low) / (self.high - self.low)
        return float(np.clip(u, 0.0, 1.0))


Values = Mapping[str, Any]
"""Values of an effect's parameters by name: numbers, and tuples of node numbers where points are meant."""


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


@dataclass(frozen=True)
class Variant:
    """One of several forms in which an effect may come: which point, which sign, which of its parameters act.

    Parameters
    ----------
    values : mapping
        What this form fixes; parameters named here are not searched.
    weight : float
        Prior probability of this form among all forms of the effect, those not listed included [-].
    within : mapping of str to (low, high)
        Part of a parameter's prior, in quantiles, to which this form keeps: losses but no gains, for instance [-].
    """

    values: Values = field(default_factory=lambda: MappingProxyType({}))
    weight: float = 1.0
    within: Mapping[str, tuple[float, float]] = field(default_factory=lambda: MappingProxyType({}))

    def quantile(self, name: str, coordinate: float) -> float:
        """Take a coordinate of this form, in [0, 1], to the parameter's prior quantile [-]."""
        low, high = self.within.get(name, (0.0, 1.0))
        return low + (high - low) * coordinate

    def coordinate(self, name: str, quantile: float) -> float:
        """Take a prior quantile to the coordinate of this form; outside [0, 1] where the form does not go there."""
        low, high = self.within.get(name, (0.0, 1.0))
        return (quantile - low) / (high - low)


@dataclass(frozen=True)
class Twin:
    """An effect that makes one and the same change as another, so that no hammer test separates them.

    Parameters
    ----------
    name : str
        The other effect.
    why : str
        What both do, stated once for the two.
    instead : str
        What to do in place of another test.
    """

    name: str
    why: str
    instead: str


class Effect(ABC):
    """A physical cause of a gap that the nominal model does not hold.

    A subclass states the class variables and implements :meth:`parameters` and :meth:`state`; the rest has
    defaults. Register an instance with :func:`updating.effects.register`.
    """

    name: str
    """Name in the report and the JSON."""
    channel: Channel
    """Where it acts."""
    summary: str
    """One sentence for the report."""
    footprint: str
    """What it does to the data."""
    models: ClassVar[tuple[str, ...]] = ("beam", "plate")
    """Kinds of model it applies to."""
    equivalent_to: ClassVar[tuple[str, ...]] = ()
    """Effects that some data cannot separate from it."""
    labels: ClassVar[tuple[str, ...]] = ()
    """Values beside the parameters that say which points are meant, by their node numbers."""
    named: ClassVar[tuple[str, ...]] = ()
    """Values beside the parameters that are names of the user's own model: of a region, a node set, a direction."""
    exchanges: ClassVar[bool] = False
    """Whether it exchanges the places of its points: accepted, the test has the places, and the model no effect."""

    of_sensor: ClassVar[bool] = False
    """Whether ``channel`` may be stated in place of the labels: one of several sensors (or forces) that stayed, by node
    and direction as ``5+Z``."""
    separated_by: str
    """The test that would separate it from these."""
    fidelity: ClassVar[float] = 0.0
    """How far, relative to the shift the effect makes, its own idealisation may be off (1 sigma) [-]."""
    uneven: ClassVar[bool] = False
    """Whether that error differs from mode to mode, as of an added mass: it turns modes that are close into each other.
    The size of a body, a spring or a place is searched, and errs for all modes alike."""
    damping_doubt: ClassVar[float] = 0.0
    """How far the effect leaves the damping in doubt beside what it predicts: 1 sigma of ln zeta [-]."""
    phrase: str = ""
    """How a sentence names it; left out, by its own name."""
    elsewhere: ClassVar[Mapping[Kind, str]] = MappingProxyType({})
    """Why it does not apply to a kind of model that is not among ``models``, where there is more to say."""
    keeps_clamps: ClassVar[bool] = False
    """Whether all that it changes needs only the columns of the clamped structure: neither it nor its priors release
    anything."""
    fuller: ClassVar[bool] = False
    """Whether it is that the model's theory leaves something out."""
    undone_by: ClassVar[frozenset[Undoing]] = frozenset()
    """Tests in which it is gone."""
    twin: ClassVar[Twin | None] = None
    """An effect that makes one and the same change; one of the two states so."""
    competes_with: ClassVar[str] = ""
    """The modeller's doubt of which it is more than that: a factor with a tolerance, or ``calibration``."""
    screened: ClassVar[Mapping[str, tuple[float, ...]]] = MappingProxyType({})
    """What is tried at every place before a search: prior quantiles of the parameters that are neither place nor size.
    Where it is empty, a search begins at :meth:`starts`."""
    of_supports: ClassVar[bool] = False
    """Whether what it sits at is a support."""
    repeats: ClassVar[bool] = False
    """Whether it may occur twice in a set of causes, at two places."""
    occurrence: int = 1
    """Which of several in a set of causes this one is."""

    @property
    def key(self) -> str:
        """What its parameters are listed under: its name, of a second one ``name#2``."""
        return self.name if self.occurrence == 1 else f"{self.name}#{self.occurrence}"

    @property
    def several(self) -> bool:
        """Whether a model may hold several of it: at other places, or of other points."""
        return self.repeats or bool(self.labels)

    def repeats_on(self, predictor: Predictor) -> bool:
        """Return whether it may occur twice in a set of causes of this specimen, ``repeats`` as a rule."""
        return self.repeats

    def again(self) -> Self:
        """Return the same effect as the next of its kind in a set."""
        other = copy(self)
        other.occurrence = self.occurrence + 1
        return other

    @abstractmethod
    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the parameters with their priors for this specimen."""

    @abstractmethod
    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the departure from the nominal model at given values."""

    def priors(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the parameters, kept with the specimen: every state of a search asks for them."""
        return predictor.once(("parameters", self), lambda: self.parameters(predictor))

    def values(self, predictor: Predictor, coordinates: Sequence[float]) -> dict[str, float]:
        """Take prior quantiles, one per parameter, to values of the parameters."""
        return {p.name: p.value(u) for p, u in zip(self.priors(predictor), coordinates, strict=True)}

    def quantiles(self, predictor: Predictor, values: Values) -> list[float]:
        """Take values, half the range where one is not given, to prior quantiles: the inverse of :meth:`values`."""
        return [
            p.coordinate(float(values[p.name])) if p.name in values else 0.5 for p in self.priors(predictor)
        ]

    def names_in(self, spec: Spec) -> set[str]:
        """Return which of ``named`` the effect takes on a model: all of imported matrices, as a rule."""
        return set() if spec.imported is None else set(self.named)

    def sentence(self, values: Values) -> str:
        """Return the summary of the form with these values."""
        return self.summary

    def settled(self, predictor: Predictor, values: Values) -> Values:
        """Return the values, what a form fixes among them, brought to what is possible together."""
        return values

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the forms in which the effect may come; those that the data exclude need not be listed."""
        return (Variant(),)

    def fidelity_on(self, predictor: Predictor) -> float:
        """Return how far the idealisation may be off on this specimen and test, ``fidelity`` as a rule [-]."""
        return self.fidelity

    def words(self) -> str:
        """Return how a sentence names the effect."""
        return self.phrase or self.name.replace("_", " ")

    def scales(self, predictor: Predictor) -> tuple[str, float] | None:
        """Return the factor of the model that the only parameter moves, and by how much per unit; None for others."""
        return None

    def damps(self, parameter: str = "") -> bool:
        """Return whether a parameter, all of them where none is named, changes damping alone."""
        return False

    def weight(self, predictor: Predictor, values: Values) -> float:
        """Return by how much a balance shows the specimen heavier, beside what factors of the model do [kg]."""
        return 0.0

    def sensor_weight(self, values: Values) -> float:
        """Return by how much a balance shows a sensor with its mount heavier than modelled [kg]."""
        return 0.0

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Return why the effect cannot be examined on this specimen and test, or None."""
        return None

    def why_not(self, predictor: Predictor) -> Obstacle | None:
        """Return why the effect is left out: it does not apply to this kind of model, or an obstacle; or None."""
        spec = predictor.spec
        if spec.kind in self.models:
            return self.obstacle(predictor)
        return Obstacle(Lack.MODEL, self.elsewhere.get(spec.kind, f"not for {spec.called}"))

    def unseen(self, predictor: Predictor) -> Obstacle | None:
        """Return which sign of the effect a test lacks, so that it is not sought in it, or None."""
        return None

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Return prior quantiles from which the search for the best values starts."""
        count = len(self.parameters(predictor))
        return tuple(tuple([u] * count) for u in (0.3, 0.7)) if count else ((),)

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return where the effect sits in model axes, empty for one that is everywhere [m]."""
        return ()

    def acts_in(self, predictor: Predictor, values: Values) -> Channel:
        """Return where it acts with these values, ``channel`` as a rule."""
        return self.channel

    def extent(self, predictor: Predictor, values: Values) -> Extent:
        """Return whether it acts all over the structure, at a place, at supports, or in the measuring chain."""
        if self.channel == "measurement":
            return "chain"
        long = float(values.get("extent", 0.0)) >= ALL_OVER * predictor.spec.length
        if long or not self.locations(predictor, values):
            return "global"
        return "edge" if self.of_supports else "local"

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return how large it is, in the currency that suits it first, then in those that other effects share.

        Left out, in that of its first parameter that is no place and has no default.
        """
        own = (p for p in self.parameters(predictor) if p.name not in PLACING and p.default is None)
        stated = (p for p in own if isinstance(values.get(p.name), int | float))
        return tuple(
            Size(p.name.replace("_", " "), float(values[p.name]), p.unit, p.scale_doubt) for p in stated
        )[:1]

    def derived(self, predictor: Predictor, values: Values) -> dict[str, tuple[float, str]]:
        """Return quantities that follow from the parameters, as name: (value, unit)."""
        return {}


def bending_stiffness(spec: Spec) -> float:
    """Return E I of a beam [N m^2] or E t^3 / 12 (1 - nu^2) of a plate [N m]."""
    if spec.kind == "beam":
        return spec.material.E * spec.width * spec.thickness**3 / 12
    return spec.material.E * spec.thickness**3 / (12 * (1 - spec.material.poisson**2))


def total_mass(spec: Spec) -> float:
    """Return the mass of the bare structure [kg]."""
    if spec.imported is not None:
        return spec.imported.total_mass
    return spec.material.density * spec.length * spec.width * spec.thickness
