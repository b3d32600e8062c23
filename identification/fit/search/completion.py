"""Adding poles and residual terms to a fit, and striking poles off, as far as the data bear it out."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.errors import EstimationError
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import background
from identification.fit.equations.normal_equations import Weights
from identification.fit.equations.pruning import inside, plausible, significant, threshold
from identification.fit.equations.refine import Fit, evaluate, refine
from identification.fit.noise import window_shaped
from identification.fit.noise.common import beyond_common_noise, without_common_noise
from identification.fit.noise.weights import decay_over_record, left_over, search_weights
from identification.fit.poly_reference import sorted_frfs
from identification.fit.search import residual_peaks, split_modes

_ROUNDS = 12
_EXTRA_POLES = 4
_REJECTIONS = 8
SHORT = 12
COARSE = 1e-6


def completed(frfs: FrfSet, fit: Fit, band: tuple[float, float], ladder: tuple[tuple[int, ...], ...]) -> Fit:
    """Add poles and residual terms as long as they explain more than noise can."""
    search = _Search()
    for _ in range(_ROUNDS):
        if not _room(frfs, fit):
            break
        weights, powers = search_weights(frfs, fit), fit.linear.powers
        pole, gain = _best_pole(frfs, fit, weights, band, search)
        higher, gain_up = _higher(frfs, fit, weights, ladder)
        if max(gain, gain_up) <= 0.0:
            break
        poles = np.append(fit.poles, pole) if gain > gain_up else fit.poles
        powers = powers if gain > gain_up else higher
        trial = refine(frfs, poles, weights, powers=powers, iterations=SHORT, tolerance=COARSE)
        trial = pruned(frfs, trial, weights, band, iterations=SHORT, tolerance=COARSE)
        if gain_up >= gain:
            fit = trial
            continue
        accepted = _acceptable(frfs, fit, trial, pole, band)
        fit = trial if accepted else fit
        search = search.after(pole, band, frfs.df, accepted=accepted)
    return fit


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
    """Return whether the lines carry one more pole: each FRF has two values a line, twice as many as unknowns."""
    return len(frfs.frequency) > 2 * (len(fit.poles) + 1) + len(fit.linear.powers)


def _best_pole(
    frfs: FrfSet, fit: Fit, weights: Weights, band: tuple[float, float], search: _Search
) -> tuple[complex, float]:
    """Return the pole, in the band or beyond, that explains most, and by how much more than noise."""
    residual, bare = left_over(frfs, fit), without_common_noise(frfs, fit, weights)
    cleaned = replace(frfs, values=frfs.values - residual + bare)
    outer = background.trial_poles(band) if search.beyond > 0 else np.zeros(0, complex)
    found = [_best_of(frfs, fit, weights, outer)]
    if len(search.blocked) < _REJECTIONS:
        inner = residual_peaks.trial_poles(frfs, bare, weights, search.blocked)
        found.append(_best_of(cleaned, fit, weights, inner))
    pole, gain = max(found, key=lambda f: f[1])
    return pole, gain - threshold(*frfs.values.shape)


def _best_of(frfs: FrfSet, fit: Fit, weights: Weights, trials: ComplexArray) -> tuple[complex, float]:
    """Return the trial pole that explains most of FRFs, and how much."""
    if len(trials) == 0:
        return 0j, 0.0
    gain = 2.0 * background.gains(frfs, fit.poles, fit.linear.powers, weights, trials)
    gain = gain / window_shaped.inflation(weights.fade, decay_over_record(frfs, trials))[0]
    best = int(gain.argmax())
    return complex(trials[best]), float(gain[best])


def _acceptable(frfs: FrfSet, fit: Fit, trial: Fit, pole: complex, band: tuple[float, float]) -> bool:
    """Return whether a pole that was added stands for a mode of its own."""
    if len(trial.poles) <= len(fit.poles):
        return False
    grown = int(inside(trial.poles, band, frfs.df).sum()) > int(inside(fit.poles, band, frfs.df).sum())
    if not grown:
        return True
    if not band[0] <= pole.imag / (2 * np.pi) <= band[1]:
        return False
    if len(frfs.values) < residual_peaks.FEW:
        moved = np.abs(trial.poles[:, None] - fit.poles[None, :]).min(axis=1)
        new = int(moved.argmax())
        gap = np.delete(np.abs(trial.poles - trial.poles[new]), new).min(initial=np.inf)
        return bool(gap > 3.0 * abs(trial.poles[new].real))
    return find_split_mode(frfs, trial) is None


def _higher(
    frfs: FrfSet, fit: Fit, weights: Weights, ladder: tuple[tuple[int, ...], ...]
) -> tuple[tuple[int, ...], float]:
    """Return the next set of residual terms, and by how much more than noise it explains."""
    rung = ladder.index(fit.linear.powers)
    if rung + 1 == len(ladder):
        return fit.linear.powers, 0.0
    extra = (len(ladder[rung + 1]) - len(ladder[rung])) * len(frfs.values)
    return ladder[rung + 1], _gain(frfs, fit, weights, ladder[rung + 1]) - float(stats.chi2.isf(1e-6, extra))


def _gain(frfs: FrfSet, fit: Fit, weights: Weights, powers: tuple[int, ...]) -> float:
    """Return how much a larger set of residual terms explains, poles held, in units of the noise [-]."""
    here = evaluate(frfs, fit.poles, weights, fit.linear.powers).cost
    there = evaluate(frfs, fit.poles, weights, powers).cost
    return float(2.0 * (here - there) / window_shaped.at_start(weights.fade))


def with_odd_term(
    frfs: FrfSet, fit: Fit, weights: Weights, band: tuple[float, float], *, chance: float = 0.01
) -> Fit:
    """Return a fit with a residual term in 1/s, if that explains more than noise does.

    Modes whose residues are not imaginary leave one: complex modes beyond the band, and all modes under a window that
    nobody stated. Poles and terms that stood for it before are struck off.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs, carried over to common poles.
    fit : Fit
        Without the term.
    weights : Weights
        Those of the fit.
    band : tuple of float
        The band [Hz].
    chance : float
        Share of tests that take the term in without need [-]: it widens intervals a little, where it lacks it biases
        them.
    """
    if -1 in fit.linear.powers:
        return fit
    powers = tuple(sorted((*fit.linear.powers, -1)))
    if _gain(frfs, fit, weights, powers) < len(frfs.values):  # what noise alone gains
        return fit
    trial = refine(frfs, fit.poles, weights, powers=powers, iterations=SHORT, tolerance=COARSE)
    gain = 2.0 * (fit.cost - trial.cost) / window_shaped.at_start(weights.fade)
    if gain < stats.chi2.isf(chance, len(frfs.values)):
        return fit
    return pruned(frfs, trial, weights, band, iterations=SHORT, tolerance=COARSE)


def find_split_mode(frfs: FrfSet, fit: Fit) -> tuple[int, int] | None:
    """Return two poles of a fit that are one mode, the weaker first, or None.

    Their shapes look like those of a split one, and one pole for each FRF leaves little more than they do; or it leaves
    no more, whatever the shapes. With fewer than four FRFs the distance decides.
    """
    places, residues = sorted_frfs(frfs), fit.linear.residues
    suspected = residual_peaks.split_mode_pairs(fit.poles, residues, places)
    energy = np.sum(np.abs(residues) ** 2, axis=0) / np.abs(fit.poles.real)
    if len(residues) < residual_peaks.FEW:
        return _weaker_first(suspected[0], energy) if suspected else None
    disagreement = None if places is None else residual_peaks.two_by_references(residues, places)
    groups = split_modes.clusters(fit.poles, disagreement)
    if not suspected and not groups:
        return None
    residual = left_over(frfs, fit)
    weights = search_weights(frfs, fit, residual)
    for pair in suspected:
        found = split_modes.misfits(frfs, fit.poles, residues, residual, weights, pair)
        if found is None or not found.two_modes:
            return _weaker_first(pair, energy)
    for group in groups:
        found = split_modes.misfits(frfs, fit.poles, residues, residual, weights, group)
        if found is not None and found.one_mode:
            return _weaker_first(group, energy)
    return None


def _weaker_first(group: IntArray, energy: FloatArray) -> tuple[int, int]:
    """Return the weakest pole of a group and the strongest."""
    return int(group[energy[group].argmin()]), int(group[energy[group].argmax()])


def without_split_modes(frfs: FrfSet, fit: Fit) -> Fit:
    """Make one of poles that split one mode between them."""
    while (pair := find_split_mode(frfs, fit)) is not None:
        rest = np.delete(fit.poles, pair[0])
        weights, powers = search_weights(frfs, fit), fit.linear.powers
        fit = refine(frfs, rest, weights, powers=powers, iterations=SHORT, tolerance=COARSE)
    return fit


def pruned(
    frfs: FrfSet, fit: Fit, weights: Weights, band: tuple[float, float], *, iterations: int, tolerance: float
) -> Fit:
    """Strike off what is implausible or insignificant, refine the rest, and look again."""
    powers = fit.linear.powers
    for _ in range(_ROUNDS):
        held = window_shaped.inflation(weights.fade, decay_over_record(frfs, fit.poles))[0]
        keep = plausible(fit.poles, band) & significant(fit, n_lines=len(frfs.frequency), inflation=held)
        keep &= beyond_common_noise(frfs, fit, weights)
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
