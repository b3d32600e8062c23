"""Least-squares complex exponential estimator (LSCE), right on any band."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import fft

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.errors import EstimationError
from acquisition.frfs.frf import FrfSet
from identification.poles import nested
from identification.poles.base import Baseband, PoleSets, row_scale

_TAPER = 0.06  # part of the band over which each edge is faded


def lsce(frfs: FrfSet, *, orders: Sequence[int]) -> PoleSets:
    """Find poles by linear prediction of the band's complex impulse responses.

    The band is shifted to the baseband and transformed back as it stands, so the coefficients are complex
    and no band is privileged (Brown, Allemang, Zimmerman and Mergeay, SAE 790221, 1979, for the real case).
    Cutting the band off leaks around t = 0 and, the transform being circular, before the end: the edges
    are faded and those samples left out. What wraps around because it has not decayed stays an exponential
    and does no harm.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs, already cut to the band.
    orders : sequence of int
        Numbers of poles [-].

    Returns
    -------
    PoleSets
        Stable poles of every order; participation is 1.

    Raises
    ------
    EstimationError
        If the band holds too few lines for the highest order.
    """
    n_lines, order = len(frfs.frequency), max(orders)
    skip = _skip(n_lines)
    if n_lines - 2 * skip < 2 * order:
        raise EstimationError(
            f"{frfs.source}: {n_lines} lines cannot carry LSCE of order {order}; lower the order or "
            "widen the band"
        )
    responses = _impulse_responses(frfs)
    normal = prediction_normal(responses[:, skip : n_lines - skip], order)
    baseband = Baseband.of(frfs, n_lines)
    found = [nested.roots(block) for block in nested.denominators(normal, orders, 1)]
    return PoleSets(tuple(orders), tuple(baseband.poles(z) for z, _ in found), tuple(p for _, p in found))


def _skip(n_lines: int) -> int:
    return min(int(np.ceil(2.0 / _TAPER)), n_lines // 10)


def _taper(n_lines: int) -> FloatArray:
    width = max(1, round(_TAPER * n_lines))
    ramp = np.sin(0.5 * np.pi * (np.arange(width) + 0.5) / width) ** 2
    window = np.ones(n_lines)
    window[:width], window[-width:] = ramp, ramp[::-1]
    return window


def _impulse_responses(frfs: FrfSet) -> ComplexArray:
    """Return the scaled complex impulse responses about the band's middle, shape (n_frf, n_lines)."""
    n_lines = len(frfs.frequency)
    data = frfs.values * row_scale(frfs)[:, None] * _taper(n_lines)
    shift = np.exp(-1j * np.pi * (n_lines - 1) * np.arange(n_lines) / n_lines)
    return np.asarray(fft.ifft(data, axis=1) * shift)


def prediction_normal(signals: ComplexArray, order: int) -> ComplexArray:
    """Return sum over signals and t of conj(h(t + a)) h(t + b), shape (order + 1, order + 1).

    The first row is a correlation, made by FFT; every other element follows along its diagonal from what
    enters and leaves the window.

    Parameters
    ----------
    signals : (n_signals, n_samples) complex array
        Impulse responses [-].
    order : int
        Highest lag [-].
    """
    span = signals.shape[1] - order
    length = int(fft.next_fast_len(signals.shape[1]))
    kept = fft.fft(signals[:, :span], length, axis=1)
    whole = fft.fft(signals, length, axis=1)
    first = fft.ifft(np.einsum("ok,ok->k", kept.conj(), whole))[: order + 1]
    head, tail = signals[:, :order], signals[:, span : span + order]
    return nested.along_diagonals(first[None, :], tail.conj().T @ tail - head.conj().T @ head)
