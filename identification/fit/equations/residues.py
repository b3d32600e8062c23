"""Residues and residual terms for given poles: least squares in the frequency domain (LSFD)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, row_blocks
from acquisition.display import Displayed
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import basis, normal_equations


@dataclass(frozen=True, eq=False)
class Residues(Displayed):
    """What is linear in a modal model.

    Parameters
    ----------
    residues : (n_frf, n_modes) complex array
        Residues of the receptance [m/(N s)].
    terms : (n_frf, n_terms) array
        Coefficients of s^k in the receptance, by ``powers``.
    powers : tuple of int
        Powers of s of the residual terms; -2 is the lower residual, 0 the upper one.
    """

    residues: ComplexArray
    terms: FloatArray
    powers: tuple[int, ...]


def uniform_weights(frfs: FrfSet) -> normal_equations.Weights:
    """Return one weight per FRF: the reciprocal of its mean square [1 / unit of the FRFs squared]."""
    power = np.mean(np.abs(frfs.values) ** 2, axis=1)
    return normal_equations.Weights(
        1.0 / np.maximum(power, 1e-12 * power.max()), np.ones((1, len(frfs.frequency)))
    )


def fit_residues(
    frfs: FrfSet,
    poles: ComplexArray,
    *,
    powers: tuple[int, ...] = basis.BASIC_TERMS,
    weights: normal_equations.Weights | None = None,
) -> Residues:
    """Fit residues and residual terms to FRFs of any form.

    The model is the receptance sum_r R_r/(s - p_r) + conj(R_r)/(s - conj p_r) + L/s^2 + U, times s for
    mobility and s^2 for accelerance, at s = i omega + decay (Ewins, Modal Testing, 2nd ed., Sec. 4.5).

    Parameters
    ----------
    frfs : FrfSet
        The FRFs, without a line at s = 0.
    poles : (n_modes,) complex array
        Poles [rad/s].
    powers : tuple of int
        Powers of s of the residual terms of the receptance [-].
    weights : Weights, optional
        Weight of every value; default one per FRF [1 / unit of the FRFs squared].

    Returns
    -------
    Residues
        Residues and residual terms.
    """
    columns = basis.build(basis.Axis.of(frfs), poles, powers)
    data = normal_equations.prepared(frfs.values, weights or uniform_weights(frfs))
    products = normal_equations.form(columns.linear, data)
    solution = normal_equations.solve(products.gram, products.cross[:, :, None])[:, :, 0]
    return unpack(solution, len(poles), columns.term_scale, powers)


def unpack(solution: FloatArray, n_modes: int, term_scale: FloatArray, powers: tuple[int, ...]) -> Residues:
    """Sort the real unknowns of all FRFs, shape (n_frf, 2 n_modes + n_terms), into complex residues."""
    parts = solution[:, : 2 * n_modes].reshape(len(solution), n_modes, 2)
    return Residues(parts[:, :, 0] + 1j * parts[:, :, 1], solution[:, 2 * n_modes :] * term_scale, powers)


def synthesise(axis: basis.Axis, poles: ComplexArray, linear: Residues) -> ComplexArray:
    """Return the FRFs of a modal model, shape (n_frf, n_lines) [by ``form``]."""
    columns = basis.build(axis, poles, linear.powers)
    parts = np.stack([linear.residues.real, linear.residues.imag], axis=2).reshape(len(linear.residues), -1)
    solution = np.hstack([parts, linear.terms / columns.term_scale])
    values = np.empty((len(solution), len(axis.laplace)), np.complex128)
    real, imaginary = np.array(columns.linear.real.T), np.array(columns.linear.imag.T)
    for rows in row_blocks(values.shape):
        values.real[rows] = solution[rows] @ real
        values.imag[rows] = solution[rows] @ imaginary
    return values
