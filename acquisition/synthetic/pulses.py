"""Laplace transforms of the pulses a hammer makes, and the filter in front of the converter."""

from __future__ import annotations

from typing import Literal

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray


def pulse_transform(
    laplace: ComplexArray, width: float, shape: Literal["haversine", "half-sine"]
) -> ComplexArray:
    """Return the Laplace transform of a pulse of unit height that starts at t = 0, shape as ``laplace`` [s].

    Parameters
    ----------
    laplace : complex array
        Where in the Laplace plane, right of the imaginary axis [rad/s].
    width : float
        Length of the pulse [s].
    shape : {"haversine", "half-sine"}
        (1 - cos(2 pi t / width)) / 2, or sin(pi t / width).
    """
    end = np.exp(-laplace * width)
    if shape == "half-sine":
        rate = np.pi / width
        return np.asarray(rate * (1 + end) / (laplace**2 + rate**2), dtype=np.complex128)
    rate = 2 * np.pi / width
    return np.asarray(0.5 * (1 - end) * rate**2 / (laplace * (laplace**2 + rate**2)), dtype=np.complex128)


RING_RATIO = 0.08
"""Damping ratio of a hammer's own resonance: the swing has died away after some two more widths; half as much lasts
twice as long [-]."""


def ringing(laplace: ComplexArray, width: float, height: float) -> ComplexArray:
    """Return what a resonance of the hammer at 1 / width adds to its pulse, relative to it, shape as ``laplace`` [-].

    Parameters
    ----------
    laplace : complex array
        Where in the Laplace plane [rad/s].
    width : float
        Length of the pulse [s].
    height : float
        Of the swing over that of the pulse; the swing builds up to about half pi times its own transform's size [-].
    """
    rate = 2 * np.pi / width
    swing = rate * laplace / (laplace**2 + 2 * RING_RATIO * rate * laplace + rate**2)
    return np.asarray(height / (0.5 * np.pi) * swing, dtype=np.complex128)


def anti_alias(frequency: FloatArray, rate: float) -> FloatArray:
    """Return the gain of the filter: 1 up to rate / 2.56, a smooth fall, 0 from the Nyquist frequency on [-].

    Parameters
    ----------
    frequency : array
        Frequencies [Hz].
    rate : float
        Sampling rate [Hz].
    """
    low, high = rate / 2.56, rate / 2
    x = np.clip((frequency - low) / (high - low), 0.0, 1.0)
    return _falling(x)


def _falling(x: FloatArray) -> FloatArray:
    """Return a fall from 1 at 0 to 0 at 1 with three derivatives that vanish at both [-]."""
    return np.asarray(1 - x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3), dtype=np.float64)


ORDER, RIPPLE, STOP = 8, 0.1, 80.0  # an eighth-order elliptic filter: order [-], ripple and stop band [dB]
LOW = 0.88  # where it is 20 dB down [Nyquist frequency]


def sharp_anti_alias(laplace: ComplexArray, rate: float) -> ComplexArray:
    """Return the transfer function of an elliptic filter with its edge at rate / 2.56, shape as ``laplace`` [-].

    Being causal it delays force and responses alike and rings after a pulse that is shorter than its own response.
    Where it is 20 dB down it is led on to 0 at the Nyquist frequency: what is left of it, cut there, would ring at that
    frequency, and the way back from the Laplace plane would make the ringing grow along the record, to the size of
    the pulse itself.

    Parameters
    ----------
    laplace : complex array
        Where in the Laplace plane, not left of the imaginary axis [rad/s].
    rate : float
        Sampling rate [Hz].
    """
    import scipy.signal  # late: it brings all of scipy.stats along

    edge = 2 * np.pi * rate / 2.56
    zeros, poles, gain = scipy.signal.ellip(ORDER, RIPPLE, STOP, edge, analog=True, output="zpk")
    unit = laplace[..., None] / edge
    ratio = np.prod((unit - zeros / edge) / (unit - poles[: len(zeros)] / edge), axis=-1)
    x = np.clip((np.abs(laplace.imag) / (np.pi * rate) - LOW) / (1.0 - LOW), 0.0, 1.0)
    return np.asarray(gain * ratio * _falling(x), dtype=np.complex128)
