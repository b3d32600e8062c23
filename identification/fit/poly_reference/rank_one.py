"""Several references, one shape to a mode: residues held to rank one in the maximum-likelihood fit.

With references j and responses i a mode's residues are R_ij = phi_i l_j, a shape times participations. A
fit that leaves every residue free spends a parameter on each; two close modes then share what they have
between them at will. Held to rank one they are separated by what differs: their shapes and participations.
Poles beyond the band stand for many modes each, so their residues stay free.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import stats

from acquisition.arrays import BoolArray, ComplexArray, FloatArray
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import normal_equations
from identification.fit.equations.iteration import decaying, expected_gain, solved_step
from identification.fit.equations.refine import Fit, fit_at
from identification.fit.equations.residues import Residues
from identification.fit.poly_reference.blocks import inverses, paired
from identification.fit.poly_reference.equations import Problem, Step, evaluate, residue_gain
from identification.fit.poly_reference.places import Sorted
from identification.fit.poly_reference.starts import first_participations, untangled

_ITERATIONS = 50
_CONVERGED = 1e-4  # gain in the misfit, which is a chi-square
_NOTHING = 0.01  # part of that gain that a step must promise: at rest, rounding makes every step a loss
_STUCK = 1e8  # damping at which no step helps any more
_CHANCE = 1e-4


@dataclass(frozen=True, eq=False)
class RankOne:
    """A fit whose residues are of rank one.

    Parameters
    ----------
    fit : Fit
        The model, with ``residue_variance``.
    long_variance : (n_rows, n_modes) array
        Variance of a part of each shape factor phi, the lead participation being 1; 0 for poles whose
        residues are free [m^2/(N s)^2].
    participation : (n_columns, n_modes) complex array
        Participations l, 1 at the lead reference and for poles whose residues are free [-].
    excess : float
        Twice the growth of the misfit over its chi-square limit [-]; over 1 the data refuse rank one.
    """

    fit: Fit
    long_variance: FloatArray
    participation: ComplexArray
    excess: float


def hold_to_rank_one(
    frfs: FrfSet,
    fit: Fit,
    weights: normal_equations.Weights,
    places: Sorted,
    modes: BoolArray,
    *,
    inflation: float = 1.0,
    watch: Callable[[ComplexArray], None] = lambda poles: None,
) -> RankOne:
    """Refine poles and participations together, shapes and residual terms projected out.

    Gauss-Newton with Levenberg-Marquardt damping over (poles, participations); the model is the p-LSCF's
    (Peeters, Van der Auweraer, Guillaume and Leuridan, Shock and Vibration 11 (2004) 395-409, Eq. 6) with
    maximum-likelihood weights.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs, without a line at s = 0.
    fit : Fit
        Fit with free residues, where the refinement starts.
    weights : Weights
        Reciprocal variances.
    places : Sorted
        Where each FRF stands.
    modes : (n_modes,) bool array
        Which poles are modes; at least one.
    inflation : float
        Factor by which noise that fades over the record exceeds what the weights imply [-].
    watch : function, optional
        Called with the poles after every step from which on the data bear it; what it raises ends the refinement.

    Returns
    -------
    RankOne
        The fit, and whether the data bear it.
    """
    front = np.concatenate([np.flatnonzero(modes), np.flatnonzero(~modes)])
    lead, share = first_participations(fit.linear.residues[:, modes], weights, places)
    free = np.arange(places.shape[1])[:, None] != lead[None, :]
    problem = Problem(frfs, weights, fit.linear.powers, places, free)
    share = untangled(problem, fit.poles[front], share)
    freed = 2 * share.shape[1] * (len(frfs.values) - places.shape[0] - places.shape[1] + 1)
    limit = float(stats.chi2.isf(_CHANCE, freed)) * inflation

    def watched(poles: ComplexArray, cost: float) -> None:
        if 2.0 * (cost - fit.cost) <= limit:  # the data bear it from here on, since steps lower the misfit
            watch(poles)

    poles, share, step, converged = _iterate(problem, fit.poles[front], share, frfs.decay, watched)
    excess = 2.0 * (step.cost - fit.cost) / limit
    there = fit_at(frfs, poles, weights, fit.linear.powers, fit.converged and converged)
    return _result(problem, there, (poles, share, step), excess)


def _iterate(
    problem: Problem,
    poles: ComplexArray,
    share: ComplexArray,
    decay: float,
    watch: Callable[[ComplexArray, float], None],
) -> tuple[ComplexArray, ComplexArray, Step, bool]:
    state, damping, n = evaluate(problem, poles, share), 1e-3, len(poles)
    for _ in range(_ITERATIONS):
        move = solved_step(state.normal, state.gradient, damping)
        promised = expected_gain(state.normal, state.gradient, move)
        if promised < _NOTHING * _CONVERGED:
            return poles, share, state, True
        trial_poles = decaying(poles + paired(move[: 2 * n]), poles, decay)
        trial_share = share.copy()
        trial_share[problem.free] += paired(move[2 * n :])
        trial = evaluate(problem, trial_poles, trial_share)
        if trial.cost > state.cost:
            damping *= 10.0
            if damping > _STUCK or promised < _CONVERGED:
                return poles, share, state, True
            continue
        watch(trial_poles, trial.cost)
        gain = state.cost - trial.cost
        poles, share, state, damping = trial_poles, trial_share, trial, max(0.1 * damping, 1e-12)
        if gain < _CONVERGED:
            return poles, share, state, True
    return poles, share, state, False


def _result(
    problem: Problem,
    free: Fit,
    found: tuple[ComplexArray, ComplexArray, Step],
    excess: float,
) -> RankOne:
    """Return the fit with its statistics, poles rising in frequency; ``free`` has free residues there."""
    poles, share, step = found
    places, n, h = problem.places, len(poles), share.shape[1]
    order = np.argsort(np.abs(poles))
    covariance = 0.5 * inverses(step.normal[None])[0]
    residue_variance, long_variance = _variances(problem, share, step, covariance)
    sign, both = places.sign[:, None], (2 * order[:, None] + np.arange(2)).ravel()
    residue_variance = np.hstack([residue_variance, np.zeros((len(sign), n - h))])[:, order]
    residue_variance = np.where(order < h, residue_variance, free.residue_inverse[:, 1::2])
    held_fit = replace(
        free,
        linear=Residues((step.residues * sign)[:, order], step.terms * sign, problem.powers),
        cost=step.cost,
        information=2.0 * _of_poles(step.normal, 2 * n)[np.ix_(both, both)],
        residue_variance=residue_variance,
    )
    spare = np.zeros((places.shape[0], n - h))
    one = np.ones((places.shape[1], n - h))
    return RankOne(
        held_fit, np.hstack([long_variance, spare])[:, order], np.hstack([share, one])[:, order], excess
    )


def _of_poles(normal: FloatArray, count: int) -> FloatArray:
    """Return the normal matrix of the first ``count`` parameters with the others projected out."""
    across = normal[:count, count:]
    left = normal[:count, :count] - across @ inverses(normal[None, count:, count:])[0] @ across.T
    return np.asarray(0.5 * (left + left.T))


def _variances(
    problem: Problem, share: ComplexArray, step: Step, covariance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the variances of Im R_ij, shape (n_frf, n_held), and of a part of phi, (n_rows, n_held)."""
    places, n_held = problem.places, share.shape[1]
    held = 0.5 * np.einsum("imm->im", step.held).reshape(-1, n_held, 2).mean(axis=2)
    by_all = np.empty((len(places.row), n_held))
    for column in range(places.shape[1]):
        mine = np.flatnonzero(places.column == column)
        by_all[mine] = _spread(residue_gain(problem, step, share, column), covariance)
    residues = held[places.row] * np.abs(share[places.column]) ** 2 + by_all
    spread = _spread(step.follow, covariance)
    return residues, held + spread.reshape(-1, n_held, 2).mean(axis=2)


def _spread(gain: FloatArray, covariance: FloatArray) -> FloatArray:
    """Return the variances of what follows parameters by a gain, (n, m, n_parameters), never negative."""
    return np.asarray(np.maximum(np.einsum("imp,imp->im", gain @ covariance, gain), 0.0))
