"""The functions of frequency that a modal model is a sum of, and their derivatives by the poles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.frf import FORMS, Form

BASIC_TERMS: tuple[int, ...] = (-2, 0)


@dataclass(frozen=True, eq=False)
class Basis:
    """Columns of a linear model with real coefficients for FRFs with given poles.

    A receptance is sum_r R_r/(s - p_r) + conj(R_r)/(s - conj p_r) + sum_k U_k s^k. With R = a + i b and
    real U every column is multiplied by a real number.

    Parameters
    ----------
    modes : (n_lines, 2 n_modes) complex array
        Columns of a_1, b_1, a_2, b_2, ... [form's power of s, over s].
    terms : (n_lines, n_terms) complex array
        Columns of the residual terms, scaled to about unity [-].
    term_scale : (n_terms,) array
        What a coefficient is multiplied by to become the coefficient of s^k in the receptance.
    slopes : (n_lines, 2 n_modes) complex array
        Derivatives of the columns ``modes`` by the real part of their pole.
    """

    modes: ComplexArray
    terms: ComplexArray
    term_scale: FloatArray
    slopes: ComplexArray

    @property
    def linear(self) -> ComplexArray:
        """Modes and residual terms side by side, shape (n_lines, 2 n_modes + n_terms)."""
        return np.hstack([self.modes, self.terms])


def build(laplace: ComplexArray, poles: ComplexArray, form: Form, terms: tuple[int, ...]) -> Basis:
    """Evaluate the basis.

    Parameters
    ----------
    laplace : (n_lines,) complex array
        Where the lines lie: i omega + decay, none of them 0 [1/s].
    poles : (n_modes,) complex array
        Poles [rad/s].
    form : {"receptance", "mobility", "accelerance"}
        What the FRFs are.
    terms : tuple of int
        Powers of s of the residual terms of the receptance; -2 is a mass below, 0 a flexibility above.

    Returns
    -------
    Basis
        Columns and slopes.
    """
    power = FORMS.index(form)
    front = (laplace**power)[:, None]
    upper = 1.0 / (laplace[:, None] - poles[None, :])
    lower = 1.0 / (laplace[:, None] - poles.conj()[None, :])
    modes = np.stack([upper + lower, 1j * (upper - lower)], axis=2)
    slopes = np.stack([upper**2 + lower**2, 1j * (upper**2 - lower**2)], axis=2)
    exponents = np.array(terms, dtype=float) + power
    unit = np.exp(np.mean(np.log(np.abs(laplace))))
    return Basis(
        (front[:, :, None] * modes).reshape(len(laplace), -1),
        (laplace[:, None] / unit) ** exponents[None, :],
        unit**-exponents,
        (front[:, :, None] * slopes).reshape(len(laplace), -1),
    )
