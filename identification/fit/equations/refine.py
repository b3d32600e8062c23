"""Maximum-likelihood refinement of poles and residues by variable projection, with its covariance."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import basis, normal_equations
from identification.fit.equations.iteration import settled
from identification.fit.equations.line_selection import Lines, selected_lines
from identification.fit.equations.projection import (
    Problem,
    State,
    Step,
    carried,
    pole_turns,
    rising,
    state_at,
)
from identification.fit.equations.residues import Residues, unpack

_ITERATIONS = 40
_CONVERGED = 1e-10
_POLISHED = 1e-8  # a tolerance under which all lines have the last word


@dataclass(frozen=True, eq=False)
class Fit:
    """A modal model fitted to FRFs.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Poles [rad/s].
    linear : Residues
        Residues and residual terms.
    cost : float
        Weighted sum of squared misfits [-].
    information : (2 n_modes, 2 n_modes) array
        Gauss-Newton information of (Re, Im) of the poles, interleaved, twice J^T J [s^2/rad^2].
    equations : State
        Normal equations on all lines at the poles, residues free: what the properties below follow from.
    converged : bool
        Whether the iteration came to rest.
    residue_variance : (n_frf, n_modes) array, optional
        Variance of the imaginary part of each residue, everything fitted, where it does not follow from
        ``pole_gain`` and ``residue_inverse``: residues held to rank one [m^2/(N s)^2].
    """

    poles: ComplexArray
    linear: Residues
    cost: float
    information: FloatArray
    equations: State
    converged: bool
    residue_variance: FloatArray | None = None

    @cached_property
    def pole_gain(self) -> FloatArray:
        """Change of the imaginary part of each residue per change of the poles, (n_frf, n_modes, 2 n_modes)."""
        n, solution = len(self.poles), self.equations.step.solution
        follow = self.equations.follow[:, 1 : 2 * n : 2].reshape(-1, n, n, 2)
        turns = -pole_turns(solution, n)[:, None]
        gain = follow[..., 0, None] * turns[..., 0, :]
        gain += follow[..., 1, None] * turns[..., 1, :]
        return np.asarray(gain.reshape(len(solution), n, 2 * n))

    @cached_property
    def residue_inverse(self) -> FloatArray:
        """Variance of both parts of each residue with the poles held, for weights that are reciprocal variances.

        Parts interleaved, (n_frf, 2 n_modes) [m^2/(N s)^2].
        """
        k = self.equations.step.solution.shape[1]
        inverse = _inverse_diagonal(self.equations.products.gram[:, :k, :k])[:, : 2 * len(self.poles)]
        return np.asarray(inverse / (2.0 * self.equations.level[:, None]))


def refine(
    frfs: FrfSet,
    poles: ComplexArray,
    weights: normal_equations.Weights,
    *,
    powers: tuple[int, ...] = basis.BASIC_TERMS,
    iterations: int = _ITERATIONS,
    tolerance: float = _CONVERGED,
    enough: float = 0.0,
    known: State | None = None,
) -> Fit:
    """Minimise the weighted misfit over poles, residues and residual terms.

    The linear unknowns are projected out (Golub and Pereyra, SIAM J. Numer. Anal. 10 (1973) 413-432, with
    Kaufman's simplification), so each step solves for the poles alone; steps are damped by
    Levenberg-Marquardt. With weights that are reciprocal noise variances this is maximum likelihood for
    circular Gaussian noise.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs, without a line at s = 0.
    poles : (n_modes,) complex array
        Starting poles [rad/s].
    weights : Weights
        Reciprocal variances E|dH|^2 [1 / unit of the FRFs squared].
    powers : tuple of int
        Powers of s of the residual terms of the receptance [-].
    iterations : int
        Upper limit of steps [-].
    tolerance : float
        Relative gain of a step at which the iteration rests [-].
    enough : float
        Gain at which it rests as well: small beside 1, with weights that are reciprocal variances [-].
    known : State, optional
        The normal equations at ``poles`` with these weights on all lines, where they were formed before.

    Returns
    -------
    Fit
        The refined model.
    """
    problem = Problem.of(*selected_lines(frfs, poles, weights), powers)
    whole = len(problem.axis.laplace) == len(frfs.frequency)
    start = known if known is not None and whole else state_at(problem, poles)
    state, converged = settled(problem, start, iterations, (tolerance, enough))
    if whole:
        return _fit(problem, state, converged)
    every = Problem.of(Lines.of(frfs), weights, powers)
    if tolerance < _POLISHED:
        state, converged = settled(every, state_at(every, state.poles), iterations, (tolerance, enough))
        return _fit(every, state, converged)
    return _fit(every, state_at(every, state.poles), converged)


def fit_at(
    frfs: FrfSet,
    poles: ComplexArray,
    weights: normal_equations.Weights,
    powers: tuple[int, ...],
    converged: bool,
) -> Fit:
    """Return the fit at given poles, rising in frequency; parameters as for :func:`refine`."""
    problem = Problem.of(Lines.of(frfs), weights, powers)
    return _fit(problem, state_at(problem, poles), converged)


def _fit(problem: Problem, state: State, converged: bool) -> Fit:
    """Return the fit at a state, poles rising in frequency."""
    state = rising(state)
    return Fit(
        state.poles,
        unpack(state.step.solution, len(state.poles), state.term_scale, problem.powers),
        state.cost,
        2.0 * state.step.normal,
        state,
        converged,
    )


def evaluate(
    frfs: FrfSet, poles: ComplexArray, weights: normal_equations.Weights, powers: tuple[int, ...]
) -> Step:
    """Project the linear unknowns out at given poles; parameters as for :func:`refine`."""
    return state_at(Problem.of(*selected_lines(frfs, poles, weights), powers), poles).step


def scores(fit: Fit) -> tuple[FloatArray, FloatArray]:
    """Return the information of each FRF alone on each pole of a fit.

    Returns
    -------
    gradient : (n_frf, n_modes, 2) array
        J^T r of (Re, Im) of each pole, the linear unknowns projected out [s/rad].
    normal : (n_frf, n_modes, 2, 2) array
        J^T J of the same [s^2/rad^2].
    """
    left, projected, turns = _of_each(fit.equations)
    level = fit.equations.level
    own = np.broadcast_to(np.einsum("jninm->jnim", projected), (len(left), *projected.shape[1:3], 2))
    gradient = np.einsum("j,jni,jnia->jna", level, left, turns)
    normal = np.einsum("j,jnia,jnim,jnmb->jnab", level, turns, own, turns, optimize=True)
    return gradient, normal


def frequency_scores(fit: Fit) -> tuple[FloatArray, FloatArray]:
    """Return the information of each FRF alone on the relative shifts of all frequencies of a fit.

    A shift d moves a pole from p to p (1 + d), so that its damping ratio stays.

    Returns
    -------
    gradient : (n_frf, n_modes) array
        J^T r of the shifts, the linear unknowns projected out [-].
    normal : (n_frf, n_modes, n_modes) array
        J^T J of the same [-].
    """
    left, projected, turns = _of_each(fit.equations)
    turned = np.einsum("jnia,na->jni", turns, np.stack([fit.poles.real, fit.poles.imag], axis=1))
    level = fit.equations.level
    gradient = np.einsum("j,jni,jni->jn", level, left, turned)
    if len(projected) == 1:
        half = np.einsum("nimb,jmb->jnim", projected[0], turned, optimize=True)
    else:
        half = np.einsum("jnimb,jmb->jnim", projected, turned, optimize=True)
    return gradient, np.einsum("j,jni,jnim->jnm", level, turned, half, optimize=True)


def _of_each(state: State) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return what is left of each FRF along the slope columns, their products, and the turns to the poles.

    The linear unknowns are projected out: (n_frf, n, 2), (n_frf or 1, n, 2, n, 2) and (n_frf, n, 2, 2).
    """
    gram, solution = state.products.gram, state.step.solution
    n, k = len(state.poles), solution.shape[1]
    across = gram[:, :k, k:]
    projected = gram[:, k:, k:] - np.matmul(across.transpose(0, 2, 1), state.follow)
    left = (state.products.cross[:, k:] - carried(solution, across)).reshape(-1, n, 2)
    return left, projected.reshape(-1, n, 2, n, 2), pole_turns(solution, n)


def _inverse_diagonal(gram: FloatArray) -> FloatArray:
    """Return the diagonal of each inverse; directions the data do not see count as seen to rounding."""
    length, values, vectors = normal_equations.scaled_eigen(gram)
    floor = np.finfo(float).eps * gram.shape[-1]
    inverse = np.einsum("jkm,jm->jk", vectors**2, 1.0 / np.maximum(values, floor))
    return np.asarray(inverse / length**2)
