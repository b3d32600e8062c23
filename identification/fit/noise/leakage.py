"""What windowed blocks of a random force leave in averaged FRFs: an error that follows from the modes themselves.

A block cuts what still rings at its start and at its end. Of N independent blocks with a random force, an averaged FRF
H1 has the variance (G_yy G_xx - |G_xy|^2) / (N G_xx^2) (Bendat and Piersol, Random Data, 4th ed., Sec. 9.2.3). For a
white force both spectra follow from the window: G_xy is H smeared by the power |W|^2 of the window, and G_yy is |H|^2
smeared by it. |H(i w)|^2 = H(s) H(-s) has the poles of H, with residues R_r H(-p_r), so G_yy takes the same line shape
as H. One number, 1 / N, is left to find. All outputs of one force have this error in common. From line to line it
hardly is: the force has the correlation 2/3 and 1/6 one and two lines apart, what a block cuts off 0.20 and -0.52, so
their products add 9 % to the variance of a sum.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.form import FORMS
from acquisition.frfs.frf import FrfSet


def follows(frfs: FrfSet) -> bool:
    """Return whether errors of FRFs follow this law: averages of blocks whose variance did not come with them."""
    return frfs.variance is None and frfs.line_shape is not None and frfs.line_shape.kind == "averaged"


def leaked(frfs: FrfSet, poles: ComplexArray, residues: ComplexArray) -> ComplexArray | None:
    """Return errors of the size and phase that leakage gives them together with one block, None without that law.

    All FRFs of one force have these errors times one number for each line, whose variance is 1 / N. The phase is that
    of the derivative of the smeared FRF by frequency, which a block weighs with the time from its middle.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    poles : (n_modes,) complex array
        Poles of a fit to them [rad/s].
    residues : (n_frf, n_modes) complex array
        Residues of the receptance [m/(N s)].

    Returns
    -------
    (n_frf, n_lines) complex array, or None
        Square root of N times the variance, with its phase [unit of the FRFs].
    """
    shape = frfs.line_shape
    if shape is None or not follows(frfs):
        return None
    poles = np.concatenate([poles, poles.conj()])
    residues = np.hstack([residues, residues.conj()])
    value, slope = shape.pole(frfs.laplace[:, None] - poles[None, :])
    mirrored = residues @ (-1.0 / (poles[:, None] + poles[None, :]))
    power = 2.0 * ((residues * mirrored) @ value.T).real - np.abs(residues @ value.T) ** 2
    way = residues @ slope.T
    size = np.sqrt(np.maximum(power, 0.0)) * np.abs(frfs.laplace) ** FORMS.index(frfs.form)
    return np.asarray(size * way / np.maximum(np.abs(way), np.finfo(float).tiny))


def shared(leaked: ComplexArray, residual: ComplexArray, variance: FloatArray) -> float:
    """Return the variance of the factor by which errors by leakage are common to all FRFs: at most 1 / N, or 0 [-].

    All FRFs of one force have them in common, those of several forces have not. With u the unit vector along the errors
    of all FRFs at a line, in units of the noise, |u^H r|^2 exceeds what independent errors give it by that
    variance times the products of different FRFs in it.

    Parameters
    ----------
    leaked, residual : (n_frf, n_lines) complex arrays
        Errors in common, and data minus model [unit of the FRFs].
    variance : (n_frf, n_lines) array
        Noise variance of every value [unit squared].
    """
    tiny, size = np.finfo(float).tiny, np.sqrt(variance)
    unit, white = leaked / size, residual / size
    power = np.maximum(np.sum(np.abs(unit) ** 2, axis=0), tiny)
    products = power - np.sum(np.abs(unit) ** 4, axis=0) / power
    along = np.abs(np.sum(unit.conj() * white, axis=0)) ** 2 / power
    alone = np.sum(np.abs(unit * white) ** 2, axis=0) / power
    found = float(np.sum(products * (along - alone)) / max(float(np.sum(products**2)), tiny))
    return min(max(found, 0.0), 1.0 / max(float(np.max(np.abs(unit) ** 2)), tiny))
