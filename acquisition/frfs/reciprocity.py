"""Reciprocity: whether what A does to B is what B does to A."""

from __future__ import annotations

import numpy as np
import pandas as pd

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.dof import Dof
from acquisition.frfs.frf import FrfSet

ALIKE = 0.95  # correlation that reciprocal FRFs reach, noise apart
LEVEL = 0.1  # relative difference of level that is worth a word
TURNED = 10.0  # difference of phase that is worth a word [deg]
COLUMNS = ("frf", "mirror", "correlation", "level ratio", "phase [deg]", "message")


def reciprocity(frfs: FrfSet, *, band: tuple[float, float] | None = None) -> pd.DataFrame:
    """Compare every FRF with its mirror image, response and reference exchanged, where both were measured.

    Parameters
    ----------
    frfs : FrfSet
        FRFs of several references; the signs of the directions are taken account of.
    band : tuple of float, optional
        Lines compared; default all [Hz].

    Returns
    -------
    pandas.DataFrame
        One row per pair: the two FRFs as response/reference; their correlation |a^H b|^2 / (a^H a b^H b)
        (the FRAC; blind to level and sign) [-]; the ratio of their levels [-]; the phase of the first against
        the second [deg]; and a message where a linear structure with true signs and calibrations cannot
        explain what is seen. Empty if no FRF has a mirror image.

    Notes
    -----
    Ewins, Modal Testing (2000), section 3.10. Noise alone lowers the correlation by (1 + n1) (1 + n2), with
    the noise-to-signal ratios known from the variance; only what is lower than that is called bad.
    """
    data = frfs if band is None else frfs.band(*band)
    signs = [float(a.sign * b.sign) for a, b in zip(data.responses, data.references, strict=True)]
    places = {(_plain(a), _plain(b)): i for i, (a, b) in _numbered(data)}
    rows = []
    for (response, reference), i in places.items():
        j = places.get((reference, response))
        if j is None or response <= reference:
            continue
        one, two = signs[i] * data.values[i], signs[j] * data.values[j]
        rows.append([_name(data, i), _name(data, j), *_compared(one, two, _noise(data)[[i, j]])])
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _numbered(data: FrfSet) -> list[tuple[int, tuple[Dof, Dof]]]:
    return list(enumerate(zip(data.responses, data.references, strict=True)))


def _plain(dof: Dof) -> Dof:
    return Dof(dof.node, abs(dof.direction))


def _name(data: FrfSet, row: int) -> str:
    return f"{data.responses[row]}/{data.references[row]}"


def _noise(data: FrfSet) -> FloatArray:
    """Return the noise-to-signal ratio of each FRF, shape (n_frf,) [-]; 0 where no variance is known."""
    if data.variance is None:
        return np.zeros(len(data.values))
    power = (np.abs(data.values) ** 2).sum(axis=1)
    noise = data.variance.sum(axis=1)
    return np.asarray(noise / np.maximum(power - noise, 1e-3 * power), dtype=np.float64)


def _compared(one: ComplexArray, two: ComplexArray, noise: FloatArray) -> tuple[float, float, float, str]:
    powers = np.array([np.vdot(one, one).real, np.vdot(two, two).real], dtype=np.float64)
    if powers.min() == 0:
        return 0.0, np.nan, np.nan, "one of the two is zero: a dead channel"
    across = complex(np.vdot(two, one))
    correlation = abs(across) ** 2 / float(powers.prod())
    clean = powers / (1 + noise)
    level = float(np.sqrt(clean[0] / clean[1]))
    phase = float(np.degrees(np.angle(across)))
    expected = ALIKE / float(np.prod(1 + noise))
    return correlation, level, phase, _message(correlation, level, phase, expected)


def _message(correlation: float, level: float, phase: float, expected: float) -> str:
    if correlation < expected:
        return (
            f"not reciprocal: correlation {correlation:.2f}; a place or direction is wrong, a hit landed "
            "elsewhere, or a sensor was moved in between"
        )
    if abs(phase) > 180 - TURNED:
        return "opposite sign: a direction or polarity is wrong"
    if abs(phase) > TURNED:
        return f"{phase:+.0f} degrees apart: a channel lags"
    if abs(np.log(level)) > np.log1p(LEVEL):
        return f"levels differ by {100 * (level - 1):+.0f} %: check the calibration of both sensors"
    return ""
