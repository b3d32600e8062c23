"""How plainly a hidden effect stands in the data, by the rig's own model: a check on what may be asked."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.blind.scene import Scene, nominal_scene
from modalkit.blind.setup import Setup

_FREQUENCY_SIGMA = 2e-4
_SHAPE_SIGMA = 0.02
_DAMPING_SIGMA = 0.05
_STEP = 1e-3
_TOLERANCES = ("E", "density", "thickness", "length", "width")


def features(scene: Scene) -> FloatArray:
    """Return the data vector: ln f, ln decay, and the level of each residue over its mode's largest.

    Parameters
    ----------
    scene : Scene
        What is on the rig.

    Returns
    -------
    (modes * (n_points + 2),) array
        For the modes the band was chosen for; residues with the scale of the mode's largest one [-].
    """
    setup = scene.setup
    frequency, decay, level = _read(scene)
    scale = np.abs(_read(nominal_scene(setup))[2]).max(axis=0)
    return np.concatenate([np.log(frequency), np.log(decay), (level / scale).ravel()])


def _read(scene: Scene) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return frequency [rad/s], decay [1/s] and modal participations phi_i phi_sensor [1/kg] of the band's modes."""
    setup = scene.setup
    skip = 0 if setup.clamped else 2
    wanted = slice(skip, skip + setup.modes)
    modes = scene.modes()
    poles = modes.poles[wanted]
    level = (modes.residues(setup.sensor)[0][:, wanted] * 2j * poles.imag).real
    return np.abs(poles), scene.window - poles.real, scene.gain * level


def visibility(scene: Scene, before: Scene) -> float:
    """Return how many standard deviations an effect moves the data off what tolerances allow.

    The data are taken as Gaussian with rough figures for identification (frequency 0.02 %, decay 5 %,
    residues 2 % of each mode's largest), plus the stated repeatability, calibration and tolerances, whose effect
    is linearised on the rig's own model. With a baseline, tolerances and calibration cancel.

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
    change = features(scene) - features(before)
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
        columns = _tolerance_columns(setup)
        covariance = covariance + columns @ columns.T
    return float(np.sqrt(change @ np.linalg.solve(covariance, change)))


def _tolerance_columns(setup: Setup) -> FloatArray:
    """Return the change of the data per standard deviation of each tolerance, one column each."""
    base = nominal_scene(setup)
    start = features(base)
    columns = []
    for name in _TOLERANCES:
        if name == "length":
            moved = base.with_beam(start=base.beam.start - _STEP * base.beam.length)
        else:
            moved = base.with_beam(**{name: getattr(base.beam, name) * (1 + _STEP)})
        columns.append((features(moved) - start) / _STEP * getattr(setup.tolerances, name))
    columns.append((features(replace(base, gain=1 + _STEP)) - start) / _STEP * setup.calibration)
    n = setup.modes
    for mode in range(n):
        scatter = base.scatter.copy()
        scatter[mode + (0 if setup.clamped else 2)] *= 1 + _STEP
        moved = replace(base, scatter=scatter)
        columns.append((features(moved) - start) / _STEP * setup.tolerances.damping)
    return np.column_stack(columns)
