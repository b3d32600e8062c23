"""Mode shapes from modal constants, mass-normalised where a drive point allows it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.dof import Dof
from acquisition.frf import FrfSet
from identification.arrangement import Arrangement, arrange


@dataclass(frozen=True, eq=False)
class Shapes:
    """Mode shapes of the measured degrees of freedom.

    Parameters
    ----------
    dofs : tuple of Dof
        Degrees of freedom, directions positive.
    shapes : (n_dofs, n_modes) complex array
        Mode shapes [kg^-1/2 where scaled, else 1/kg: the constants of the reference].
    sigma : (n_dofs, n_modes) array
        Standard deviation of the real part of each component [as ``shapes``].
    scaled : bool
        Whether they are mass-normalised.
    warnings : tuple of str
        What stood in the way.
    """

    dofs: tuple[Dof, ...]
    shapes: ComplexArray
    sigma: FloatArray
    scaled: bool
    warnings: tuple[str, ...]


def mode_shapes(frfs: FrfSet, constants: ComplexArray, sigma: FloatArray) -> Shapes:
    """Turn modal constants A_ij = phi_i phi_j into shapes.

    With several references the constants of one mode form a matrix of rank one, whose weighted least-squares
    factors are the shape and the participations. A drive point (response and reference at one node and axis)
    gives phi_d^2 = A_dd and with it the scale; all drive points together give it where there are several.
    The phase is turned so that the shape is as real as it can be.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs the constants belong to.
    constants : (n_frf, n_modes) complex array
        Modal constants, signs of directions applied [1/kg].
    sigma : (n_frf, n_modes) array
        Their standard deviations [1/kg].

    Returns
    -------
    Shapes
        The shapes, and whether they are mass-normalised.
    """
    plan = arrange(frfs)
    row = np.where(plan.index >= 0, plan.index, 0)
    measured = (plan.index >= 0)[:, :, None]
    values, spread = constants[row], np.maximum(sigma[row], 1e-300)
    weight = np.where(measured, 1.0 / spread**2, 0.0)
    long, short, long_variance = _rank_one(values, weight)
    drive = _drive_pairs(plan)
    if len(drive) == 0:
        turned, _ = _turned(long)
        note = (
            f"no drive point: none of {len(plan.rows)} points was both hit and measured at one node and "
            "axis, so the mode shapes are not mass-normalised; measure one drive point to scale them"
        )
        return Shapes(plan.rows, turned, np.sqrt(long_variance), False, (note,))
    return _scaled(plan, (long, short, long_variance), (constants, sigma), drive)


def _rank_one(values: ComplexArray, weight: FloatArray) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """Return factors with values ~ long short^T of every mode, the strongest column of ``short`` being 1.

    Alternating weighted least squares over (n_rows, n_columns, n_modes).
    """
    energy = np.sum(weight * np.abs(values) ** 2, axis=0)
    lead = energy.argmax(axis=0)
    modes = np.arange(values.shape[2])
    short = np.zeros(values.shape[1:], complex)
    short[lead, modes] = 1.0
    for _ in range(1 if values.shape[1] == 1 else 30):
        below = np.maximum(np.einsum("ijm,jm->im", weight, np.abs(short) ** 2), 1e-300)
        long = np.einsum("ijm,jm->im", weight * values, short.conj()) / below
        above = np.maximum(np.einsum("ijm,im->jm", weight, np.abs(long) ** 2), 1e-300)
        short = np.einsum("ijm,im->jm", weight * values, long.conj()) / above
        short = short / short[lead, modes]
    below = np.maximum(np.einsum("ijm,jm->im", weight, np.abs(short) ** 2), 1e-300)
    long = np.einsum("ijm,jm->im", weight * values, short.conj()) / below
    return long, short, np.asarray(1.0 / below)


def _drive_pairs(plan: Arrangement) -> IntArray:
    """Return (row, column) of every measured drive point, shape (n, 2)."""
    place = {d: i for i, d in enumerate(plan.rows)}
    pairs = [(place[d], j) for j, d in enumerate(plan.columns) if d in place]
    return np.array([(i, j) for i, j in pairs if plan.index[i, j] >= 0], dtype=np.int64).reshape(-1, 2)


def _turned(shapes: ComplexArray) -> tuple[ComplexArray, ComplexArray]:
    """Turn each shape to be as real as possible, its largest component positive; return it and the factor."""
    phase = np.exp(-0.5j * np.angle(np.sum(shapes**2, axis=0)))
    turned = shapes * phase
    largest = turned[np.abs(turned).argmax(axis=0), np.arange(shapes.shape[1])]
    flip = np.where(largest.real < 0, -1.0, 1.0)
    return turned * flip, phase * flip


def _scaled(
    plan: Arrangement,
    factors: tuple[ComplexArray, ComplexArray, FloatArray],
    constants: tuple[ComplexArray, FloatArray],
    drive: IntArray,
) -> Shapes:
    """Return phi = c long with c^2 from the drive points, where A_dd = long_d short_d = c^2 long_d^2."""
    long, short, variance = factors
    frf = plan.index[drive[:, 0], drive[:, 1]]
    values, spread = constants[0][frf], np.maximum(constants[1][frf], 1e-300)
    here = long[drive[:, 0]]
    power = np.maximum(np.sum(np.abs(here) ** 4 / spread**2, axis=0), 1e-300)
    square = np.sum((here**2).conj() * here * short[drive[:, 1]] / spread**2, axis=0) / power
    certainty = np.abs(square) * np.sqrt(power)
    scale = np.sqrt(np.maximum(np.abs(square), 1.0 / np.sqrt(power)))
    shapes, _ = _turned(long * scale)
    relative = 0.5 / np.maximum(certainty, 1.0)
    own = variance * scale**2
    if len(drive) == 1:
        own[drive[0, 0]] = 0.0
    sigma = np.sqrt(own + (np.abs(shapes) * relative) ** 2)
    return Shapes(plan.rows, shapes, sigma, True, _drive_notes(values, spread, certainty, plan, drive))


def _drive_notes(
    values: ComplexArray, spread: FloatArray, certainty: FloatArray, plan: Arrangement, drive: IntArray
) -> tuple[str, ...]:
    notes = []
    names = ", ".join(str(plan.rows[i]) for i in drive[:, 0])
    weak = np.flatnonzero(certainty < 5.0) + 1
    if len(weak):
        notes.append(
            f"mode(s) {_listed(weak)} hardly move at the drive point {names}: their scale is uncertain"
        )
    wrong = np.flatnonzero((values.real < -5.0 * spread).any(axis=0) & (certainty >= 5.0)) + 1
    if len(wrong):
        notes.append(
            f"the drive point {names} has a negative modal constant in mode(s) {_listed(wrong)}: check the "
            "direction signs of hammer and sensor"
        )
    return tuple(notes)


def _listed(numbers: IntArray) -> str:
    return ", ".join(str(int(n)) for n in numbers)
