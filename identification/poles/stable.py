"""The few roots of a long polynomial that lie inside the unit circle, without the many outside."""

from __future__ import annotations

import numpy as np
from scipy import fft

from acquisition.arrays import ComplexArray, FloatArray

_RADII = (1.006, 1.003, 1.012)  # circles tried in turn; no root may lie too near
_POINTS = 4096  # on a circle, or sixteen times the order
_TURN = 2.5  # a larger turn from point to point leaves the count in doubt [rad]
_STEPS, _REST = 8, 1e-11  # Newton's steps at the most, and the length of the last


def stable_roots(coefficients: ComplexArray) -> ComplexArray | None:
    """Return the roots inside the unit circle, or None if they cannot be determined reliably.

    The argument of the polynomial along a circle a little larger counts the roots in it; the Fourier series of
    the logarithm holds their power sums (Oppenheim and Schafer, Discrete-Time Signal Processing, 3rd ed., Ch.
    13), that is, the factor whose roots they are; Newton's method on the whole polynomial gives them to
    rounding. As many distinct roots as were counted are all there are.

    Parameters
    ----------
    coefficients : (order + 1,) complex array
        From the constant term, which is not 0, to the highest [-].
    """
    powers = np.arange(len(coefficients))
    for radius in _RADII:
        roots = _inside(coefficients * radius**powers)
        if roots is not None:
            found = radius * roots
            return np.asarray(found[np.abs(found) < 1.0])
    return None


def _inside(coefficients: ComplexArray) -> ComplexArray | None:
    """Return the roots inside the unit circle, or None if one is too near to it or two are one."""
    points = max(_POINTS, 16 * len(coefficients))
    values = fft.ifft(coefficients, points) * points
    size, turn = np.abs(values), np.angle(np.roll(values, -1) * values.conj())
    if not (np.abs(turn).max() < _TURN and size.min() > 0):
        return None
    count = round(float(turn.sum()) / (2 * np.pi))
    phase = np.concatenate([[0.0], np.cumsum(turn - 2 * np.pi * count / points)[:-1]])
    factor = _factor(np.log(size) + 1j * phase, count)
    return _polished(np.asarray(np.roots(factor), complex), coefficients)


def _factor(logarithm: ComplexArray, count: int) -> ComplexArray:
    """Return the polynomial, highest power first, whose logarithm is the part of the series in 1/z."""
    scaled = fft.ifft(logarithm)[1 : count + 1] * np.arange(1, count + 1)
    factor = np.ones(count + 1, complex)
    for k in range(1, count + 1):
        factor[k] = scaled[:k] @ factor[k - 1 :: -1] / k
    return factor


def _polished(roots: ComplexArray, coefficients: ComplexArray) -> ComplexArray | None:
    """Return roots after Newton's steps, or None if they do not come to rest, distinct and inside the circle."""
    slopes = coefficients[1:] * np.arange(1, len(coefficients))
    for _ in range(_STEPS):
        powers = np.vander(roots, len(coefficients), increasing=True)
        step = (powers @ coefficients) / (powers[:, :-1] @ slopes)
        roots = roots - step
        if not np.abs(roots).max(initial=0.0) < 1.0:
            return None
        if np.abs(step).max(initial=0.0) < _REST:
            disagreement: FloatArray = np.abs(roots[:, None] - roots) + 2.0 * np.eye(len(roots))
            return roots if disagreement.min(initial=2.0) > 1e3 * _REST else None
    return None
