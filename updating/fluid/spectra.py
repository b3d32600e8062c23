r"""Wavenumber spectra of the functions of a ``JumpAxis``: what turns products of functions into sums.

The Chebyshev functions transform to :math:`\pi h\, i^n (n+1) J_{n+1}(kh)/(kh)`, times the phase of their
centre. In open water the wavenumbers are continuous, between walls they are the cosines that fit there.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from scipy.special import jv

from acquisition.arrays import FloatArray, frozen_array

from .axis import JumpAxis

CUTOFF = 200.0
"""Wavenumber times half-length up to which spectra are taken as they are; beyond, their mean is."""

PER_ORDER = 15.0
"""The same for each order of the highest Bessel function, whose mean sets in late."""

LINES = 8000
"""Most lines between two walls; the narrow side of a very slender plate is cut off earlier."""

PANEL = 0.5 * math.pi
"""Half a period of the squared Bessel functions: one Gauss panel."""

KEPT = 8
"""Axes whose transforms are kept, at most 2 MB each: the same plate thin and thick, and under other surfaces and
bottoms, has the same. Twice as many hold twice the memory."""


def spectra(axis: JumpAxis) -> tuple[FloatArray, FloatArray]:
    """Wavenumbers and, at each, the weighted products of the transforms of every two functions.

    Parameters
    ----------
    axis : JumpAxis
        The functions and the walls.

    Returns
    -------
    tuple of FloatArray
        Wavenumbers, shape (nk,) [rad/m], and products, shape (nk, terms, terms), whose sum over the
        wavenumbers is the integral over the axis of the product of two functions. [m]
    """
    if axis.spans:
        return _cosine_lines(axis)
    if axis.open_water:
        k, weight, transform = _transforms(axis)
        products = _weighted(transform, weight) * _same_parity(axis)
        end = _cutoff(axis) / axis.half
    else:
        k, weight, transform = _transforms(axis)
        phase = (k * (axis.centre - axis.low_wall))[:, None]
        even = axis.degrees % 2.0 == 0.0
        products = _weighted(transform * np.where(even, np.cos(phase), -np.sin(phase)), weight)
        end = float(k[-1] + 0.5 * k[1])
    tail, mean = _tail(axis, end)
    return np.concatenate([k, tail]), np.concatenate([products, mean])


@lru_cache(maxsize=KEPT)
def _transforms(axis: JumpAxis) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Wavenumbers (nk,), their weights, and the transforms there (nk, terms) but for the phase."""
    k, weight = _open_nodes(axis) if axis.open_water else _wall_lines(axis)
    return frozen_array(k), frozen_array(weight), frozen_array(_amplitude(axis, k))


def _weighted(transform: FloatArray, weight: FloatArray) -> FloatArray:
    """Products of every two transforms, (nk, terms, terms), times the weights (nk,)."""
    return np.asarray(weight[:, None, None] * transform[:, :, None] * transform[:, None, :])


def _same_parity(axis: JumpAxis) -> FloatArray:
    """One where two functions are both symmetric or both antisymmetric about the centre, else zero."""
    parity = axis.degrees % 2.0
    return np.asarray(parity[:, None] == parity, dtype=np.float64)


def _amplitude(axis: JumpAxis, k: FloatArray) -> FloatArray:
    """Transforms (nk, terms) but for the phase; of the halves of mirrored functions, half. [m]"""
    order = axis.degrees + 1.0
    argument = np.maximum(k * axis.half, 1e-12)[:, None]
    sign = np.where(axis.degrees // 2.0 % 2.0 == 0.0, 1.0, -1.0)
    share = 0.5 if axis.mirrored else 1.0
    return np.asarray(share * math.pi * axis.half * sign * order * jv(order, argument) / argument)


def _cutoff(axis: JumpAxis) -> float:
    """Wavenumber times half-length where the mean takes over."""
    return max(CUTOFF, PER_ORDER * float(axis.degrees[-1] + 1.0))


def _open_nodes(axis: JumpAxis) -> tuple[FloatArray, FloatArray]:
    """Gauss panels up to the cutoff, ever shorter towards zero, and weights dk / pi."""
    end = _cutoff(axis)
    uniform = np.append(np.arange(PANEL, end, PANEL), end)
    graded = PANEL * 0.25 ** np.arange(7, 0, -1.0)
    edges = np.concatenate([[0.0], graded, uniform]) / axis.half
    node, weight = np.polynomial.legendre.leggauss(4)
    reach = 0.5 * np.diff(edges)[:, None]
    k = edges[:-1, None] + reach * (node + 1.0)
    return k.ravel(), (reach * weight).ravel() / math.pi


def _wall_lines(axis: JumpAxis) -> tuple[FloatArray, FloatArray]:
    """Return the cosines that fit between two walls: wavenumbers, and weights from their mean square."""
    span = axis.high_wall - axis.low_wall
    number = np.arange(0.0, min(math.ceil(_cutoff(axis) / axis.half * span / math.pi), LINES) + 1)
    return number * math.pi / span, np.where(number == 0, 1.0, 2.0) / span


def _cosine_lines(axis: JumpAxis) -> tuple[FloatArray, FloatArray]:
    """Return the spectra of a plate from wall to wall: every cosine is its own line."""
    number = np.arange(axis.terms)
    products = np.zeros((axis.terms, axis.terms, axis.terms))
    products[number, number, number] = np.where(number == 0, 1.0, 0.5) * axis.side
    return np.asarray(number * math.pi / axis.side, dtype=np.float64), products


def _tail(axis: JumpAxis, end: float) -> tuple[FloatArray, FloatArray]:
    """Mean of the oscillating products beyond ``end``, (n+1)(n'+1) / (h k^3), on Gauss points of end / k."""
    node, weight = np.polynomial.legendre.leggauss(12)
    s = 0.5 * (node + 1.0)
    k = end / s
    order = axis.degrees + 1.0
    share = 0.5 if axis.mirrored else 1.0
    level = share * order[:, None] * order * _same_parity(axis) / axis.half
    return k, (0.5 * weight * end / s**2 / k**3)[:, None, None] * level
