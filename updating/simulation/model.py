"""A model in one state as numbers: its matrices between its undamped modes, and the points it is observed from."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy import linalg

from acquisition.arrays import FloatArray
from acquisition.display import Displayed
from acquisition.errors import StudyError
from updating.case import Case
from updating.models.base import added
from updating.models.damping import Matrices
from updating.models.state import State
from updating.nominal import predictor_of
from updating.prediction.predict import Predictor

Departure = State | Callable[[Predictor], State]
"""What differs from the nominal model: a state, or how to make one on a predictor's basis."""

HUNG_AT = 0.05
"""Frequency of a body that hangs on cords, relative to its first elastic mode [-]."""

CORD_DAMPING = 0.05
"""Damping ratio of cords [-]."""

APART = 0.1
"""Relative distance of the frequencies of the rigid-body modes on cords, which never are the same [-]."""


@dataclass(frozen=True, eq=False)
class Simulated(Displayed):
    """A model that can be excited and observed.

    Parameters
    ----------
    matrices : Matrices
        K, M, C and D, where :func:`simulated` makes it between all undamped modes of the reduced basis: M is one, K
        diagonal and exactly zero for rigid-body modes.
    rows : (n_points, r) array
        Displacement of the basis at the points, each along its direction [kg^-1/2].
    slopes : (dim, n_points, r) array
        Its derivatives along the in-plane axes [kg^-1/2/m].
    rigid : int
        Number of rigid-body modes.
    gain : float
        Factor of the measured level over the true one [-].
    decay : float
        Decay rate of an exponential window that is not stated [1/s].
    """

    matrices: Matrices
    rows: FloatArray
    slopes: FloatArray
    rigid: int = 0
    gain: float = 1.0
    decay: float = 0.0

    def hung(self, frequency: float | None = None, *, damping: float = CORD_DAMPING) -> Simulated:
        """Return the same body on soft cords; itself if it is clamped.

        The cords act on the rigid-body modes alone, so that the elastic ones stay what they were.

        Parameters
        ----------
        frequency : float, optional
            That of the lowest rigid-body mode, the others 10 % apart; left out, a twentieth of the first elastic
            mode [Hz].
        damping : float
            Damping ratio of these modes [-].
        """
        if not self.rigid:
            return self
        values, vectors = linalg.eigh(self.matrices.stiffness, self.matrices.mass)
        lowest = HUNG_AT * np.sqrt(values[self.rigid]) if frequency is None else 2 * np.pi * frequency
        omega = lowest * (1 + APART * np.arange(self.rigid))
        momenta = self.matrices.mass @ vectors[:, : self.rigid]
        held = replace(
            self.matrices,
            stiffness=self.matrices.stiffness + (momenta * omega**2) @ momenta.T,
            viscous=self.matrices.viscous + (momenta * (2 * damping * omega)) @ momenta.T,
        )
        return replace(self, matrices=held, rigid=0)


def simulated(
    source: Predictor | Case,
    *departures: Departure,
    points: FloatArray | None = None,
    directions: FloatArray | None = None,
) -> Simulated:
    """Return a model in a state, seen from the points of its test or from any others.

    Parameters
    ----------
    source : Predictor or Case
        The nominal model; accepted effects of a case are in it.
    *departures : State or callable
        What differs. A state that adds matrices belongs to the basis of its predictor: with other points or another
        theory give a function of the predictor, such as an effect's.
    points : (n_points, dim) array, optional
        Where to look from, in model axes; left out, the points of the test [m].
    directions : (n_points, 3) array, optional
        Which way each of these points moves, in model axes; left out, along z [-].

    Raises
    ------
    StudyError
        If a state's matrices belong to another basis.
    """
    predictor = predictor_of(source) if isinstance(source, Case) else source
    if points is not None:
        predictor = _from_points(predictor, np.asarray(points, dtype=float), directions)
    whole = predictor.for_test(predictor.measured, (*predictor.additions, *map(_function, departures)))
    theory = whole.base.theory
    if theory is not None and theory != whole.spec.theory:
        whole = whole.of(whole.spec.with_theory(theory))
    _check(whole)
    seen = slice(None) if points is None else slice(-len(points), None)
    matrices, rigid = whole.matrices(), whole.reduced.structure.rigid_modes
    values, vectors = linalg.eigh(matrices.stiffness, matrices.mass)
    values[:rigid] = 0.0  # what rounding makes of a rigid body's stiffness would move it at low frequency
    between = Matrices(
        np.diag(values),
        np.eye(len(values)),
        vectors.T @ matrices.viscous @ vectors,
        vectors.T @ matrices.structural @ vectors,
    )
    rows, slopes = whole.point_rows()[seen] @ vectors, whole.point_slopes()[:, seen] @ vectors
    return Simulated(between, rows, slopes, rigid, whole.base.gain, whole.base.decay)


def _function(departure: Departure) -> Callable[[Predictor], State]:
    return (lambda _: departure) if isinstance(departure, State) else departure


def _from_points(predictor: Predictor, points: FloatArray, directions: FloatArray | None) -> Predictor:
    """Return the predictor on a basis that holds the static answers to forces at further points as well."""
    test = predictor.measured
    if points.ndim != 2 or points.shape[1] != test.points.shape[1]:
        raise StudyError(
            f"points of shape {points.shape} to look from; this model takes (n, {test.points.shape[1]})"
        )
    nodes = tuple(max(test.nodes, default=0) + 1 + i for i in range(len(points)))
    ways = None
    if directions is not None or test.directions is not None:
        ways = np.vstack([_ways(test.directions, len(test.points)), _ways(directions, len(points))])
    more = replace(
        test, points=np.vstack([test.points, points]), nodes=(*test.nodes, *nodes), directions=ways
    )
    return replace(predictor, measured=more, basis=None)


def _ways(directions: FloatArray | None, count: int) -> FloatArray:
    return np.tile([0.0, 0.0, 1.0], (count, 1)) if directions is None else np.asarray(directions, dtype=float)


def _check(predictor: Predictor) -> None:
    size = predictor.reduced.basis.shape[1]
    state = predictor.base
    more = added(predictor.reduced.structure, state)
    matrices = (*more["stiffness"], *more["mass"], *state.damping)
    wrong = [matrix.shape for matrix in matrices if matrix.shape != (size, size)]
    wrong += [one.row.shape for one in state.absorbers if one.row.shape != (size,)]
    if wrong:
        raise StudyError(
            f"a state adds a matrix of shape {wrong[0]} to a model whose basis has {size} columns: it was made for "
            "other points or another theory; give a function of the predictor instead"
        )
