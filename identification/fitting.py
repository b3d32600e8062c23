"""From candidate poles to the fit the data bear out: refine, prune, complete, weigh."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from acquisition.arrays import BoolArray, ComplexArray, FloatArray
from acquisition.errors import EstimationError
from acquisition.frf import FrfSet
from identification import background, basis, fading, leftover, noise
from identification.grams import Weights
from identification.poly_reference import RankOne, hold_to_rank_one, sorted_frfs
from identification.pruning import inside, plausible, significant, threshold
from identification.refine import Fit, evaluate, refine
from identification.residues import synthesise, uniform_weights

_ROUNDS = 12
_EXTRA_POLES = 4
_SHORT, _LONG = 12, 40
_COARSE, _FINE = 1e-6, 1e-10
_REJECTIONS = 2
_BROAD = 0.1


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
    held: RankOne | None = None
    rank_excess: float = 0.0


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
    fit = refine(frfs, start, uniform_weights(frfs), powers=ladder[0], iterations=_SHORT, tolerance=_COARSE)
    weights = _search_weights(frfs, fit)
    fit = refine(frfs, fit.poles, weights, powers=ladder[0], iterations=_SHORT, tolerance=_COARSE)
    fit = _pruned(frfs, fit, weights, band, iterations=_SHORT, tolerance=_COARSE)
    fit = _completed(frfs, fit, band, ladder)
    fit = _without_broad(frfs, fit, band, ladder)
    fitted = _weighted(frfs, _without_halves(frfs, fit), band)
    while _halves(frfs, fitted.fit) is not None:
        fitted = _weighted(frfs, _without_halves(frfs, fitted.fit), band)
    return _held(frfs, fitted, band)


def _held(frfs: FrfSet, fitted: Fitted, band: tuple[float, float]) -> Fitted:
    """Hold residues to rank one where several references were measured and agree on the shapes."""
    places = sorted_frfs(frfs)
    if places is None:
        return fitted
    modes = inside(fitted.fit.poles, band, frfs.df)
    fade = fading.at_start(fitted.weights.fade)
    held = hold_to_rank_one(frfs, fitted.fit, fitted.weights, places, modes, inflation=fade)
    if held.excess > 1.0:
        return replace(fitted, rank_excess=held.excess)
    result = replace(fitted, fit=held.fit, held=held)
    return replace(result, residual=_residual(frfs, held.fit))


def _without_halves(frfs: FrfSet, fit: Fit) -> Fit:
    """Make one of poles that are the halves of one mode."""
    while (halves := _halves(frfs, fit)) is not None:
        rest = np.delete(fit.poles, halves[0])
        weights, powers = _search_weights(frfs, fit), fit.linear.powers
        fit = refine(frfs, rest, weights, powers=powers, iterations=_SHORT, tolerance=_COARSE)
    return fit


def _halves(frfs: FrfSet, fit: Fit) -> tuple[int, int] | None:
    return leftover.split_halves(fit.poles, fit.linear.residues, sorted_frfs(frfs))


def _completed(frfs: FrfSet, fit: Fit, band: tuple[float, float], ladder: tuple[tuple[int, ...], ...]) -> Fit:
    """Add poles and residual terms as long as they explain more than noise can."""
    search = _Search()
    for _ in range(_ROUNDS):
        if not _room(frfs, fit):
            break
        weights, powers = _search_weights(frfs, fit), fit.linear.powers
        pole, gain = _best_pole(frfs, fit, weights, band, search)
        higher, gain_up = _higher(frfs, fit, weights, ladder)
        if max(gain, gain_up) <= 0.0:
            break
        poles = np.append(fit.poles, pole) if gain > gain_up else fit.poles
        powers = powers if gain > gain_up else higher
        trial = refine(frfs, poles, weights, powers=powers, iterations=_SHORT, tolerance=_COARSE)
        trial = _pruned(frfs, trial, weights, band, iterations=_SHORT, tolerance=_COARSE)
        if gain_up >= gain:
            fit = trial
            continue
        accepted = _acceptable(frfs, fit, trial, pole, band)
        fit = trial if accepted else fit
        search = search.after(pole, band, frfs.df, accepted=accepted)
    return fit


def _without_broad(
    frfs: FrfSet, fit: Fit, band: tuple[float, float], ladder: tuple[tuple[int, ...], ...]
) -> Fit:
    """Do without poles whose half-power band is a tenth of the band, if a background explains as much."""
    for pole in fit.poles[_broad(fit.poles, band, frfs.df)]:
        rest = fit.poles[np.abs(fit.poles - pole) > 1e-9 * abs(pole)]
        if len(rest) == 0 or len(rest) == len(fit.poles):
            continue
        weights = _search_weights(frfs, fit)
        limit = float(stats.chi2.isf(1e-6, 2 * len(frfs.values))) * fading.at_start(weights.fade)
        powers = fit.linear.powers
        plain = refine(frfs, rest, weights, powers=powers, iterations=_SHORT, tolerance=_COARSE)
        plain = _completed(frfs, plain, band, ladder)
        again = refine(
            frfs, plain.poles, weights, powers=plain.linear.powers, iterations=_SHORT, tolerance=_COARSE
        )
        fewer = inside(again.poles, band, frfs.df).sum() < inside(fit.poles, band, frfs.df).sum()
        if fewer and 2.0 * (again.cost - fit.cost) < limit:
            fit = again
    return fit


def _broad(poles: ComplexArray, band: tuple[float, float], df: float) -> BoolArray:
    return np.asarray(inside(poles, band, df) & (-poles.real / np.pi > _BROAD * (band[1] - band[0])))


@dataclass(frozen=True)
class _Search:
    """Where a search for further poles still looks: how many beyond the edges, what stretches no more."""

    beyond: int = _EXTRA_POLES
    blocked: tuple[tuple[float, float], ...] = ()

    def after(self, pole: complex, band: tuple[float, float], df: float, *, accepted: bool) -> _Search:
        """Return what is left to search once a pole was tried."""
        frequency = pole.imag / (2 * np.pi)
        if not band[0] <= frequency <= band[1]:
            return replace(self, beyond=self.beyond - 1 if accepted else 0)
        if accepted:
            return self
        reach = 5 * df + 3 * abs(pole.real) / (2 * np.pi)
        return replace(self, blocked=(*self.blocked, (frequency - reach, frequency + reach)))


def _room(frfs: FrfSet, fit: Fit) -> bool:
    return len(frfs.frequency) > 4 * len(fit.poles) + 20


def _best_pole(
    frfs: FrfSet, fit: Fit, weights: Weights, band: tuple[float, float], search: _Search
) -> tuple[complex, float]:
    """Return the pole, in the band or beyond, that explains most, and by how much more than noise."""
    inner = np.zeros(0, complex)
    if len(search.blocked) < _REJECTIONS:
        inner = leftover.trial_poles(frfs, _residual(frfs, fit), weights, search.blocked)
    outer = background.trial_poles(band) if search.beyond > 0 else np.zeros(0, complex)
    trials = np.concatenate([inner, outer])
    if len(trials) == 0:
        return 0j, 0.0
    gain = 2.0 * background.gains(frfs, fit.poles, fit.linear.powers, weights, trials)
    gain = gain / fading.inflation(weights.fade, _decay_over_record(frfs, trials))[0]
    best = int(gain.argmax())
    return complex(trials[best]), float(gain[best]) - threshold(*frfs.values.shape)


def _acceptable(frfs: FrfSet, fit: Fit, trial: Fit, pole: complex, band: tuple[float, float]) -> bool:
    """Tell whether a pole that was added stands for a mode of its own."""
    if len(trial.poles) <= len(fit.poles):
        return False
    grown = int(inside(trial.poles, band, frfs.df).sum()) > int(inside(fit.poles, band, frfs.df).sum())
    if not grown:
        return True
    if not band[0] <= pole.imag / (2 * np.pi) <= band[1]:
        return False
    if len(frfs.values) < leftover.FEW:
        moved = np.abs(trial.poles[:, None] - fit.poles[None, :]).min(axis=1)
        new = int(moved.argmax())
        gap = np.delete(np.abs(trial.poles - trial.poles[new]), new).min(initial=np.inf)
        return bool(gap > 3.0 * abs(trial.poles[new].real))
    return _halves(frfs, trial) is None


def _higher(
    frfs: FrfSet, fit: Fit, weights: Weights, ladder: tuple[tuple[int, ...], ...]
) -> tuple[tuple[int, ...], float]:
    """Return the next set of residual terms, and by how much more than noise it explains."""
    rung = ladder.index(fit.linear.powers)
    if rung + 1 == len(ladder):
        return fit.linear.powers, 0.0
    extra = (len(ladder[rung + 1]) - len(ladder[rung])) * len(frfs.values)
    here = evaluate(frfs, fit.poles, weights, fit.linear.powers).cost
    there = evaluate(frfs, fit.poles, weights, ladder[rung + 1]).cost
    gain = 2.0 * (here - there) / fading.at_start(weights.fade)
    return ladder[rung + 1], gain - float(stats.chi2.isf(1e-6, extra))


def _residual(frfs: FrfSet, fit: Fit) -> ComplexArray:
    return np.asarray(frfs.values - synthesise(frfs.laplace, fit.poles, fit.linear, frfs.form))


def _search_weights(frfs: FrfSet, fit: Fit) -> Weights:
    """Weigh by the scatter from line to line, which does not mind what the model still lacks.

    Where the data carry variance or coherence, the lines weigh in common as these say: noise of the force
    is larger on a peak.
    """
    residual = _residual(frfs, fit)
    known = noise.from_statistics(frfs, frfs.values - residual)
    shape = np.ones((1, len(frfs.frequency)))
    if known is not None:
        power = np.log(known)
        shape = np.exp(np.mean(power - power.mean(axis=1, keepdims=True), axis=0, keepdims=True))
    even = residual / np.sqrt(shape)
    fade = fading.decay_over_record(even)
    level = noise.scatter(even) / fading.roughness(fade, 4)
    level = np.maximum(level, noise.quiet_floor(frfs.values)[:, 0])
    return Weights(1.0 / level, 1.0 / shape, fade)


def _decay_over_record(frfs: FrfSet, poles: ComplexArray) -> FloatArray:
    return np.asarray((frfs.decay - poles.real) / frfs.df)


def _pruned(
    frfs: FrfSet, fit: Fit, weights: Weights, band: tuple[float, float], *, iterations: int, tolerance: float
) -> Fit:
    """Strike off what is implausible or insignificant, refine the rest, and look again."""
    powers = fit.linear.powers
    for _ in range(_ROUNDS):
        held = fading.inflation(weights.fade, _decay_over_record(frfs, fit.poles))[0]
        keep = plausible(fit.poles, band) & significant(fit, n_lines=len(frfs.frequency), inflation=held)
        if keep.all():
            break
        if not (keep & inside(fit.poles, band, frfs.df)).any():
            raise EstimationError(
                f"{frfs.source}: no mode stands out of the noise between {band[0]:g} and {band[1]:g} Hz; "
                "widen the band, raise the order or check the FRFs"
            )
        fit = refine(
            frfs, fit.poles[keep], weights, powers=powers, iterations=iterations, tolerance=tolerance
        )
    return fit


def _weighted(frfs: FrfSet, fit: Fit, band: tuple[float, float]) -> Fitted:
    """Weigh by the noise itself and refine until both agree."""
    weights = _search_weights(frfs, fit)
    for tolerance in (_COARSE, _COARSE, _FINE):
        residual, absorbed = _residual(frfs, fit), _absorbed(frfs, fit, weights)
        weights, variance, measured = _noise(frfs, residual, absorbed)
        powers = fit.linear.powers
        fit = refine(frfs, fit.poles, weights, powers=powers, iterations=_LONG, tolerance=tolerance)
        fit = _pruned(frfs, fit, weights, band, iterations=_LONG, tolerance=tolerance)
    return Fitted(fit, weights, variance, _residual(frfs, fit), _absorbed(frfs, fit, weights), measured)


def _noise(frfs: FrfSet, residual: ComplexArray, absorbed: FloatArray) -> tuple[Weights, FloatArray, bool]:
    fade = fading.decay_over_record(residual)
    known = noise.from_statistics(frfs, frfs.values - residual)
    floor = noise.quiet_floor(frfs.values)
    if known is None:
        weights, variance = noise.from_residual(residual, absorbed, floor)
        return replace(weights, fade=fade), variance, False
    if frfs.variance is None:
        excess = np.mean(np.abs(residual) ** 2 / known / np.maximum(1.0 - absorbed, 0.02), axis=1)
        known = np.maximum(known * excess[:, None], floor)
    level = 1.0 / np.exp(np.mean(np.log(known), axis=1))
    return Weights(level, 1.0 / (known * level[:, None]), fade), known, True


def _absorbed(frfs: FrfSet, fit: Fit, weights: Weights) -> FloatArray:
    columns = basis.build(frfs.laplace, fit.poles, frfs.form, fit.linear.powers).linear
    poles_too = 1.0 + 1.0 / len(frfs.values)
    return np.asarray(np.minimum(poles_too * noise.leverage(columns, weights), 0.98))
