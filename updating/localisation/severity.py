"""Likelihood of every severity from predictions at a few of them, and its integral.

Between the severities predicted, residual, sensitivities and noise are interpolated by splines, each as it grows with
the severity; the nuisances are integrated out anew at each severity asked for.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import logsumexp

from acquisition.arrays import BoolArray, FloatArray
from updating.likelihood.comparison import Comparison
from updating.thresholds import SHAPE_NOISE_SCALES

EVEN = 0.4
"""Log-likelihoods of neighbouring severities may differ by so much at the maximum [-]."""

DEPTH = 14.0
"""What lies further below the maximum of the log-likelihood does not count [-]."""


@dataclass(frozen=True, eq=False)
class Between:
    """Comparisons at some severities, and what lies between them.

    Parameters
    ----------
    evaluations : mapping
        Comparisons by severity; all of the same data and nuisances.
    """

    evaluations: Mapping[float, Comparison]

    @cached_property
    def nodes(self) -> FloatArray:
        """The severities predicted, in order."""
        return np.array(sorted(self.evaluations), dtype=float)

    @cached_property
    def _ordered(self) -> list[Comparison]:
        return [self.evaluations[s] for s in self.nodes.tolist()]

    @cached_property
    def _data(self) -> CubicSpline:
        """Spline of nuisances and residual, (n, p + 1)."""
        parts = [np.column_stack([evaluation.nuisance, evaluation.residual]) for evaluation in self._ordered]
        return CubicSpline(self.nodes, np.stack(parts))

    @cached_property
    def _least(self) -> FloatArray:
        return np.asarray(np.min([evaluation.variance for evaluation in self._ordered], axis=0))

    @cached_property
    def _excess(self) -> CubicSpline:
        """Spline of what the severity adds to the noise.

        The noise of frequencies grows with the square of their shift: its root, with the sign of the shift, is smooth
        where the noise is least. That of the shapes has a floor well above what it grows by there.
        """
        excess = np.stack([evaluation.variance for evaluation in self._ordered]) - self._least
        change = np.stack([evaluation.residual for evaluation in self._ordered])
        start = int(np.argmin(excess[:, self._shifting].sum(axis=1)))
        root = np.sign(change - change[start]) * np.sqrt(excess)
        return CubicSpline(self.nodes, np.where(self._shifting, root, excess))

    @cached_property
    def _shifting(self) -> BoolArray:
        return np.asarray(self._ordered[0].of("frequency"))

    def variance(self, severity: FloatArray) -> FloatArray:
        """Return the variance of the independent noise at severities, (m, n) [-]."""
        excess = self._excess(severity)
        return np.asarray(self._least + np.where(self._shifting, excess**2, np.maximum(excess, 0.0)))

    @cached_property
    def _settled(self) -> tuple[Between, ...]:
        """The same at each size of the doubts whose size is unknown, where there are any."""
        sizes = max((evaluation.sizes for evaluation in self._ordered), key=len)
        if len(sizes) == 1:
            return (self,)
        return tuple(
            Between({s: evaluation.settled(*size) for s, evaluation in self.evaluations.items()})
            for size in sizes
        )

    def log_likelihoods(self, severity: FloatArray) -> FloatArray:
        """Return the log-likelihood at severities, (m,) [-].

        Nuisances, the shapes' noise and the size of the doubt in the idealisation are integrated out.
        """
        found = np.stack([one._at_its_size(severity) for one in self._settled])
        return np.asarray(logsumexp(found, axis=0) - np.log(len(found)))

    def _at_its_size(self, severity: FloatArray) -> FloatArray:
        """Return the log-likelihood at severities with the doubt in the idealisation as it stands, (m,) [-]."""
        first = self._ordered[0]
        shapes = first.scaled
        scales = SHAPE_NOISE_SCALES if shapes.any() else (1.0,)
        prior = np.log(first.scale_prior if len(scales) > 1 else (1.0,))
        data, variance = self._data(severity), self.variance(severity)
        gram_matrices = [_gram_matrices(data[:, rows], variance[:, rows]) for rows in (~shapes, shapes)]
        noise = np.log(variance).sum(axis=1) + len(shapes) * np.log(2 * np.pi)
        found = [
            prior_of
            - 0.5
            * (
                noise
                + 2 * shapes.sum() * np.log(scale)
                + _marginal(gram_matrices[0] + gram_matrices[1] / scale**2)
            )
            for scale, prior_of in zip(scales, prior, strict=True)
        ]
        return np.asarray(logsumexp(np.stack(found), axis=0))


def _gram_matrices(data: FloatArray, variance: FloatArray) -> FloatArray:
    return np.asarray(np.swapaxes(data / variance[:, :, None], 1, 2) @ data)


def _marginal(gram: FloatArray) -> FloatArray:
    """Return chi-squared plus the logarithm of the determinant from Gram matrices of [nuisances | residual].

    The last pivot of the Cholesky factor is the length that the nuisances leave of the residual; 1e-6 keeps it
    positive where nothing is left.
    """
    p = gram.shape[1] - 1
    pivots = np.diagonal(np.linalg.cholesky(gram + np.diag(np.r_[np.ones(p), 1e-6])), axis1=1, axis2=2)
    return np.asarray(pivots[:, p] ** 2 + 2 * np.log(pivots[:, :p]).sum(axis=1))


def refine(
    log_likelihoods: Callable[[FloatArray], FloatArray],
    grid: FloatArray,
    *,
    rounds: int = 12,
    even: float = EVEN,
    slack: float = 0.3,
) -> tuple[FloatArray, FloatArray]:
    """Halve the steps between severities until the log-likelihood is even from one to the next where it counts.

    Parameters
    ----------
    log_likelihoods : callable
        Log-likelihoods at severities, (m,) to (m,) [-].
    grid : (m,) array
        Severities to begin with, in order.
    rounds : int
        How often they are halved at most.
    even, slack : float
        Neighbours whose log-likelihoods differ by no more than ``even`` are near enough at the maximum, and by
        ``slack`` more for each unit that they lie below it [-].

    Returns
    -------
    grid, values : (m',) arrays
        Severities in order, and their log-likelihoods [-].
    """
    values = log_likelihoods(grid)
    for _ in range(rounds):
        middle = (grid[1:] + grid[:-1]) / 2
        between = CubicSpline(grid, values)(middle)
        high = np.maximum(np.maximum(values[1:], values[:-1]), between)
        low = np.minimum(np.minimum(values[1:], values[:-1]), between)
        coarse = (high > high.max() - DEPTH) & (high - low > even + slack * (high.max() - high))
        if not coarse.any():
            break
        grid = np.r_[grid, middle[coarse]]
        values = np.r_[values, log_likelihoods(middle[coarse])]
        order = np.argsort(grid)
        grid, values = grid[order], values[order]
    return grid, values


def integrate(grid: FloatArray, values: FloatArray, *, parts: int = 8) -> tuple[FloatArray, FloatArray]:
    """Return severities of refined steps, and the logarithm of the integral that each stands for, prior left out.

    Parameters
    ----------
    grid, values : (m,) arrays
        What :func:`refine` gave [-].
    parts : int
        Into how many parts each step is cut.
    """
    place = np.arange(len(grid), dtype=float)
    fine = np.interp(np.linspace(0, len(grid) - 1, parts * (len(grid) - 1) + 1), place, grid)
    middle = (fine[1:] + fine[:-1]) / 2
    highest = (
        np.repeat(np.maximum(values[1:], values[:-1]), parts) + EVEN
    )  # a spline may swing where steps are long
    return middle, np.asarray(np.minimum(CubicSpline(grid, values)(middle), highest) + np.log(np.diff(fine)))
