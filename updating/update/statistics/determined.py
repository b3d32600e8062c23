"""What the data determine: covariance of the parameters, and which of them nothing but the prior holds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2 as chi2_distribution

from acquisition.arrays import BoolArray, FloatArray
from updating.update.data.system import Linear, System
from updating.update.gauss_newton import NEGLIGIBLE
from updating.update.statistics.identifiability import Determinability, determinability
from updating.update.statistics.leverage import leverage

SIGNIFICANT = 1e-3
"""A misfit less probable than this means that the model's error, not the measurement's, is what scatters."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Statistics:
    """Statistics of an update.

    Parameters
    ----------
    covariance : (p, p) array
        Of the coordinates; infinite variance where nothing determines a parameter.
    undetermined : (p,) bool array
        Parameters that the data alone determine less than the doubt there was before, and do not contradict it.
    chi2 : float
        Sum of squared residuals over measurement variance [-].
    dof : int
        Data minus parameters.
    inflation : float
        Factor by which standard deviations were raised because the model does not fit the data [-].
    determinability : Determinability
        Singular values, combinations, and the best subset.
    strain : float
        By how much the parameters leave their tolerances, r.m.s., where chance does not explain it; else 1 [-].
    beliefs : (p, p) array
        Part of the covariance that rests on the tolerances.
    """

    covariance: FloatArray
    undetermined: BoolArray
    chi2: float
    dof: int
    inflation: float
    determinability: Determinability
    strain: float
    beliefs: FloatArray

    def strained(self) -> Statistics:
        """Return the same with what rests on the tolerances raised by how far the data contradict them."""
        return replace(self, covariance=self.covariance + (self.strain**2 - 1) * self.beliefs)


def assess(system: System, linear: Linear, theta: FloatArray) -> Statistics:
    """Work out covariance and determinability at the solution.

    With weights from the covariance of the measurement, the covariance is (S'WS + W_theta)^-1, raised by
    chi^2 / dof where the misfit is beyond what the measurement explains. With any other weights the scatter of
    the residuals stands in for the measurement's variance.
    """
    stated = _stated(system, linear, theta)
    undetermined = stated.undetermined
    both = zip(linear.evaluations, system.specimens, strict=True)
    residual = np.concatenate([1 - evaluation.frequency / s.measured.frequency for evaluation, s in both])
    variance = np.concatenate([s.relative_variance for s in system.specimens])
    behind = system.count_of_frequencies
    chi2 = float(np.sum((residual**2 / variance)[system.used]))
    chi2 += float(np.sum(linear.weight[behind:] * linear.residual[behind:] ** 2))
    dof = system.count - int(np.sum(system.prior == 0))
    inflation = 1.0
    if dof > 0 and chi2_distribution.sf(chi2, dof) < SIGNIFICANT:
        inflation = float(np.sqrt(chi2 / dof))
    if system.shapes:
        inflation = max(inflation, _of_frequencies(system, linear))
    data, beliefs = _covariance(system, linear, variance * inflation**2, inflation)
    covariance = data + beliefs
    hopeless = undetermined & (system.prior == 0)
    covariance[hopeless, :] = 0.0
    covariance[:, hopeless] = 0.0
    covariance[hopeless, hopeless] = np.inf
    couplings = tuple(replace(c, sigma=tuple(inflation * v for v in c.sigma)) for c in stated.couplings)
    stated = replace(stated, couplings=couplings)
    strain = _strain(system, theta)
    return Statistics(
        covariance=covariance,
        undetermined=undetermined,
        chi2=chi2,
        dof=dof,
        inflation=inflation,
        determinability=stated,
        strain=strain,
        beliefs=beliefs,
    )


def _of_frequencies(system: System, linear: Linear) -> float:
    """Return by how much frequencies alone are missed beyond chance, r.m.s.; else 1; many shapes outweigh it [-]."""
    behind = system.count_of_frequencies
    missed = system.frequency_misfit(linear.evaluations)
    free = float(np.sum((1 - leverage(system, linear)[:behind])[system.used]))
    if free <= 0 or chi2_distribution.sf(missed, free) > SIGNIFICANT:
        return 1.0
    return float(np.sqrt(missed / free))


def _strain(system: System, theta: FloatArray) -> float:
    """Return by how much the parameters leave their tolerances, r.m.s., where chance does not explain it; else 1."""
    held = system.prior > 0
    moved = float(np.sum(system.prior[held] * (theta - system.start)[held] ** 2))
    count = int(held.sum())
    if count == 0 or chi2_distribution.sf(moved, count) > SIGNIFICANT:
        return 1.0
    return float(np.sqrt(moved / count))


def _stated(system: System, linear: Linear, theta: FloatArray) -> Determinability:
    """Return what the data determine at the solution, and what explains the nominal model's residual."""
    evaluations = system.evaluations(system.start)
    start = system.linear(system.start, evaluations)
    both, behind = zip(evaluations, system.specimens, strict=True), system.count_of_frequencies
    residual = [(1 - k.frequency / s.measured.frequency) / np.sqrt(s.relative_variance) for k, s in both]
    return determinability(
        system.whitened(linear) * system.doubt,
        system.names,
        doubt=system.doubt,
        log=np.array([k.log for k in system.model_parameters]),
        moved=theta - system.start,
        at_start=system.whitened(start) * system.doubt,
        residual=np.concatenate(
            [np.concatenate(residual)[system.used], np.sqrt(start.weight[behind:]) * start.residual[behind:]]
        ),
        tolerated=system.prior > 0,
    )


def _covariance(
    system: System, linear: Linear, variance: FloatArray, inflation: float
) -> tuple[FloatArray, FloatArray]:
    """Return the covariance of Eq. 25's linear answer to errors of the data, and to errors of the tolerances."""
    per_log = np.concatenate(
        [system._per_log(s, k) for k, s in zip(linear.evaluations, system.specimens, strict=True)]
    )
    behind = inflation**2 / linear.weight[len(variance) :]
    noise = np.concatenate([variance * per_log**2, behind])
    doubt = system.doubt
    s = linear.sensitivity * doubt
    normal = (s.T * linear.weight) @ s + np.diag(system.prior * doubt**2)
    inverse = np.linalg.pinv(normal, rcond=NEGLIGIBLE, hermitian=True)
    gain = inverse @ (s.T * linear.weight)
    data = (gain * noise) @ gain.T
    prior = inverse @ np.diag(system.prior * doubt**2) @ inverse
    scale = np.outer(doubt, doubt)
    return np.asarray(data * scale), np.asarray(prior * scale)


def correlations(covariance: FloatArray) -> FloatArray:
    """Return the correlation matrix; nan where a variance is infinite or zero [-]."""
    sigma = np.sqrt(np.diag(covariance))
    good = np.isfinite(sigma) & (sigma > 0)
    safe = np.where(good, sigma, 1.0)
    matrix = covariance / np.outer(safe, safe)
    matrix[~good, :] = np.nan
    matrix[:, ~good] = np.nan
    np.fill_diagonal(matrix, 1.0)
    return np.asarray(matrix)
