"""The rig as it really stands: the specimen inside its tolerances, the sensor, the gain, the window."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray, frozen_array
from modalkit.blind.bodies.beam import Beam
from modalkit.blind.bodies.complex_modes import ComplexModes, complex_modes
from modalkit.blind.bodies.parts import Attached
from modalkit.blind.setup import Setup

_EXTRA_MODES = 8


@dataclass(frozen=True, eq=False)
class Scene:
    """What is on the rig.

    Parameters
    ----------
    setup : Setup
        What is stated about it.
    beam : Beam
        The true specimen with everything attached.
    gain : float
        True level of the FRFs over the stated one [-].
    window : float
        True decay rate of the exponential window [1/s].
    scatter : (n,) array
        Factor of each mode's damping over the Rayleigh line [-].
    """

    setup: Setup
    beam: Beam
    gain: float
    window: float
    scatter: FloatArray

    def modes(self) -> ComplexModes:
        """Return the true complex modes at the test's points."""
        return complex_modes(
            self.beam, np.array(self.setup.points), count=len(self.scatter), scatter=self.scatter
        )

    def with_beam(self, **changes: object) -> Scene:
        """Return a scene whose beam differs in some fields."""
        return replace(self, beam=replace(self.beam, **changes))  # type: ignore[arg-type]


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
        The beam grows or shrinks at its start, so that the points keep their distance from the free end.
    """
    tol = setup.tolerances
    bare = setup.nominal

    def off(sigma: float) -> float:
        return float(1.0 + sigma * rng.standard_normal())

    beam = replace(
        bare,
        start=bare.end - bare.length * off(tol.length),
        width=bare.width * off(tol.width),
        thickness=bare.thickness * off(tol.thickness),
        E=bare.E * off(tol.E),
        density=bare.density * off(tol.density),
        attached=attachments(setup),
    )
    gain = off(setup.calibration)
    scatter = np.exp(tol.damping * rng.standard_normal(setup.modes + _EXTRA_MODES))
    return Scene(setup, beam, gain, setup.window, frozen_array(scatter))


def nominal_scene(setup: Setup) -> Scene:
    """Return the rig with the specimen exactly as stated."""
    beam = replace(setup.nominal, attached=attachments(setup))
    return Scene(setup, beam, 1.0, setup.window, frozen_array(np.ones(setup.modes + _EXTRA_MODES)))


def attachments(setup: Setup) -> tuple[Attached, ...]:
    """Return what the beam always carries: the known sensor, and soft springs under a free beam."""
    sensor = Attached(setup.points[setup.sensor], mass=setup.sensor_mass, inertia=setup.sensor_inertia)
    return (sensor,) if setup.clamped else (sensor, *_suspension(setup))


def _suspension(setup: Setup) -> tuple[Attached, ...]:
    """Hang a free beam by its first nodal points, at a fifteenth of its first frequency, damped by 10 %."""
    bare = setup.nominal
    omega = 2 * np.pi * setup.nominal_hz[0] / 15
    stiffness, damping = 0.5 * bare.mass * omega**2, 0.1 * bare.mass * omega
    places = (0.224 * setup.length, 0.776 * setup.length)
    return tuple(Attached(x, stiffness=stiffness, damping=damping) for x in places)
