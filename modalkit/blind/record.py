"""Measure a scene: raw hammer hits in a UFF file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from acquisition.dof import Dof
from acquisition.geometry import Geometry
from acquisition.hammer import HammerTest
from acquisition.synthetic import HammerPlan, ModalSystem, hammer_test
from acquisition.uff import write_uff
from modalkit.blind.bodies.complex_modes import ComplexModes
from modalkit.blind.scene import Scene
from modalkit.blind.setup import Setup

_OVERSAMPLING = 1.25 * 2.56
_DECAY_WANTED = 6.0
_SAMPLES = (4096, 65536)
_FORCE_NOISE = 0.1
_PEAK = 100.0


def remounted(modes: ComplexModes, repeatability: float, rng: np.random.Generator) -> ComplexModes:
    """Return the modes after the specimen was taken off the rig and put back.

    Parameters
    ----------
    modes : ComplexModes
        True modes.
    repeatability : float
        Scatter of every frequency, relative 1-sigma, independent between modes [-].
    rng : numpy.random.Generator
        Source of randomness.

    Returns
    -------
    ComplexModes
        Poles scaled; mode shapes and modal masses as before.
    """
    factor = 1.0 + repeatability * rng.standard_normal(len(modes.poles))
    root = np.sqrt(factor)
    return replace(modes, poles=modes.poles * factor, points=modes.points / root, slopes=modes.slopes / root)


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
    hit = [i for i in range(len(setup.points)) if setup.drive or i != setup.sensor]
    gradients = setup.sensor_sign * modes.gradients(setup.sensor)[:, hit]
    return ModalSystem(
        poles=modes.poles,
        residues=setup.sensor_sign * modes.residues(setup.sensor)[:, hit],
        responses=(Dof(setup.sensor + 1, 3 * setup.sensor_sign),),
        points=tuple(Dof(i + 1, 3) for i in hit),
        gradients=np.stack([gradients, np.zeros_like(gradients)]),
    )


def hammer_plan(scene: Scene, modes: ComplexModes) -> HammerPlan:
    """Return how the test is made: the record is lengthened until the slowest mode has died away.

    Parameters
    ----------
    scene : Scene
        What is on the rig.
    modes : ComplexModes
        Its modes.

    Returns
    -------
    HammerPlan
        A power of two of samples, and a pulse short enough for the band.
    """
    setup = scene.setup
    rate = float(np.ceil(_OVERSAMPLING * setup.band[1]))
    inside = (modes.frequency > setup.band[0]) & (modes.frequency < setup.band[1])
    slowest = float(np.min(scene.window - modes.poles.real[inside]))
    samples = 2 ** int(np.ceil(np.log2(rate * _DECAY_WANTED / slowest)))
    return HammerPlan(
        rate=rate,
        samples=int(np.clip(samples, *_SAMPLES)),
        hits=setup.hits,
        peak=_PEAK,
        width=1.0 / setup.band[1],
        pre_trigger=64 / rate,
        force_noise=_FORCE_NOISE * setup.noise * _PEAK,
        response_noise=setup.noise,
        adc_bits=setup.bits,
        position_sigma=setup.position_sigma,
        decay=scene.window,
        gain=scene.gain,
    )


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
        Its ``decay`` is the stated one, since the record itself does not know better.
    """
    setup = scene.setup
    modes = remounted(scene.modes(), setup.repeatability, rng)
    coordinates = np.zeros((len(setup.points), 3))
    coordinates[:, 0] = setup.points
    geometry = Geometry(tuple(range(1, len(setup.points) + 1)), coordinates)
    system = modal_system(modes, setup)
    test = hammer_test(system, hammer_plan(scene, modes), rng=rng, geometry=geometry)
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
