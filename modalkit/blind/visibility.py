"""How plainly a hidden effect stands in the data, by the rig's own model: a check on what may be asked."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from modalkit.simulator.bodies.solid.solid import Solid
from modalkit.simulator.matching import match
from modalkit.simulator.scene import Scene, nominal_scene
from modalkit.simulator.setup import Setup

_FREQUENCY_SIGMA = 2e-4
_SHAPE_SIGMA = 0.02
_DAMPING_SIGMA = 0.05
_STEP = 1e-3
_ELEMENTS: dict[str, Any] = {"beam": 6, "plate": (4, 2), "solid": 6}
_HARDER = 1.5
_TOLERANCES = ("E", "density", "thickness", "length", "width")


@dataclass(frozen=True, eq=False)
class _Reading:
    """What a test reads of the modes the band was chosen for.

    Frequency [rad/s], decay [1/s], modal constants phi_i phi_sensor [1/kg], the change of ln f from the median
    level to a harder hit, and the scatter that the test's conduct adds to ln f and to the constants [-].
    """

    frequency: FloatArray
    decay: FloatArray
    constants: ComplexArray
    level_shift: FloatArray
    drift: float
    tilt: float

    def vector(self, scale: FloatArray) -> FloatArray:
        """Return ln f, ln decay, level shifts, and the constants over their modes' ``scale``, in one row."""
        constants = (self.constants / scale).ravel()
        return np.concatenate(
            [np.log(self.frequency), np.log(self.decay), self.level_shift, constants.real, constants.imag]
        )


def _read(scene: Scene, like: _Reading | None = None, shapes: Scene | None = None) -> _Reading:
    setup = scene.setup
    if not isinstance(scene.body, Solid):
        scene = scene.with_body(elements=_ELEMENTS[setup.kind])
    modes = scene.elastic()
    if shapes is not None:
        nominal = shapes.elastic().take(slice(0, setup.modes))
        chosen = match(nominal, modes)
    else:
        chosen = np.arange(setup.modes)
    poles = modes.poles[chosen]
    constants = modes.residues[:, chosen] * 2j * poles.imag
    constants = scene.chain.gain * constants * np.exp(-1j * poles.imag * scene.chain.delay)
    shift = np.zeros(len(chosen))
    if scene.depends_on_level:
        harder = scene.elastic(_HARDER * setup.peak).poles[chosen]
        shift = np.log(np.abs(harder) / np.abs(poles))
    return _Reading(
        np.abs(poles),
        scene.chain.window - poles.real,
        constants,
        shift,
        scene.chain.drift,
        scene.chain.tilt,
    )


def visibility(scene: Scene, before: Scene) -> float:
    """Return how many standard deviations an effect moves the data off what tolerances allow.

    The data are taken as Gaussian with rough figures for identification (frequency 0.02 %, decay 5 %,
    constants 2 % of each mode's largest), plus the stated repeatability, calibration, tolerances and places of
    the points, whose effect is linearised on the rig's own model. With a baseline, tolerances and calibration
    cancel. What scatters from hit to hit counts by its scatter over that of the hits.

    Parameters
    ----------
    scene, before : Scene
        The same specimen with and without the effect.

    Returns
    -------
    float
        Mahalanobis length of the change [-].
    """
    setup = scene.setup
    nominal = nominal_scene(setup)
    base = _read(nominal)
    scale = np.abs(base.constants).max(axis=0)
    first, second = _read(scene, shapes=nominal), _read(before, shapes=nominal)
    change = second.vector(scale) - first.vector(scale)
    n = setup.modes
    sigma = np.concatenate(
        [
            np.full(n, np.hypot(_FREQUENCY_SIGMA, setup.repeatability)),
            np.full(n, _DAMPING_SIGMA),
            np.full(n, _FREQUENCY_SIGMA),
            np.full(len(change) - 3 * n, _SHAPE_SIGMA),
        ]
    )
    covariance = np.diag(sigma**2) * (2.0 if setup.baseline else 1.0)
    if not setup.baseline:
        columns = _tolerance_columns(setup, base, scale)
        covariance = covariance + columns @ columns.T
    square = change @ np.linalg.solve(covariance, change)
    square += n * (first.drift / _FREQUENCY_SIGMA) ** 2 / len(setup.points)
    square += len(setup.points) * (0.5 * first.tilt**2 / _SHAPE_SIGMA) ** 2
    return float(np.sqrt(square))


def _tolerance_columns(setup: Setup, nominal: _Reading, scale: FloatArray) -> FloatArray:
    """Return the change of the data per standard deviation of each doubt, one column each."""
    start = nominal.vector(scale)
    columns = []
    for name in _TOLERANCES:
        moved = _read(nominal_scene(setup, factors={name: 1.0 + _STEP}))
        columns.append((moved.vector(scale) - start) / _STEP * getattr(setup.tolerances, name))
    n = setup.modes
    constants = (nominal.constants / scale).ravel()
    gain = np.concatenate([np.zeros(3 * n), constants.real, constants.imag])
    damping = np.zeros((len(start), n))
    share = (nominal.decay - setup.window) / nominal.decay
    damping[n + np.arange(n), np.arange(n)] = setup.tolerances.damping * share
    return np.column_stack([*columns, setup.calibration * gain, damping])
