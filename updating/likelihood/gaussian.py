"""Marginal likelihood of a comparison: nuisances integrated out exactly, in the small space they span.

How well shapes were measured is known only so far: cross-talk, oblique hits and rounded positions leave no
trace in the coherence. So the noise of the shapes has an unknown scale, summed over a few values by their
prior; a misfit of shapes then counts for as much as their noise, judged by all of them, allows.

How far the idealisation of an effect is off is known as little: it is a judgement of what it may be at most. So its
size is summed over likewise: a region that is softened just so is not made less believable by a doubt it has no need
of, and one that is not still has it. So are doubts of single channels, see :mod:`updating.likelihood.judged`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.likelihood.bordered import Bordered, bordered
from updating.likelihood.comparison import Comparison
from updating.likelihood.judged import separate_channels
from updating.likelihood.separate import Beside
from updating.likelihood.stack import Pattern, Stack, pattern_of
from updating.thresholds import DOUBT_SHARES, LARGEST_SENSITIVITY, SHAPE_NOISE_SCALES


@dataclass(frozen=True, eq=False)
class Marginal:
    """A Gaussian residual with variance D + J J^T, D with an unknown scale on the shapes.

    Parameters
    ----------
    log_likelihood : float
        Logarithm of the marginal likelihood, summed over the scales [-].
    chi2 : float
        Mahalanobis length of the residual at the most probable scale [-].
    shift : (p,) array
        Most probable nuisances at that scale [standard deviations].
    count : int
        Number of data.
    scale : float
        The most probable scale of the noise of the shapes [-].
    share : float
        The most probable size of the doubt in the idealisation, as a share of the largest [-].
    unseen : float
        That of the errors that no scatter shows [-].
    judged : tuple of (int, float)
        Channels with a judged doubt, by number, and its most probable share of the most [-].
    """

    log_likelihood: float
    chi2: float
    shift: FloatArray
    count: int
    scale: float
    share: float = 1.0
    unseen: float = 1.0
    judged: tuple[tuple[int, float], ...] = ()

    def settle(self, comparison: Comparison) -> Comparison:
        """Return a comparison with all doubts at their most probable sizes."""
        return comparison.settled(self.share, self.unseen, self.judged)


def marginal(comparison: Comparison, keep: BoolArray | None = None) -> Marginal:
    """Integrate nuisances, scale and the size of the doubt in the idealisation out of a comparison.

    Parameters
    ----------
    comparison : Comparison
        Residual, nuisances and noise.
    keep : (n,) bool array, optional
        Data to use; left out, all.

    Returns
    -------
    Marginal
        With a likelihood of zero where the prediction is not finite.
    """
    return marginals([comparison], keep)[0]


def marginals(comparisons: Sequence[Comparison], keep: BoolArray | None = None) -> list[Marginal]:
    """Integrate the same out of many comparisons of the same data: those whose nuisances change the same data at once.

    Parameters
    ----------
    comparisons, keep
        As in :func:`marginal`.
    """
    found = [
        Marginal(-np.inf, np.inf, np.zeros(c.nuisance.shape[1]), len(c.residual), 1.0) for c in comparisons
    ]
    alike: dict[tuple[Pattern, bool, bool], list[int]] = {}
    for i, one in enumerate(comparisons):
        if _sound(one):
            key = pattern_of(one, keep), one.idealised is None, one.unseen is None
            alike.setdefault(key, []).append(i)
    for (pattern, *_), members in alike.items():
        stack = Stack.of([comparisons[i] for i in members])
        for i, marginal_likelihood in zip(members, _summed(stack, pattern), strict=True):
            found[i] = marginal_likelihood
    return found


def _summed(stack: Stack, pattern: Pattern) -> list[Marginal]:
    """Return the marginals of a stack, sizes of all doubts and scales of the noise of the shapes summed over."""
    scales = SHAPE_NOISE_SCALES if pattern.shapes else (1.0,)
    sizes = stack.first.sizes
    variance = stack.variances(sizes)
    channels = separate_channels(stack, pattern.channels, variance)
    parts = _integrated(stack, pattern, scales, variance)
    prior = np.log(stack.first.scale_prior if len(scales) > 1 else (1.0,))
    score = parts.log_likelihood + prior - np.log(len(sizes))
    for one in channels:
        score = score + one.summed[..., None]
    flat, each = score.reshape(len(score), -1), np.arange(len(score))
    total = np.logaddexp.reduce(flat, axis=1)
    size, scale = np.unravel_index(np.argmax(flat, axis=1), score.shape[1:])
    shift, chi2 = parts.shift(size, scale), parts.fit.chi2[each, size, scale]
    shares: list[list[tuple[int, float]]] = []
    for one in channels:
        best = np.argmax(one.log_likelihood[each, size], axis=1)
        shift[:, one.own.columns] = one.parts.shift((each, size, best))
        chi2 = chi2 + one.parts.chi2[each, size, best]
        shares.append([(one.own.channel, DOUBT_SHARES[i]) for i in best])
    count = len(pattern.rows) + sum(len(one.rows) for one in pattern.channels)
    return [
        Marginal(
            log_likelihood=float(total[n]),
            chi2=float(chi2[n]),
            shift=shift[n],
            count=count,
            scale=scales[scale[n]],
            share=sizes[size[n]][0],
            unseen=sizes[size[n]][1],
            judged=tuple(one[n] for one in shares),
        )
        for n in each.tolist()
    ]


def _sound(comparison: Comparison) -> bool:
    """Return whether a prediction is finite and no sensitivity is beyond all measure."""
    return bool(
        np.isfinite(comparison.residual).all()
        and np.isfinite(comparison.variance).all()
        and np.abs(comparison.nuisance).max(initial=0.0) < LARGEST_SENSITIVITY
    )


@dataclass(frozen=True, eq=False)
class Parts:
    """Comparisons with their nuisances integrated out, at sizes of the doubts and scales of the noise of the shapes.

    Parameters
    ----------
    log_likelihood : (a, b, s) array
        As in :class:`Marginal`, of comparisons, sizes and scales [-].
    fit : Bordered
        The nuisances that all data have in common, (a, b, s).
    own : Beside
        The other nuisances.
    scales : (s,) array
        Scales of the noise of the shapes [-].
    count : int
        Number of nuisances.
    """

    log_likelihood: FloatArray
    fit: Bordered
    own: Beside
    scales: FloatArray
    count: int

    def shift(self, size: IntArray, scale: IntArray) -> FloatArray:
        """Return the most probable nuisances of each comparison at one size and scale, by rank, (a, p)."""
        each, common = np.arange(len(self.log_likelihood)), self.own.groups.common
        found = np.zeros((len(each), self.count))
        found[:, common] = self.fit.shift((each, size, scale))
        left = np.hstack([-found[:, common], np.ones((len(each), 1))])
        self.own.fill(found, size, self.scales[scale], left)
        return found


def gaussian(comparison: Comparison, scales: Sequence[float], keep: BoolArray | None = None) -> Parts:
    """Integrate the nuisances out of a comparison at every scale of the noise of the shapes, all doubts as they are.

    Parameters
    ----------
    comparison, keep
        As in :func:`marginal`.
    scales : (s,) sequence of float
        Scales of the noise of the shapes [-].
    """
    stack = Stack.of([comparison])
    pattern = pattern_of(comparison, keep, judged=False)
    return _integrated(stack, pattern, scales, stack.variance[:, None])


def _integrated(stack: Stack, pattern: Pattern, scales: Sequence[float], variance: FloatArray) -> Parts:
    """Integrate the nuisances out at every scale of the noise of the shapes, beside noises of some variance (a, b, n).

    All of them weigh the same Gram matrices, one of the shapes and one of the rest, so that one batch of factors gives
    all likelihoods.
    """
    rows, groups, shapes = pattern.rows, pattern.groups, pattern.scaled
    factor = np.asarray(scales, dtype=float)
    r, j, d = stack.residual[:, rows], stack.nuisance[:, rows], variance[..., rows]
    data = np.concatenate([j[..., groups.common], r[..., None]], axis=-1)
    own = groups.beside(j, d, data)
    rest, scaled = (
        (np.swapaxes(data[:, None, part] / d[..., part, None], -1, -2) @ data[:, None, part])
        for part in (~shapes, shapes)
    )
    fit = bordered(rest[:, :, None] + scaled[:, :, None] / factor[:, None, None] ** 2 - own.share(factor))
    log_det = fit.log_det + 2 * shapes.sum() * np.log(factor) + own.log_det(factor)
    noise = np.log(d).sum(axis=-1)[..., None] + len(rows) * np.log(2 * np.pi)
    return Parts(-0.5 * (fit.chi2 + log_det + noise), fit, own, factor, stack.nuisance.shape[-1])


def normal_equations(
    comparison: Comparison, columns: FloatArray, scale: float, keep: BoolArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return normal matrix and load of least squares on ``columns``, the nuisances integrated out.

    Parameters
    ----------
    comparison : Comparison
        Residual, nuisances and noise.
    columns : (n, k) array
        Change of the prediction per parameter.
    scale : float
        Scale of the noise of the shapes [-].
    keep : (n,) bool array, optional
        Data to use; left out, all.

    Returns
    -------
    normal : (k, k) array
    load : (k,) array
    """
    pattern = pattern_of(comparison, keep, judged=False)
    rows, groups = pattern.rows, pattern.groups
    j, d, columns = comparison.nuisance[rows], comparison.noise(scale)[rows], columns[rows]
    common = j[:, groups.common]
    precise = groups.precise(j, d, np.hstack([common, columns]))
    own, free = precise[:, : common.shape[1]], precise[:, common.shape[1] :]
    inner = cho_factor(np.eye(common.shape[1]) + common.T @ own)
    solved = free - own @ cho_solve(inner, common.T @ free)
    return columns.T @ solved, solved.T @ comparison.residual[rows]
