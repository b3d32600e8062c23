"""One kind of hidden effect, and the draws that several share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup

Values = dict[str, Any]
Place = tuple[float, ...]
Draw = Callable[[np.random.Generator, Setup, float], Values]
Act = Callable[[Scene, Values], Scene]


def everywhere(setup: Setup) -> bool:
    """State that any setup can have it."""
    return True


def is_beam(setup: Setup) -> bool:
    """Return whether the specimen is a beam."""
    return setup.kind == "beam"


def is_plate(setup: Setup) -> bool:
    """Return whether the specimen is a plate."""
    return setup.kind == "plate"


def is_clamped(setup: Setup) -> bool:
    """Return whether the specimen is clamped."""
    return bool(setup.clamped)


def nowhere(setup: Setup, values: Values) -> tuple[Place, ...]:
    """Return no place: the effect is all over."""
    return ()


def at_its_place(setup: Setup, values: Values) -> tuple[Place, ...]:
    """Return the place that the parameters name."""
    return (place_of(setup, values),)


def no_equals(setup: Setup, values: Values) -> tuple[str, ...]:
    """Return no other name."""
    return ()


def as_drawn(setup: Setup, values: Values) -> Values:
    """Return the parameters as they are drawn."""
    return values


@dataclass(frozen=True)
class HiddenEffect:
    """One kind of hidden effect.

    Parameters
    ----------
    name : str
        Its name in the contract; for one that the library lacks, a name of the rig's.
    draw : callable
        ``draw(rng, setup, strength)`` returns the parameters, under the contract's names and in SI units;
        strength 1 is a clear one.
    act : callable
        ``act(scene, values)`` returns the changed scene.
    applies : callable
        Whether a setup can have it.
    equals : callable
        ``equals(setup, values)``: other names that describe exactly the same change of the data.
    places : callable
        ``places(setup, values)``: where it sits, in model axes.
    outside : bool
        Whether it is drawn among what libraries do not have.
    known_as : str or None
        Its name in the library of the diagnosis, None where that is not expected to know it; left out, its own.
    graded : bool
        Whether it comes in different strengths.
    exclusive : str
        Two effects with the same location cannot be there at once; empty for none.
    metric : {"frequency", "damping", ""}
        In which of the two the gap that it makes shrinks; empty for neither.
    solid : bool
        Whether a body of bricks can have it.
    kinds : tuple of str
        Kinds of specimen that it is for; empty for beams, plates and, where ``solid`` states so, bricks.
    stated : callable
        ``stated(setup, values)``: the parameters as the library defines them, where the rig's differ.
    share : float
        About the share of setups that can have it, so that all effects come up about as often [-].
    """

    name: str
    draw: Draw
    act: Act
    applies: Callable[[Setup], bool] = everywhere
    equals: Callable[[Setup, Values], tuple[str, ...]] = no_equals
    places: Callable[[Setup, Values], tuple[Place, ...]] = nowhere
    outside: bool = False
    known_as: str | None = ""
    graded: bool = True
    exclusive: str = ""
    metric: str = "frequency"
    solid: bool = False
    kinds: tuple[str, ...] = ()
    stated: Callable[[Setup, Values], Values] = as_drawn
    share: float = 1.0

    def __post_init__(self) -> None:
        if self.known_as == "":
            object.__setattr__(self, "known_as", self.name)

    @property
    def in_library(self) -> bool:
        """Whether the diagnosis is expected to know it."""
        return self.known_as is not None

    def fits(self, setup: Setup) -> bool:
        """Return whether the specimen can have it, of what it is made of too."""
        if self.kinds or setup.by_matrices:
            return setup.kind in self.kinds and self.applies(setup)
        return self.applies(setup) and (self.solid or setup.kind != "solid")


def either_sign(rng: np.random.Generator) -> float:
    """Draw -1 or 1 [-]."""
    return float(rng.choice([-1.0, 1.0]))


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw from low to high, uniform in the logarithm."""
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def factor(low: float, high: float, *, most: float) -> Draw:
    """Return a draw of a factor exp(+-u), u between two bounds times the strength and never above ``most``.

    Parameters
    ----------
    low, high, most : float
        Of the size of the logarithm [-].
    """

    def draw(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
        size = min(strength * log_uniform(rng, low, high), most)
        return {"factor": float(np.exp(either_sign(rng) * size))}

    return draw


def nothing(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw no parameters."""
    return {}


def scaled(name: str) -> Callable[[Scene, Values], Scene]:
    """Return an act that scales a field of the body by the values' ``factor``."""
    return lambda scene, values: scene.with_body(**{name: getattr(scene.body, name) * values["factor"]})


def place_of(setup: Setup, values: Values) -> Place:
    """Return the place that the parameters name [m]."""
    return tuple(float(values[axis]) for axis in ("x", "y")[: len(setup.size)])


def only_level(setup: Setup, factor: float) -> bool:
    """Return whether a section that is wider by a factor shows in the level alone.

    Parameters
    ----------
    setup : Setup
        With the known sensor, which weighs less beside a wider section.
    factor : float
        On the section's stiffness and mass [-].

    Returns
    -------
    bool
        Whether the sensor shifts no frequency, which it does by at most 2 m / M at a free end, by more than
        frequencies are measured.
    """
    shift = 2 * setup.sensor_mass / setup.mass * abs(1 / factor - 1)
    return bool(shift < 2 * np.hypot(2e-4, setup.repeatability))


def draw_place(rng: np.random.Generator, setup: Setup, low: float = 0.06, high: float = 0.94) -> Values:
    """Draw a place between two shares of the length, and anywhere across the width [m].

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    setup : Setup
        With the extents.
    low, high : float
        Shares of the length [-].
    """
    place = {"x": float(rng.uniform(low, high) * setup.length)}
    return place if setup.kind != "plate" else place | {"y": float(rng.uniform(0.1, 0.9) * setup.width)}


def draw_within(
    rng: np.random.Generator, setup: Setup, extents: tuple[float, ...], low: float = 0.0, high: float = 1.0
) -> Values:
    """Draw a place for something of some size that stays on the structure [m].

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    setup : Setup
        With the extents.
    extents : tuple of float
        Of the thing, along each axis [m].
    low, high : float
        Shares of the length between which its middle lies, as far as its size allows [-].
    """
    place: Values = {}
    for axis, extent, size, bounds in zip(
        ("x", "y"), extents, setup.size, ((low, high), (0.1, 0.9)), strict=False
    ):
        half = 0.5 * extent / size
        first, last = max(bounds[0], half), min(bounds[1], 1.0 - half)
        place[axis] = float(rng.uniform(min(first, last), max(first, last)) * size)
    return place


def draw_extents(rng: np.random.Generator, setup: Setup, low: float, high: float) -> Values:
    """Draw an extent along each axis, independent of each other, as shares of the structure's [m].

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    setup : Setup
        With the extents.
    low, high : float
        Shares, uniform in the logarithm [-].
    """
    names = ("extent", "extent_y")
    return {name: log_uniform(rng, low, high) * size for name, size in zip(names, setup.size, strict=False)}


def clamped_places(setup: Setup, values: Values) -> tuple[Place, ...]:
    """Return the middles of the clamped edges."""
    middle = np.array(setup.size) / 2
    places = []
    for edge in setup.clamped:
        place = middle.copy()
        place["xy".index(edge[0])] = float(edge[1]) * setup.size["xy".index(edge[0])]
        places.append(tuple(float(x) for x in place))
    return tuple(places)


def with_level(scene: Scene, change: Callable[[Any, float], Any]) -> Scene:
    """Return the scene whose body also changes with the level of the hit, after what changed it before.

    Parameters
    ----------
    scene : Scene
        The rig.
    change : callable
        Body and peak force [N] to body.
    """
    before = scene.at_level
    return replace(scene, at_level=lambda body, level: change(before(body, level), level))
