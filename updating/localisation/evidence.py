"""Evidence of each region: the marginal likelihood of a change of it, its severity and all nuisances integrated.

The data are predicted by the model itself at a dozen severities, not by sensitivities, and interpolated between
them, as is their noise; the nuisances are integrated exactly at each. So it holds for a region that has lost nearly
everything.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.special import expit, logsumexp

from acquisition.arrays import FloatArray
from updating.likelihood.base import Doubt
from updating.likelihood.comparison import Comparison
from updating.likelihood.gaussian import marginal
from updating.localisation.base import KINDS, Kind, Localiser, areas
from updating.localisation.changes import NODES, changes
from updating.localisation.severity import DEPTH, Between, integrate, refine
from updating.models.state import NOMINAL, State
from updating.problem.specimen import SpecimenProblem

DOUBT = Doubt(fidelity=0.1)
"""A change is rarely even over just one region: how far that is off, relative to the shift it makes."""

AGAIN = (-1.5, 0.0, 1.5)
"""Where about the peak the data are predicted anew [standard deviations]."""


@dataclass(frozen=True, eq=False)
class RegionPosterior:
    """Evidence of the data for a change of one region.

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
        with np.errstate(divide="ignore"):  # a region without an area is none that may be changed
            score = self.log_evidence + np.log(self.prior)
        if not np.isfinite(score).any():
            return np.broadcast_to(self.prior / len(self.kinds), score.shape)
        return np.asarray(np.exp(score - logsumexp(score)))

    @property
    def regions(self) -> FloatArray:
        """Probability of each region, (n_regions,) [-]."""
        return np.asarray(self.probability.sum(axis=0))

    @property
    def beside_none(self) -> FloatArray:
        """Probability of each region where no change is as likely before as a change of one, (n_regions,) [-]."""
        with np.errstate(divide="ignore"):
            changed = float(logsumexp(self.log_evidence + np.log(self.prior / len(self.kinds))))
        return np.asarray(self.regions * expit(changed))

    @property
    def by_kind(self) -> dict[str, float]:
        """Probability that stiffness, mass or damping of a region is wrong [-]."""
        return dict(zip(self.kinds, self.probability.sum(axis=1).tolist(), strict=True))


def compare_regions(problem: SpecimenProblem, kinds: tuple[Kind, ...] = KINDS) -> RegionPosterior:
    """Evaluate a change of every region.

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
    reference = marginal(problem.compare(NOMINAL)).log_likelihood
    plain = problem.compare(NOMINAL, doubt=DOUBT)
    found = [[_compare(problem, plain, c.state, k) for c in changes(problem, k)] for k in kept]
    table = np.array(found).reshape(len(kept), -1, 2)
    return RegionPosterior(kept, table[..., 0] - reference, areas(problem), table[..., 1])


@dataclass(frozen=True)
class RegionEvidence(Localiser):
    """Probability of each region by the evidence of a change of it."""

    summary: ClassVar[str] = (
        "Marginal likelihood of a change of one region, severity and nuisances integrated."
    )
    needs: ClassVar[str] = "Needs frequencies, shapes to separate mirrored regions, and realistic tolerances."
    misleads: ClassVar[str] = (
        "Misleads where more than one region is wrong, or a support, a fluid or the measurement: that is "
        "attributed to the region with the most similar effect."
    )
    source: ClassVar[str] = "Beck and Katafygiotis (1998), J. Eng. Mech. 124, applied region by region"
    kinds: ClassVar[tuple[Kind, ...]] = KINDS
    needs_shapes: ClassVar[bool] = False

    def scores(self, problem: SpecimenProblem, *, kind: Kind = "stiffness") -> FloatArray:
        """Return the probability that each region is changed, where one or none is, each as likely before [-].

        What the probabilities lack to 1 is that of no change.
        """
        return compare_regions(problem, (kind,)).beside_none


def _compare(
    problem: SpecimenProblem,
    plain: Comparison,
    state: Callable[[float], State],
    kind: Kind,
    *,
    enough: int = 4,
) -> tuple[float, float]:
    """Return log evidence and mean severity of one region's change.

    A region whose data cannot be predicted at ``enough`` severities is left out.
    """
    evaluations = {float(s): problem.compare(state(float(s)), doubt=DOUBT) for s in NODES[kind]}
    if kind != "damping":
        evaluations[0.0] = plain
    evaluations = {s: evaluation for s, evaluation in evaluations.items() if _finite(evaluation)}
    if len(evaluations) < enough:
        return -np.inf, 0.0
    start = _start(kind)
    grid, likely = refine(Between(evaluations).log_likelihoods, start)
    mean, spread = _moments(*_posterior(grid, likely, kind))
    for severity in np.clip(mean + spread * np.array(AGAIN), start[0], start[-1]).tolist():
        exact = problem.compare(state(severity), doubt=DOUBT)
        if _finite(exact):
            evaluations[severity] = exact
    worth = (likely > likely.max() - 2 * DEPTH) | np.isin(grid, [start[0], 0.0, start[-1]])
    fine, score = _posterior(*refine(Between(evaluations).log_likelihoods, grid[worth]), kind)
    return float(logsumexp(score)), _moments(fine, score)[0]


def _start(kind: Kind, *, count: int = 42) -> FloatArray:
    """Return ``count`` severities at which the likelihood is taken at first, with 0 where the prior changes there."""
    low, high = NODES[kind][0], NODES[kind][-1]
    sides = [np.linspace(low, high, count)] if kind == "damping" else [
        np.linspace(a, b, count // 2) for a, b in ((low, 0.0), (0.0, high))
    ]  # fmt: skip
    return np.unique(np.concatenate(sides))


def _posterior(grid: FloatArray, likely: FloatArray, kind: Kind) -> tuple[FloatArray, FloatArray]:
    """Return severities and the logarithm of the probability, not normalised, that each stands for.

    The prior is even, but softer and stiffer, or lighter and heavier, are as probable.
    """
    low, high = grid[0], grid[-1]
    fine, score = integrate(grid, likely)
    if kind == "damping":
        return fine, score - np.log(high - low)
    return fine, score - np.log(2 * np.where(fine < 0, -low, high))


def _finite(evaluation: Comparison) -> bool:
    return all(
        np.isfinite(part).all() for part in (evaluation.residual, evaluation.nuisance, evaluation.variance)
    )


def _moments(grid: FloatArray, score: FloatArray) -> tuple[float, float]:
    """Return mean and standard deviation of the severity."""
    weight = np.exp(score - logsumexp(score))
    mean = float(weight @ grid)
    return mean, float(np.sqrt(weight @ (grid - mean) ** 2))
