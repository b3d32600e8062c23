"""From candidate poles to the fit the data bear out: refine, prune, complete the background, weigh, repeat."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.errors import EstimationError
from acquisition.frf import FrfSet
from identification import background, basis, noise
from identification.grams import Weights
from identification.pruning import inside, plausible, significant, threshold
from identification.refine import Fit, refine
from identification.residues import synthesise, uniform_weights

_ROUNDS = 12
_EXTRA_POLES = 4
_SHORT = 12


@dataclass(frozen=True, eq=False)
class Fitted:
    """A fit with the noise it was weighted by.

    Parameters
    ----------
    fit : Fit
        The model.
    weights : Weights
        Reciprocal variances used.
    variance : (n_frf, n_lines) array
        Noise variance of every value [unit of the FRFs squared].
    residual : (n_frf, n_lines) complex array
        Data minus model [unit of the FRFs].
    absorbed : (n_frf or 1, n_lines) array
        Part of each line's power the linear unknowns absorb [-].
    measured : bool
        Whether the variance came with the data; if not it was estimated from the residual.
    """

    fit: Fit
    weights: Weights
    variance: FloatArray
    residual: ComplexArray
    absorbed: FloatArray
    measured: bool


def fit_modes(frfs: FrfSet, start: ComplexArray, *, band: tuple[float, float]) -> Fitted:
    """Fit a modal model starting from candidate poles.

    Candidates that the data do not bear out are struck off; poles beyond the band's edges and more residual
    terms are added as long as the gain is more than noise can give; then the fit is weighted by the noise
    and repeated.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs in the band, without a line at s = 0.
    start : (n,) complex array
        Candidate poles [rad/s].
    band : tuple of float
        The band [Hz].

    Returns
    -------
    Fitted
        The fit and the noise.

    Raises
    ------
    EstimationError
        If no candidate is a mode of the band.
    """
    ladder = background.term_ladder(band)
    rung, left = 0, _EXTRA_POLES
    fit = refine(frfs, start, uniform_weights(frfs), powers=ladder[0], iterations=_SHORT)
    fit = _pruned(frfs, fit, _search_weights(frfs, fit), band, iterations=_SHORT)
    for _ in range(_ROUNDS):
        weights = _search_weights(frfs, fit)
        pole, climb = _extension(frfs, fit, weights, band, ladder, rung, allow_pole=left > 0)
        if pole is None and not climb:
            break
        poles = fit.poles if pole is None else np.append(fit.poles, pole)
        trial = refine(frfs, poles, weights, powers=ladder[rung + climb], iterations=_SHORT)
        trial = _pruned(frfs, trial, weights, band, iterations=_SHORT)
        if inside(trial.poles, band, frfs.df).sum() > inside(fit.poles, band, frfs.df).sum():
            left = 0  # it went into the band to mend the misfit of a mode: not a mode of its own
            continue
        fit, rung, left = trial, rung + climb, left - (pole is not None)
    return _weighted(frfs, fit, band)


def _residual(frfs: FrfSet, fit: Fit) -> ComplexArray:
    return np.asarray(frfs.values - synthesise(frfs.laplace, fit.poles, fit.linear, frfs.form))


def _search_weights(frfs: FrfSet, fit: Fit) -> Weights:
    """Weigh by the scatter from line to line, which does not mind what the model still lacks."""
    level = np.maximum(noise.scatter(_residual(frfs, fit)), noise.quiet_floor(frfs.values)[:, 0])
    return Weights(1.0 / level, np.ones((1, len(frfs.frequency))))


def _pruned(
    frfs: FrfSet, fit: Fit, weights: Weights, band: tuple[float, float], *, iterations: int
) -> Fit:
    """Strike off what is implausible or insignificant, refine, and look again."""
    powers = fit.linear.powers
    fit = refine(frfs, fit.poles, weights, powers=powers, iterations=iterations)
    for _ in range(_ROUNDS):
        keep = plausible(fit.poles, band) & significant(fit, n_lines=len(frfs.frequency))
        if keep.all():
            break
        if not (keep & inside(fit.poles, band, frfs.df)).any():
            raise EstimationError(
                f"{frfs.source}: no mode stands out of the noise between {band[0]:g} and {band[1]:g} Hz; widen "
                "the band, raise the order or check the FRFs"
            )
        fit = refine(frfs, fit.poles[keep], weights, powers=powers, iterations=iterations)
    return fit


def _extension(
    frfs: FrfSet,
    fit: Fit,
    weights: Weights,
    band: tuple[float, float],
    ladder: tuple[tuple[int, ...], ...],
    rung: int,
    *,
    allow_pole: bool,
) -> tuple[complex | None, bool]:
    """Return the pole beyond the edges, or the step up the ladder, that explains more than noise can."""
    n_frf, n_lines = frfs.values.shape
    best, pole = 0.0, None
    if allow_pole and n_lines > 4 * len(fit.poles) + 20:
        trials = background.trial_poles(band)
        gain = 2.0 * background.gains(frfs, fit.poles, fit.linear.powers, weights, trials)
        best = float(gain.max() - threshold(n_frf, n_lines))
        pole = complex(trials[gain.argmax()])
    climb = False
    if rung + 1 < len(ladder) and n_lines > 4 * len(fit.poles) + 20:
        extra = len(ladder[rung + 1]) - len(ladder[rung])
        higher = refine(frfs, fit.poles, weights, powers=ladder[rung + 1], iterations=2)
        gain_up = 2.0 * (fit.cost - higher.cost) - float(stats.chi2.isf(1e-6, extra * n_frf))
        climb = gain_up > max(best, 0.0)
    return (pole if best > 0 and not climb else None), climb


def _weighted(frfs: FrfSet, fit: Fit, band: tuple[float, float]) -> Fitted:
    """Weigh by the noise itself and refine until both agree."""
    weights = _search_weights(frfs, fit)
    for _ in range(3):
        residual, absorbed = _residual(frfs, fit), _absorbed(frfs, fit, weights)
        weights, variance, measured = _noise(frfs, fit, residual, absorbed)
        fit = _pruned(frfs, fit, weights, band, iterations=40)
    return Fitted(fit, weights, variance, _residual(frfs, fit), _absorbed(frfs, fit, weights), measured)


def _noise(
    frfs: FrfSet, fit: Fit, residual: ComplexArray, absorbed: FloatArray
) -> tuple[Weights, FloatArray, bool]:
    known = noise.from_statistics(frfs, frfs.values - residual)
    floor = noise.quiet_floor(frfs.values)
    if known is None:
        weights, variance = noise.from_residual(residual, absorbed, floor)
        return weights, variance, False
    if frfs.variance is None:
        excess = np.mean(np.abs(residual) ** 2 / known / np.maximum(1.0 - absorbed, 0.02), axis=1)
        known = np.maximum(known * excess[:, None], floor)
    level = 1.0 / np.exp(np.mean(np.log(known), axis=1))
    return Weights(level, 1.0 / (known * level[:, None])), known, True


def _absorbed(frfs: FrfSet, fit: Fit, weights: Weights) -> FloatArray:
    columns = basis.build(frfs.laplace, fit.poles, frfs.form, fit.linear.powers).linear
    poles_too = 1.0 + 1.0 / len(frfs.values)
    return np.asarray(np.minimum(poles_too * noise.leverage(columns, weights), 0.98))
