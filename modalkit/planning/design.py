"""A test in its essentials, and the covariance of its data with all doubts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from acquisition.arrays import FloatArray, IntArray
from modalkit.planning.known import KnownTest
from modalkit.planning.responses import TOLERANCES, Stations

_UNKNOWN = 30.0


@dataclass(frozen=True, eq=False)
class Design:
    """Everything that a change of the test may change.

    Parameters
    ----------
    stations : tuple of int
        Which stations are hit; the sensor's own among them where there is a drive point.
    modes : int
        Modes in the band [-].
    calibration, repeatability : float
        Relative standard deviations of level and of frequencies at re-mounting [-].
    noise : float
        Standard deviations of the identification over those told [-].
    position_sigma : float
        Of the hammer's points [m].
    tolerances : tuple of float
        Doubts in E, density, thickness, length, width, relative [-].
    damping : float
        Doubt in the damping expected, relative [-].
    damping_known, shapes : bool
        Whether damping and modal constants tell anything.
    absolute : bool
        Whether constants have an absolute level.
    baseline : bool
        Whether the same specimen was tested before the effect was there.
    """

    stations: tuple[int, ...]
    modes: int
    calibration: float
    repeatability: float
    noise: float
    position_sigma: float
    tolerances: tuple[float, ...]
    damping: float
    damping_known: bool
    shapes: bool
    absolute: bool
    baseline: bool


def present(known_test: KnownTest) -> Design:
    """Return the test as it is told.

    Parameters
    ----------
    known_test : KnownTest
        The test.
    """
    setup = known_test.setup
    hit = tuple(i for i in range(len(setup.points)) if setup.drive or i != setup.sensor)
    return Design(
        stations=hit,
        modes=setup.modes,
        calibration=setup.calibration,
        repeatability=setup.repeatability,
        noise=1.0,
        position_sigma=setup.position_sigma,
        tolerances=tuple(float(getattr(setup.tolerances, name)) for name in TOLERANCES),
        damping=setup.tolerances.damping,
        damping_known=known_test.damping_known,
        shapes=known_test.shapes,
        absolute=known_test.absolute,
        baseline=setup.baseline,
    )


def columns(design: Design, stations: Stations) -> IntArray:
    """Return which entries of a row of data a test has.

    Parameters
    ----------
    design : Design
        The test.
    stations : Stations
        What the entries are.
    """
    n, modes = stations.modes, np.arange(design.modes)
    parts = [modes]
    if design.damping_known or design.baseline:
        parts.append(n + modes)
    if design.shapes:
        hit = np.array(design.stations)
        parts.append((2 * n + hit[:, None] * n + modes).ravel())
    return np.concatenate(parts)


def whitener(design: Design, known_test: KnownTest, stations: Stations) -> FloatArray:
    """Return W with ``W @ data`` of unit covariance, tolerances and all other doubts counted in.

    Parameters
    ----------
    design : Design
        The test.
    known_test : KnownTest
        How well each kind of datum is known.
    stations : Stations
        The rig's own sensitivities.

    Returns
    -------
    (n_data, n_data) array
        Inverse of the Cholesky factor of the covariance; a pair of tests has twice the noise, and neither
        tolerances nor doubts in level and damping.
    """
    size = len(stations.nominal)
    doubts = [_own_noise(design, known_test, stations) * (np.sqrt(2.0) if design.baseline else 1.0)]
    if not design.baseline:
        named = zip(TOLERANCES, design.tolerances, strict=True)
        systematic = [sigma * stations.tolerances[name] for name, sigma in named]
        systematic.append(design.calibration * stations.gain)
        doubts.append(np.column_stack(systematic))
        n = stations.modes
        damping = np.zeros((size, n))
        damping[n + np.arange(n), np.arange(n)] = design.damping * stations.material_share
        doubts.append(damping)
    if not design.absolute:
        doubts.append(_UNKNOWN * np.column_stack([stations.gain_of(mode) for mode in range(stations.modes)]))
    factor = np.hstack(doubts)[columns(design, stations)]
    lower = scipy.linalg.cholesky(factor @ factor.T, lower=True)
    return np.asarray(scipy.linalg.solve_triangular(lower, np.eye(len(lower)), lower=True))


def _own_noise(design: Design, known_test: KnownTest, stations: Stations) -> FloatArray:
    """Return what is new with every test, one column per independent cause."""
    n, count = stations.modes, len(stations.x)
    frequency, damping, shape = (
        _one_more(v) for v in (known_test.frequency, known_test.damping, known_test.shape)
    )
    diagonal = np.concatenate(
        [
            np.hypot(design.noise * frequency, design.repeatability),
            design.noise * damping,
            np.tile(design.noise * shape, count),
        ]
    )
    strayed = np.zeros((len(diagonal), count))
    for i in range(count):
        strayed[2 * n + i * n : 2 * n + (i + 1) * n, i] = design.position_sigma * stations.slopes[i]
    return np.hstack([np.diag(diagonal), strayed])


def _one_more(values: FloatArray) -> FloatArray:
    """Take the mode above the band to be known as the one below it."""
    return np.append(values, values[-1])
