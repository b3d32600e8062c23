"""Measures of FRFs, (n_frf, n_lines)."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import AnyArray, FloatArray
from identification.mac.columns import both, paired, undefined, unit


def frac(h1: AnyArray, h2: AnyArray) -> FloatArray:
    """Frequency response assurance criterion of paired FRFs: |h1^H h2|^2 / (h1^H h1)(h2^H h2) over the lines.

    Heylen and Lammens, ISMA 1996. A factor common to all lines (level, sign) has no influence; a shift of
    frequencies has. On a single line it is always 1: the answer is nan.

    Parameters
    ----------
    h1, h2 : (n_frf, n_lines) complex arrays
        Paired FRFs on the same lines; a single FRF may be one-dimensional [any unit].

    Returns
    -------
    (n_frf,) array
        Between 0 and 1; 0 for a zero FRF [-].

    Raises
    ------
    InputError
        If the FRFs are not paired.
    """
    first, second = (unit(x) for x in paired(np.atleast_2d(h1).T, np.atleast_2d(h2).T))
    over = np.abs(np.sum(first.conj() * second, axis=0)) ** 2
    return undefined(np.minimum(over, 1.0), len(first))


def fdac(h1: AnyArray, h2: AnyArray) -> FloatArray:
    """Frequency domain assurance criterion: signed cosine between the FRFs' shapes at any two frequencies.

    Re(h1^H h2) / |h1| |h2| (Pascual, Golinval and Razeto, IMAC XV (1997) 587-592); the sign separates an
    antiphase from a phase. With one FRF it is the cosine of the phase between the two and contains no information on
    shapes.

    Parameters
    ----------
    h1, h2 : (n_frf, n_lines_1) and (n_frf, n_lines_2) complex arrays
        FRFs of the same pairs of degrees of freedom [any unit].

    Returns
    -------
    (n_lines_1, n_lines_2) array
        Between -1 and 1; 0 where an FRF is zero [-].

    Raises
    ------
    InputError
        If the numbers of FRFs disagree.
    """
    first, second = (unit(x) for x in both(h1, h2))
    return np.asarray(np.clip((first.conj().T @ second).real, -1.0, 1.0))
