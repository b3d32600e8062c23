"""Evidence of each region: the marginal likelihood of a change of it, its severity and all nuisances integrated.

The data are predicted by the model itself at a dozen severities, not by sensitivities, and interpolated between
them; the nuisances are integrated exactly at each. So it holds for a region that has lost nearly everything.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import cho_factor, solve_triangular
from scipy.special import logsumexp

from acquisition.arrays import FloatArray, IntArray
from updating.diagnosis.candidate import Doubt
from updating.diagnosis.comparison import SCALES, SHAPES, Comparison
from updating.diagnosis.gaussian import marginal
from updating.diagnosis.problem import Problem
from updating.localisation.base import KINDS, Kind, Localiser, areas
from updating.localisation.changes import NODES, changes
from updating.models.state import NOMINAL, State

DOUBT = Doubt(fidelity=0.1)
"""A change is rarely even over just one region: how far that is off, relative to the shift it makes."""

FINE = 801
"""Severities at which the likelihood is taken between the nodes, and again about the peak."""

AGAIN = (-1.5, 0.0, 1.5)
"""Where about the peak the data are predicted anew [standard deviations]."""

WIDE = 6.0
"""How far about the peak these go [standard deviations]."""

ENOUGH = 4
"""A region whose data cannot be predicted at so many severities is left out."""


@dataclass(frozen=True, eq=False)
class RegionPosterior:
    """What the data say of a change of one region.

    Parameters
    ----------
    kinds : tuple of str
        What of the regions may be wrong.
    log_evidence : (n_kinds, n_regions) array
        Logarithm of the marginal likelihood over that of the model with its tolerances alone [-].
    prior : (n_regions,) array
        Prior of each region: its share of the area [-].
    severity : (n_kinds, n_regions) array
        Posterior mean of the logarithm of the factor, or of the loss factor [-].
    """

    kinds: tuple[Kind, ...]
    log_evidence: FloatArray
    prior: FloatArray
    severity: FloatArray

    @property
    def probability(self) -> FloatArray:
        """Probability of each kind and region, given that one region is changed, (n_kinds, n_regions) [-]."""
        score = self.log_evidence + np.log(self.prior)
        if not np.isfinite(score).any():
            return np.broadcast_to(self.prior / len(self.kinds), score.shape)
        return np.asarray(np.exp(score - logsumexp(score)))

    @property
    def regions(self) -> FloatArray:
        """Probability of each region, (n_regions,) [-]."""
        return np.asarray(self.probability.sum(axis=0))

    @property
    def by_kind(self) -> dict[str, float]:
        """Probability that stiffness, mass or damping of a region is wrong [-]."""
        return dict(zip(self.kinds, self.probability.sum(axis=1).tolist(), strict=True))


def weigh_regions(problem: Problem, kinds: tuple[Kind, ...] = KINDS) -> RegionPosterior:
    """Weigh a change of every region.

    Parameters
    ----------
    problem : Problem
        A test beside a model.
    kinds : tuple of str
        What may be wrong; damping is left out where none is measured or expected.

    Returns
    -------
    RegionPosterior
    """
    kept = tuple(k for k in kinds if k != "damping" or len(problem.damping_known))
    plain = problem.compare(NOMINAL)
    reference = marginal(plain).log_likelihood
    found = [[_weigh(problem, plain, c.state, k) for c in changes(problem, k)] for k in kept]
    table = np.array(found).reshape(len(kept), -1, 2)
    return RegionPosterior(kept, table[..., 0] - reference, areas(problem), table[..., 1])


@dataclass(frozen=True)
class RegionEvidence(Localiser):
    """Probability of each region by the evidence of a change of it."""

    name: ClassVar[str] = "evidence"
    summary: ClassVar[str] = (
        "Marginal likelihood of a change of one region, severity and nuisances integrated."
    )
    source: ClassVar[str] = "Beck and Katafygiotis (1998), J. Eng. Mech. 124, applied region by region"
    kinds: ClassVar[tuple[Kind, ...]] = KINDS
    needs_shapes: ClassVar[bool] = False

    def scores(self, problem: Problem, *, kind: Kind = "stiffness") -> FloatArray:
        """Return the probability of each region, given that one region is changed [-]."""
        return weigh_regions(problem, (kind,)).regions


def _weigh(
    problem: Problem, plain: Comparison, state: Callable[[float], State], kind: Kind
) -> tuple[float, float]:
    """Return log evidence and mean severity of one region's change."""
    looks = {float(s): problem.compare(state(float(s)), doubt=DOUBT) for s in NODES[kind]}
    if kind != "damping":
        looks[0.0] = plain
    looks = {s: look for s, look in looks.items() if np.isfinite(look.residual).all()}
    if len(looks) < ENOUGH:
        return -np.inf, 0.0
    fine = np.linspace(NODES[kind][0], NODES[kind][-1], FINE)
    fine, score = _posterior(looks, fine, kind)
    peak, spread = _moments(fine, score)
    for severity in np.clip(peak + spread * np.array(AGAIN), fine[0], fine[-1]).tolist():
        exact = problem.compare(state(severity), doubt=DOUBT)
        if np.isfinite(exact.residual).all():
            looks[severity] = exact
    near = peak + max(spread, 1e-4) * np.linspace(-WIDE, WIDE, FINE)
    fine = np.union1d(fine, near[(near > fine[0]) & (near < fine[-1])])
    fine, score = _posterior(looks, fine, kind)
    return float(logsumexp(score)), _moments(fine, score)[0]


def _posterior(looks: dict[float, Comparison], fine: FloatArray, kind: Kind) -> tuple[FloatArray, FloatArray]:
    """Return severities, and the logarithm of likelihood times prior mass at each, (n_fine,) each."""
    nodes = np.array(sorted(looks))
    ordered = [looks[s] for s in nodes.tolist()]
    residual = CubicSpline(nodes, np.stack([look.residual for look in ordered]))(fine)
    score = _likelihoods(residual, ordered, np.abs(fine[:, None] - nodes).argmin(axis=1))
    return fine, score + np.log(_prior(fine, kind))


def _moments(fine: FloatArray, score: FloatArray) -> tuple[float, float]:
    """Return mean and standard deviation of the severity."""
    weight = np.exp(score - logsumexp(score))
    mean = float(weight @ fine)
    return mean, float(np.sqrt(weight @ (fine - mean) ** 2))


def _prior(fine: FloatArray, kind: Kind) -> FloatArray:
    """Return the prior of the severities: even, but softer and stiffer, or lighter and heavier, are as probable."""
    weight = np.gradient(fine)
    if kind != "damping":
        for side in (fine < 0, fine > 0):
            weight[side] /= weight[side].sum()
    return np.asarray(weight / weight.sum())


def _likelihoods(residual: FloatArray, looks: list[Comparison], node_of: IntArray) -> FloatArray:
    """Return log-likelihoods of residuals (n_fine, n), each with the nuisances and noise of the node named."""
    found = np.full(len(residual), -np.inf)
    for node in np.unique(node_of):
        rows, look = node_of == node, looks[int(node)]
        count = len(SCALES) if (look.channel == SHAPES).any() else 1
        prior: tuple[float, ...] = look.scale_prior if count > 1 else (1.0,)
        parts = [
            _gaussian(residual[rows], look, s) + np.log(p) for s, p in zip(SCALES[:count], prior, strict=True)
        ]
        found[rows] = logsumexp(np.stack(parts), axis=0)
    return found


def _gaussian(residual: FloatArray, look: Comparison, scale: float) -> FloatArray:
    """Return the logarithm of the Gaussian density of residuals (m, n), the nuisances integrated out, (m,)."""
    deviation = np.sqrt(look.noise(scale))
    spread = look.nuisance / deviation[:, None]
    lower = cho_factor(np.eye(spread.shape[1]) + spread.T @ spread, lower=True)[0]
    white = residual / deviation
    load = solve_triangular(lower, spread.T @ white.T, lower=True)
    chi2 = np.sum(white**2, axis=1) - np.sum(load**2, axis=0)
    log_det = 2 * np.sum(np.log(deviation)) + 2 * np.sum(np.log(np.diag(lower)))
    return np.asarray(-0.5 * (chi2 + log_det + residual.shape[1] * np.log(2 * np.pi)))


__all__ = ["RegionEvidence", "RegionPosterior", "weigh_regions"]
