"""Whether FRFs carry the line shape of a Hann window, as the FRFs themselves show it or as it is stated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.errors import EstimationError
from acquisition.frfs.frf import FrfSet
from acquisition.frfs.line_shape import KINDS, Kind, LineShape
from identification.fit.equations.refine import Fit, refine
from identification.fit.equations.residues import uniform_weights
from identification.fit.fit import Fitted, fit_candidates
from identification.fit.noise.leakage import follows, leaked
from identification.fit.noise.weights import absorbed_by, left_over, noise_weights, search_weights
from identification.fit.search.completion import COARSE, SHORT

RESOLVED = 1.5
"""Distance of poles that a Hann window shows as one [lines]: the half-power width of |W|^2 is 1.44. Doubled, close
modes count as one until the completion of the fit adds the second again; halved, the two poles that imitate the line
shape stay."""

STRONG = 10.0
"""By how much Schwarz's criterion must fall for a line shape that nobody stated [-]: very strong evidence (Kass and
Raftery, J. Am. Stat. Assoc. 90 (1995) 773-795). Doubled: no change where peaks are narrow; at none, peaks far wider
than lines get a shape by chance, and a damping that is off by more than its sigma."""

BROAD = 100.0
"""Decay of a pole over a block beyond which its line shape is left as it is, to 0.1 % [-]. Doubled: work without
effect."""

ASKED = 96
"""FRFs, evenly spread over those of a test, which are asked whether a line shape is worth a fit of all: where one is
carried, all carry it. Doubled: more work, the same line shapes [-]."""


def fit_shaped(
    frfs: FrfSet, start: ComplexArray, *, band: tuple[float, float], course: FloatArray | None = None
) -> Fitted:
    """Fit candidates with the line shape that explains the FRFs best, no window included unless one is stated.

    A shape that nobody states counts if the fit with it explains more than the one without, each pole and term at its
    price (Schwarz, Ann. Stat. 6 (1978) 461-464), and the number of averages, which the law of leakage has beside the
    levels of the noise, too: two poles under a half-power width apart imitate the line shape.
    Beside a course only a stated window counts: what a course leaves on peaks passes for errors of averages.

    Parameters
    ----------
    frfs, start, band, course
        As of :func:`identification.fit.fit.fit_candidates`.

    Raises
    ------
    EstimationError
        If no candidate is a mode of the band.
    """
    kinds = _worth_a_fit(frfs, start) if course is None or frfs.window == "hann" else []
    fits: list[Fitted] = []
    failure: EstimationError | None = None
    for shaped, poles in [(_with(frfs, kind), _merged(start, frfs.df)) for kind in kinds] or [(frfs, start)]:
        try:
            fits.append(fit_candidates(shaped, poles, band=band, course=course))
        except EstimationError as error:
            failure = error
    if kinds and frfs.window is None:
        try:
            fits.append(fit_candidates(frfs, start, band=band))
        except EstimationError as error:
            failure = error
    if not fits:
        raise failure or EstimationError(f"{frfs.source}: no candidate is a mode of the band")
    return min(fits, key=lambda fitted: _price(fitted) - (0.0 if fitted.frfs.line_shape else STRONG))


def _worth_a_fit(frfs: FrfSet, start: ComplexArray) -> list[Kind]:
    """Return the line shapes to fit: both where a window is stated, else those with which few poles fit better."""
    known = frfs.window == "none" or frfs.record is not None or frfs.line_shape is not None
    if known or not np.any(-start.real < BROAD * frfs.df):
        return []
    if frfs.window == "hann":
        return list(KINDS)
    few = _merged(start, frfs.df)
    frfs = frfs.select(list(range(0, len(frfs.values), -(-len(frfs.values) // ASKED))))
    plain, shaped = _of_few(frfs, few), np.array([_of_few(_with(frfs, kind), few) for kind in KINDS])
    best = {
        int(k) for k, better in zip(shaped.argmin(axis=0), shaped.min(axis=0) < plain, strict=True) if better
    }
    return [KINDS[k] for k in sorted(best)]


def _with(frfs: FrfSet, kind: Kind) -> FrfSet:
    return replace(frfs, line_shape=LineShape(kind, 1.0 / frfs.df))


def _merged(poles: ComplexArray, df: float) -> ComplexArray:
    """Return poles with those that a window shows as one replaced by their mean, rising."""
    poles = poles[np.argsort(poles.imag)]
    cuts = np.flatnonzero(np.diff(poles.imag) > RESOLVED * 2 * np.pi * df) + 1
    return np.array([part.mean() for part in np.split(poles, cuts)], dtype=np.complex128)


def _of_few(frfs: FrfSet, poles: ComplexArray) -> tuple[float, float]:
    """Return two measures of how badly poles fit that are refined, but neither struck off nor completed [-].

    The misfit over the power of each FRF, in which a mode that the candidates lack weighs little; and the price, in
    which the error of averages on a narrow peak, of the size of the peak, weighs little.
    """
    fit = refine(frfs, poles, uniform_weights(frfs), iterations=SHORT, tolerance=COARSE)
    weights, misfit = search_weights(frfs, fit), fit.cost
    fit = refine(frfs, fit.poles, weights, iterations=SHORT, tolerance=COARSE)
    residual, absorbed = left_over(frfs, fit), absorbed_by(frfs, fit, weights)
    variance = noise_weights(frfs, residual, absorbed, leaked(frfs, fit.poles, fit.linear.residues))[1]
    return misfit, _criterion(frfs, fit, residual, variance)


def _price(fitted: Fitted) -> float:
    """Return Schwarz's criterion with the noise that the fit leaves: less is better [-]."""
    return _criterion(fitted.frfs, fitted.fit, fitted.residual, fitted.variance)


def _criterion(frfs: FrfSet, fit: Fit, residual: ComplexArray, variance: FloatArray) -> float:
    n_frf = len(residual)
    lack = float(np.sum(np.log(variance) + np.abs(residual) ** 2 / variance))
    unknowns = len(fit.poles) * (2 * n_frf + 2) + n_frf * len(fit.linear.powers) + follows(frfs)
    return float(2.0 * lack + unknowns * np.log(2 * residual.size))
