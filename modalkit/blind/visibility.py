"""How plainly a hidden effect stands in the data, by the rig's own model: a check on what may be asked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.blind.scene import Scene, nominal_scene
from modalkit.blind.setup import Setup

_FREQUENCY_SIGMA = 2e-4
_SHAPE_SIGMA = 0.02
_DAMPING_SIGMA = 0.05
_STEP = 1e-3
_ELEMENTS = 6
_TOLERANCES = ("E", "density", "thickness", "length", "width")


@dataclass(frozen=True, eq=False)
class _Reading:
    """Frequency [rad/s], decay [1/s] and phi_i phi_sensor [1/kg] of the modes the band was chosen for."""

    frequency: FloatArray
    decay: FloatArray
    level: FloatArray

    def vector(self, scale: FloatArray) -> FloatArray:
        """Return ln f, ln decay, and the levels over their modes' ``scale``, in one row."""
        return np.concatenate([np.log(self.frequency), np.log(self.decay), (self.level / scale).ravel()])


def _read(scene: Scene) -> _Reading:
    setup = scene.setup
    skip = 0 if setup.clamped else 2
    wanted = slice(skip, skip + setup.modes)
    modes = scene.with_beam(elements=_ELEMENTS).modes()
    poles = modes.poles[wanted]
    level = (modes.residues(setup.sensor)[0][:, wanted] * 2j * poles.imag).real
    return _Reading(np.abs(poles), scene.window - poles.real, scene.gain * level)


def visibility(scene: Scene, before: Scene) -> float:
    """Return how many standard deviations an effect moves the data off what tolerances allow.

    The data are taken as Gaussian with rough figures for identification (frequency 0.02 %, decay 5 %,
    residues 2 % of each mode's largest), plus the stated repeatability, calibration and tolerances, whose
    effect is linearised on the rig's own model. With a baseline, tolerances and calibration cancel.

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
    nominal = _read(nominal_scene(setup))
    scale = np.abs(nominal.level).max(axis=0)
    change = _read(scene).vector(scale) - _read(before).vector(scale)
    n = setup.modes
    sigma = np.concatenate(
        [
            np.full(n, np.hypot(_FREQUENCY_SIGMA, setup.repeatability)),
            np.full(n, _DAMPING_SIGMA),
            np.full(len(change) - 2 * n, _SHAPE_SIGMA),
        ]
    )
    covariance = np.diag(sigma**2) * (2.0 if setup.baseline else 1.0)
    if not setup.baseline:
        columns = _tolerance_columns(setup, nominal, scale)
        covariance = covariance + columns @ columns.T
    return float(np.sqrt(change @ np.linalg.solve(covariance, change)))


def _tolerance_columns(setup: Setup, nominal: _Reading, scale: FloatArray) -> FloatArray:
    """Return the change of the data per standard deviation of each doubt, one column each."""
    base = nominal_scene(setup)
    start = nominal.vector(scale)
    columns = []
    for name in _TOLERANCES:
        if name == "length":
            moved = base.with_beam(start=base.beam.start - _STEP * base.beam.length)
        else:
            moved = base.with_beam(**{name: getattr(base.beam, name) * (1 + _STEP)})
        columns.append((_read(moved).vector(scale) - start) / _STEP * getattr(setup.tolerances, name))
    n = setup.modes
    gain = np.concatenate([np.zeros(2 * n), (nominal.level / scale).ravel()])
    damping = np.zeros((len(start), n))
    share = (nominal.decay - setup.window) / nominal.decay
    damping[n + np.arange(n), np.arange(n)] = setup.tolerances.damping * share
    return np.column_stack([*columns, setup.calibration * gain, damping])
