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
from scipy import ndimage

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.form import FORMS
from acquisition.frfs.frf import FrfSet
from identification.fit.noise.levels import window_length

_ROUNDS = 6
_PEAK = 6.0
"""Power over the expected one by which a value counts at the most [-], as in `identification.fit.noise.common`."""
_STEP = 1e-3
"""Least ratio of a variance to the one of the round before [-]."""
_COLOURS = 2
"""Times that the colour of the own noise is estimated [-]; the second knows what leakage there is."""
_PIECE = 16
"""Lines of a piece, as in `identification.fit.noise.levels` [-]."""
_AMONG = 5
"""Neighbouring pieces of which the middle one counts [-]. Doubled: noise that rises within 80 lines is not followed."""
_CHANCE = 2.5
"""Mean square of the logarithm of a colour, times the lines of a window, that chance gives, as in
`identification.fit.noise.levels` [-]."""


def follows(frfs: FrfSet) -> bool:
    """Tell whether errors of FRFs follow this law: averages of blocks whose variance did not come with them."""
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


def levelled(power: FloatArray, law: FloatArray, level: FloatArray) -> tuple[FloatArray, float]:
    """Return variances a c + b law, (n_frf, n_lines), and b: a for each FRF, c for each line [unit squared], [-].

    Values far above what is expected of them count as if they were less, so that a mode that is missing in the fit
    does not pass for noise. FRFs have noise of their own in a colour, c, where the force gets weaker along the lines.

    Parameters
    ----------
    power : (n_frf, n_lines) array
        Power of what a fit leaves [unit squared].
    law : (n_frf, n_lines) array
        N times the variance by leakage [unit squared].
    level : (n_frf,) array
        Start of a [unit squared].
    """
    strong = law > 0.01 * law.max(axis=1, keepdims=True)
    a, b = level, float(np.median(power[strong] / law[strong])) / np.log(2.0) if strong.any() else 0.0
    colour = np.ones(power.shape[1])
    for _ in range(_COLOURS):
        colour = _colour(power, a, b * law)
        a, b = _scored(power, law / colour, colour, a, b)
    return a[:, None] * colour + b * law, b


def _scored(
    power: FloatArray, law: FloatArray, colour: FloatArray, a: FloatArray, b: float
) -> tuple[FloatArray, float]:
    """Return a and b by scoring from a start, with power and law in units of the colour."""
    power = power / colour
    guess = a[:, None] + b * law
    for _ in range(_ROUNDS):
        w = 1.0 / guess**2
        seen = np.minimum(power, _PEAK * guess)
        a = np.maximum(np.sum(w * (seen - b * law), axis=1) / w.sum(axis=1), _STEP * a)
        total = max(float(np.sum(w * law**2)), np.finfo(float).tiny)
        b = max(float(np.sum(w * law * (seen - a[:, None]))) / total, _STEP * b)
        guess = a[:, None] + b * law
    return a, b


def _colour(power: FloatArray, a: FloatArray, leakage: FloatArray) -> FloatArray:
    """Return how the FRFs' own noise varies along the lines, alike in all: (n_lines,), of geometric mean 1 [-].

    Medians over pieces and over neighbouring pieces do not see peaks that the fit lacks; pieces of leakage are
    passed over. One that chance explains is none.
    """
    n_frf, n_lines = power.shape
    window, pieces = window_length(n_lines), n_lines // _PIECE
    if n_lines < 2 * window:
        return np.ones(n_lines)
    cut = (n_frf, pieces, _PIECE)
    total = np.median(power[:, : pieces * _PIECE].reshape(cut), axis=2) / np.log(2.0)
    own = total - np.median(leakage[:, : pieces * _PIECE].reshape(cut), axis=2)
    valid = own > 0.5 * total
    known = np.flatnonzero(valid.any(axis=0))
    if len(known) < _AMONG:
        return np.ones(n_lines)
    logarithm = np.where(valid, np.log(np.where(valid, own, 1.0) / a[:, None]), 0.0)
    mean = logarithm.sum(axis=0)[known] / valid.sum(axis=0)[known]
    smooth = ndimage.median_filter(mean, _AMONG, mode="nearest")
    smooth -= smooth.mean()
    if np.mean(smooth**2) < _CHANCE / window:
        return np.ones(n_lines)
    return np.asarray(np.exp(np.interp(np.arange(n_lines), (known + 0.5) * _PIECE, smooth)))


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
