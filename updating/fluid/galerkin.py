"""The Galerkin matrix of the flow around the plate, and the factor of its energy."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.linalg import LinAlgError, cholesky, inv, solve_triangular

from acquisition.arrays import FloatArray, IntArray, frozen_array
from acquisition.errors import InputError

from .axis import JumpAxis
from .domain import FluidDomain
from .spectra import spectra

BLOCK = 2_000_000
"""Pairs of wavenumbers worked on at a time."""

KEPT = 8
"""Factors kept, of some 2 MB each, for the next that asks with the same plate in the same domain: other theories and
studies of one specimen do. Twice as many hold twice the memory."""


REACH = 9.0
"""Wavenumber times distance beyond which a flow is not affected by a surface or a bottom: tanh is one to 3e-8 [-]."""


@lru_cache(maxsize=KEPT)
def energy_factor(along: JumpAxis, across: JumpAxis, domain: FluidDomain, thickness: float) -> FloatArray:
    """Assemble A from the spectra of both axes and factorise its inverse less the plate's own volume.

    Parameters
    ----------
    along, across : JumpAxis
        Functions along x and y.
    domain : FluidDomain
        What bounds the fluid above and below.
    thickness : float
        Thickness t of the plate. [m]

    Returns
    -------
    FloatArray
        Lower triangle F with F F^T = A^-1 - t G^-1, shape (n, n), not to be written to.

    Notes
    -----
    The Gram matrices are summed over the same wavenumbers as A: the stiffness is below 1/t at each of them,
    so the difference stays positive definite whatever the quadrature leaves out.
    """
    try:
        matrix = inv(_flow(along, across, domain, thickness), assume_a="pos")
        if thickness > 0.0:
            matrix = matrix - _volume(along, across, thickness)
        return frozen_array(cholesky(0.5 * (matrix + matrix.T), lower=True))
    except LinAlgError as error:
        raise _alike(along, across) from error


def energy_matrix(
    along: JumpAxis, across: JumpAxis, domain: FluidDomain, thickness: float, loads: FloatArray
) -> FloatArray:
    """Return the energy of the flows under some loads, at a third of the cost of the factor and without keeping it.

    Parameters
    ----------
    along, across, domain, thickness
        As for :func:`energy_factor`.
    loads : FloatArray
        Integrals of the functions times shapes, shape (r, n). [m^2]

    Returns
    -------
    FloatArray
        Added mass for unit density, shape (r, r). [m^3 shape^2]
    """
    try:
        factor = cholesky(_flow(along, across, domain, thickness), lower=True)
    except LinAlgError as error:
        raise _alike(along, across) from error
    white = solve_triangular(factor, loads.T, lower=True)
    energy = white.T @ white
    return np.asarray(
        energy - loads @ _volume(along, across, thickness) @ loads.T if thickness > 0.0 else energy
    )


def _alike(along: JumpAxis, across: JumpAxis) -> InputError:
    return InputError(
        f"added mass: {along.terms} x {across.terms} functions cannot be separated in this domain; ask for "
        "fewer terms"
    )


def _flow(along: JumpAxis, across: JumpAxis, domain: FluidDomain, thickness: float) -> FloatArray:
    """Return A, (n, n)."""
    half = _unbounded(along, across, thickness)
    if domain.nearest is not None:
        half = half + _assembled(along, across, domain, thickness)
    return _unfold(half, np.tril_indices(along.terms), np.tril_indices(across.terms))


@lru_cache(maxsize=KEPT)
def _unbounded(along: JumpAxis, across: JumpAxis, thickness: float) -> FloatArray:
    """Return A in a fluid without surface and bottom, as :func:`_assembled`."""
    return frozen_array(_assembled(along, across, FluidDomain(), thickness))


def _assembled(along: JumpAxis, across: JumpAxis, domain: FluidDomain, thickness: float) -> FloatArray:
    """Return A at the lower triangles of pairs along x and across y, (n_pairs along, n_pairs across).

    Of a fluid with a surface or a bottom, what these change: short waves do not reach there.
    """
    (k, left), (across_k, right) = spectra(along), spectra(across)
    left, right = left[:, *np.tril_indices(along.terms)], right[:, *np.tril_indices(across.terms)]
    if domain.nearest is not None:
        near, near_across = (line < REACH / domain.nearest for line in (k, across_k))
        k, left, across_k, right = k[near], left[near], across_k[near_across], right[near_across]
    half = np.zeros((left.shape[1], right.shape[1]))
    step = max(1, BLOCK // max(across_k.size, 1))
    for start in range(0, k.size, step):
        block = slice(start, start + step)
        waves = np.hypot(k[block, None], across_k)
        stiffness = domain.stiffness(waves, thickness)
        if domain.nearest is not None:
            stiffness = stiffness - FluidDomain().stiffness(waves, thickness)
        half += left[block].T @ (stiffness @ right)
    return half


@lru_cache(maxsize=KEPT)
def _volume(along: JumpAxis, across: JumpAxis, thickness: float) -> FloatArray:
    """Return t G^-1, the plate's own volume, (n, n)."""
    left, right = (spectra(axis)[1].sum(axis=0) for axis in (along, across))
    return frozen_array(thickness * np.kron(inv(left), inv(right)))


def _unfold(half: FloatArray, p: tuple[IntArray, IntArray], q: tuple[IntArray, IntArray]) -> FloatArray:
    """Matrix A, (n, n), from its values at the lower triangles of pairs along x and across y."""
    along, across = int(p[0][-1]) + 1, int(q[0][-1]) + 1
    matrix = np.empty((along, along, across, across))
    for first, second in (p, p[::-1]):
        for third, fourth in (q, q[::-1]):
            matrix[first[:, None], second[:, None], third, fourth] = half
    return matrix.transpose(0, 2, 1, 3).reshape(along * across, along * across)
