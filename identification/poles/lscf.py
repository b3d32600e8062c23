"""Poly-reference least-squares complex frequency-domain estimator (p-LSCF) on any band."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import fft

from acquisition.arrays import ComplexArray
from acquisition.errors import EstimationError
from acquisition.frfs.frf import FrfSet
from identification.arrangement import matrix_form
from identification.poles import nested
from identification.poles.base import Baseband, PoleSets, row_scale

_GAP = 0.08  # part of the circle left free: poles just outside the band land there


def lscf(frfs: FrfSet, *, orders: Sequence[int]) -> PoleSets:
    """Find poles by the right matrix-fraction model with complex coefficients.

    The band is mapped on the unit circle, so that no band is better conditioned than another; the
    numerators are eliminated and the products are made by FFT (Guillaume, Verboven,
    Vanlanduit, Van der Auweraer and Peeters, "A poly-reference implementation of the least-squares complex
    frequency-domain estimator", IMAC XXI, 2003, Eqs. 12-22).

    Parameters
    ----------
    frfs : FrfSet
        The FRFs, already cut to the band.
    orders : sequence of int
        Degrees of the denominator [-].

    Returns
    -------
    PoleSets
        Stable poles of every order, with the participation of each reference.

    Raises
    ------
    EstimationError
        If the band holds too few lines for the highest order.
    """
    data = matrix_form(frfs, row_scale(frfs))
    if data.shape[2] < 2 * max(orders):
        raise EstimationError(
            f"{frfs.source}: {data.shape[2]} lines cannot carry LSCF of order {max(orders)}; lower the order or "
            "widen the band"
        )
    circle = int(fft.next_fast_len(max(round(data.shape[2] * (1 + _GAP)), 2 * max(orders) + 2)))
    normal = _reduced_normal(data, max(orders), circle)
    baseband = Baseband.of(frfs, circle)
    found = [nested.roots(block) for block in nested.denominators(normal, orders, data.shape[1])]
    return PoleSets(tuple(orders), tuple(baseband.poles(z) for z, _ in found), tuple(p for _, p in found))


def _moments(signal: ComplexArray, order: int, circle: int) -> ComplexArray:
    """Return sum_k signal_k z_k^m for m = 0 ... order along the last axis."""
    n_lines = signal.shape[-1]
    spectrum = fft.ifft(signal, circle, axis=-1)[..., : order + 1]
    centre = np.exp(-1j * np.pi * (n_lines - 1) / circle * np.arange(order + 1))
    return np.asarray(spectrum * (circle * centre))


def _numerators(z: ComplexArray, order: int) -> ComplexArray:
    """Return polynomials of degree 0 ... order, orthonormal over the lines z, shape (order + 1, n_lines).

    Szego's recurrence: z times the last one, made orthogonal to its reversal (Simon, Orthogonal Polynomials on
    the Unit Circle, 2005, Sec. 1.5).
    """
    rows = np.empty((order + 1, len(z)), complex)
    rows[0] = reversal = np.full(len(z), len(z) ** -0.5, complex)
    power = np.ones_like(z)
    for degree in range(order):
        step = z * rows[degree]
        step -= np.vdot(reversal, step) * reversal
        rows[degree + 1] = step / np.linalg.norm(step)
        power *= z
        reversal = power * rows[degree + 1].conj()
    return rows


def _reduced_normal(data: ComplexArray, order: int, circle: int) -> ComplexArray:
    """Return the normal matrix of the denominator with all numerators eliminated (Eq. 20).

    Block [a, b] is the product of z^a H and z^b H, less the part within the numerators 1 ... z^n. Raising both
    powers by one is the same as lowering those of the numerators: one leaves at the upper end, one enters at the
    lower end. So the first row and those two end pieces give the whole matrix.
    """
    m, n_lines = data.shape[1:]
    z = np.exp(2j * np.pi / circle * (np.arange(n_lines) - 0.5 * (n_lines - 1)))
    numerators = _numerators(z, order)
    flat = data.reshape(-1, n_lines)
    left = (flat - (flat @ numerators.conj().T) @ numerators).reshape(data.shape)
    product = np.einsum("oik,ojk->ijk", left.conj(), data, optimize=True)
    first = _moments(product, order, circle).transpose(0, 2, 1).reshape(m, -1)
    leaves = numerators[order]
    enters = z ** (order - 1) * leaves.conj()
    change = _products(data * leaves.conj(), order, circle) - _products(data * enters.conj(), order, circle)
    return nested.along_diagonals(first, change)


def _products(signal: ComplexArray, order: int, circle: int) -> ComplexArray:
    """Return the sum over the rows of the outer products of their moments 0 ... order - 1."""
    moments = _moments(signal, order - 1, circle).transpose(0, 2, 1).reshape(len(signal), -1)
    return np.asarray(moments.conj().T @ moments)
