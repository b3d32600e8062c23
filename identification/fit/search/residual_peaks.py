"""Modes the stabilisation chart missed: where in the band a fit leaves more than noise."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, IntArray
from acquisition.frfs.frf import FrfSet
from identification.fit.equations.normal_equations import Weights
from identification.fit.noise.levels import local_mean
from identification.fit.poly_reference import Sorted
from identification.mac import mpc

_WIDTHS = (1, 3, 9, 27, 81)
_EXCESS = 6.0
_REAL = 0.7
FEW = 4
_TOGETHER = 0.6
_SAME = 0.25
_PURE, _ALIKE = 0.9, 0.8
_FILLINGS = 40


def trial_poles(
    frfs: FrfSet, residual: ComplexArray, weights: Weights, blocked: tuple[tuple[float, float], ...]
) -> ComplexArray:
    """Return poles about the most conspicuous peak of a residual, none if there is no peak [rad/s].

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    residual : (n_frf, n_lines) complex array
        Data minus model [unit of the FRFs].
    weights : Weights
        Reciprocal noise variances [1 / unit squared].
    blocked : tuple of (float, float)
        Stretches of the band not to look at again [Hz].
    """
    n_frf, n_lines = residual.shape
    power = np.sum(weights.full * np.abs(residual) ** 2, axis=0, keepdims=True)
    free = np.ones(n_lines, dtype=bool)
    for low, high in blocked:
        free &= (frfs.frequency < low) | (frfs.frequency > high)
    widths = [w for w in _WIDTHS if w <= max(1, n_lines // 8)]
    excess = np.concatenate([(local_mean(power, w) - n_frf) * np.sqrt(w / n_frf) for w in widths])
    edge = np.minimum(np.arange(n_lines), np.arange(n_lines)[::-1])
    central = edge[None, :] > np.array(widths)[:, None]  # a rise towards an edge is a flank, not a peak
    excess = np.where(free[None, :] & central, excess, -np.inf)
    row, line = np.unravel_index(int(excess.argmax()), excess.shape)
    if not excess[row, line] > _EXCESS:
        return np.zeros(0, complex)
    spread = widths[int(row)] * frfs.df
    centre = float(frfs.frequency[line])
    offset, width = np.meshgrid(np.array([-1.0, -0.5, 0.0, 0.5, 1.0]), np.array([0.1, 0.25, 0.5, 1.0, 2.0]))
    damped = 2j * np.pi * (centre + offset * spread) - np.pi * width * spread
    damped = damped.ravel()
    low, high = 2 * np.pi * frfs.frequency[0], 2 * np.pi * frfs.frequency[-1]
    return np.asarray(damped[(damped.imag >= low) & (damped.imag <= high)])


def split_mode_pairs(
    poles: ComplexArray, residues: ComplexArray, places: Sorted | None = None
) -> list[IntArray]:
    """Return pairs of poles that may be the halves of one mode, the nearest first.

    FRFs measured one after the other do not agree to the last digit on a frequency; a second pole beside
    the first then fits the difference. Two modes have shapes whose components lie on a line and that differ;
    the halves of one mode do not lie on a line, or, under one half-power half-width apart, move together
    at all points. Under a quarter of that half-width a drift from FRF to FRF and a second mode look alike by
    their shapes. Fewer than four FRFs cannot tell, and poles that near are then taken for halves.
    With several references two modes also differ in both their shapes and their participations, whatever
    their distance; the halves of one do not, since what drifts does so from response to response, from
    reference to reference, or from FRF to FRF.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Poles of the fit [rad/s].
    residues : (n_frf, n_modes) complex array
        Residues [m/(N s)].
    places : Sorted, optional
        Where each FRF stands in the matrix of responses by references, where there are several.
    """
    if len(poles) < 2:
        return []
    width = np.maximum(np.abs(poles.real)[:, None], np.abs(poles.real)[None, :])
    distance = np.abs(poles[:, None] - poles[None, :]) / width
    straight, size = mpc(residues), np.abs(residues)
    together = np.abs(residues.conj().T @ residues) / np.maximum(size.T @ size, np.finfo(float).tiny)
    crooked = np.minimum(straight[:, None], straight[None, :]) < _REAL
    if len(residues) < FEW:
        suspected = distance < 1.0
    else:
        suspected = (
            (distance < 3.0) & crooked | (distance < 1.0) & (together > _TOGETHER) | (distance < _SAME)
        )
    if places is not None and suspected.any():
        suspected &= ~two_by_references(residues, places)
    first, second = np.nonzero(np.triu(suspected, 1))
    order = np.argsort(distance[first, second], kind="stable")
    return [np.array([first[i], second[i]]) for i in order]


def two_by_references(residues: ComplexArray, places: Sorted) -> BoolArray:
    """Return which pairs differ in shape and in participation, both residues being of rank one."""
    table = np.zeros((residues.shape[1], *places.shape), complex)
    table[:, places.row, places.column] = (residues * places.sign[:, None]).T
    measured = np.zeros(places.shape, dtype=bool)
    measured[places.row, places.column] = True
    left, values, right = np.linalg.svd(table, full_matrices=False)
    for _ in range(0 if measured.all() else _FILLINGS):  # what was not measured is what rank one has there
        filled = values[:, :1, None] * left[:, :, :1] * right[:, :1]
        left, values, right = np.linalg.svd(np.where(measured, table, filled), full_matrices=False)
    pure = values[:, 0] ** 2 > _PURE * np.sum(values**2, axis=1)
    shapes, shares = left[:, :, 0], right[:, 0]
    alike = np.abs(shapes.conj() @ shapes.T) ** 2, np.abs(shares.conj() @ shares.T) ** 2
    return np.asarray(pure[:, None] & pure[None, :] & (np.maximum(*alike) < _ALIKE))
