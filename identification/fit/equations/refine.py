"""Maximum-likelihood refinement of poles and residues by variable projection, with its covariance."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import basis, normal_equations
from identification.fit.equations.line_selection import Lines, selected_lines
from identification.fit.equations.residues import Residues, unpack

_ITERATIONS = 40
_CONVERGED = 1e-10
_RIDGE = 1e-14
NOTHING = 0.01
"""Part of the gain at which an iteration rests that a step must promise [-]: at rest, rounding makes every step a loss,
and each is tried again with more damping."""
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


@dataclass(frozen=True, eq=False)
class Step:
    """Everything at one set of poles that the next step needs.

    Parameters
    ----------
    cost : float
        Weighted sum of squared misfits with the best linear unknowns [-].
    solution : (n_frf, 2 n_modes + n_terms) array
        Those unknowns.
    normal : (2 n_modes, 2 n_modes) array
        J^T J of (Re, Im) of the poles, interleaved [s^2/rad^2].
    gradient : (2 n_modes,) array
        J^T r [s/rad].
    """

    cost: float
    solution: FloatArray
    normal: FloatArray
    gradient: FloatArray


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
    problem = _Problem.of(*selected_lines(frfs, poles, weights), powers)
    whole = len(problem.axis.laplace) == len(frfs.frequency)
    start = known if known is not None and whole else _at(problem, poles)
    state, converged = _iterate(problem, start, iterations, (tolerance, enough))
    if whole:
        return _fit(problem, state, converged)
    every = _Problem.of(Lines.of(frfs), weights, powers)
    if tolerance < _POLISHED:
        state, converged = _iterate(every, _at(every, state.poles), iterations, (tolerance, enough))
        return _fit(every, state, converged)
    return _fit(every, _at(every, state.poles), converged)


@dataclass(frozen=True, eq=False)
class _Problem:
    """What stays the same from step to step: the lines, the data times their weights, the residual terms."""

    axis: basis.Axis
    data: normal_equations.Data
    powers: tuple[int, ...]

    @classmethod
    def of(cls, lines: Lines, weights: normal_equations.Weights, powers: tuple[int, ...]) -> _Problem:
        return cls(lines.axis, normal_equations.prepared(lines.values, weights), powers)


@dataclass(frozen=True, eq=False)
class State:
    """A step at its poles, with the normal equations it comes from.

    Parameters
    ----------
    poles : (n_modes,) complex array
        The poles [rad/s].
    step : Step
        Misfit, linear unknowns and the equations of the poles.
    products : Grams
        Products of the linear columns and then the slopes.
    follow : (n_frf or 1, 2 n_modes + n_terms, 2 n_modes) array
        How the linear unknowns follow the slope columns.
    term_scale : (n_terms,) array
        What a coefficient is multiplied by to become that of s^k in the receptance.
    level : (n_frf,) array
        Factor of each FRF in the weights [1 / unit of the FRFs squared].
    """

    poles: ComplexArray
    step: Step
    products: normal_equations.NormalEquations
    follow: FloatArray
    term_scale: FloatArray
    level: FloatArray

    @property
    def cost(self) -> float:
        """Weighted sum of squared misfits [-]."""
        return self.step.cost


def _iterate(
    problem: _Problem, state: State, iterations: int, tolerance: tuple[float, float]
) -> tuple[State, bool]:
    """Return where the steps come to rest, and whether they do."""
    damping = 1e-3
    for _ in range(iterations):
        rest = max(tolerance[0] * state.cost, tolerance[1])
        step = solved_step(state.step.normal, state.step.gradient, damping)
        if expected_gain(state.step.normal, state.step.gradient, step) < NOTHING * rest:
            return state, True
        trial_poles = state.poles + step[0::2] + 1j * step[1::2]
        trial = _at(problem, decaying(trial_poles, state.poles, problem.axis.decay))
        if trial.cost <= state.cost:
            gain = state.cost - trial.cost
            state, damping = trial, max(0.1 * damping, 1e-12)
            if gain < rest:
                return state, True
        else:
            damping *= 10.0
            if damping > 1e8:
                return state, True
    return state, False


def solved_step(normal: FloatArray, gradient: FloatArray, damping: float) -> FloatArray:
    """Return the step of Levenberg and Marquardt in unit columns, shape as ``gradient``."""
    diagonal = np.diag(normal)
    length = np.sqrt(np.maximum(diagonal, 1e-24 * diagonal.max() + 1e-200))
    unit = normal / np.outer(length, length) + (damping + _RIDGE) * np.eye(len(length))
    return np.asarray(np.linalg.solve(unit, gradient / length) / length)


def expected_gain(normal: FloatArray, gradient: FloatArray, step: FloatArray) -> float:
    """Return by how much a step lowers the misfit where the model is linear [-]."""
    return float(step @ (2.0 * gradient - normal @ step))


def decaying(trial: ComplexArray, poles: ComplexArray, decay: float) -> ComplexArray:
    """Keep trial poles decaying and Im > 0; go half-way to a border that would be crossed."""
    real = np.where(trial.real < decay, trial.real, 0.5 * (poles.real + decay))
    imag = np.where(trial.imag > 0.5 * poles.imag, trial.imag, 0.75 * poles.imag)
    return np.asarray(real + 1j * imag)


def _at(problem: _Problem, poles: ComplexArray) -> State:
    """Project the linear unknowns out at given poles."""
    columns = basis.build(problem.axis, poles, problem.powers)
    products, level = normal_equations.form(columns.columns, problem.data), problem.data.weights.level
    solution, follow = _projection(products, columns.n_linear)
    return State(
        poles,
        _step(products, solution, follow, level, len(poles)),
        products,
        follow,
        columns.term_scale,
        level,
    )


def _projection(products: normal_equations.NormalEquations, k: int) -> tuple[FloatArray, FloatArray]:
    """Return the linear solution, (n_frf, k), and how it follows the slope columns, (n_frf or 1, k, rest)."""
    here, across = products.gram[:, :k, :k], products.gram[:, :k, k:]
    if len(here) < len(products.cross):
        solution = normal_equations.solve(here, products.cross[:, :k, None])[:, :, 0]
        return solution, normal_equations.solve(here, across)
    both = normal_equations.solve(here, np.concatenate([products.cross[:, :k, None], across], axis=2))
    return both[:, :, 0], both[:, :, 1:]


def scores(fit: Fit) -> tuple[FloatArray, FloatArray]:
    """Return what each FRF alone says about each pole of a fit.

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


def frequency_scores(fit: Fit) -> tuple[FloatArray, FloatArray]:
    """Return what each FRF alone says about the relative shifts of all frequencies of a fit.

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


def carried(solution: FloatArray, across: FloatArray) -> FloatArray:
    """Return what each FRF's factors make of products, (n_frf, k) by (n_frf or 1, k, m)."""
    if len(across) == 1:
        return np.asarray(solution @ across[0])
    return np.asarray(np.matmul(solution[:, None, :], across)[:, 0])


def pole_turns(solution: FloatArray, n_modes: int) -> FloatArray:
    """Return the 2 x 2 blocks that turn (Re, Im) of a pole's step into weights of its two slope columns.

    The slope columns are derivatives by Re p; those by Im p are the same two crosswise, because the columns
    are analytic in p. Shape (n_frf, n_modes, slope, Re or Im).
    """
    a = solution[:, 0 : 2 * n_modes : 2]
    b = solution[:, 1 : 2 * n_modes : 2]
    return np.stack([np.stack([a, -b], axis=2), np.stack([b, a], axis=2)], axis=2)


def evaluate(
    frfs: FrfSet, poles: ComplexArray, weights: normal_equations.Weights, powers: tuple[int, ...]
) -> Step:
    """Project the linear unknowns out at given poles; parameters as for :func:`refine`."""
    return _at(_Problem.of(*selected_lines(frfs, poles, weights), powers), poles).step


def _step(
    products: normal_equations.NormalEquations,
    solution: FloatArray,
    follow: FloatArray,
    level: FloatArray,
    n: int,
) -> Step:
    k = solution.shape[1]
    cost = float(level @ (products.power - np.einsum("jk,jk->j", products.cross[:, :k], solution)))
    between = products.gram[:, :k, k:]
    projected = products.gram[:, k:, k:] - np.einsum("jkm,jkl->jml", between, follow)
    turns = pole_turns(solution, n)
    left = (products.cross[:, k:] - carried(solution, between)).reshape(-1, n, 2)
    gradient = np.einsum("j,jni,jnia->na", level, left, turns)
    normal = _contract(projected.reshape(-1, n, 2, n, 2), turns, level)
    return Step(max(cost, 0.0), solution, normal, gradient.reshape(2 * n))


def _contract(projected: FloatArray, turns: FloatArray, level: FloatArray) -> FloatArray:
    """Return sum_j level_j T_j^T S_j T_j, shape (2 n_modes, 2 n_modes)."""
    n = turns.shape[1]
    if len(projected) == 1:
        pairs = np.einsum("j,jnia,jmkb->niamkb", level, turns, turns, optimize=True)
        normal = np.einsum("nimk,niamkb->namb", projected[0], pairs)
    else:
        half = np.einsum("jnimk,jmkb->jnimb", projected, turns)
        normal = np.einsum("j,jnia,jnimb->namb", level, turns, half, optimize=True)
    return np.asarray(normal.reshape(2 * n, 2 * n))


def fit_at(
    frfs: FrfSet,
    poles: ComplexArray,
    weights: normal_equations.Weights,
    powers: tuple[int, ...],
    converged: bool,
) -> Fit:
    """Return the fit at given poles, rising in frequency; parameters as for :func:`refine`."""
    problem = _Problem.of(Lines.of(frfs), weights, powers)
    return _fit(problem, _at(problem, poles), converged)


def _fit(problem: _Problem, state: State, converged: bool) -> Fit:
    """Return the fit at a state, poles rising in frequency."""
    state = _sorted(state)
    return Fit(
        state.poles,
        unpack(state.step.solution, len(state.poles), state.term_scale, problem.powers),
        state.cost,
        2.0 * state.step.normal,
        state,
        converged,
    )


def _sorted(state: State) -> State:
    """Return the same state with poles rising in frequency."""
    n, k = len(state.poles), state.step.solution.shape[1]
    order = np.argsort(np.abs(state.poles))
    if (np.diff(order) > 0).all():
        return state
    both = (2 * order[:, None] + np.arange(2)).ravel()
    linear, step, products = np.concatenate([both, np.arange(2 * n, k)]), state.step, state.products
    every = np.concatenate([linear, k + both])
    return replace(
        state,
        poles=state.poles[order],
        step=Step(step.cost, step.solution[:, linear], step.normal[np.ix_(both, both)], step.gradient[both]),
        products=normal_equations.NormalEquations(
            products.gram[:, every[:, None], every], products.cross[:, every], products.power
        ),
        follow=state.follow[:, linear[:, None], both],
    )


def _inverse_diagonal(gram: FloatArray) -> FloatArray:
    """Return the diagonal of each inverse; directions the data do not see count as seen to rounding."""
    length = np.sqrt(np.maximum(np.einsum("jkk->jk", gram), np.finfo(float).tiny))
    values, vectors = np.linalg.eigh(gram / (length[:, :, None] * length[:, None, :]))
    floor = np.finfo(float).eps * gram.shape[-1]
    inverse = np.einsum("jkm,jm->jk", vectors**2, 1.0 / np.maximum(values, floor))
    return np.asarray(inverse / length**2)
