"""Measures of single degrees of freedom over a set of paired modes."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import AnyArray, FloatArray
from identification.mac.columns import paired, ratio, undefined, unit
from identification.mac.shapes import msf


def comac(a: AnyArray, b: AnyArray) -> FloatArray:
    """Co-ordinate MAC: how well each degree of freedom agrees over the paired modes.

    (sum |a b|)^2 / sum |a|^2 sum |b|^2 over the modes; Lieven and Ewins, IMAC VI (1988) 690-695. It does not see
    signs. It weighs modes by the scale of their shapes, so every shape is brought to unit length first. Over
    one mode it is always 1: the answer is nan; so it is where neither set moves.

    Parameters
    ----------
    a, b : (n_dofs, n_modes) arrays
        Paired mode shapes [any unit].

    Returns
    -------
    (n_dofs,) array
        Between 0 and 1, 0 where only one set moves [-].

    Raises
    ------
    InputError
        If the shapes are not paired.
    """
    first, second = (np.abs(unit(x)) for x in paired(a, b))
    moves = (first.max(axis=1, initial=0.0) > 0) | (second.max(axis=1, initial=0.0) > 0)
    over = np.sum(first * second, axis=1) ** 2
    values = ratio(over, np.sum(first**2, axis=1) * np.sum(second**2, axis=1))
    return undefined(np.where(moves, values, np.nan), first.shape[1])


def ecomac(a: AnyArray, b: AnyArray) -> FloatArray:
    """Enhanced co-ordinate MAC: mean distance of the shapes at each degree of freedom.

    sum |a - b| / 2 n_modes (Hunt, Exp. Tech. 16 (1992) 23-24). It needs common scale and sign: a mode whose
    sign is turned would count as wrong at every degree of freedom. So here every shape is brought to unit
    length and turned by the phase of its scale factor first, and absolute scale is not compared. One degree of
    freedom then always agrees: the answer is nan.

    Parameters
    ----------
    a, b : (n_dofs, n_modes) arrays
        Paired mode shapes [any unit].

    Returns
    -------
    (n_dofs,) array
        0 where the shapes agree, 1 at the most [-].

    Raises
    ------
    InputError
        If the shapes are not paired.
    """
    first, second = (unit(x) for x in paired(a, b))
    phase = np.exp(1j * np.angle(msf(first, second)))
    values = np.sum(np.abs(first * phase - second), axis=1) / (2.0 * max(first.shape[1], 1))
    return undefined(values, len(first) if first.shape[1] else 0)
