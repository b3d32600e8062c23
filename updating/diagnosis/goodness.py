"""Does an explanation explain? Chi-squared over all data and over each channel, corrected for asking often."""

from __future__ import annotations

import numpy as np
from scipy.stats import chi2, norm

from updating.diagnosis.comparison import CHANNELS, SCALES, SHAPES
from updating.diagnosis.fit import Point
from updating.diagnosis.gaussian import gaussian, marginal, whiten


def p_values(point: Point, fitted: int = 0) -> dict[str, float]:
    """Return the p-value of each channel and of all data together.

    Shapes may be worse than thought: for each scale of their noise the p-value is the smaller of that of the
    residual and the prior chance of noise that bad, and the best of these counts.

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
        together`` and ``damping together``, whether all modes lie off alike, as a factor on the whole makes them; and
        ``doubts``: whether a tolerance or the calibration had to be stretched beyond belief.
    """
    comparison = point.comparison
    if not np.isfinite(point.marginal.log_likelihood):
        return {"all": 0.0}
    tails = np.cumsum(comparison.scale_prior[::-1])[::-1]
    values = {}
    for name in ("all", *CHANNELS):
        keep = (
            np.ones(len(comparison.channel), bool)
            if name == "all"
            else comparison.channel == CHANNELS.index(name)
        )
        if not keep.any():
            continue
        shapes = bool((comparison.channel[keep] == SHAPES).any())
        tried = list(zip(SCALES, tails, strict=True)) if shapes else [(1.0, 1.0)]
        found = gaussian(comparison, [scale for scale, _ in tried], keep)
        parts = [(part, tail) for part, (_, tail) in zip(found, tried, strict=True)]
        freedom = max(int(keep.sum()) - (fitted if name == "all" else 0), 1)
        values[name] = max(min(float(chi2.sf(part.chi2, freedom)), float(tail)) for part, tail in parts)
    for name in ("frequency", "damping"):
        together = (comparison.channel == CHANNELS.index(name)).astype(float)[:, None]
        if together.any():
            normal, load = whiten(comparison, together, point.marginal.scale)
            values[f"{name} together"] = float(2 * norm.sf(abs(load[0]) / np.sqrt(normal[0, 0])))
    named = point.marginal.shift[comparison.doubts]
    if len(named):
        values["doubts"] = float(min(1.0, len(named) * 2 * norm.sf(np.abs(named).max())))
    return values


def p_value(point: Point, fitted: int = 0) -> float:
    """Return one p-value: the smallest of :func:`p_values`, Bonferroni-corrected."""
    values = p_values(point, fitted)
    return float(min(1.0, len(values) * min(values.values())))


def carrier(point: Point) -> str:
    """Return the channel that carries the gap: the one whose chi-squared is the least likely."""
    channel = point.comparison.channel
    surprise = {}
    for i, name in enumerate(CHANNELS):
        keep = channel == i
        if keep.any():
            part = marginal(point.comparison, keep)
            surprise[name] = float(chi2.logsf(part.chi2, part.count))
    return min(surprise, key=lambda n: surprise[n]) if surprise else "frequency"
