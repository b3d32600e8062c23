"""Measure a scene: raw hammer hits in a UFF file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.dof import Dof
from acquisition.geometry import Geometry
from acquisition.hits.hammer import HammerTest
from acquisition.synthetic import BAD_HITS, BadHit, HammerPlan, ModalSystem, hammer_test
from acquisition.uff import write_uff
from modalkit.simulator.bodies.complex_modes import ComplexModes
from modalkit.simulator.conduct import Conduct, draw_conduct
from modalkit.simulator.scene import MARKED, Scene
from modalkit.simulator.setup import Setup, hit_points

_OVERSAMPLING = 1.25 * 2.56
_DECAY_WANTED = 6.0
_SAMPLES = (4096, 65536)
_FORCE_NOISE = 0.1
_LEVELS = np.exp(np.linspace(-1.6, 1.6, 9))
_STEADY = 0.8
_WANDER = 0.15
_PERFECT = Conduct()


def remounting(setup: Setup, count: int, rng: np.random.Generator) -> FloatArray:
    """Draw the factors that taking the specimen off the rig and putting it back makes on its frequencies.

    Parameters
    ----------
    setup : Setup
        With the repeatability.
    count : int
        Number of modes [-].
    rng : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    (count,) array
        Independent between modes [-].
    """
    factors: FloatArray = 1.0 + setup.repeatability * rng.standard_normal(count)
    return factors


def scaled(modes: ComplexModes, factor: FloatArray | float) -> ComplexModes:
    """Return modes with their poles times a factor; shapes per mass and modal masses stay."""
    root = np.sqrt(factor)
    return ComplexModes(modes.poles * factor, modes.points / root, modes.slopes / root, modes.sensor / root)


def modal_system(modes: ComplexModes, setup: Setup) -> ModalSystem:
    """Return the structure as the synthetic hammer test takes it: one sensor, a roving hammer.

    Parameters
    ----------
    modes : ComplexModes
        Modes at the test's points.
    setup : Setup
        Which point carries the sensor, and whether it is hit.

    Returns
    -------
    ModalSystem
        Nodes are numbered from 1 in the order of the points; hits are along +z.
    """
    hit = hit_points(setup)
    gradients = setup.sensor_sign * modes.gradients[:, None, hit]
    absent = np.zeros((2 - len(gradients), *gradients.shape[1:]), complex)
    return ModalSystem(
        poles=modes.poles,
        residues=setup.sensor_sign * modes.residues[None, hit],
        responses=(Dof(setup.sensor + 1, 3 * setup.sensor_sign),),
        points=tuple(Dof(i + 1, 3) for i in hit),
        gradients=np.concatenate([gradients, absent]),
    )


def hammer_plan(
    scene: Scene, modes: ComplexModes, rng: np.random.Generator, made: Conduct = _PERFECT
) -> HammerPlan:
    """Return how the test is made: the record is lengthened until the slowest mode has died away.

    Parameters
    ----------
    scene : Scene
        What is on the rig.
    modes : ComplexModes
        Its modes.
    rng : numpy.random.Generator
        Draws which hits are bad.
    made : Conduct
        How far from perfect the test is; default perfect.

    Returns
    -------
    HammerPlan
        A power of two of samples, and a pulse short enough for the band.
    """
    setup, chain = scene.setup, scene.chain
    rate = float(np.ceil(_OVERSAMPLING * setup.band[1]))
    inside = (modes.frequency > setup.band[0]) & (modes.frequency < setup.band[1])
    slowest = float(np.min(chain.window - modes.poles.real[inside]))
    samples = 2 ** int(np.ceil(np.log2(rate * _DECAY_WANTED / slowest)))
    return HammerPlan(
        rate=rate,
        samples=int(np.clip(samples, *_SAMPLES)),
        hits=setup.hits,
        peak=setup.peak,
        level_scatter=setup.level_scatter,
        width=1.0 / setup.band[1],
        pre_trigger=64 / rate,
        force_noise=_FORCE_NOISE * setup.noise * setup.peak,
        response_noise=setup.noise,
        noise_slope=setup.noise_slope,
        adc_bits=setup.bits,
        position_sigma=np.sqrt(1 - MARKED**2) * setup.position_sigma,
        decay=chain.window,
        gain=chain.gain,
        delay=chain.delay,
        bad=bad_hits(setup, rng),
        ringing=made.ringing,
        anti_alias="sharp" if made.sharp else "smooth",
        noisy=made.noisy,
    )


def bad_hits(setup: Setup, rng: np.random.Generator) -> dict[tuple[int, int], BadHit]:
    """Draw which hits are bad, and how; most of each point's stay good.

    Parameters
    ----------
    setup : Setup
        With the probability of a bad hit.
    rng : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    dict
        (Row of the point, hit) to the kind of fault.
    """
    bad: dict[tuple[int, int], BadHit] = {}
    for row in range(len(hit_points(setup))):
        spoilt = np.flatnonzero(rng.random(setup.hits) < setup.bad_hits)
        kinds = rng.integers(len(BAD_HITS), size=setup.hits)
        bad |= {(row, int(hit)): BAD_HITS[kinds[hit]] for hit in spoilt[: (setup.hits - 1) // 2]}
    return bad


@dataclass(frozen=True, eq=False)
class _Hit:
    """The structure at each hit: at its level, at its time, hit at its angle."""

    at_level: Callable[[float], ModalSystem]
    stage: FloatArray
    push: FloatArray

    def __call__(self, row: int, hit: int, level: float) -> ModalSystem:
        system, factor = self.at_level(level), self.stage[row, hit]
        residues = system.residues / factor * self.push[row, hit]
        assert system.gradients is not None
        gradients = system.gradients / factor * self.push[row, hit]
        return replace(system, poles=system.poles * factor, residues=residues, gradients=gradients)


def _interpolated(systems: list[ModalSystem], levels: FloatArray) -> Callable[[float], ModalSystem]:
    """Return the structure as a function of the level, linear between those it was solved at."""
    count = min(len(system.poles) for system in systems)

    def at(level: float) -> ModalSystem:
        k = int(np.clip(np.searchsorted(levels, level) - 1, 0, len(levels) - 2))
        u = float(np.clip((level - levels[k]) / (levels[k + 1] - levels[k]), 0.0, 1.0))
        low, high = systems[k], systems[k + 1]
        assert low.gradients is not None and high.gradients is not None
        return replace(
            low,
            poles=(1 - u) * low.poles[:count] + u * high.poles[:count],
            residues=(1 - u) * low.residues[..., :count] + u * high.residues[..., :count],
            gradients=(1 - u) * low.gradients[..., :count] + u * high.gradients[..., :count],
        )

    return at


def _structure(scene: Scene, factors: FloatArray, rng: np.random.Generator, slow: FloatArray) -> _Hit:
    """Return what each hit meets; ``slow`` is each point's factor on all frequencies, (n_points, 1)."""
    setup = scene.setup

    def system(level: float) -> ModalSystem:
        modes = scene.modes(level)
        return modal_system(scaled(modes, factors[: len(modes.poles)]), setup)

    if scene.depends_on_level:
        levels = setup.peak * _LEVELS
        at_level = _interpolated([system(float(level)) for level in levels], levels)
    else:
        only = system(setup.peak)
        at_level = lambda level: only  # noqa: E731
    shape = (len(hit_points(setup)), setup.hits)
    stages = slow * _stages(scene.chain.drift, shape, rng)
    return _Hit(at_level, stages, _pushes(scene.chain.tilt, shape, rng))


def slow_drift(sigma: float, points: int, rng: np.random.Generator) -> FloatArray:
    """Return what temperature does to all frequencies while each point is hit: a smooth course of stated size.

    Parameters
    ----------
    sigma : float
        1-sigma at any point, over tests; its mean over a test is part of the test's own shift [-].
    points : int
        Number of points, hit one after the other [-].
    rng : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    (points, 1) array
        Factors: a half-wave of random phase over the whole test, so that neighbours hardly differ [-].
    """
    time = np.pi * np.arange(points)[:, None] / points
    a, b = rng.standard_normal(2)
    factors: FloatArray = 1.0 + sigma * (a * np.cos(time) + b * np.sin(time))
    return factors


def _stages(drift: float, shape: tuple[int, int], rng: np.random.Generator) -> FloatArray:
    """Return the factor on all frequencies at each hit: a trend through the test, and some wandering about its line."""
    count = shape[0] * shape[1]
    time = np.linspace(-0.5, 0.5, count)
    wander = np.cumsum(rng.standard_normal(count)) / np.sqrt(count)
    wander -= wander.mean()
    wander -= time * (time @ wander) / max(float(time @ time), 1e-300)
    stages: FloatArray = (1.0 + drift * (time + _WANDER * wander)).reshape(shape)
    return stages


def _pushes(tilt: float, shape: tuple[int, int], rng: np.random.Generator) -> FloatArray:
    """Return the share of the hammer's force that pushes along the normal; most of its angle is the point's own."""
    own = _STEADY * rng.standard_normal((shape[0], 1))
    pushes: FloatArray = np.cos(
        np.clip(tilt * (own + np.sqrt(1 - _STEADY**2) * rng.standard_normal(shape)), -1.2, 1.2)
    )
    return pushes


def measure(scene: Scene, *, rng: np.random.Generator) -> HammerTest:
    """Put a scene on the rig and hit it.

    Parameters
    ----------
    scene : Scene
        What is on the rig.
    rng : numpy.random.Generator
        Source of all scatter and noise.

    Returns
    -------
    HammerTest
        Its ``decay`` is the stated one, since the record itself has no better value.
    """
    setup = scene.setup
    mount, conduct, hit, faults = rng.spawn(4)
    points = len(hit_points(setup))
    made = draw_conduct(points, faults)
    coordinates = np.zeros((len(setup.points), 3))
    coordinates[:, : len(setup.size)] = setup.places
    geometry = Geometry(tuple(range(1, len(setup.points) + 1)), coordinates)
    mounted = 1.0 + made.mounting * (remounting(setup, len(scene.scatter), mount) - 1.0)
    slow = slow_drift(made.drift * setup.repeatability, points, faults)
    structure = _structure(scene, mounted, conduct, slow)
    plan = hammer_plan(scene, scene.modes(), conduct, made)
    test = hammer_test(structure.at_level, plan, rng=hit, geometry=geometry, at_hit=structure)
    return replace(test, decay=setup.window, source=setup.title)


def record(scene: Scene, path: Path, *, rng: np.random.Generator) -> None:
    """Measure a scene and write its raw hits.

    Parameters
    ----------
    scene : Scene
        What is on the rig.
    path : Path
        The UFF file to write; single precision holds what 24 bits of a converter hold.
    rng : numpy.random.Generator
        Source of all scatter and noise.
    """
    test = measure(scene, rng=rng)
    write_uff(path, tests=[test], geometry=test.geometry, title=scene.setup.title, precision="single")
