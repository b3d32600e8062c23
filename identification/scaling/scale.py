"""Mode shapes from modal constants, mass-normalised where a drive point allows it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from identification.arrangement import Arrangement, arrange
from identification.scaling import notes
from identification.scaling.factors import Factors, rank_one, symmetric
from identification.scaling.shapes import Shapes, turned

_STEPS = 8
_CERTAIN = 5.0
_FINEST = 1e-12
_APART = 2.0
"""Modes further apart than so many sums of their half bandwidths are coupled by no damping [-]. A phase of 45 degrees
takes one."""


def mode_shapes(
    frfs: FrfSet, constants: ComplexArray, sigma: FloatArray, *, poles: ComplexArray | None = None
) -> Shapes:
    """Turn modal constants A_ij = phi_i phi_j into shapes.

    The constants of one mode form a matrix of rank one, whose weighted least-squares factors are the shape
    and the participations. A drive point (response and reference at one node and axis, whichever way the
    transducers point) gives phi_d^2 = A_dd and with it the scale. Several are weighted by their variances, and
    so is what references say of one another: A_12 A_13 / A_23 = phi_1^2. The phase is turned so that the
    shape is as real as it can be.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs the constants belong to.
    constants : (n_frf, n_modes) complex array
        Modal constants, signs of directions applied [1/kg].
    sigma : (n_frf, n_modes) array
        Standard deviations of their real and of their imaginary parts [1/kg].
    poles : (n_modes,) complex array, optional
        Of the modes: overlapping ones do not say whether a drive point is one; left out, none overlap [rad/s].

    Returns
    -------
    Shapes
        The shapes, and whether they are mass-normalised.
    """
    plan, lost = _tied_together(arrange(frfs))
    row = np.where(plan.index >= 0, plan.index, 0)
    measured = (plan.index >= 0)[:, :, None]
    size = np.abs(np.where(measured, constants[row], 0)).max(axis=(0, 1))
    size = np.where(size > 0, size, 1.0)
    spread = np.maximum(sigma[row] / size, _FINEST)
    values, weight = constants[row] / size, np.where(measured, 1.0 / spread**2, 0.0)
    start = rank_one(values, weight)
    place = {d: j for j, d in enumerate(plan.columns)}
    column = np.array([place.get(d, -1) for d in plan.rows], dtype=np.int64)
    alone = np.ones(constants.shape[1], dtype=bool) if poles is None else _alone(poles)
    about = notes.about_drive_points(plan, (constants, sigma), column, alone)
    false = notes.contradicted(plan, (constants, sigma), column, alone)
    column[false] = -1
    if np.all(column < 0):
        factors = _disagreement(values, weight, start, bonds=1)
        stated = (*lost, *about, *(() if len(false) else (notes.no_drive_point(frfs),)))
        return _shapes(plan, _times(factors, size), scaled=False, warnings=stated)
    scaled, certainty = _scaled(start, weight, column)
    polished = symmetric(values, weight, scaled, column, steps=_STEPS if len(plan.columns) > 1 else 0)
    factors = _where(_sane(polished, scaled) & (certainty >= _CERTAIN), polished, scaled)
    factors = _disagreement(values, weight, factors, bonds=int(np.sum(column >= 0)))
    stated = (*lost, *about, *notes.about_scale(plan, column, certainty))
    return _shapes(plan, _times(factors, np.sqrt(size)), scaled=True, warnings=stated)


def _alone(poles: ComplexArray) -> BoolArray:
    """Return which modes overlap with no other."""
    apart = np.abs(poles.imag[:, None] - poles.imag)
    np.fill_diagonal(apart, np.inf)
    return np.asarray((apart > -_APART * (poles.real[:, None] + poles.real)).all(axis=1))


def _tied_together(plan: Arrangement) -> tuple[Arrangement, tuple[str, ...]]:
    """Leave out points that no FRF ties to the others: relative scale and sign are unknown."""
    measured = plan.index >= 0
    reached = measured[:, [int(measured.sum(axis=0).argmax())]].any(axis=1)
    for _ in range(measured.shape[1]):
        reached = measured[:, measured[reached].any(axis=0)].any(axis=1)
    if reached.all():
        return plan, ()
    columns = measured[reached].any(axis=0)
    gone = [str(plan.rows[i]) for i in np.flatnonzero(~reached)]
    kept = replace(
        plan,
        rows=tuple(plan.rows[i] for i in np.flatnonzero(reached)),
        columns=tuple(plan.columns[j] for j in np.flatnonzero(columns)),
        index=plan.index[np.ix_(reached, columns)],
    )
    return kept, (notes.not_tied(gone),)


def _scaled(start: Factors, weight: FloatArray, column: IntArray) -> tuple[Factors, FloatArray]:
    """Return phi = c long with c^2 long_d = short_d, and c^2 over its standard deviation [-].

    Where c^2 is below its standard deviation, that takes its place.
    """
    tied = np.flatnonzero(column >= 0)
    here, there = start.long[tied], start.short[column[tied]]
    seen = np.einsum("im,im->im", weight[tied, column[tied]], np.abs(here) ** 2)
    above = np.einsum("ijm,im->jm", weight, np.abs(start.long) ** 2)[column[tied]]
    seen = np.where(seen > 0, seen, above)
    power = np.maximum(np.sum(seen * np.abs(here) ** 2, axis=0), 1e-60)
    square = np.sum(seen * here.conj() * there, axis=0) / power
    certainty = np.abs(square) * np.sqrt(power)
    floor = np.maximum(np.abs(square), 1.0 / np.sqrt(power))
    scale = np.sqrt(floor * np.exp(1j * np.angle(square)))
    long = start.long * scale
    own = start.own * floor
    common = np.zeros(start.common.shape, complex)
    common[:, 0] = long * 0.5 / np.maximum(certainty, 1.0)
    if len(tied) == 1:
        own[tied[0]] = 0.0
    return Factors(long, start.short / scale, own, common), certainty


def _sane(polished: Factors, start: Factors) -> BoolArray:
    """Return for which modes the Gauss-Newton steps stayed near their start."""
    moved = np.linalg.norm(polished.long - start.long, axis=0)
    return np.asarray(np.isfinite(moved) & (moved < np.linalg.norm(start.long, axis=0)))


def _where(choose: BoolArray, first: Factors, second: Factors) -> Factors:
    names = ("long", "short", "own", "common")
    return Factors(**{n: np.where(choose, getattr(first, n), getattr(second, n)) for n in names})


def _disagreement(values: ComplexArray, weight: FloatArray, factors: Factors, *, bonds: int) -> Factors:
    """Inflate the covariance by the misfit of constants that fit no single shape: the square of Birge's ratio.

    Only what exceeds three standard deviations of chi-squared counts. Rows and columns have ``bonds`` unknowns
    too many between them.
    """
    freedom = np.count_nonzero(weight[:, :, 0]) - values.shape[0] - values.shape[1] + bonds
    if freedom < 1:
        return factors
    misfit = weight * np.abs(values - factors.long[:, None] * factors.short) ** 2
    ratio = np.sum(misfit, axis=(0, 1)) / (2.0 * freedom)
    ratio = np.where(ratio > 1.0 + 3.0 / np.sqrt(freedom), ratio, 1.0)
    return replace(factors, own=factors.own * ratio, common=factors.common * np.sqrt(ratio))


def _times(factors: Factors, size: FloatArray) -> Factors:
    own, common = factors.own * size**2, factors.common * size
    return Factors(factors.long * size, factors.short, own, common)


def _shapes(plan: Arrangement, factors: Factors, *, scaled: bool, warnings: tuple[str, ...]) -> Shapes:
    shapes, angle = turned(factors.long)
    sigma = np.sqrt(factors.own + np.sum(np.abs(factors.common) ** 2, axis=1))
    common = factors.common * np.exp(1j * angle)
    return Shapes(
        dofs=plan.rows,
        shapes=shapes,
        sigma=sigma,
        scaled=scaled,
        warnings=warnings,
        own=factors.own,
        common=common,
        phase=angle,
    )
