"""Measured mode shapes point by point, and their expansion to the whole model.

Modal constants are products of two components, phi_response * phi_force. Where only one point changes from FRF to
FRF they are the shape itself up to a factor; in general the shape is what explains all products at once.
Expansion: O'Callahan, Avitabile and Riemer (1989), SEREP; Balmes (2000), minimum dynamic residual expansion.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import linalg

from acquisition.arrays import FloatArray, IntArray
from identification.pairing import counterparts
from updating.models.absorbers import structural
from updating.models.state import NOMINAL
from updating.problem.specimen import SpecimenProblem


@dataclass(frozen=True, eq=False, kw_only=True)
class Shapes:
    """Measured shapes beside the model on its reduced basis.

    Parameters
    ----------
    points : (n,) int array
        Test points at which the shapes are known.
    measured, predicted : (n, n_modes) arrays
        Components, the measured ones scaled to the predicted [kg^-1/2].
    rows : (n, r) array
        Displacement of the basis at these points, absorbers behind it [kg^-1/2].
    modes : (r, n_modes) array
        The model's modes, mass-normalised [kg^-1/2].
    omega : (n_modes,) array
        Measured angular frequencies [rad/s].
    stiffness, mass : (r, r) arrays
        The model's matrices [SI].
    """

    points: IntArray
    measured: FloatArray
    predicted: FloatArray
    rows: FloatArray
    modes: FloatArray
    omega: FloatArray
    stiffness: FloatArray
    mass: FloatArray


def shapes_of(problem: SpecimenProblem) -> Shapes:
    """Return the measured shapes point by point, and the model's prediction of them."""
    predictor, test = problem.predictor, problem.measured
    stiffness, mass = predictor.reduced.matrices(predictor.base)
    rows = predictor.point_rows(NOMINAL)
    modes = _modes(problem)
    model = rows @ modes
    known = np.unique(np.r_[test.seen, test.hit[test.hit >= 0]])
    return Shapes(
        points=known,
        measured=_components(problem, model)[known],
        predicted=model[known],
        rows=rows[known],
        modes=modes,
        omega=2 * np.pi * test.frequency,
        stiffness=stiffness,
        mass=mass,
    )


def _modes(problem: SpecimenProblem) -> FloatArray:
    """Return the undamped modes that the measured ones are, with what hangs on the structure, (r, n_modes)."""
    predictor, known = problem.predictor, problem.nominal.vectors
    if not predictor.base.absorbers:
        return known
    _, vectors = predictor.reduced.eigen(predictor.base)
    elastic = vectors[:, predictor.reduced.structure.rigid_modes :]
    alike = known.T @ structural(elastic, predictor.base.absorbers)
    columns = counterparts(-(alike**2))
    return np.asarray(elastic[:, columns] * np.sign(alike[np.arange(len(columns)), columns]))


def _components(
    problem: SpecimenProblem, model: FloatArray, *, rounds: int = 6, weight: float = 1e-6
) -> FloatArray:
    """Fit the components of a shape at all points to the products of two of them, (n_points, n_modes).

    The two factors are fitted in turn; ``weight`` is that of the model's shape, for where no product holds a component.
    """
    test = problem.measured
    share = np.sum(test.constants * problem.nominal.constants, axis=0)
    share = share / np.maximum(np.sum(problem.nominal.constants**2, axis=0), 1e-300)
    constants = test.constants / np.where(np.abs(share) > 0, share, 1.0)
    bare = test.hit[:, None] < 0
    anchor = weight * np.mean(model**2, axis=0)
    found = model
    for _ in range(rounds):
        upper, lower = anchor * model, np.broadcast_to(anchor, model.shape).copy()
        right = np.where(bare, 1.0, found[test.hit])
        np.add.at(upper, test.seen, constants * right)
        np.add.at(lower, test.seen, right**2)
        left = np.where(bare, 0.0, found[test.seen])
        np.add.at(upper, np.maximum(test.hit, 0), np.where(bare, 0.0, constants) * left)
        np.add.at(lower, np.maximum(test.hit, 0), left**2)
        found = (found + upper / np.maximum(lower, 1e-300)) / 2
    return np.asarray(found)


def serep(shapes: Shapes) -> FloatArray:
    """Expand the shapes by the model's own lowest modes, no more of them than there are points.

    Returns
    -------
    (r, n_modes) array
        Shapes in the coordinates of the reduced basis [kg^-1/2].
    """
    count = max(1, min(len(shapes.points), len(shapes.omega)))
    basis = shapes.modes[:, :count]
    return np.asarray(basis @ np.linalg.lstsq(shapes.rows @ basis, shapes.measured, rcond=1e-8)[0])


def dynamic(shapes: Shapes, *, trust: float = 1e4) -> FloatArray:
    """Expand the shapes so that they leave the least dynamic residual, weighted by the flexibility.

    Parameters
    ----------
    shapes : Shapes
        Measured and predicted shapes.
    trust : float
        Weight of the measured components, relative to the residual [-].

    Returns
    -------
    (r, n_modes) array
        Shapes in the coordinates of the reduced basis [kg^-1/2].
    """
    held = shapes.stiffness + 1e-6 * float(shapes.omega.min() ** 2) * shapes.mass
    flexibility = linalg.cho_factor(held)
    found = np.zeros((len(shapes.stiffness), len(shapes.omega)))
    for r, omega in enumerate(shapes.omega):
        force = shapes.stiffness - omega**2 * shapes.mass
        weight = (
            trust * omega**2 / max(float(np.mean(shapes.measured[:, r] ** 2)), 1e-300) / len(shapes.points)
        )
        normal = force @ linalg.cho_solve(flexibility, force) + weight * shapes.rows.T @ shapes.rows
        found[:, r] = linalg.solve(normal, weight * shapes.rows.T @ shapes.measured[:, r], assume_a="sym")
    return found
