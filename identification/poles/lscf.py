"""Poly-reference least-squares complex frequency-domain estimator (p-LSCF) on any band."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import fft, linalg

from acquisition.arrays import ComplexArray
from acquisition.frf import FrfSet
from identification.arrangement import matrix_form
from identification.poles.base import Baseband, PoleSets, row_scale
from identification.poles.nested import denominators, roots

_GAP = 0.08  # part of the circle left free: poles just outside the band land there
_RANK = 1e-11  # numerators that live in the gap alone are left out


def lscf(frfs: FrfSet, *, orders: Sequence[int]) -> PoleSets:
    """Find poles by the right matrix-fraction model with complex coefficients.

    The band is mapped on the unit circle, so that no band is better conditioned than another; the
    numerators are eliminated and the normal equations are Toeplitz blocks made by FFT (Guillaume, Verboven,
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
    """
    data = matrix_form(frfs, row_scale(frfs))
    circle = int(fft.next_fast_len(max(round(data.shape[2] * (1 + _GAP)), 2 * max(orders) + 2)))
    normal = _reduced_normal(data, max(orders), circle)
    baseband = Baseband.of(frfs, circle)
    found = [roots(block) for block in denominators(normal, orders, data.shape[1])]
    return PoleSets(tuple(orders), tuple(baseband.poles(z) for z, _ in found), tuple(p for _, p in found))


def _moments(signal: ComplexArray, order: int, circle: int) -> ComplexArray:
    """Return sum_k signal_k z_k^m for m = -order ... order along the last axis."""
    n_lines = signal.shape[-1]
    spectrum = fft.ifft(signal, circle, axis=-1) * circle
    powers = np.arange(-order, order + 1)
    centre = np.exp(-1j * np.pi * (n_lines - 1) * powers / circle)
    return np.asarray(spectrum[..., powers % circle] * centre)


def _toeplitz(moments: ComplexArray, order: int) -> ComplexArray:
    """Spread moments m = -order ... order into blocks with entry [a, b] of moment b - a."""
    a = np.arange(order + 1)
    return np.asarray(moments[..., order + a[None, :] - a[:, None]])


def _reduced_normal(data: ComplexArray, order: int, circle: int) -> ComplexArray:
    """Return the normal matrix of the denominator with all numerators eliminated (Eq. 20)."""
    n_rows, m, n_lines = data.shape
    size = order + 1
    unit = _toeplitz(_moments(np.ones(n_lines, complex), order, circle), order)
    values, vectors = linalg.eigh(unit)
    keep = values > _RANK * values[-1]
    whiten = (vectors[:, keep] / np.sqrt(values[keep])).conj().T
    power = np.einsum("oik,ojk->ijk", data.conj(), data, optimize=True)
    total = _toeplitz(_moments(power, order, circle), order).transpose(2, 0, 3, 1).reshape(size * m, size * m)
    total = total.copy()
    cross = _moments(data, order, circle)
    chunk = max(1, int(2e6 / (size * size * m)))
    for start in range(0, n_rows, chunk):
        block = _toeplitz(cross[start : start + chunk], order)
        half = np.matmul(whiten, block).transpose(0, 2, 3, 1).reshape(-1, size * m)
        total -= half.conj().T @ half
    return np.asarray(0.5 * (total + total.conj().T))
