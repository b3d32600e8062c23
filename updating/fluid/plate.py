"""Added-mass matrices of plates and beams in one call."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import InputError

from .domain import FluidDomain
from .operator import AddedMassOperator


def quadrature_grid(
    length: float, width: float, n: int | tuple[int, int] = 24
) -> tuple[FloatArray, FloatArray]:
    """Gauss-Legendre points on the plate, the best places to sample shapes at.

    Parameters
    ----------
    length, width : float
        Sides of the plate. [m]
    n : int or tuple of two ints
        Number of points along x and y; three for each half-wave of the shapes and six more are ample.

    Returns
    -------
    tuple of FloatArray
        x in (0, length), shape (nx,), and y in (0, width), shape (ny,), ascending. [m]
    """
    nx, ny = (n, n) if isinstance(n, int) else n
    x, y = (np.polynomial.legendre.leggauss(number)[0] for number in (nx, ny))
    return 0.5 * length * (1.0 + x), 0.5 * width * (1.0 + y)


def added_mass(
    shapes: FloatArray,
    x: FloatArray,
    y: FloatArray,
    *,
    length: float,
    width: float,
    thickness: float = 0.0,
    domain: FluidDomain | None = None,
) -> FloatArray:
    """Added-mass matrix of a flat plate wetted on both sides, for a fluid of unit density.

    Parameters
    ----------
    shapes : FloatArray
        Normal deflections at the grid points, shape (n_modes, nx, ny).
    x, y : FloatArray
        Grid lines within [0, length] and [0, width], shapes (nx,) and (ny,); see ``quadrature_grid``. [m]
    length, width : float
        Sides of the wetted plate; what sits inside a clamp does not count. [m]
    thickness : float
        Thickness of the plate; zero is the thin plate. [m]
    domain : FluidDomain or None
        What bounds the fluid; unbounded when left out.

    Returns
    -------
    FloatArray
        Shape (n_modes, n_modes), symmetric and positive definite for independent shapes; times the fluid's
        density it adds to the modal mass matrix. [m^3 shape^2]

    Raises
    ------
    InputError
        If sizes, grid or walls do not fit together.
    """
    operator = AddedMassOperator.build(length=length, width=width, thickness=thickness, domain=domain)
    return operator.matrix(shapes, x, y)


def beam_operator(
    *, length: float, width: float, thickness: float = 0.0, domain: FluidDomain | None = None
) -> AddedMassOperator:
    """Operator of a beam whose section moves as a whole; its centre line is y = 0 of the domain's axes.

    Parameters
    ----------
    length, width : float
        Length of the beam and breadth of its section across the motion. [m]
    thickness : float
        Thickness of the section in the direction of motion. [m]
    domain : FluidDomain or None
        What bounds the fluid; unbounded when left out.
    """
    shifted = None if domain is None else domain.shifted(0.5 * width)
    return AddedMassOperator.build(length=length, width=width, thickness=thickness, domain=shifted)


def beam_matrix(operator: AddedMassOperator, shapes: FloatArray, x: FloatArray) -> FloatArray:
    """Added-mass matrix of beam shapes, (n_modes, nx), with an operator from ``beam_operator``."""
    if shapes.ndim != 2:
        raise InputError(f"added mass: beam shapes are {shapes.shape}; they must be (n_modes, nx)")
    across = np.array([0.0, operator.across.side])
    return operator.matrix(np.repeat(shapes[:, :, None], 2, axis=2), x, across)


def beam_added_mass(
    shapes: FloatArray,
    x: FloatArray,
    *,
    length: float,
    width: float,
    thickness: float = 0.0,
    domain: FluidDomain | None = None,
) -> FloatArray:
    """Added-mass matrix of a beam whose section moves as a whole, its finite length taken into account.

    Parameters
    ----------
    shapes : FloatArray
        Deflections at the stations, shape (n_modes, nx).
    x : FloatArray
        Stations within [0, length], ascending, shape (nx,). [m]
    length, width, thickness : float
        Length of the beam, breadth of its section across the motion and thickness along it. [m]
    domain : FluidDomain or None
        What bounds the fluid (the beam's centre line is y = 0); unbounded when left out.

    Returns
    -------
    FloatArray
        Shape (n_modes, n_modes), for a fluid of unit density. [m^3 shape^2]

    Raises
    ------
    InputError
        If sizes, stations or walls do not fit together.
    """
    operator = beam_operator(length=length, width=width, thickness=thickness, domain=domain)
    return beam_matrix(operator, shapes, x)
