"""Does an explanation explain? Chi-squared over all data and over each channel, corrected for asking often."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.stats import chi2, norm

from updating.diagnosis.search.fit import Point
from updating.likelihood.comparison import CHANNELS, Comparison
from updating.likelihood.gaussian import gaussian, normal_equations
from updating.thresholds import SHAPE_NOISE_SCALES

SCATTER = "scatter of shapes"


def p_values(point: Point, fitted: int = 0) -> dict[str, float]:
    """Return the p-value of each channel and of all data together.

    Shapes may be worse than thought. The scale of their noise is the one at which the answer is the most
    believable: neither the residual surprises nor that noise should be that bad.

    Parameters
    ----------
    point : Point
        A candidate at its best parameters.
    fitted : int
        Number of parameters fitted, taken off the degrees of freedom of all data.

    Returns
    -------
    dict
        Each of ``CHANNELS`` where there are such data, ``all`` of them together; ``frequency
        together`` and ``damping together``, whether all modes lie off alike, as a factor on the whole makes them;
        ``doubts``: whether a tolerance or the calibration had to be stretched beyond belief; and ``scatter of
        shapes``: the prior chance that they are as bad as was taken.
    """
    comparison = point.comparison
    if not np.isfinite(point.marginal.log_likelihood):
        return {"all": 0.0}
    same = _of_point(point)
    found = _of_scales(comparison, fitted)
    tails = np.cumsum(comparison.scale_prior[::-1])[::-1]
    tried = [{**values, **same, SCATTER: float(tail)} for values, tail in zip(found, tails, strict=False)]
    return max(tried, key=_corrected)


def p_value(point: Point, fitted: int = 0) -> float:
    """Return one p-value: the smallest of :func:`p_values`, Bonferroni-corrected."""
    return _corrected(p_values(point, fitted))


def _corrected(values: Mapping[str, float]) -> float:
    """Correct for how many things were asked of the residual; how bad the scatter may be is asked once."""
    asked = [value for name, value in values.items() if name != SCATTER]
    return float(min(1.0, len(asked) * min(asked), values.get(SCATTER, 1.0)))


def _of_scales(comparison: Comparison, fitted: int) -> list[dict[str, float]]:
    """Return the p-values of chi-squared at each scale of the noise of the shapes, one where there are none."""
    scales = SHAPE_NOISE_SCALES if comparison.scaled.any() else SHAPE_NOISE_SCALES[:1]
    tried: list[dict[str, float]] = [{} for _ in scales]
    for name in ("all", *CHANNELS):
        every = name == "all"
        keep = (np.full(len(comparison.channel), every) | comparison.of(name)) & comparison.stated
        if not keep.any():
            continue
        freedom = max(int(keep.sum()) - (fitted if every else 0), 1)
        for values, square in zip(tried, gaussian(comparison, scales, keep).chi2[0].tolist(), strict=True):
            values[name] = float(chi2.sf(square, freedom))
    return tried


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
