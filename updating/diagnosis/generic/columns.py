"""What a cause in no library may change: stiffness and mass of each region, the damping of each mode, each channel.

What regions change is taken by differences of the comparison itself, so that every model and every kind of data gives
it alike, a baseline included: the field is what came after it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.distance import cdist

from acquisition.arrays import FloatArray
from updating.diagnosis.search.evidence import Explanation
from updating.likelihood.comparison import Comparison
from updating.likelihood.constants import Constants
from updating.likelihood.outliers import with_outliers
from updating.models.spec import Spec
from updating.models.state import State
from updating.problem.specimen import SpecimenProblem

PROPERTIES = ("E", "density")
"""Factors of the regions that a field changes: stiffness and mass."""


@dataclass(frozen=True, eq=False)
class Columns:
    """Data beside a state, and what a field about it may change.

    Parameters
    ----------
    comparison : Comparison
        The residual, carried back to no field, and its nuisances.
    regions : mapping of str to (n, r) array
        Change of the prediction by the logarithm of each of ``PROPERTIES`` in each region [-].
    loss : (n, m) array
        By ln zeta of each mode whose damping is measured [-].
    gain : (n, c) array
        By the logarithm of the gain of each measuring channel [-].
    """

    comparison: Comparison
    regions: Mapping[str, FloatArray]
    loss: FloatArray
    gain: FloatArray


def columns(
    problem: SpecimenProblem, explanation: Explanation, field: FloatArray, *, step: float = 0.02
) -> Columns:
    """Return the data beside an explanation at its best, and what a field about one that is there may change.

    Parameters
    ----------
    problem : SpecimenProblem
        Test and model.
    explanation : Explanation
        The set of effects.
    field : (2, r) array
        Logarithms of the factors of ``PROPERTIES`` in each region, and in what is in none, the last [-].
    step : float
        Step of the differences [-]: between round-off and curvature of ln f.
    """
    here = compared(problem, explanation, field)
    slopes = np.zeros((*field.shape, len(here.residual)))
    for k, region in np.ndindex(*field.shape):
        moved = field.copy()
        moved[k, region] += step
        slopes[k, region] = (here.residual - compared(problem, explanation, moved).residual) / step
    slopes[~np.isfinite(slopes)] = 0.0  # no prediction there
    carried = replace(here, residual=here.residual + np.einsum("kr,krn->n", field, slopes))
    regions = {name: slopes[k].T for k, name in enumerate(PROPERTIES)}
    return Columns(carried, regions, np.eye(len(here.residual))[:, here.of("damping")], _gain(problem, here))


def compared(problem: SpecimenProblem, explanation: Explanation, field: FloatArray) -> Comparison:
    """Compare the data with an explanation at its best and a field (2, r) on it, see :func:`columns`."""
    candidate, best = explanation.candidate, explanation.best
    (parts,) = problem.parts(candidate, best.coordinates)
    state = candidate.assemble(candidate.stage(problem.predictor), parts)
    changed = State(
        regional={
            (region, name): float(np.exp(values[region]))
            for name, values in zip(PROPERTIES, field, strict=True)
            for region in np.flatnonzero(values).tolist()
        }
    )
    doubt = candidate.doubt_on(problem.predictor, parts)
    found = problem.compare(state.plus(changed), best.about, doubt=doubt)
    if len(best.coordinates):  # its parameters become nuisances, which join the channels
        found = found.channels_settled(best.marginal.judged)
    return with_outliers(found, candidate.outliers)


def _gain(problem: SpecimenProblem, here: Comparison, *, fewest: int = 3) -> FloatArray:
    """Return the change of the data by the logarithm of each channel's gain, (n, c).

    None of fewer channels than ``fewest``: theirs is the level of the test or of a mode.
    """
    rows, constants = (
        np.flatnonzero(here.of("frf")),
        [q for q in problem.quantities if isinstance(q, Constants)],
    )
    source = here.source[rows]
    channels = np.unique(source[source >= 0])
    if not constants or len(channels) < fewest:
        return np.zeros((len(here.residual), 0))
    predicted = (problem.measured.constants / constants[0].scale).ravel() - here.residual[rows]
    found = np.zeros((len(here.residual), len(channels)))
    found[rows] = np.where(source[:, None] == channels, predicted[:, None], 0.0)
    return found


def correlations(spec: Spec, lengths: Sequence[float], *, rounding: float = 1e-6) -> list[FloatArray]:
    """Return lower factors (r, r) of the correlation among regions, one for each length [share of the span].

    Two regions have that of a squared exponential of their distance (Rasmussen and Williams 2006, Gaussian Processes
    for Machine Learning, Eq. 4.9). Regions of imported matrices have no place and are independent, and so is what is in
    no region, the last. ``rounding`` keeps those of close regions positive definite [-].
    """
    count = len(spec.regions)
    if not spec.outlined:
        return [np.eye(count + 1)]
    middles = np.array([[np.mean(region.x), np.mean(region.y or (0.0, 0.0))] for region in spec.regions])
    far = cdist(middles, middles) / spec.length
    found = np.tile(np.eye(count + 1), (len(lengths), 1, 1))
    for lower, one in zip(found, lengths, strict=True):
        lower[:-1, :-1] = np.linalg.cholesky(np.exp(-0.5 * (far / one) ** 2) + rounding * np.eye(count))
    return list(found)
