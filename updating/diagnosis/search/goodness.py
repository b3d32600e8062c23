"""Does an explanation explain? What the rest of the data predicts of each part of them, beside what was measured.

A part is predicted by the explanation and by all other data, through the nuisances that they have in common, and
through the noise of the shapes, whose scale all shapes show together. So a p-value is that of a prediction, uniform
where the explanation holds (Gelfand, Dey and Chang 1992, Bayesian Statistics 4, 147-167; Bayarri and Berger 2000,
J. Am. Stat. Assoc. 95, 1127-1142), and noise that is too large by a factor hides nothing. Parts are the channels, and
of those with many data each mode and each measuring channel: what is missing in a model is mostly in a few of them.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.stats import chi2, f, norm

from acquisition.arrays import BoolArray, FloatArray
from updating.diagnosis.search.points import Point
from updating.likelihood.comparison import CHANNELS, Comparison
from updating.likelihood.gaussian import gaussian, normal_equations
from updating.thresholds import SHAPE_NOISE_SCALES

SCATTER = "scatter of shapes"


def p_values(point: Point, fitted: int = 0) -> dict[str, float]:
    """Return the p-value of each part of the data and of all together.

    Parameters
    ----------
    point : Point
        A candidate at its best parameters.
    fitted : int
        Number of parameters fitted, taken off the degrees of freedom of all data.

    Returns
    -------
    dict
        Each of ``CHANNELS`` where there are such data, each mode's frequency, the shapes of each mode and of each
        measuring channel, ``all``; ``frequency together`` and ``damping together``, whether all modes lie off alike,
        as a factor on the whole makes them; ``doubts``: whether a tolerance or the calibration had to be stretched
        beyond belief; and ``scatter of shapes``: the prior chance that they are as bad as they are.
    """
    if not np.isfinite(point.marginal.log_likelihood):
        return {"all": 0.0}
    return _predicted(point.comparison, fitted) | _of_point(point)


def p_value(point: Point, fitted: int = 0) -> float:
    """Return one p-value: the smallest of :func:`p_values`, corrected for how many there are (Sidak)."""
    values = p_values(point, fitted)
    asked = [value for name, value in values.items() if name != SCATTER]
    return float(min(-np.expm1(len(asked) * np.log1p(-min(*asked, 1 - 1e-9))), values.get(SCATTER, 1.0)))


def _predicted(comparison: Comparison, fitted: int) -> dict[str, float]:
    """Return the p-values of what the rest of the data predicts, over all scales of the noise of the shapes."""
    shapes, used = comparison.scaled.any(), comparison.stated
    scales = SHAPE_NOISE_SCALES if shapes else (1.0,)
    prior = np.array(comparison.scale_prior if shapes else (1.0,))
    likelihood, square = _at_scales(comparison, scales, used)
    weight = _normed(likelihood, prior)
    values = {"all": float(weight @ chi2.sf(square, max(int(used.sum()) - fitted, 1)))}
    if shapes:
        values[SCATTER] = float(weight @ np.cumsum(prior[::-1])[::-1])
    for name, part in _parts(comparison):
        rest, left = _at_scales(comparison, scales, used & ~part)
        chance = _tail(np.maximum(square - left, 0.0), int(part.sum()), " of " in name)
        values[name] = float(_normed(rest, prior) @ chance)
    return values


def _at_scales(
    comparison: Comparison, scales: tuple[float, ...], keep: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return log-likelihood and chi-squared of some data at each scale of the noise of the shapes, (s,) each."""
    if not keep.any():
        return np.zeros(len(scales)), np.zeros(len(scales))
    found = gaussian(comparison, scales, keep)
    return found.log_likelihood[0, 0], found.fit.chi2[0, 0]


def _normed(log_likelihood: FloatArray, prior: FloatArray) -> FloatArray:
    weight = prior * np.exp(log_likelihood - log_likelihood.max())
    return np.asarray(weight / weight.sum())


def _tail(square: FloatArray, count: int, local: bool, *, freedom: float = 8.0) -> FloatArray:
    """Return how seldom chance makes a chi-squared of so many data as large [-].

    The noise of one mode's shape, or of one measuring channel's constants, is known by some ``freedom`` degrees of
    freedom: some hits make it, and no two modes have the same.
    """
    return np.asarray(f.sf(square / count, count, freedom) if local else chi2.sf(square, count))


def _parts(comparison: Comparison) -> Iterator[tuple[str, BoolArray]]:
    """Yield the parts that the rest of the data predicts, each with its name."""
    used = comparison.stated
    for name in CHANNELS:
        if (part := comparison.of(name) & used).any():
            yield name, part
    for mode in np.unique(comparison.mode[comparison.of("frequency") & used]).tolist():
        yield f"frequency {mode + 1}", comparison.of("frequency") & used & (comparison.mode == mode)
    shapes = comparison.scaled & used
    for name, labels in (("mode", comparison.mode), ("channel", comparison.source)):
        for label in np.unique(labels[shapes]).tolist():
            yield f"shapes of {name} {label + 1}", shapes & (labels == label)


def _of_point(point: Point) -> dict[str, float]:
    """Return the p-values that are asked at the point's own scale."""
    comparison, values = point.comparison, {}
    for name in ("frequency", "damping"):
        together = comparison.of(name).astype(float)[:, None]
        if together.any():
            normal, load = normal_equations(comparison, together, point.marginal.scale)
            values[f"{name} together"] = float(2 * norm.sf(abs(load[0]) / np.sqrt(normal[0, 0])))
    named = point.marginal.shift[comparison.doubts]
    if len(named):
        values["doubts"] = float(min(1.0, len(named) * 2 * norm.sf(np.abs(named).max())))
    return values
