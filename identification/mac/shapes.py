"""Measures of whole mode shapes.

Shapes are arrays of (n_dofs, n_modes); a single shape may be one-dimensional.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import AnyArray, ComplexArray, FloatArray
from identification.mac.columns import TINY, both, columns, paired, ratio, undefined, unit


def mac(a: AnyArray, b: AnyArray) -> FloatArray:
    """Modal assurance criterion |a^H b|^2 / (a^H a)(b^H b).

    Allemang and Brown, IMAC I (1982) 110-116. Scale and phase of a shape have no influence. At a single
    degree of freedom every shape is a multiple of every other: there is nothing to compare, and the answer
    is nan.

    Parameters
    ----------
    a, b : (n_dofs, n_a) and (n_dofs, n_b) arrays
        Mode shapes [any unit].

    Returns
    -------
    (n_a, n_b) array
        Between 0 and 1; 0 for a zero shape, nan for one degree of freedom [-].

    Raises
    ------
    InputError
        If the degrees of freedom disagree.
    """
    first, second = (unit(x) for x in both(a, b))
    return undefined(np.minimum(np.abs(first.conj().T @ second) ** 2, 1.0), len(first))


def auto_mac(a: AnyArray) -> FloatArray:
    """MAC of a set of shapes with itself, shape (n_a, n_a) [-].

    Parameters
    ----------
    a : (n_dofs, n_a) array
        Mode shapes [any unit].
    """
    return mac(a, a)


def macx(a: AnyArray, b: AnyArray) -> FloatArray:
    """MAC for complex shapes, which takes a shape and its conjugate as one.

    (|a^H b| + |a^T b|)^2 / (a^H a + |a^T a|)(b^H b + |b^T b|); Vacher, Jacquier and Bucharles, ISMA 2010. For
    real shapes it is the MAC.

    Parameters
    ----------
    a, b : (n_dofs, n_a) and (n_dofs, n_b) arrays
        Mode shapes [any unit].

    Returns
    -------
    (n_a, n_b) array
        Between 0 and 1; 0 for a zero shape, nan for one degree of freedom [-].

    Raises
    ------
    InputError
        If the degrees of freedom disagree.
    """
    first, second = (unit(x) for x in both(a, b))
    over = (np.abs(first.conj().T @ second) + np.abs(first.T @ second)) ** 2
    size = [np.sum(np.abs(x) ** 2, axis=0) + np.abs(np.sum(x**2, axis=0)) for x in (first, second)]
    return undefined(ratio(over, np.outer(size[0], size[1])), len(first))


def msf(a: AnyArray, b: AnyArray) -> ComplexArray:
    """Modal scale factor a^H b / a^H a: what each a is multiplied by to fit the b it is paired with.

    Allemang, Sound Vib. 37-8 (2003) 14-23. It is defined for a single degree of freedom too.

    Parameters
    ----------
    a, b : (n_dofs, n_modes) arrays
        Paired mode shapes [any unit].

    Returns
    -------
    (n_modes,) complex array
        Factors; b ~ a msf; 0 where a is zero [unit of b over unit of a].

    Raises
    ------
    InputError
        If the shapes are not paired.
    """
    first, second = paired(a, b)
    size = np.maximum(np.abs(first).max(axis=0, initial=0.0), TINY)
    first = first / size
    under = np.maximum(np.sum(np.abs(first) ** 2, axis=0), TINY)
    return np.asarray(np.sum(first.conj() * second, axis=0) / under / size)


def mpc(a: AnyArray) -> FloatArray:
    """Modal phase collinearity: 1 for a shape whose components lie on one line of the complex plane.

    ((S_xx - S_yy)^2 + 4 S_xy^2) / (S_xx + S_yy)^2 with the products of real and imaginary parts (Pappa,
    Elliott and Schenk, J. Guid. Control Dyn. 16 (1993) 832-838); that is |a^T a|^2 / (a^H a)^2, the MAC of the
    shape with its conjugate. The parts are taken about zero, not about their means: the line goes through
    the origin. A single component always lies on such a line: the answer is nan.

    Parameters
    ----------
    a : (n_dofs, n_modes) array
        Mode shapes [any unit].

    Returns
    -------
    (n_modes,) array
        Between 0 and 1; 0 for a zero shape, nan for one degree of freedom [-].
    """
    shapes = unit(columns(a))
    return undefined(np.minimum(np.abs(np.sum(shapes**2, axis=0)) ** 2, 1.0), len(shapes))
