"""Comparison of mode shapes and of FRFs: the MAC family.

Shapes are arrays of (n_dofs, n_modes), a single shape may be one-dimensional; FRFs are (n_frf, n_lines).
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import AnyArray, ComplexArray, FloatArray
from acquisition.errors import InputError

_TINY = float(np.finfo(float).tiny)


def _pair(a: AnyArray, b: AnyArray) -> tuple[ComplexArray, ComplexArray]:
    first, second = (np.asarray(x, dtype=complex) for x in (a, b))
    first, second = (x[:, None] if x.ndim == 1 else x for x in (first, second))
    if first.ndim != 2 or second.ndim != 2 or first.shape[0] != second.shape[0]:
        raise InputError(
            f"shapes of {first.shape} and {second.shape}: both need one row for each of the same "
            "degrees of freedom"
        )
    return first, second


def _paired(a: AnyArray, b: AnyArray) -> tuple[ComplexArray, ComplexArray]:
    first, second = _pair(a, b)
    if first.shape != second.shape:
        raise InputError(f"shapes of {first.shape} and {second.shape}: the modes must be paired one to one")
    return first, second


def _ratio(over: FloatArray, under: FloatArray) -> FloatArray:
    return np.asarray(np.where(under > _TINY, over / np.maximum(under, _TINY), 0.0))


def mac(a: AnyArray, b: AnyArray) -> FloatArray:
    """Modal assurance criterion |a^H b|^2 / (a^H a)(b^H b).

    Allemang and Brown, IMAC I (1982) 110-116.

    Parameters
    ----------
    a, b : (n_dofs, n_a) and (n_dofs, n_b) arrays
        Mode shapes [-].

    Returns
    -------
    (n_a, n_b) array
        Between 0 and 1; 0 for a zero shape [-].

    Raises
    ------
    InputError
        If the degrees of freedom disagree.
    """
    first, second = _pair(a, b)
    norms = np.outer(np.sum(np.abs(first) ** 2, axis=0), np.sum(np.abs(second) ** 2, axis=0))
    return _ratio(np.abs(first.conj().T @ second) ** 2, norms)


def auto_mac(a: AnyArray) -> FloatArray:
    """MAC of a set of shapes with itself, shape (n_a, n_a) [-].

    Parameters
    ----------
    a : (n_dofs, n_a) array
        Mode shapes [-].
    """
    return mac(a, a)


def macx(a: AnyArray, b: AnyArray) -> FloatArray:
    """MAC for complex shapes, which takes a shape and its conjugate as one.

    (|a^H b| + |a^T b|)^2 / (a^H a + |a^T a|)(b^H b + |b^T b|); Vacher, Jacquier and Bucharles, ISMA 2010. For
    real shapes it is the MAC.

    Parameters
    ----------
    a, b : (n_dofs, n_a) and (n_dofs, n_b) arrays
        Mode shapes [-].

    Returns
    -------
    (n_a, n_b) array
        Between 0 and 1 [-].

    Raises
    ------
    InputError
        If the degrees of freedom disagree.
    """
    first, second = _pair(a, b)
    over = (np.abs(first.conj().T @ second) + np.abs(first.T @ second)) ** 2
    size = [np.sum(np.abs(x) ** 2, axis=0) + np.abs(np.sum(x**2, axis=0)) for x in (first, second)]
    return _ratio(over, np.outer(size[0], size[1]))


def msf(a: AnyArray, b: AnyArray) -> ComplexArray:
    """Modal scale factor a^H b / a^H a: what each a is multiplied by to fit the b it is paired with.

    Parameters
    ----------
    a, b : (n_dofs, n_modes) arrays
        Paired mode shapes [-].

    Returns
    -------
    (n_modes,) complex array
        Factors; b ~ a msf [-].

    Raises
    ------
    InputError
        If the shapes are not paired.
    """
    first, second = _paired(a, b)
    under = np.maximum(np.sum(np.abs(first) ** 2, axis=0), _TINY)
    return np.asarray(np.sum(first.conj() * second, axis=0) / under)


def comac(a: AnyArray, b: AnyArray) -> FloatArray:
    """Co-ordinate MAC: how well each degree of freedom agrees over the paired modes.

    (sum |a b*|)^2 / sum |a|^2 sum |b|^2; Lieven and Ewins, IMAC VI (1988) 690-695. Every shape is brought to
    unit length first, as the measure asks for one scale in both sets.

    Parameters
    ----------
    a, b : (n_dofs, n_modes) arrays
        Paired mode shapes [-].

    Returns
    -------
    (n_dofs,) array
        Between 0 and 1 [-].

    Raises
    ------
    InputError
        If the shapes are not paired.
    """
    first, second = (_unit(x) for x in _paired(a, b))
    over = np.sum(np.abs(first * second.conj()), axis=1) ** 2
    return _ratio(over, np.sum(np.abs(first) ** 2, axis=1) * np.sum(np.abs(second) ** 2, axis=1))


def ecomac(a: AnyArray, b: AnyArray) -> FloatArray:
    """Enhanced co-ordinate MAC: mean distance of the shapes at each degree of freedom.

    sum |a - b| / 2 n_modes (Hunt, Exp. Tech. 16 (1992) 23-24). It needs common scale and sign: here every
    shape is brought to unit length and turned by the phase of its scale factor first.

    Parameters
    ----------
    a, b : (n_dofs, n_modes) arrays
        Paired mode shapes [-].

    Returns
    -------
    (n_dofs,) array
        0 where the shapes agree, 1 at the most [-].

    Raises
    ------
    InputError
        If the shapes are not paired.
    """
    first, second = (_unit(x) for x in _paired(a, b))
    phase = np.exp(1j * np.angle(msf(first, second)))
    return np.asarray(np.mean(np.abs(first * phase - second), axis=1) / 2.0)


def _unit(shapes: ComplexArray) -> ComplexArray:
    return np.asarray(shapes / np.maximum(np.linalg.norm(shapes, axis=0), _TINY))


def mpc(a: AnyArray) -> FloatArray:
    """Modal phase collinearity: 1 for a shape whose components lie on one line of the complex plane.

    ((S_xx - S_yy)^2 + 4 S_xy^2) / (S_xx + S_yy)^2 with real and imaginary parts about zero (Pappa, Elliott
    and Schenk, J. Guid. Control Dyn. 16 (1993) 832-838, without subtracting the mean, for a shape with one
    component has none).

    Parameters
    ----------
    a : (n_dofs, n_modes) array
        Mode shapes [-].

    Returns
    -------
    (n_modes,) array
        Between 0 and 1 [-].
    """
    shapes, _ = _pair(a, a)
    return _ratio(np.abs(np.sum(shapes**2, axis=0)) ** 2, np.sum(np.abs(shapes) ** 2, axis=0) ** 2)


def frac(h1: AnyArray, h2: AnyArray) -> FloatArray:
    """Frequency response assurance criterion of paired FRFs: MAC along the lines.

    Heylen and Lammens, ISMA 1996.

    Parameters
    ----------
    h1, h2 : (n_frf, n_lines) complex arrays
        Paired FRFs on the same lines [any unit].

    Returns
    -------
    (n_frf,) array
        Between 0 and 1 [-].

    Raises
    ------
    InputError
        If the FRFs are not paired.
    """
    first, second = _paired(np.atleast_2d(h1).T, np.atleast_2d(h2).T)
    over = np.abs(np.sum(first.conj() * second, axis=0)) ** 2
    return _ratio(over, np.sum(np.abs(first) ** 2, axis=0) * np.sum(np.abs(second) ** 2, axis=0))


def fdac(h1: AnyArray, h2: AnyArray) -> FloatArray:
    """Frequency domain assurance criterion: signed cosine between the FRFs' shapes at any two frequencies.

    Re(h1^H h2) / |h1| |h2| (Pascual, Golinval and Razeto, IMAC XV (1997) 587-592); the sign tells an
    antiphase from a phase.

    Parameters
    ----------
    h1, h2 : (n_frf, n_lines_1) and (n_frf, n_lines_2) complex arrays
        FRFs of the same pairs of degrees of freedom [any unit].

    Returns
    -------
    (n_lines_1, n_lines_2) array
        Between -1 and 1 [-].

    Raises
    ------
    InputError
        If the numbers of FRFs disagree.
    """
    first, second = _pair(h1, h2)
    norms = np.outer(np.linalg.norm(first, axis=0), np.linalg.norm(second, axis=0))
    return _ratio((first.conj().T @ second).real, norms)
