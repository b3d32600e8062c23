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
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.likelihood.comparison import Comparison
from updating.likelihood.judged import SeparateChannel, separate_channels
from updating.likelihood.separate import Beside, separate
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
    if not _sound(comparison):
        nothing = np.zeros(comparison.nuisance.shape[1])
        return Marginal(-np.inf, np.inf, nothing, len(comparison.residual), 1.0)
    shapes = comparison.scaled if keep is None else comparison.scaled & keep
    scales = SHAPE_NOISE_SCALES if shapes.any() else SHAPE_NOISE_SCALES[:1]
    channels = separate_channels(comparison, keep, comparison.sizes)
    parts = gaussian(comparison, scales, _without(comparison, keep, channels), sizes=comparison.sizes)
    prior = np.log(comparison.scale_prior if len(scales) > 1 else (1.0,))
    score = parts.log_likelihood + prior - np.log(len(parts.sizes))
    for one in channels:
        score = score + one.summed[:, None]
    top = np.unravel_index(int(np.argmax(score)), score.shape)
    found = _joined(parts.at(int(top[0]), int(top[1])), channels, int(top[0]))
    return replace(found, log_likelihood=float(np.logaddexp.reduce(score, axis=None)))


def _without(
    comparison: Comparison, keep: BoolArray | None, channels: Sequence[SeparateChannel]
) -> BoolArray | None:
    """Return which data (n,) are in none of the separate channels; None for all."""
    if not channels:
        return keep
    others = ~np.isin(comparison.channel, [one.channel for one in channels])
    return others if keep is None else others & keep


def _joined(found: Marginal, channels: Sequence[SeparateChannel], size: int) -> Marginal:
    """Return a marginal with the separate channels in it, at one size of the other doubts."""
    shift = found.shift.copy()
    chi2, count, judged = found.chi2, found.count, []
    for one in channels:
        best = int(np.argmax(one.log_likelihood[size]))
        shift[one.columns] = one.shift[size, best]
        chi2, count = chi2 + float(one.chi2[size, best]), count + one.count
        judged.append((one.channel, DOUBT_SHARES[best]))
    return replace(found, chi2=chi2, count=count, shift=shift, judged=tuple(judged))


def _sound(comparison: Comparison) -> bool:
    """Return whether a prediction is finite and no sensitivity is beyond all measure."""
    whole = np.isfinite(comparison.residual).all() and np.isfinite(comparison.nuisance).all()
    return bool(
        whole
        and np.isfinite(comparison.variance).all()
        and np.abs(comparison.nuisance).max(initial=0.0) < LARGEST_SENSITIVITY
    )


@dataclass(frozen=True, eq=False)
class Parts:
    """A comparison with its nuisances integrated out, at sizes of the doubts and scales of the noise of the shapes.

    Parameters
    ----------
    sizes : (b,) tuple of (float, float)
        Shares of the two doubts, see :attr:`Comparison.sizes` [-].
    scales : (s,) tuple of float
        Scales of the noise of the shapes [-].
    log_likelihood, chi2 : (b, s) arrays
        As in :class:`Marginal`.
    precision : (b, s, c + 1, c + 1) array
        Of the nuisances that all data have in common; in the last row and column what the residual pulls [-].
    own : Beside
        The other nuisances.
    common : (c,) int array
        Which are those in common.
    shape : (int, int)
        Number of data and of nuisances.
    """

    sizes: tuple[tuple[float, float], ...]
    scales: tuple[float, ...]
    log_likelihood: FloatArray
    chi2: FloatArray
    precision: FloatArray
    own: Beside
    common: IntArray
    shape: tuple[int, int]

    def at(self, i: int, k: int) -> Marginal:
        """Return the marginal at the i-th size and k-th scale, with its most probable nuisances."""
        precision, scale = self.precision[i, k], self.scales[k]
        shift = np.zeros(self.shape[1])
        shift[self.common] = np.linalg.solve(precision[:-1, :-1], precision[:-1, -1])
        self.own.fill(shift, i, scale, np.append(-shift[self.common], 1.0))
        likelihood, chi2 = float(self.log_likelihood[i, k]), float(self.chi2[i, k])
        return Marginal(likelihood, chi2, shift, self.shape[0], scale, *self.sizes[i])


def gaussian(
    comparison: Comparison,
    scales: Sequence[float],
    keep: BoolArray | None = None,
    *,
    sizes: Sequence[tuple[float, float]] = ((1.0, 1.0),),
) -> Parts:
    """Integrate the nuisances out at every size of the doubts and every scale of the noise of the shapes.

    All of them weigh the same Gram matrices, one of the shapes and one of the rest. The last pivot of the Cholesky
    factor of a precision bordered by what the residual pulls is chi-squared (Golub and Van Loan 2013, Matrix
    Computations, section 4.2), so that one batch of factors gives all likelihoods.

    Parameters
    ----------
    comparison, keep
        As in :func:`marginal`.
    scales : (s,) sequence of float
        Scales of the noise of the shapes [-].
    sizes : (b,) sequence of (float, float)
        Shares of the two doubts, see :attr:`Comparison.sizes` [-].
    """
    rows = slice(None) if keep is None else keep
    r, j, shapes = comparison.residual[rows], comparison.nuisance[rows], comparison.scaled[rows]
    d = comparison.variances(sizes)[:, rows]
    groups = separate(j, shapes)
    data = np.column_stack([j[:, groups.common], r])
    own, p, factor = groups.beside(d, data), len(groups.common), np.asarray(scales, dtype=float)
    rest, scaled = ((data[part].T / d[:, None, part]) @ data[part] for part in (~shapes, shapes))
    precision = rest[:, None] + scaled[:, None] / factor[:, None, None] ** 2 - own.share(factor)
    # what is added to the residual's corner, more than its round-off, goes from chi-squared again
    corner = 1.0 + 1e-12 * precision[..., -1, -1]
    precision[..., :-1, :-1] += np.eye(p)
    precision[..., -1, -1] += corner
    pivots = np.diagonal(np.linalg.cholesky(precision), axis1=2, axis2=3)
    chi2 = np.maximum(pivots[..., -1] ** 2 - corner, 0.0)
    log_det = 2 * np.log(pivots[..., :-1]).sum(axis=-1) + 2 * shapes.sum() * np.log(factor)
    noise = np.log(d).sum(axis=1)[:, None] + len(r) * np.log(2 * np.pi)
    return Parts(
        sizes=tuple(sizes),
        scales=tuple(factor.tolist()),
        log_likelihood=-0.5 * (chi2 + log_det + own.log_det(factor) + noise),
        chi2=chi2,
        precision=precision,
        own=own,
        common=groups.common,
        shape=(len(r), j.shape[1]),
    )


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
    rows = slice(None) if keep is None else keep
    j, d, columns = comparison.nuisance[rows], comparison.noise(scale)[rows], columns[rows]
    groups = separate(j, comparison.scaled[rows])
    common = j[:, groups.common]
    precise = groups.precise(d, np.hstack([common, columns]))
    own, free = precise[:, : common.shape[1]], precise[:, common.shape[1] :]
    inner = cho_factor(np.eye(common.shape[1]) + common.T @ own)
    solved = free - own @ cho_solve(inner, common.T @ free)
    return columns.T @ solved, solved.T @ comparison.residual[rows]
