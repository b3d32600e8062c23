"""Whether FRFs carry the line shape of a Hann window, as the FRFs themselves show it or as it is stated."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import ComplexArray
from acquisition.frfs.frf import FrfSet
from acquisition.frfs.line_shape import KINDS, Kind, LineShape
from identification.fit.equations.normal_equations import Weights
from identification.fit.equations.refine import Fit, refine
from identification.fit.equations.residues import uniform_weights
from identification.fit.noise.weights import absorbed_by, left_over, noise_weights
from identification.fit.search.completion import COARSE, SHORT

RESOLVED = 1.5
"""Distance of poles that a Hann window shows as one [lines]: the half-power width of |W|^2 is 1.44. Doubled, close modes
count as one until the completion of the fit adds the second again; halved, the two poles that imitate the line shape
stay."""

HALVED = 2.0
"""By how much a line shape must lower the misfit of the same poles to be taken for that of a window [-]. One that is in
the FRFs lowers it ten times and more where it matters; drift, leakage or modes that are not linear, by a fifth.
Doubled: windows pass unnoticed where noise is a third of what they change."""

BROAD = 100.0
"""Decay of a pole over a block beyond which its line shape is left as it is, to 0.1 % [-]. Doubled: work without effect."""


FEWEST = 16
"""Lines of which two are left out at the most [-]. Doubled: the ends of short sets, smoothed otherwise, move modes."""

WEIGHINGS = 2
"""Fits that are compared: the second is weighted by the noise that the first leaves. A third changes little [-]."""


@dataclass(frozen=True, eq=False)
class Shaped:
    """FRFs with their line shape, and candidate poles for it.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs, ``line_shape`` set where there is one.
    start : (n,) complex array
        Candidate poles [rad/s].
    """

    frfs: FrfSet
    start: ComplexArray


def with_line_shape(frfs: FrfSet, start: ComplexArray) -> Shaped:
    """Return FRFs with the line shape that explains them best, no window included unless one is stated.

    A window that nobody states counts if it halves the misfit that the same poles leave without it, and if it explains
    the FRFs better than all candidates do without one, each further pole at its price (Schwarz, Ann. Stat. 6 (1978)
    461-464): two poles under a half-power width apart imitate the line shape.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs in the band.
    start : (n,) complex array
        Candidate poles found as if there were no window [rad/s].
    """
    known = frfs.window == "none" or frfs.record is not None or frfs.line_shape is not None
    if known or not np.any(-start.real < BROAD * frfs.df):
        return Shaped(frfs, start)
    few = merged(start, RESOLVED * 2 * np.pi * frfs.df)
    kinds = [Shaped(_with(frfs, kind), few) for kind in KINDS]
    misfits = [_misfit(shaped) / shaped.frfs.values.size for shaped in kinds]
    best = int(np.argmin(misfits))
    if frfs.window == "hann":
        return kinds[best]
    if HALVED * misfits[best] > _misfit(Shaped(frfs, few)) / frfs.values.size:
        return Shaped(frfs, start)
    plain = Shaped(frfs.band(*kinds[best].frfs.frequency[[0, -1]]), start)
    return kinds[best] if _price(kinds[best]) < _price(plain) else Shaped(frfs, start)


def _with(frfs: FrfSet, kind: Kind) -> FrfSet:
    """Return FRFs with a line shape; the first and last of smoothed lines, which lack a neighbour, are left out."""
    inner = frfs.band(*frfs.frequency[[1, -2]]) if kind == "smoothed" and len(frfs.frequency) > FEWEST else frfs
    return replace(inner, line_shape=LineShape(kind, 1.0 / frfs.df))


def merged(poles: ComplexArray, distance: float) -> ComplexArray:
    """Return poles with those nearer to one another than a distance [rad/s] replaced by their mean, rising."""
    poles = poles[np.argsort(poles.imag)]
    cuts = np.flatnonzero(np.diff(poles.imag) > distance) + 1
    return np.array([part.mean() for part in np.split(poles, cuts)], dtype=np.complex128)


def _misfit(shaped: Shaped) -> float:
    """Return the misfit of the refined poles over the power of each FRF [-]."""
    return _refined(shaped, uniform_weights(shaped.frfs)).cost


def _refined(shaped: Shaped, weights: Weights) -> Fit:
    return refine(shaped.frfs, shaped.start, weights, iterations=SHORT, tolerance=COARSE)


def _price(shaped: Shaped) -> float:
    """Return Schwarz's criterion with the noise that the fit leaves: the less, the better the FRFs are explained [-]."""
    frfs, weights = shaped.frfs, uniform_weights(shaped.frfs)
    variance = np.ones(frfs.values.shape)
    for _ in range(WEIGHINGS):
        fit = _refined(shaped, weights)
        residual = left_over(frfs, fit)
        weights, variance, _ = noise_weights(frfs, residual, absorbed_by(frfs, fit, weights))
    unknowns = len(shaped.start) * (2 * len(frfs.values) + 2)
    lack = float(np.sum(np.log(variance) + np.abs(residual) ** 2 / variance))
    return 2.0 * lack + unknowns * np.log(2 * residual.size)
