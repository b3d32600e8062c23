"""The rig as it really stands: the specimen inside its tolerances, the sensor, the chain, the conduct."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from acquisition.arrays import FloatArray, frozen_array
from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.block.block import Block
from modalkit.simulator.bodies.body import Body
from modalkit.simulator.bodies.complex_modes import ComplexModes, complex_modes
from modalkit.simulator.bodies.frame.frame import Frame
from modalkit.simulator.bodies.parts import Attached
from modalkit.simulator.bodies.plate.parts import PlateAttached
from modalkit.simulator.bodies.plate.plate import Plate
from modalkit.simulator.bodies.solid.solid import Solid
from modalkit.simulator.setup import Setup

EXTRA_MODES = 8
_SUSPENSION: dict[str, tuple[tuple[tuple[float, ...], ...], float]] = {
    "beam": (((0.224,), (0.776,)), 15.0),
    "plate": (((0.2, 0.2), (0.2, 0.8), (0.8, 0.2), (0.8, 0.8)), 40.0),
}
"""Where free specimens hang, in shares of their extents, and how many times below the first frequency."""

MARKED = 0.8
"""Share of a point's error that its mark has once for all; the rest strays from hit to hit [-]."""


@dataclass(frozen=True, eq=False)
class Chain:
    """What the measurement does to the data.

    Parameters
    ----------
    gain : float
        True level of the FRFs over the stated one [-].
    window : float
        True decay rate of the exponential window [1/s].
    delay : float
        By how much the responses lag [s].
    reversed : tuple of int
        Points that are hit from the other side.
    exchanged : tuple of (int, int)
        Points whose labels are exchanged.
    moved : mapping of int to tuple
        By how much points lie elsewhere than stated [m].
    drift : float
        Relative change of all frequencies from the first hit of the test to the last [-].
    tilt : float
        1-sigma of the hammer's angle off the normal, in each hit anew [rad].
    gains : mapping of int to float
        Factors on the FRFs of single points [-].
    arms : tuple of float
        What the sensor sees of the slope along each axis, beside the deflection: its cross-axis sensitivity times
        its height [m].
    """

    gain: float = 1.0
    window: float = 0.0
    delay: float = 0.0
    reversed: tuple[int, ...] = ()
    exchanged: tuple[tuple[int, int], ...] = ()
    moved: Mapping[int, tuple[float, ...]] = field(default_factory=lambda: MappingProxyType({}))
    drift: float = 0.0
    tilt: float = 0.0
    gains: Mapping[int, float] = field(default_factory=lambda: MappingProxyType({}))
    arms: tuple[float, ...] = ()


def _same(body: Body, level: float) -> Body:
    return body


@dataclass(frozen=True, eq=False)
class Scene:
    """What is on the rig.

    Parameters
    ----------
    setup : Setup
        What is stated about it.
    body : Body
        The true specimen with everything attached, at rest.
    chain : Chain
        What the measurement does.
    scatter : (n,) array
        Factor of each mode's damping over the Rayleigh line [-].
    marks : (n_points + 1, dim) array
        Errors of the points' marks; the last is the sensor's place [m].
    at_level : callable
        Body at rest and peak force of a hit [N] to the body at that level.
    """

    setup: Setup
    body: Body
    chain: Chain
    scatter: FloatArray
    marks: FloatArray
    at_level: Callable[[Body, float], Body] = _same

    @property
    def depends_on_level(self) -> bool:
        """Whether the body changes with the force."""
        return self.at_level is not _same

    def modes(self, level: float | None = None) -> ComplexModes:
        """Return the true complex modes at the test's points, reversed and exchanged as the chain has it.

        Parameters
        ----------
        level : float, optional
            Peak force of the hit; default the median [N].
        """
        setup, chain = self.setup, self.chain
        body = self.at_level(self.body, setup.peak if level is None else level)
        places = setup.places + self.marks[:-1]
        for point, away in chain.moved.items():
            places[point] += away
        inside = inside_body(body, np.vstack([places, sensor_place(setup, self.marks)]))
        count = len(self.scatter)
        modes = complex_modes(body, inside, inside[-1], count=count, scatter=self.scatter)
        seen = modes.sensor + sum((a * s for a, s in zip(chain.arms, modes.slopes[:, -1], strict=False)), 0.0)
        modes = replace(modes, points=modes.points[:-1], slopes=modes.slopes[:, :-1], sensor=seen)
        order, sign = np.arange(len(places)), np.ones(len(places))
        for a, b in chain.exchanged:
            order[[a, b]] = order[[b, a]]
        sign[list(chain.reversed)] = -1.0
        for point, gain in chain.gains.items():
            sign[point] *= gain
        return replace(
            modes,
            points=sign[:, None] * modes.points[order],
            slopes=sign[:, None] * modes.slopes[:, order],
        )

    def elastic(self, level: float | None = None) -> ComplexModes:
        """Return the modes without rigid-body ones."""
        return self.modes(level).take(slice(self.body.rigid_modes, None))

    def with_body(self, **changes: Any) -> Scene:
        """Return a scene whose body differs in some fields."""
        return replace(self, body=replace(self.body, **changes))  # type: ignore[type-var]

    def with_chain(self, **changes: Any) -> Scene:
        """Return a scene whose measurement differs in some fields."""
        return replace(self, chain=replace(self.chain, **changes))


def sensor_place(setup: Setup, marks: FloatArray) -> FloatArray:
    """Return where the sensor really sits, on the body as drawn, shape (dim,) [m]."""
    place: FloatArray = np.clip(setup.places[setup.sensor] + marks[-1], 0.0, np.array(setup.size))
    return place


def inside_body(body: Body, places: FloatArray) -> FloatArray:
    """Return places with those off the body moved to its edge, shape (n, dim) [m]."""
    if isinstance(body, (Block, Frame)):
        return np.clip(places, [body.start, 0.0], [body.end, body.width])
    if isinstance(body, Plate):
        return np.clip(places, [body.start, body.side], [body.end, body.side + body.width])
    return np.clip(places, getattr(body, "start", -np.inf), getattr(body, "end", np.inf))


def draw_scene(setup: Setup, rng: np.random.Generator) -> Scene:
    """Draw a specimen from the stated tolerances and put it on the rig, without any effect.

    Parameters
    ----------
    setup : Setup
        Stated dimensions, material and tolerances.
    rng : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    Scene
        The body grows or shrinks at its clamped edge, so that points keep their distance from the free end.
    """
    tol = setup.tolerances

    def off(sigma: float) -> float:
        return float(1.0 + sigma * rng.standard_normal())

    factors = {name: off(getattr(tol, name)) for name in ("length", "width", "thickness", "E", "density")}
    marks = MARKED * setup.position_sigma * rng.standard_normal((len(setup.points) + 1, len(setup.size)))
    gain = abs(off(setup.calibration)) if setup.calibrated else float(np.exp(0.3 * rng.standard_normal()))
    scatter = np.exp(tol.damping * rng.standard_normal(setup.modes + EXTRA_MODES))
    return build_scene(setup, factors, body=setup.made, gain=gain, scatter=scatter, marks=marks)


def nominal_scene(setup: Setup, *, factors: Mapping[str, float] | None = None) -> Scene:
    """Return the rig with the specimen exactly as stated, or with some of its properties scaled.

    It is of the kind that the study models: a solid's is a beam.

    Parameters
    ----------
    setup : Setup
        What is stated.
    factors : mapping, optional
        Factors on E, density, thickness, length and width [-].
    """
    marks = np.zeros((len(setup.points) + 1, len(setup.size)))
    scatter = np.ones(setup.modes + EXTRA_MODES)
    return build_scene(setup, factors or {}, body=setup.nominal, gain=1.0, scatter=scatter, marks=marks)


def build_scene(
    setup: Setup,
    factors: Mapping[str, float],
    *,
    body: Body,
    gain: float,
    scatter: FloatArray,
    marks: FloatArray,
) -> Scene:
    """Return the rig with a specimen whose properties are some factors times the stated ones.

    Parameters
    ----------
    setup : Setup
        What is stated.
    factors : mapping
        On E, density, thickness, length and width; those left out are 1 [-].
    body : Body
        The specimen as stated.
    gain : float
        Level of the FRFs [-].
    scatter, marks : arrays
        As in :class:`Scene`.
    """
    plain = {name: f * getattr(setup, name) for name, f in factors.items() if name != "length"}
    body = replace(body, **plain)  # type: ignore[type-var]
    scene = Scene(
        setup,
        lengthened(body, (factors.get("length", 1.0) - 1.0) * setup.length),
        Chain(gain=gain, window=setup.window),
        frozen_array(scatter),
        frozen_array(marks),
    )
    return scene.with_body(attached=attachments(setup, sensor_place(setup, marks)))


def lengthened(body: Body, extension: float) -> Body:
    """Return a body longer along x by an extension, which is added at its clamped ends [m]."""
    assert isinstance(body, (Beam, Block, Plate, Solid, Frame))
    ends = [end for end in ("x0", "x1") if end in body.clamped] or ["x0"]
    start, end = (extension * (name in ends) / len(ends) for name in ("x0", "x1"))
    return replace(body, start=body.start - start, end=body.end + end)


def attachments(setup: Setup, place: FloatArray) -> tuple[Attached | PlateAttached, ...]:
    """Return what the body always carries: the known sensor, and soft springs under a free one."""
    part: Any = PlateAttached if len(setup.size) > 1 else Attached
    sensor = part(*(float(x) for x in place), mass=setup.sensor_mass, inertia=setup.sensor_inertia)
    if setup.clamped:
        return (sensor,)
    places, softness = _SUSPENSION[setup.kind]
    omega = 2 * np.pi * setup.nominal_hz[0] / softness
    stiffness = setup.mass * omega**2 / len(places)
    damping = 0.03 * setup.mass * omega / len(places)
    ropes = (
        part(
            *(s * size for s, size in zip(shares, setup.size, strict=True)),
            stiffness=stiffness,
            damping=damping,
        )
        for shares in places
    )
    return (sensor, *ropes)
