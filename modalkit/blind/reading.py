"""What a test reads of a scene, by the rig's own coarse model, and how well it can be read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg

from acquisition.arrays import ComplexArray, FloatArray
from modalkit.simulator.bodies.complex_modes import ComplexModes
from modalkit.simulator.bodies.solid.solid import Solid
from modalkit.simulator.conduct import DRIFTS
from modalkit.simulator.drawing.block import MODELLED
from modalkit.simulator.matching import match
from modalkit.simulator.scene import Scene, nominal_scene
from modalkit.simulator.setup import Setup

FREQUENCY_SIGMA = 2e-4
SHAPE_SIGMA = 0.02
_DAMPING_SIGMA = 0.05
_STEP = 1e-3
_ELEMENTS: dict[str, Any] = {
    "beam": 6,
    "plate": (4, 2),
    "solid": 6,
    "frame": 3,
    "ribbed": MODELLED,
    "bracket": MODELLED,
}
_HARDER = 1.5
_TREND = 2.4 * DRIFTS / np.sqrt(3)
"""What a slow drift of temperature in every test puts into a line through it, over the repeatability: 24 / pi^2 times
the size of a half-wave, a share of 0 to `DRIFTS` [-]."""
_TOLERANCES = ("E", "density", "thickness", "length", "width")


@dataclass(frozen=True, eq=False)
class Reading:
    """What a test reads of the modes the band was chosen for.

    Frequency [rad/s], decay [1/s], modal constants phi_i phi_sensor [1/kg], how these change along each axis
    (n_axes, n_points, n_modes) [1/(kg m)], the change of ln f from the median level to a harder hit and from the
    first hit to the last, and the scatter that the test's conduct adds to the constants [-].
    """

    frequency: FloatArray
    decay: FloatArray
    constants: ComplexArray
    gradients: ComplexArray
    level_shift: FloatArray
    drift: float
    tilt: float

    def vector(self, scale: FloatArray) -> FloatArray:
        """Return ln f, ln decay, level shifts, drift, and the constants over their modes' ``scale``, in one row."""
        whole = [np.log(self.frequency), np.log(self.decay), self.level_shift, [self.drift]]
        return np.concatenate([*whole, shape_part(self.constants, scale)])


def shape_part(constants: ComplexArray, scale: FloatArray) -> FloatArray:
    """Return real and imaginary parts of constants, (n_points, n_modes), over their modes' scale, in one row."""
    relative = (constants / scale).ravel()
    return np.concatenate([relative.real, relative.imag])


def coarse(scene: Scene) -> Scene:
    """Return a scene whose body, unless it is of bricks, has few elements."""
    kind = scene.setup.kind
    return scene if isinstance(scene.body, Solid) else scene.with_body(elements=_ELEMENTS[kind])


def read(scene: Scene, *, like: ComplexModes | None = None) -> Reading:
    """Return what a test reads of a scene, of the modes that are most similar to some others.

    Parameters
    ----------
    scene : Scene
        With whatever is hidden.
    like : ComplexModes, optional
        Modes to find; default the lowest.
    """
    setup = scene.setup
    modes = coarse(scene).elastic()
    chosen = np.arange(setup.modes) if like is None else match(like, modes)
    poles = modes.poles[chosen]
    factor = scene.chain.gain * 2j * poles.imag * np.exp(-1j * poles.imag * scene.chain.delay)
    shift = np.zeros(len(chosen))
    if scene.depends_on_level:
        harder = scene.elastic(_HARDER * setup.peak).poles[chosen]
        shift = np.log(np.abs(harder) / np.abs(poles))
    return Reading(
        np.abs(poles),
        scene.chain.window - poles.real,
        modes.residues[:, chosen] * factor,
        modes.gradients[..., chosen] * factor,
        shift,
        scene.chain.drift,
        scene.chain.tilt,
    )


@dataclass(frozen=True, eq=False)
class Scales:
    """How a change of the data is measured: in standard deviations of what noise and tolerances do.

    Parameters
    ----------
    nominal : Scene
        The rig as stated.
    modes : ComplexModes
        Of it, those that the band was chosen for.
    base : Reading
        Of it.
    scale : (n_modes,) array
        Largest constant of each mode [1/kg].
    root : (n, n) array
        Lower Cholesky factor of the covariance of the data.
    """

    nominal: Scene
    modes: ComplexModes
    base: Reading
    scale: FloatArray
    root: FloatArray

    def standardised(self, changes: FloatArray) -> FloatArray:
        """Return changes of the data, one or one a column, in standard deviations [-]."""
        return np.asarray(scipy.linalg.solve_triangular(self.root, changes, lower=True))

    def change(self, scene: Scene, before: Scene) -> FloatArray:
        """Return the whitened change of the data from one scene to another [-]."""
        after, first = (read(s, like=self.modes).vector(self.scale) for s in (scene, before))
        return self.standardised(after - first)


def scales(setup: Setup) -> Scales:
    """Return the scales of a test.

    The data are taken as Gaussian with rough figures for identification (frequency 0.02 %, decay 5 %,
    constants 2 % of each mode's largest), plus the stated repeatability, calibration, tolerances and places of
    the points, whose effect is linearised on the rig's own model. With a baseline, tolerances and calibration
    cancel.

    Parameters
    ----------
    setup : Setup
        What is stated.
    """
    nominal = coarse(nominal_scene(setup))
    base = read(nominal)
    scale = np.abs(base.constants).max(axis=0)
    n, size = setup.modes, len(base.vector(scale))
    sigma = np.concatenate(
        [
            np.full(n, np.hypot(FREQUENCY_SIGMA, setup.repeatability)),
            np.full(n, _DAMPING_SIGMA),
            np.full(n, FREQUENCY_SIGMA),
            [np.hypot(FREQUENCY_SIGMA, _TREND * setup.repeatability)],
            np.full(size - 3 * n - 1, SHAPE_SIGMA),
        ]
    )
    covariance = np.diag(sigma**2) * (2.0 if setup.baseline else 1.0)
    if not setup.baseline:
        columns = _tolerance_columns(setup, base, scale)
        covariance = covariance + columns @ columns.T
    root = np.asarray(np.linalg.cholesky(covariance), dtype=np.float64)
    return Scales(nominal, nominal.elastic().take(slice(0, setup.modes)), base, scale, root)


def _tolerance_columns(setup: Setup, nominal: Reading, scale: FloatArray) -> FloatArray:
    """Return the change of the data per standard deviation of each doubt, one column each."""
    start = nominal.vector(scale)
    columns = []
    for name in _TOLERANCES:
        if not getattr(setup.tolerances, name):
            continue
        moved = read(nominal_scene(setup, factors={name: 1.0 + _STEP}))
        columns.append((moved.vector(scale) - start) / _STEP * getattr(setup.tolerances, name))
    n = setup.modes
    gain = np.concatenate([np.zeros(3 * n + 1), shape_part(nominal.constants, scale)])
    damping = np.zeros((len(start), n))
    share = (nominal.decay - setup.window) / nominal.decay
    damping[n + np.arange(n), np.arange(n)] = setup.tolerances.damping * share
    return np.column_stack([*columns, setup.calibration * gain, damping])
