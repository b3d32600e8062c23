"""The functions of frequency that a modal model is a sum of, and their derivatives by the poles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.form import FORMS, Form
from acquisition.frfs.frf import FrfSet, Record
from acquisition.frfs.line_shape import LineShape

BASIC_TERMS: tuple[int, ...] = (-2, 0)
_NOTHING = 1e-9  # what is cut off is worth its cost from here on [-]


@dataclass(frozen=True, eq=False)
class Axis:
    """Where FRFs were sampled, and how.

    Parameters
    ----------
    laplace : (n_lines,) complex array
        Where the lines lie: i omega + decay, none of them 0 [1/s].
    form : {"receptance", "mobility", "accelerance"}
        What the FRFs are.
    decay : float
        Decay of the exponential window still in the FRFs [1/s].
    record : Record, optional
        Records whose ends cut off what still rings.
    shape : LineShape, optional
        What a Hann window leaves of a pole.
    """

    laplace: ComplexArray
    form: Form
    decay: float = 0.0
    record: Record | None = None
    shape: LineShape | None = None

    @classmethod
    def of(cls, frfs: FrfSet) -> Axis:
        """Return the axis of a set."""
        return cls(frfs.laplace, frfs.form, frfs.decay, frfs.record, frfs.line_shape)


@dataclass(frozen=True, eq=False)
class Basis:
    """Columns of a linear model with real coefficients for FRFs with given poles.

    A receptance is sum_r R_r/(s - p_r) + conj(R_r)/(s - conj p_r) + sum_k U_k s^k. With R = a + i b and
    real U every column is multiplied by a real number.

    Parameters
    ----------
    columns : (n_lines, 4 n_modes + n_terms) complex array
        Columns of a_1, b_1, a_2, b_2, ... [form's power of s, over s]; of the residual terms, scaled to about
        unity [-]; and the derivatives of the first by the real part of their pole.
    term_scale : (n_terms,) array
        What a coefficient is multiplied by to become the coefficient of s^k in the receptance.
    """

    columns: ComplexArray
    term_scale: FloatArray

    @property
    def n_linear(self) -> int:
        """How many columns the model is linear in: 2 n_modes + n_terms."""
        return int(self.columns.shape[1] + len(self.term_scale)) // 2

    @property
    def linear(self) -> ComplexArray:
        """Modes and residual terms side by side, shape (n_lines, 2 n_modes + n_terms)."""
        return self.columns[:, : self.n_linear]

    @property
    def modes(self) -> ComplexArray:
        """Columns of the modes, shape (n_lines, 2 n_modes)."""
        return self.columns[:, : self.n_linear - len(self.term_scale)]

    @property
    def terms(self) -> ComplexArray:
        """Columns of the residual terms, shape (n_lines, n_terms)."""
        return self.columns[:, self.n_linear - len(self.term_scale) : self.n_linear]

    @property
    def slopes(self) -> ComplexArray:
        """Derivatives of ``modes`` by the real part of their pole, shape (n_lines, 2 n_modes)."""
        return self.columns[:, self.n_linear :]


def build(axis: Axis, poles: ComplexArray, terms: tuple[int, ...]) -> Basis:
    """Evaluate the basis.

    Parameters
    ----------
    axis : Axis
        Where the lines lie, and what the FRFs are.
    poles : (n_modes,) complex array
        Poles [rad/s].
    terms : tuple of int
        Powers of s of the residual terms of the receptance; -2 is a mass below, 0 a flexibility above.

    Returns
    -------
    Basis
        Columns and slopes.

    Notes
    -----
    A record of length T with the hit at t0 ends before a mode does. On the lines of its transform, which are
    multiples of 1/T, what is cut off is a term of its own: with q the power of s of what was recorded, the
    mode's s^q / (s - p) becomes s^q / (s - p) - p^q exp((p - d) T) exp((s - p) t0) h / (1 - exp((p - s) h)), where h is
    the distance of samples: the record is cut behind the converter. So FRFs of records that were not at rest, with
    no window or a weak one, are fitted without bias.
    """
    s, power = axis.laplace, FORMS.index(axis.form)
    front = (s**power)[:, None]
    upper, upper_slope = _column(axis, front, poles)
    lower, lower_slope = _column(axis, front, poles.conj())
    exponents = np.array(terms, dtype=float) + power
    unit = np.exp(np.mean(np.log(np.abs(s))))
    n, k = 2 * len(poles), 2 * len(poles) + len(terms)
    columns = np.empty((len(s), n + k), complex)
    columns[:, 0:n:2], columns[:, 1:n:2] = upper + lower, 1j * (upper - lower)
    columns[:, n:k] = (s[:, None] / unit) ** exponents[None, :]
    columns[:, k::2], columns[:, k + 1 :: 2] = upper_slope + lower_slope, 1j * (upper_slope - lower_slope)
    return Basis(columns, unit**-exponents)


def _column(axis: Axis, front: ComplexArray, poles: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return what each pole adds to FRFs, and its derivative by the pole, both (n_lines, n_modes)."""
    inverse = 1.0 / (axis.laplace[:, None] - poles[None, :])
    column = front * inverse
    if axis.shape is not None:
        return _smeared(axis, axis.shape, poles, column, inverse)
    if axis.record is None:
        return column, column * inverse
    q, rest = FORMS.index(axis.record.form), axis.record.duration - axis.record.trigger
    left = np.exp((poles - axis.decay) * rest)
    if not np.abs(left).max(initial=0.0) > _NOTHING:
        return column, column * inverse
    phase = np.exp((axis.laplace - axis.decay) * axis.record.trigger)
    turned = phase * axis.laplace ** (FORMS.index(axis.form) - q)
    lost = turned[:, None] * (left * poles**q)[None, :]
    tail, tail_slope = _tail(axis, poles, inverse)
    return column - lost * tail, column * inverse - lost * (tail_slope + (rest + q / poles) * tail)


def _smeared(
    axis: Axis, shape: LineShape, poles: ComplexArray, column: ComplexArray, inverse: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return the same as a Hann window over each block leaves it.

    With q the power of s of the form, s^q / (s - p) is a polynomial in s, which no lag window changes, and
    p^q / (s - p), of which the line shape takes the place.
    """
    q = FORMS.index(axis.form)
    value, slope = shape.pole(axis.laplace[:, None] - poles[None, :])
    changed = value - inverse
    return column + poles**q * changed, column * inverse + poles**q * (
        slope - inverse**2 + q / poles * changed
    )


def _tail(axis: Axis, poles: ComplexArray, inverse: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Return the transform of what rings on behind the end of a record, and its derivative by the pole.

    The sum over the samples that are not there, h / (1 - exp((p - s) h)) with h their distance; the integral
    1 / (s - p) where that is not known.
    """
    rate = None if axis.record is None else axis.record.rate
    if rate is None:
        return inverse, inverse**2
    step = np.exp((poles[None, :] - axis.laplace[:, None]) / rate)
    tail = np.asarray(1.0 / (rate * (1.0 - step)), dtype=np.complex128)
    return tail, np.asarray(step * tail**2)
