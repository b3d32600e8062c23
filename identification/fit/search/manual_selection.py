"""The user's word on which poles are modes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, FloatArray
from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import background, normal_equations

_NEAR = 0.01
_WIDTHS = np.array([0.3, 1.0, 3.0, 10.0])
_OFFSETS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])
_RATIOS = np.array([0.0003, 0.001, 0.003, 0.01, 0.03])


def nearest_modes(poles: ComplexArray, hertz: Sequence[float], candidates: BoolArray, df: float) -> BoolArray:
    """Return which poles the user means by their frequencies, shape (n_modes,).

    Parameters
    ----------
    poles : (n_modes,) complex array
        Poles of a fit [rad/s].
    hertz : sequence of float
        What the user named [Hz].
    candidates : (n_modes,) bool array
        Which of them are modes.
    df : float
        Line spacing [Hz].

    Raises
    ------
    InputError
        If no mode is within 1 % or three lines of a frequency named.
    """
    meant = np.zeros(len(poles), dtype=bool)
    frequency = np.abs(poles) / (2 * np.pi)
    for value in hertz:
        distance = np.where(candidates, np.abs(frequency - value), np.inf)
        best = int(distance.argmin())
        if not distance[best] <= max(_NEAR * value, 3 * df):  # nan is near nothing
            found = ", ".join(f"{f:.5g}" for f in frequency[candidates])
            raise InputError(f"no mode near {value:g} Hz; those found are at {found} Hz")
        meant[best] = True
    return meant


def must_have_stayed(
    poles: ComplexArray, before: ComplexArray, hertz: float, modes: BoolArray, df: float
) -> None:
    """Refuse a mode asked for whose pole the data drove away.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Poles of the fit [rad/s].
    before : (n,) complex array
        Poles without the mode asked for [rad/s].
    hertz : float
        Where the mode was asked for [Hz].
    modes : (n_modes,) bool array
        Which poles are modes of the band.
    df : float
        Line spacing [Hz].

    Raises
    ------
    InputError
        If no mode is within 1 % or three lines of it.
    """
    new = int(np.abs(poles[:, None] - before[None, :]).min(axis=1).argmax()) if len(before) else 0
    off = abs(np.abs(poles[new]) / (2 * np.pi) - hertz)
    if not modes[new] or off > max(_NEAR * hertz, 3 * df):
        raise InputError(_left(hertz))


def must_have_a_mode(poles: ComplexArray, modes: BoolArray, add: Sequence[float], df: float) -> None:
    """Refuse a mode asked for that is not there once modes are held to one shape each.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Poles of the fit [rad/s].
    modes : (n_modes,) bool array
        Which poles are modes of the band.
    add : sequence of float
        Where modes were asked for [Hz].
    df : float
        Line spacing [Hz].

    Raises
    ------
    InputError
        If no mode is within 1 % or three lines of one of them.
    """
    found = np.abs(poles[modes]) / (2 * np.pi)
    for hertz in add:
        if not np.any(np.abs(found - hertz) <= max(_NEAR * hertz, 3 * df)):
            raise InputError(_left(hertz))


def _left(hertz: float) -> str:
    return (
        f"no mode can be kept at {hertz:g} Hz: in the fit, its pole moves to another frequency or becomes part of the "
        "background; narrow the band about it, or leave it out"
    )


def best_start(
    frfs: FrfSet,
    poles: ComplexArray,
    powers: tuple[int, ...],
    weights: normal_equations.Weights,
    hertz: float,
) -> complex:
    """Return the pole about a frequency that explains most of what a fit leaves [rad/s].

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    poles : (n_modes,) complex array
        Poles of the fit [rad/s].
    powers : tuple of int
        Powers of s of its residual terms [-].
    weights : Weights
        Reciprocal variances.
    hertz : float
        Where the user sees a mode [Hz].

    Raises
    ------
    InputError
        If it is not among the lines.
    """
    low, high = float(frfs.frequency[0]), float(frfs.frequency[-1])
    if not low <= hertz <= high:
        raise InputError(
            f"a mode at {hertz:g} Hz was asked for, outside the lines from {low:g} to {high:g} Hz"
        )
    width: FloatArray = np.concatenate([_WIDTHS * frfs.df, _RATIOS * hertz])
    offset, decay = np.meshgrid(_OFFSETS, np.pi * width)
    damped = 2j * np.pi * hertz + 1j * offset * decay - decay
    trials: ComplexArray = np.asarray(damped.ravel(), complex)
    gains = background.gains(frfs, poles, powers, weights, trials)
    return complex(trials[int(gains.argmax())])
