"""How noisy the FRFs are: from their variance, their coherence, or what a fit leaves."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy import stats

from acquisition.arrays import ComplexArray, FloatArray, row_blocks, squared
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import normal_equations
from identification.fit.equations.normal_equations import Weights
from identification.fit.noise.differences import power_of_differences

_CHANCE = 1e-4
_ROUNDS = 3
_SCORINGS = 6
_PEAK = 6.0
"""Power over the expected one by which a value counts at the most [-], as in `identification.fit.noise.common`."""
_STEP = 1e-3  # a round lowers a variance to this part of what it was at the most; what follows from twice is the same
_WINDOW = 48  # lines over which a local variance is averaged at the least
_QUIET = 1e-6  # noise is never taken to be below this part of an FRF's r.m.s.
_PIECE = 16  # lines over which the scatter is averaged before the median
# A variance line by line counts by this factor over the law at the most where a stretch of lines is held against it: a
# coherence near zero gives millions. Twice as much lets one line raise its whole stretch.
_SPIKE = 10.0
_MORE = 1.5  # by which a stretch must exceed the law: two standard deviations where each line has one degree of freedom
_FEWEST = 15  # lines under which fourth differences are too few to determine the scatter


def window_length(n_lines: int) -> int:
    """Return over how many lines a local variance is averaged: a twelfth of the band, 48 at the least."""
    return min(n_lines, max(_WINDOW, n_lines // 12))


def quiet_floor(values: ComplexArray) -> FloatArray:
    """Return the smallest variance worth believing, per FRF, shape (n_frf, 1) [unit squared]."""
    power = np.mean(squared(values), axis=1, keepdims=True)
    return np.asarray(_QUIET**2 * np.maximum(power, 1e-12 * power.max()))


def usual(ratio: FloatArray) -> FloatArray:
    """Return the mean of each FRF's powers over the expected ones, whatever single lines have, (n_frf, 1) [-]."""
    mean = ratio.mean(axis=1, keepdims=True)
    for _ in range(_SCORINGS):
        mean = np.minimum(ratio, _PEAK * mean).mean(axis=1, keepdims=True)
    return np.asarray(mean)


def local_mean(power: FloatArray, window: int) -> FloatArray:
    """Average along lines over ``window`` lines, mirrored at the ends, shape as ``power``.

    Each window is the end of one block and the start of the next, of which sums are at hand. A running sum
    would subtract: beside a value 1e18 times as large, its mean of small positive values may be negative.
    """
    n_lines = power.shape[1]
    before = window // 2
    blocks = -(-(n_lines + window - 1) // window)
    mirrored = np.pad(power, ((0, 0), (before, blocks * window - n_lines - before)), mode="symmetric")
    block = mirrored.reshape(len(power), blocks, window)
    start, end = np.cumsum(block, axis=2), np.cumsum(block[:, :, ::-1], axis=2)[:, :, ::-1]
    # A window that begins with a block is that whole block: nothing of a next one is added.
    start[:, :, -1] = 0.0
    total = start.reshape(len(power), -1)[:, window - 1 : window - 1 + n_lines]
    total += end.reshape(len(power), -1)[:, :n_lines]
    total /= window
    return np.asarray(total)


def scatter(residual: ComplexArray) -> FloatArray:
    """Return the variance of the line-to-line scatter of residuals, per FRF, shape (n_frf,) [unit squared].

    Fourth differences are blind to what is smooth from line to line, a mode left out or far away; a median
    over stretches of lines is blind to a few peaks. So this is the noise, whatever the model still lacks.

    Parameters
    ----------
    residual : (n_frf, n_lines) complex array
        Data minus model [unit of the FRFs].
    """
    n_lines = residual.shape[1]
    if n_lines < _FEWEST:
        return np.asarray(np.mean(squared(residual), axis=1))
    rough = power_of_differences(residual, 4)
    pieces = max(1, rough.shape[1] // _PIECE)
    power = rough[:, : pieces * (rough.shape[1] // pieces)]
    return np.asarray(np.median(power.reshape(len(power), pieces, -1).mean(axis=2), axis=1))


def leverage(columns: ComplexArray, weights: Weights) -> FloatArray:
    """Return which part of each line's power the linear unknowns absorb, shape (n_frf or 1, n_lines) [-]."""
    real = np.concatenate([columns.real, columns.imag])
    real = real / np.maximum(np.linalg.norm(real, axis=0), np.finfo(float).tiny)
    gram = normal_equations.products(real, weights.lines)
    length, values, vectors = normal_equations.scaled_eigen(gram)
    seen = values > 1e-13 * values[:, -1:]
    root = np.where(seen, 1.0 / np.sqrt(np.where(seen, values, 1.0)), 0.0)
    return 0.5 * weights.lines * normal_equations.forms(real, vectors * root[:, None, :] / length[:, :, None])


def from_residual(
    residual: ComplexArray, absorbed: FloatArray, floor: FloatArray, model: ComplexArray
) -> tuple[Weights, FloatArray]:
    """Return weights and variances from what a fit leaves.

    The simplest law the residuals support is taken: white in each FRF; one colour common to all; each its own
    colour; or, where that is more likely, white noise of the response and noise of the force, which grows with
    the FRF; or noise of the force beside noise of one colour. Degrees of freedom the fit absorbed are given back line
    by line.

    Parameters
    ----------
    residual : (n_frf, n_lines) complex array
        Data minus model [unit of the FRFs].
    absorbed : (n_frf or 1, n_lines) array
        Part of each line's power the fit absorbs [-].
    floor : (n_frf, 1) array
        Smallest variance to believe [unit squared].
    model : (n_frf, n_lines) complex array
        The fit [unit of the FRFs].

    Returns
    -------
    Weights
        Reciprocal variances.
    variance : (n_frf, n_lines) array
        Local variances of the law chosen [unit squared].
    """
    n_lines = residual.shape[1]
    power = squared(residual)
    free = np.maximum(1.0 - absorbed, 0.02)
    level = np.maximum(power.sum(axis=1) / free.sum(axis=1), floor[:, 0])
    window = window_length(n_lines)
    local = np.maximum(local_mean(power, window) / local_mean(free, window), floor)
    colour = np.log(local / level[:, None])
    common = np.log(np.mean(local / level[:, None], axis=0, keepdims=True))
    if n_lines < 2 * window or np.mean(colour**2) < 2.5 / window:
        lines, more = np.ones((1, n_lines)), 0.0
    elif np.mean((colour - common) ** 2) < 2.5 / window:
        lines, more = np.exp(-common), n_lines / window - 1.0
    else:
        lines, more = np.exp(-colour), len(power) * (n_lines / window - 1.0)
    weights = Weights(1.0 / level, lines, unknowns=more)
    power /= free
    grown = np.maximum(_levelled(power, squared(model), _over_all_lines), floor)
    of_grown = likelihood(power, grown)
    gain = of_grown - likelihood(power, level[:, None])
    better = of_grown > likelihood(power, 1.0 / weights.full)
    if better and 2.0 * gain > stats.chi2.isf(_CHANCE, len(power)):
        mean = np.exp(np.mean(np.log(grown), axis=1))
        weights = Weights(1.0 / mean, mean[:, None] / grown, unknowns=float(len(power)))
    both, numbers = of_two_sources(power, squared(model), level)
    both = np.maximum(both, floor)
    gain = 2.0 * (likelihood(power, both) - likelihood(power, 1.0 / weights.full))
    if gain > (numbers - weights.unknowns) * np.log(2 * power.size):
        mean = np.exp(np.mean(np.log(both), axis=1))
        weights = Weights(1.0 / mean, mean[:, None] / both, unknowns=numbers)
    return weights, 1.0 / weights.full


def of_two_sources(power: FloatArray, law: FloatArray, level: FloatArray) -> tuple[FloatArray, float]:
    """Return variances a c + b law, (n_frf, n_lines), and how many numbers they have beside one per FRF [-].

    Each FRF has its own a, all have one b, at most one: what a single block or hit would have. The first part has a
    colour c, common to all FRFs, as where the force gets weaker along the lines, if that is worth its price by
    Schwarz's criterion (Ann. Stat. 6 (1978) 461-464).

    Parameters
    ----------
    power : (n_frf, n_lines) array
        Power of what a fit leaves [unit squared].
    law : (n_frf, n_lines) array
        What the second part is proportional to [unit squared].
    level : (n_frf,) array
        Start of a [unit squared].
    """
    n_lines = power.shape[1]
    window = window_length(n_lines)
    even = _scored(power, law, level, n_lines)
    if n_lines < 2 * window:
        return even, 1.0
    coloured, more = _scored(power, law, level, window), n_lines / window - 1.0
    gain = 2.0 * (likelihood(power, coloured) - likelihood(power, even))
    return (coloured, 1.0 + more) if gain > more * np.log(2 * power.size) else (even, 1.0)


def _scored(power: FloatArray, law: FloatArray, level: FloatArray, window: int) -> FloatArray:
    """Return variances a c + b law by scoring, c the same over all lines or a mean over a window of fewer.

    Values far above what is expected of them count as if they were less, so that a mode that is missing in the fit
    does not pass for noise.
    """
    tiny, n_lines = np.finfo(float).tiny, power.shape[1]
    a, c = level[:, None], np.ones((1, n_lines))
    strong = law > 0.01 * law.max(axis=1, keepdims=True)
    b = float(np.median(power[strong] / law[strong])) / np.log(2.0) if strong.any() else 0.0
    for _ in range(_SCORINGS):
        guess = a * c + b * law
        w = 1.0 / guess**2
        seen = np.minimum(power, _PEAK * guess)
        a = np.maximum(
            (w * c * (seen - b * law)).sum(axis=1)[:, None] / (w * c**2).sum(axis=1)[:, None], _STEP * a
        )
        if window < n_lines:
            along, size = np.sum(w * a * (seen - b * law), axis=0), np.sum(w * a**2, axis=0)
            c = np.maximum(
                local_mean(along[None, :], window) / np.maximum(local_mean(size[None, :], window), tiny),
                _STEP * c,
            )
        b = max(float(np.sum(w * law * (seen - a * c)) / max(np.sum(w * law**2), tiny)), _STEP * b)
        b = min(b, 1.0)
    return a * c + b * law


def _over_all_lines(values: FloatArray) -> FloatArray:
    return np.asarray(np.mean(values, axis=1, keepdims=True))


def likelihood(power: FloatArray, variance: FloatArray) -> float:
    """Return the logarithm of the likelihood of circular Gaussian residuals of such power."""
    logarithms = float(np.sum(np.log(variance))) * power.size / variance.size
    return -logarithms - float(np.sum(power / variance))


def from_statistics(frfs: FrfSet, model: ComplexArray) -> FloatArray | None:
    """Return variances from the set's own variance or coherence, shape (n_frf, n_lines), or None.

    Few averages make a variance line by line a poor weight, so it is levelled locally by the law noise of
    the response plus noise proportional to the FRF: variance = a + b |H|^2, with a and b from neighbouring
    lines. A variance without a number of averages is taken as it stands. Coherence gives
    |H|^2 (1 - gamma^2) / (gamma^2 n) (Bendat and Piersol, Random Data, 4th ed., Sec. 9.2.3).

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    model : (n_frf, n_lines) complex array
        A fit to them, in place of |H| itself [unit of the FRFs].
    """
    if frfs.variance is not None:
        raw = np.array(frfs.variance)
        if frfs.averages is None:
            return np.maximum(raw, quiet_floor(frfs.values))
    elif frfs.coherence is not None:
        coherent = np.clip(frfs.coherence, 1e-6, 1.0)
        count = np.ones(len(frfs.values)) if frfs.averages is None else np.maximum(1.0, frfs.averages)
        raw = squared(frfs.values) * (1.0 - coherent) / coherent / count[:, None]
    else:
        return None
    window = window_length(raw.shape[1])
    levelled = _levelled(raw, squared(model), lambda m: local_mean(m, window))
    return np.maximum(_raised(levelled, raw), quiet_floor(frfs.values))


def _raised(law: FloatArray, raw: FloatArray) -> FloatArray:
    """Return variances by a law, raised where a stretch of lines has more: beside a step, which no window follows."""
    ratio = local_mean(
        np.minimum(raw / np.maximum(law, np.finfo(float).tiny), _SPIKE), min(_PIECE, raw.shape[1])
    )
    return np.where(ratio > _MORE, ratio * law, law)


def _levelled(raw: FloatArray, power: FloatArray, mean: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Fit raw = a + b power with a, b >= 0, relative errors weighted alike.

    Scoring starts from lines of usual size. Started from a mean that a peak carries, it leaves a, the noise of the
    quiet lines beside the peak, ten times too small, and these weigh too much.

    Parameters
    ----------
    raw : (n_frf, n_lines) array
        Powers of the noise, each of few degrees of freedom [unit squared].
    power : (n_frf, n_lines) array
        |H|^2 [unit squared].
    mean : function
        Mean over the lines that share a and b: those nearby, or all.
    """
    levelled = np.empty_like(raw)
    for rows in row_blocks(raw.shape):
        levelled[rows] = _levelled_rows(raw[rows], power[rows], mean)
    return levelled


def _levelled_rows(
    raw: FloatArray, power: FloatArray, mean: Callable[[FloatArray], FloatArray]
) -> FloatArray:
    """Return the same of some FRFs."""
    tiny = np.finfo(float).tiny
    size = np.maximum(raw.mean(axis=1, keepdims=True), tiny)
    raw, power = raw / size, power / np.maximum(power.mean(axis=1, keepdims=True), tiny)
    guess = 0.5 * (_typical(raw, mean) + power * _typical(raw / np.maximum(power, _QUIET**2), mean))
    for _ in range(_ROUNDS):
        w = 1.0 / guess**2
        s0, s1, s2 = (mean(w * m) for m in (np.ones_like(raw), power, power**2))
        t0, t1 = mean(w * raw), mean(w * raw * power)
        determinant = s0 * s2 - s1**2
        safe = determinant > 1e-9 * s0 * s2
        b = np.where(safe, (s0 * t1 - s1 * t0) / np.where(safe, determinant, 1.0), 0.0)
        b = np.clip(b, 0.0, t1 / np.maximum(s2, tiny))
        a = np.maximum((t0 - b * s1) / s0, 0.0)
        guess = np.maximum(a + b * power, _STEP * guess)
    return np.asarray(guess * size)


def _typical(values: FloatArray, mean: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Return the geometric mean: one peak among the lines does not carry it, as it does the arithmetic one."""
    return np.asarray(np.exp(mean(np.log(np.maximum(values, _QUIET**2)))))
