"""Data that are worse than thought, at a price: one kind of data of a mode, a mode, or a channel; or a tolerance.

Every test has something that is not stated: a mode that is no mode of this body, a sensor that hung loose, one
frequency that drifted. Gaussian noise makes of it an argument against every true explanation. So any group of data may
be an *outlier*: its noise is so many times what is stated. The prior states how rarely; the data determine by how much
better everything else fits, whether. Each choice of outliers is Gaussian again.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from acquisition.arrays import BoolArray
from updating.likelihood.comparison import CHANNELS, Comparison
from updating.thresholds import OUTLIER_PRIOR, OUTLIER_SCALES

SHAPE = (CHANNELS.index("frf"), CHANNELS.index("phase"))
"""Channels of a mode's shape."""

FREQUENCY = CHANNELS.index("frequency")
"""Channel of natural frequencies."""


@dataclass(frozen=True)
class Outlier:
    """A group of data, or a tolerance, that is so many times worse than thought.

    Parameters
    ----------
    mode, channel : int, optional
        Data of one mode, those of one of ``CHANNELS``, or all of them.
    source : int, optional
        The modal constants of one measuring channel.
    tolerance : int, optional
        One of a comparison's tolerances of the model.
    scale : float
        How many times worse [-].
    """

    mode: int | None = None
    channel: int | None = None
    source: int | None = None
    tolerance: int | None = None
    scale: float = OUTLIER_SCALES[0]

    def data(self, comparison: Comparison) -> BoolArray:
        """Return which data (n,) it is about."""
        if self.source is not None:
            return np.asarray(comparison.source == self.source)
        if self.mode is None:
            return np.zeros(len(comparison.mode), dtype=bool)
        own = comparison.mode == self.mode
        return np.asarray(own if self.channel is None else own & (comparison.channel == self.channel))

    @property
    def of_shape(self) -> bool:
        """Whether it is the shape of one mode: what changes a structure moves a frequency as well, a slip need not."""
        return self.channel in SHAPE

    @property
    def of_frequency(self) -> bool:
        """Whether the frequency of a mode is among it."""
        return self.mode is not None and self.channel in (None, FREQUENCY)

    def about_the_same(self, other: Outlier) -> bool:
        """Return whether another one is of the same data, or tolerance: nothing is worse than thought twice."""
        return replace(self, scale=other.scale) == other

    def scaled(self) -> list[Outlier]:
        """Return it at every scale; a tolerance that is off by more than the least of them is no longer that."""
        scales = OUTLIER_SCALES if self.tolerance is None else OUTLIER_SCALES[:1]
        return [replace(self, scale=scale) for scale in scales]


def log_price(outliers: Sequence[Outlier]) -> float:
    """Return the logarithm of the prior of a choice of outliers, relative to none [-]."""
    return len(outliers) * float(np.log(OUTLIER_PRIOR / len(OUTLIER_SCALES)))


def with_outliers(comparison: Comparison, outliers: Sequence[Outlier]) -> Comparison:
    """Return a comparison with the noise of outliers as much larger as they imply."""
    if not outliers:
        return comparison
    worse, nuisance = np.ones(len(comparison.variance)), comparison.nuisance.copy()
    for outlier in outliers:
        worse[outlier.data(comparison)] *= outlier.scale**2
        if outlier.tolerance is not None:
            nuisance[:, comparison.tolerances[outlier.tolerance]] *= outlier.scale
    idealised = None if comparison.idealised is None else worse * comparison.idealised
    unseen = None if comparison.unseen is None else worse * comparison.unseen
    judged = None if comparison.judged is None else worse * comparison.judged
    return replace(
        comparison,
        variance=worse * comparison.variance,
        nuisance=nuisance,
        idealised=idealised,
        unseen=unseen,
        judged=judged,
    )


def suspects(comparison: Comparison, scale: float, most: int) -> list[Outlier]:
    """Return the groups of data that everything else predicts worst, the worst first.

    Each datum is compared with what all others make of it: its residual over its standard deviation, had it been
    left out (Cook and Weisberg 1982, Residuals and Influence in Regression, chapter 2).

    Parameters
    ----------
    comparison : Comparison
        Residual, noise, and nuisances; parameters in doubt are nuisances, too.
    scale : float
        Of the noise of the shapes [-].
    most : int
        How many to return.
    """
    noise, columns = comparison.noise(scale), comparison.nuisance
    inner = cho_factor(np.eye(columns.shape[1]) + (columns.T / noise) @ columns)
    gain = cho_solve(inner, columns.T / noise)
    precise = (comparison.residual - columns @ (gain @ comparison.residual)) / noise
    own = np.maximum((1 - np.einsum("np,pn->n", columns, gain)) / noise, 1e-300)
    squares = precise**2 / own
    found = [(squares[group.data(comparison)], group) for group in _groups(comparison)]
    scored = [(float(part.sum() - len(part)), group) for part, group in found]
    shift = gain @ comparison.residual
    left = np.maximum(1 - np.diag(cho_solve(inner, np.eye(len(shift)))), 1e-12)
    scored += [
        (float(shift[k] ** 2 / left[k] - 1), Outlier(tolerance=i))
        for i, k in enumerate(comparison.tolerances.tolist())
    ]
    scored.sort(key=lambda pair: -pair[0])
    return [group for _, group in scored[:most]]


def _groups(comparison: Comparison) -> list[Outlier]:
    """Return every group of data that may be worse than thought."""
    pairs = {(int(m), int(c)) for m, c in zip(comparison.mode, comparison.channel, strict=True) if m >= 0}
    modes = sorted({m for m, _ in pairs})
    groups = [Outlier(mode=m, channel=c) for m, c in sorted(pairs)]
    groups += [Outlier(mode=m) for m in modes if sum(m == other for other, _ in pairs) > 1]
    return groups + [Outlier(source=int(s)) for s in np.unique(comparison.source[comparison.source >= 0])]
