"""What a fit leaves, and the weights that follow from it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import basis
from identification.fit.equations.normal_equations import Weights
from identification.fit.equations.refine import Fit
from identification.fit.equations.residues import synthesise
from identification.fit.noise import leakage, levels, window_shaped

_LEAST_FREE = 0.02  # part of the values that a fit leaves free at the least


def left_over(frfs: FrfSet, fit: Fit) -> ComplexArray:
    """Return data minus model, shape (n_frf, n_lines) [unit of the FRFs]."""
    model = synthesise(basis.Axis.of(frfs), fit.poles, fit.linear)
    return np.subtract(frfs.values, model, out=model)


def search_weights(frfs: FrfSet, fit: Fit, residual: ComplexArray | None = None) -> Weights:
    """Weigh by the scatter from line to line, which does not mind what the model still lacks.

    Where the data carry variance or coherence, the lines weigh in common as these imply: noise of the force
    is larger on a peak. What the fit leaves, ``residual``, is computed where it is not given.
    """
    residual = left_over(frfs, fit) if residual is None else residual
    leaked = leakage.leaked(frfs, fit.poles, fit.linear.residues)
    if leaked is not None:
        free = max(1.0 - _unknowns(fit) / (2 * len(frfs.frequency)), _LEAST_FREE)
        return _of_leakage(frfs, np.abs(residual) ** 2 / free, leaked)
    known = _stated(frfs, residual)
    shape = np.ones((1, len(frfs.frequency)))
    if known is not None:
        power = np.log(known)
        shape = np.exp(np.mean(power - power.mean(axis=1, keepdims=True), axis=0, keepdims=True))
    even = residual if known is None else residual / np.sqrt(shape)
    fade = window_shaped.decay_over_record(even)
    free = 1.0 - _unknowns(fit) / (2 * len(frfs.frequency))
    level = levels.scatter(even) / window_shaped.roughness(fade, 4) / max(free, _LEAST_FREE)
    level = np.maximum(level, levels.quiet_floor(frfs.values)[:, 0])
    return Weights(1.0 / level, 1.0 / shape, fade)


def _of_leakage(frfs: FrfSet, power: FloatArray, leaked: ComplexArray) -> Weights:
    """Return weights of FRFs whose noise is leakage, and noise of their own that is the same at all lines."""
    floor = levels.quiet_floor(frfs.values)
    start = np.maximum(np.median(power, axis=1), floor[:, 0])
    variance, more = levels.of_two_sources(power, np.abs(leaked) ** 2, start)
    variance = np.maximum(variance, floor)
    level = 1.0 / np.exp(np.mean(np.log(variance), axis=1))
    return Weights(level, 1.0 / (variance * level[:, None]), unknowns=more)


def _stated(frfs: FrfSet, residual: ComplexArray) -> FloatArray | None:
    """Return the variances that came with the data, or None where none did."""
    if frfs.variance is None and frfs.coherence is None:
        return None
    return levels.from_statistics(frfs, frfs.values - residual)


def _unknowns(fit: Fit) -> float:
    """Return how many real numbers a fit takes from each FRF, its share of the poles included."""
    n_frf, n_modes = fit.linear.residues.shape
    return float(2.0 * n_modes * (1.0 + 1.0 / n_frf) + len(fit.linear.powers))


def decay_over_record(frfs: FrfSet, poles: ComplexArray) -> FloatArray:
    """Return how far each pole decays over the record, sigma T, shape (n_modes,) [-]."""
    return np.asarray((frfs.decay - poles.real) / frfs.df)


def noise_weights(
    frfs: FrfSet, residual: ComplexArray, absorbed: FloatArray, leaked: ComplexArray | None = None
) -> tuple[Weights, FloatArray, bool]:
    """Return weights and variances by the noise itself, and whether these came with the data.

    The noise estimated from the data is scaled to the residual where it is coherence without hits to count.
    """
    if leaked is not None:
        weights = _of_leakage(frfs, np.abs(residual) ** 2 / np.maximum(1.0 - absorbed, _LEAST_FREE), leaked)
        return weights, 1.0 / weights.full, False
    fade = window_shaped.decay_over_record(residual)
    known = _stated(frfs, residual)
    floor = levels.quiet_floor(frfs.values)
    if known is None:
        weights, variance = levels.from_residual(residual, absorbed, floor, frfs.values - residual)
        return replace(weights, fade=fade), variance, False
    if frfs.variance is None:
        excess = levels.usual(np.abs(residual) ** 2 / known / np.maximum(1.0 - absorbed, _LEAST_FREE))
        known = np.maximum(known * excess, floor)
    level = 1.0 / np.exp(np.mean(np.log(known), axis=1))
    return Weights(level, 1.0 / (known * level[:, None]), fade), known, True


def absorbed_by(frfs: FrfSet, fit: Fit, weights: Weights) -> FloatArray:
    """Return which part of each line's power a fit absorbs, shape (n_frf or 1, n_lines) [-]."""
    columns = basis.build(basis.Axis.of(frfs), fit.poles, fit.linear.powers).linear
    poles_too = 1.0 + 1.0 / len(frfs.values)
    return np.asarray(np.minimum(poles_too * levels.leverage(columns, weights), 0.98))
