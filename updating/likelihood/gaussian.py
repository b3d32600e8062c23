"""Marginal likelihood of a comparison: nuisances integrated out exactly, in the small space they span.

How well shapes were measured is known only so far: cross-talk, oblique hits and rounded positions leave no
trace in the coherence. So the noise of the shapes has an unknown scale, summed over a few values by their
prior; a misfit of shapes then counts for as much as their noise, judged by all of them, allows.

How far the idealisation of an effect is off is known as little: it is a judgement of what it may be at most. So its
size is summed over likewise: a region that is softened just so is not made less believable by a doubt it has no need
of, and one that is not still has it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.linalg.lapack import dposv

from acquisition.arrays import BoolArray, FloatArray
from updating.likelihood.comparison import Comparison
from updating.likelihood.separate import Separate, separate
from updating.thresholds import (
    LARGEST_SENSITIVITY,
    NEGLIGIBLE_SCALE,
    SHAPE_NOISE_SCALES,
)


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
    """

    log_likelihood: float
    chi2: float
    shift: FloatArray
    count: int
    scale: float
    share: float = 1.0
    unseen: float = 1.0


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
    sizes = comparison.sizes
    prior = dict(zip(scales, np.log(comparison.scale_prior if len(scales) > 1 else (1.0,)), strict=True))
    rows = slice(None) if keep is None else keep
    groups = separate(comparison.nuisance[rows], comparison.scaled[rows])
    parts = [
        replace(part, share=share, unseen=unseen)
        for share, unseen in sizes
        for part in _worth_adding(gaussian(comparison.settled(share, unseen), scales, keep, groups))
    ]
    score = np.array([part.log_likelihood + prior[part.scale] for part in parts]) - np.log(len(sizes))
    top = parts[int(np.argmax(score))]
    peak = float(score.max())
    return replace(top, log_likelihood=peak + float(np.log(np.sum(np.exp(score - peak)))))


def _worth_adding(parts: Iterator[Marginal]) -> Iterator[Marginal]:
    """Yield what is worth adding up of the same data with ever noisier shapes: all until it is far past the best.

    What the noise adds to the determinant grows with its logarithm, what it takes from chi-squared falls.
    """
    best = -np.inf
    for part in parts:
        yield part
        best = max(best, part.log_likelihood)
        if part.log_likelihood < best - NEGLIGIBLE_SCALE:
            return


def _sound(comparison: Comparison) -> bool:
    """Tell whether a prediction is finite and no sensitivity is beyond all measure."""
    whole = np.isfinite(comparison.residual).all() and np.isfinite(comparison.nuisance).all()
    return bool(
        whole
        and np.isfinite(comparison.variance).all()
        and np.abs(comparison.nuisance).max(initial=0.0) < LARGEST_SENSITIVITY
    )


def gaussian(
    comparison: Comparison,
    scales: Sequence[float],
    keep: BoolArray | None = None,
    groups: Separate | None = None,
) -> Iterator[Marginal]:
    """Integrate the nuisances out at one scale of the noise of the shapes after the other; see :func:`marginal`.

    ``groups`` are those of the data kept, where they are found already.
    """
    rows = slice(None) if keep is None else keep
    r, j, d = comparison.residual[rows], comparison.nuisance[rows], comparison.variance[rows]
    shapes = comparison.scaled[rows]
    groups = separate(j, shapes) if groups is None else groups
    data = np.column_stack([j[:, groups.common], r])
    # every scale weighs the same two Gram matrices, those of the shapes and of the rest
    gram_matrices = [(data[part].T / d[part]) @ data[part] for part in (~shapes, shapes)]
    own = groups.beside(d, data)
    p, noise = len(groups.common), float(np.sum(np.log(d))) + len(r) * np.log(2 * np.pi)
    for scale in scales:
        gram = gram_matrices[0] + gram_matrices[1] / scale**2 - own.share(scale)
        load = gram[:p, p]
        shift, pivots = _solved(np.eye(p) + gram[:p, :p], load)
        chi2 = float(gram[p, p] - load @ shift)
        log_det = 2 * float(np.log(pivots).sum() + shapes.sum() * np.log(scale)) + own.log_det(scale)
        whole = np.zeros(j.shape[1])
        whole[groups.common] = shift
        own.fill(whole, scale, np.append(-shift, 1.0))
        yield Marginal(-0.5 * (chi2 + log_det + noise), chi2, whole, len(r), scale)


def _solved(matrix: FloatArray, load: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Solve with a positive definite matrix (p, p), by one call of LAPACK: most are small.

    Returns
    -------
    solution : (p,) array
    pivots : (p,) array
        Diagonal of the Cholesky factor.
    """
    if not len(load):
        return load, load
    lower, solution, failed = dposv(matrix, load, lower=1)
    if failed:
        raise np.linalg.LinAlgError("the precision of the nuisances is not positive definite")
    return solution, np.diagonal(lower)


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
