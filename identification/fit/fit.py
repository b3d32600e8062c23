"""From candidate poles to the fit the data bear out: refine, prune, complete, weigh."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from acquisition.arrays import BoolArray, ComplexArray, FloatArray
from acquisition.frfs.frf import FrfSet
from identification.fit.alignment import aligned, distinct
from identification.fit.course import without_course
from identification.fit.drift import Drift, carried_over, estimate_drift
from identification.fit.equations import background
from identification.fit.equations.normal_equations import Weights
from identification.fit.equations.projection import State
from identification.fit.equations.pruning import inside
from identification.fit.equations.refine import Fit, refine
from identification.fit.equations.residues import uniform_weights
from identification.fit.noise import leakage, window_shaped
from identification.fit.noise.weights import absorbed_by, left_over, noise_weights, search_weights
from identification.fit.poly_reference import RankOne, hold_to_rank_one, sorted_frfs
from identification.fit.search import manual_selection
from identification.fit.search.completion import (
    COARSE,
    SHORT,
    completed,
    find_split_mode,
    pruned,
    with_odd_term,
    without_split_modes,
)

_LONG = 40
_FEW = 2  # steps of a provisional fit: the first finds the frequency, the second the damping too
_FINE = 1e-10
_BROAD = 0.1
_AT_REST = 1e-4  # gain in the misfit, there a chi-square
_COARSE_WEIGHINGS = 2  # the second sees the noise of a fit weighted by noise
_SAME_NOISE = 0.01  # change of a variance that moves a standard deviation by half a per cent at most


@dataclass(frozen=True, eq=False, kw_only=True)
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
    frfs : FrfSet
        The FRFs carried over to common poles: what was fitted.
    drift : Drift
        How the frequencies of each FRF differ from the common ones.
    held : RankOne, optional
        The fit's factors, where its residues were held to rank one.
    rank_excess : float
        By what factor the misfit of rank-one residues exceeds what noise allows, where that is why they were
        left free; 0 otherwise [-].
    """

    fit: Fit
    weights: Weights
    variance: FloatArray
    residual: ComplexArray
    absorbed: FloatArray
    measured: bool
    frfs: FrfSet
    drift: Drift
    held: RankOne | None = None
    rank_excess: float = 0.0

    def excess(self) -> float:
        """Return the power the fit leaves over that of the noise, the middle one of all FRFs [-]."""
        ratio = np.abs(self.residual) ** 2 / self.variance
        return float(np.median(ratio.mean(axis=1) / np.maximum(1.0 - self.absorbed, 0.02).mean(axis=1)))

    def left_unexplained(self) -> float:
        """Return the logarithm of the power that the fit leaves as noise, its mean over all FRFs and lines [-]."""
        tiny = np.finfo(float).tiny
        return float(np.mean(np.log(np.maximum(self.variance, tiny))) + np.log(max(self.excess(), tiny)))


def fit_candidates(
    frfs: FrfSet, start: ComplexArray, *, band: tuple[float, float], course: FloatArray | None = None
) -> Fitted:
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
    course : (n_frf,) array, optional
        By what all frequencies of each FRF lie beside the candidates, where that is known beforehand; see
        :func:`identification.fit.course.course_of` [-].

    Returns
    -------
    Fitted
        The fit and the noise; residues are not held to rank one yet, see :func:`with_named`.

    Raises
    ------
    EstimationError
        If no candidate is a mode of the band.
    """
    ladder = background.term_ladder(band)
    data = frfs if course is None else without_course(frfs, start, course, ladder[0])
    fit = refine(data, start, uniform_weights(data), powers=ladder[0], iterations=SHORT, tolerance=COARSE)
    weights = search_weights(data, fit)
    fit = refine(data, fit.poles, weights, powers=ladder[0], iterations=SHORT, tolerance=COARSE)
    fit = without_split_modes(data, pruned(data, fit, weights, band, iterations=SHORT, tolerance=COARSE))
    known = None if course is None else Drift.common_to(fit.poles, course)
    data, fit, drift = aligned(frfs, fit, known)
    fit = completed(data, fit, band, ladder)
    if drift.variance.any():
        data, fit, drift = aligned(frfs, without_split_modes(data, fit), drift)
    fit = _without_broad(data, fit, band, ladder)
    fitted = _weighted(frfs, without_split_modes(data, fit), drift, band)
    while find_split_mode(fitted.frfs, fitted.fit) is not None:
        fit = without_split_modes(fitted.frfs, fitted.fit)
        fitted = _weighted(frfs, fit, fitted.drift, band)
    fit = with_odd_term(
        fitted.frfs, fitted.fit, fitted.weights, band
    )  # where FRFs disagree, the term would take that
    return fitted if fit is fitted.fit else _weighted(frfs, fit, fitted.drift, band)


def with_named(fitted: Fitted, add: Sequence[float], *, band: tuple[float, float]) -> Fitted:
    """Return a fit of candidates with the modes that the user names, each mode held to one shape where it has one.

    Parameters
    ----------
    fitted : Fitted
        The fit of :func:`fit_candidates`.
    add : sequence of float
        Frequencies at which a mode is kept regardless of the data [Hz].
    band : tuple of float
        The band [Hz].

    Raises
    ------
    InputError
        If no mode can be kept where one is named.
    """
    frfs = fitted.frfs
    return _held(frfs, _with_added(frfs, fitted, add, band), band, add)


def provisional(fitted: Fitted, hertz: float) -> Fit:
    """Return a fit with one more mode, refined by a few steps only: what a picture needs of :func:`with_named`.

    Parameters
    ----------
    fitted : Fitted
        The fit to add to.
    hertz : float
        Where the mode is [Hz].

    Raises
    ------
    InputError
        If that is not among the lines.
    """
    fit, frfs = fitted.fit, fitted.frfs
    pole = manual_selection.best_start(frfs, fit.poles, fit.linear.powers, fitted.weights, hertz)
    poles, powers = np.append(fit.poles, pole), fit.linear.powers
    return refine(frfs, poles, fitted.weights, powers=powers, iterations=_FEW)


def _with_added(frfs: FrfSet, fitted: Fitted, hertz: Sequence[float], band: tuple[float, float]) -> Fitted:
    """Add a mode at each frequency the user names, and do not ask whether it is significant."""
    fit = fitted.fit
    for value in hertz:
        pole = manual_selection.best_start(frfs, fit.poles, fit.linear.powers, fitted.weights, value)
        poles, before = np.append(fit.poles, pole), fit.poles
        fit = refine(frfs, poles, fitted.weights, powers=fit.linear.powers, iterations=_LONG, enough=_AT_REST)
        modes = inside(fit.poles, band, frfs.df)
        manual_selection.must_have_stayed(fit.poles, before, value, modes, frfs.df)
    if fit is fitted.fit:
        return fitted
    return replace(
        fitted, fit=fit, residual=left_over(frfs, fit), absorbed=absorbed_by(frfs, fit, fitted.weights)
    )


def _held(frfs: FrfSet, fitted: Fitted, band: tuple[float, float], add: Sequence[float]) -> Fitted:
    """Hold residues to rank one where several references were measured and agree on the shapes.

    A mode that the user names may leave its place as residues are held; it is refused at the step that does so.
    """
    places = sorted_frfs(frfs)
    if places is None:
        return fitted
    modes = inside(fitted.fit.poles, band, frfs.df)
    fade = window_shaped.at_start(fitted.weights.fade)

    def stayed(poles: ComplexArray) -> None:
        manual_selection.must_have_a_mode(poles, inside(poles, band, frfs.df), add, frfs.df)

    held = hold_to_rank_one(
        frfs,
        fitted.fit,
        fitted.weights,
        places,
        modes,
        inflation=fade,
        watch=stayed if add else lambda _: None,
    )
    if held.excess > 1.0:
        return replace(fitted, rank_excess=held.excess)
    result = replace(fitted, fit=held.fit, held=held)
    return replace(result, residual=left_over(frfs, held.fit))


def _without_broad(
    frfs: FrfSet, fit: Fit, band: tuple[float, float], ladder: tuple[tuple[int, ...], ...]
) -> Fit:
    """Do without poles whose half-power band is a tenth of the band, if a background explains as much."""
    for pole in fit.poles[_broad(fit.poles, band, frfs.df)]:
        rest = fit.poles[np.abs(fit.poles - pole) > 1e-9 * abs(pole)]
        if not inside(rest, band, frfs.df).any() or len(rest) == len(fit.poles):
            continue
        weights = search_weights(frfs, fit)
        limit = float(stats.chi2.isf(1e-6, 2 * len(frfs.values))) * window_shaped.at_start(weights.fade)
        powers = fit.linear.powers
        plain = refine(frfs, rest, weights, powers=powers, iterations=SHORT, tolerance=COARSE)
        plain = completed(frfs, plain, band, ladder)
        again = refine(
            frfs, plain.poles, weights, powers=plain.linear.powers, iterations=SHORT, tolerance=COARSE
        )
        fewer = inside(again.poles, band, frfs.df).sum() < inside(fit.poles, band, frfs.df).sum()
        if fewer and 2.0 * (again.cost - fit.cost) < limit:
            fit = again
    return fit


def _broad(poles: ComplexArray, band: tuple[float, float], df: float) -> BoolArray:
    return np.asarray(inside(poles, band, df) & (-poles.real / np.pi > _BROAD * (band[1] - band[0])))


def _weighted(frfs: FrfSet, fit: Fit, drift: Drift, band: tuple[float, float]) -> Fitted:
    """Weigh by the noise itself, carry over to common poles and refine until all agree."""
    data = carried_over(frfs, fit, drift.at(fit.poles))
    residual = left_over(data, fit)
    absorbed = absorbed_by(data, fit, search_weights(data, fit, residual))
    weights, variance, measured = _noise(data, fit, residual, absorbed)
    for _ in range(_COARSE_WEIGHINGS):
        fit = _refined(data, fit, weights, band, COARSE)
        used, fitted = (weights, variance, measured), data
        drift = estimate_drift(data, fit, weights, own=distinct(fit.poles), previous=drift)
        data = carried_over(frfs, fit, drift)
        residual, absorbed = left_over(data, fit), absorbed_by(data, fit, weights)
        weights, variance, measured = _noise(data, fit, residual, absorbed)
    known = None
    if data is fitted and np.abs(np.log(variance / used[1])).max() < _SAME_NOISE:
        (weights, variance, measured), known = used, fit.equations
    fit = _refined(data, fit, weights, band, _FINE, known)
    drift = estimate_drift(data, fit, weights, own=distinct(fit.poles), previous=drift)
    residual, absorbed = left_over(data, fit), absorbed_by(data, fit, weights)
    return Fitted(
        fit=fit,
        weights=weights,
        variance=variance,
        residual=residual,
        absorbed=absorbed,
        measured=measured,
        frfs=data,
        drift=drift,
    )


def _noise(
    frfs: FrfSet, fit: Fit, residual: ComplexArray, absorbed: FloatArray
) -> tuple[Weights, FloatArray, bool]:
    """Return weights and variances by the noise, as of :func:`identification.fit.noise.weights.noise_weights`."""
    return noise_weights(frfs, residual, absorbed, leakage.leaked(frfs, fit.poles, fit.linear.residues))


def _refined(
    frfs: FrfSet,
    fit: Fit,
    weights: Weights,
    band: tuple[float, float],
    tolerance: float,
    known: State | None = None,
) -> Fit:
    """Refine by the noise and strike off what it does not bear out."""
    fit = refine(
        frfs,
        fit.poles,
        weights,
        powers=fit.linear.powers,
        iterations=_LONG,
        tolerance=tolerance,
        enough=_AT_REST,
        known=known,
    )
    return pruned(frfs, fit, weights, band, iterations=_LONG, tolerance=tolerance)
