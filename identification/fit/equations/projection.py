"""The linear unknowns projected out at given poles: what a step from there needs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from identification.fit.equations import basis, normal_equations
from identification.fit.equations.line_selection import Lines

_FEWER = 2  # FRFs to a combination from which on the combinations pay for themselves


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


@dataclass(frozen=True, eq=False)
class Problem:
    """What stays the same from step to step: the lines, the data times their weights, the residual terms."""

    axis: basis.Axis
    data: normal_equations.Data
    powers: tuple[int, ...]

    @classmethod
    def of(cls, lines: Lines, weights: normal_equations.Weights, powers: tuple[int, ...]) -> Problem:
        """Return the problem of FRFs on some lines."""
        return cls(lines.axis, normal_equations.prepared(lines.values, weights), powers)

    def combined(self, cross: FloatArray) -> Problem | None:
        """Return the problem of combinations of FRFs in its place, None where these are not far fewer.

        Where lines weigh alike, the misfit depends on the FRFs by their products with one another alone: turned among
        themselves they are the same problem. Combinations that are orthogonal to all columns and slopes at some
        poles have nothing to say near these, but for second order terms of noise. So as many are left as there are
        columns and slopes, at those poles to the last digit (Golub and Van Loan, Matrix Computations, 4th ed.,
        Sec. 5.2).

        Parameters
        ----------
        cross : (n_frf, n_columns) array
            Products of the FRFs with columns and slopes.
        """
        data, count = self.data, cross.shape[1]
        if len(data.weights.lines) > 1 or len(cross) < _FEWER * count:
            return None
        root = np.sqrt(data.weights.level)[:, None]
        turn = (root * np.linalg.qr(root * cross)[0]).T
        power = np.full(count, float(data.weights.level @ data.power) / count)
        weights = normal_equations.Weights(np.ones(count), data.weights.lines, data.weights.fade)
        return replace(self, data=normal_equations.Data(turn @ data.weighted, power, weights))


@dataclass(frozen=True, eq=False)
class State:
    """A step at its poles, with the normal equations it comes from.

    Parameters
    ----------
    poles : (n_modes,) complex array
        The poles [rad/s].
    step : Step
        Misfit, linear unknowns and the equations of the poles.
    products : NormalEquations
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


def state_at(problem: Problem, poles: ComplexArray) -> State:
    """Project the linear unknowns out at given poles."""
    columns = basis.build(problem.axis, poles, problem.powers)
    products, level = normal_equations.form(columns.columns, problem.data), problem.data.weights.level
    solution, follow = _projection(products, columns.n_linear)
    return State(
        poles,
        _normal_step(products, solution, follow, level, len(poles)),
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


def _normal_step(
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


def rising(state: State) -> State:
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
