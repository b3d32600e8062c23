"""What a region may have that the model has not: other stiffness, other mass, or damping beside the expected."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.localisation.base import Kind
from updating.localisation.force_residual import region_parts
from updating.models.state import NOMINAL, Loss, State
from updating.prediction.predict import Predictor
from updating.problem.specimen import SpecimenProblem

NODES: dict[Kind, FloatArray] = {
    "stiffness": np.array([-3.0, -1.7, -0.9, -0.4, -0.1, 0.1, 0.45, 1.1]),
    "mass": np.array([-1.1, -0.45, -0.1, 0.1, 0.4, 0.9, 1.7, 3.0]),
    "damping": np.log(np.array([1e-4, 1e-3, 5e-3, 2e-2, 0.1, 1.0])),
}
"""Severities at which the data are predicted: logarithms of the factor or of the loss factor [-].

A region keeps between 5 % and three times its stiffness, a third and twenty times its mass; a loss factor lies
between that of a metal and that of a damping layer.
"""


@dataclass(frozen=True, eq=False)
class Change:
    """A change of one region as a function of its severity.

    Parameters
    ----------
    region : int
        Index of the region.
    kind : {"stiffness", "mass", "damping"}
        What changes.
    state : callable
        State of the model at a severity.
    """

    region: int
    kind: Kind
    state: Callable[[float], State]


def changes(problem: SpecimenProblem, kind: Kind) -> tuple[Change, ...]:
    """Return the change of every region."""
    count = len(problem.predictor.spec.regions)
    if kind == "damping":
        stiff = region_parts(problem, "stiffness")
        return tuple(Change(i, kind, _lossy(problem.predictor, stiff[i])) for i in range(count))
    factor = "E" if kind == "stiffness" else "density"
    return tuple(Change(i, kind, _scaled(i, factor)) for i in range(count))


def _scaled(region: int, factor: str) -> Callable[[float], State]:
    return lambda severity: State(regional={(region, factor): float(np.exp(severity))})


def _lossy(predictor: Predictor, stiffness: FloatArray) -> Callable[[float], State]:
    """Return damping of a region, its matrix padded to the whole basis."""
    whole = np.zeros((predictor.reduced.basis.shape[1],) * 2)
    whole[: len(stiffness), : len(stiffness)] = stiffness
    return lambda severity: State(losses=(Loss(float(np.exp(severity)) * whole, -1.0),))


def columns(problem: SpecimenProblem, kind: Kind, *, step: float = 0.05, small: float = 1e-3) -> FloatArray:
    """Return the change of the data by each region's severity, at the nominal model, (n, n_regions) [-].

    Parameters
    ----------
    problem : SpecimenProblem
        A test beside a model.
    kind : {"stiffness", "mass", "damping"}
        What of a region changes.
    step, small : float
        Logarithm of the factor, and loss factor, at which sensitivities are taken [-].
    """
    plain = problem.compare(NOMINAL).residual
    found = []
    for change in changes(problem, kind):
        if kind == "damping":
            away = problem.compare(change.state(float(np.log(small)))).residual
            found.append((plain - away) / small)
            continue
        low, high = (problem.compare(change.state(s)).residual for s in (-step, step))
        found.append((low - high) / (2 * step))
    return np.stack(found, axis=1)
