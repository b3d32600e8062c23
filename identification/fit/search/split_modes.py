"""Poles that are one mode whose frequency is another in every FRF.

A sensor or a hammer that roves, or a temperature that rises, moves the frequencies from FRF to FRF. Two or
three common poles then fit the difference nearly as well as two or three modes would. The difference is detected by
what explains the FRFs: common poles, or one pole for each FRF alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray, squared
from acquisition.form import FORMS
from acquisition.frfs.frf import FrfSet
from identification.fit.equations.normal_equations import Weights

_CLOSE = 2.5  # half-power half-widths between poles that may be one mode
_UNEQUAL = 8.0
"""Ratio of half-widths beyond which two poles are not parts of one mode [-]: drift spreads a mode over poles of
about its own width. Half of it would part the narrow and the wide half of a mode that is spread unevenly."""
_REACH = 6.0  # half-widths about them over which the FRFs are compared
_STEPS = 10
_SETTLED = 1e-4  # part of the misfit by which a step must lower it for another
_DOUBT = 3.0  # standard deviations of chi-squared by which one pole each may fit worse
_LEAST_LINES = 6
_RATIO_OF_TWO = 20.0
"""How many times the misfit of two poles one pole for each FRF must leave where two are two modes though their shapes
are those of a split one [-]. Modes that drift, smear or do not decay as modes do leave up to a dozen times it, pairs of
modes a fifth to one half-width from each other 25 to 500 times, both in FRFs whose peaks stand 50 dB and more above
their noise. Doubled: pairs nearer to the noise are taken for one."""


def clusters(poles: ComplexArray, disagreement: BoolArray | None = None) -> list[IntArray]:
    """Return groups of poles that are linked by less than 2.5 half-widths, two or more in each.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Poles [rad/s].
    disagreement : (n_modes, n_modes) bool array, optional
        Pairs known to be two modes.
    """
    width = np.maximum(np.abs(poles.real)[:, None], np.abs(poles.real)[None, :])
    linked = (np.abs(poles[:, None] - poles[None, :]) < _CLOSE * width) & alike_wide(poles)
    if disagreement is not None:
        linked &= ~disagreement
    reached = linked
    for _ in range(len(poles)):
        wider = (reached.astype(np.int64) @ linked) > 0
        if np.array_equal(wider, reached):
            break
        reached = wider
    first = reached.argmax(axis=1)
    groups = [np.flatnonzero(first == i) for i in np.unique(first)]
    return [g for g in groups if len(g) > 1]


def alike_wide(poles: ComplexArray) -> BoolArray:
    """Return which pairs of poles are about as wide, shape (n_modes, n_modes): parts of one mode are."""
    width = np.abs(poles.real)
    wider = np.maximum(width[:, None], width[None, :])
    return np.asarray(wider < _UNEQUAL * np.minimum(width[:, None], width[None, :]))


@dataclass(frozen=True)
class Misfits:
    """Weighted misfits about a group of poles: of the poles, common to all FRFs, and of one free pole for each FRF.

    Parameters
    ----------
    common, each : float
        The misfits [-].
    size : int
        Number of complex values that they are of.
    """

    common: float
    each: float
    size: int

    @property
    def one_mode(self) -> bool:
        """Whether one free pole for every FRF explains it as well as the common poles."""
        return bool(self.each < self.common + _DOUBT * np.sqrt(2.0 * self.size))

    @property
    def two_modes(self) -> bool:
        """Whether the common poles explain what no shift from FRF to FRF can, be their shapes as alike as may be."""
        return self.each > _RATIO_OF_TWO * self.common


def misfits(
    frfs: FrfSet,
    poles: ComplexArray,
    residues: ComplexArray,
    residual: ComplexArray,
    weights: Weights,
    group: IntArray,
) -> Misfits | None:
    """Return the misfits about a group of poles, None where there are too few lines to tell.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    poles : (n_modes,) complex array
        Poles of the fit [rad/s].
    residues : (n_frf, n_modes) complex array
        Residues of the receptance [m/(N s)].
    residual : (n_frf, n_lines) complex array
        Data minus the whole fit [unit of the FRFs].
    weights : Weights
        Reciprocal noise variances.
    group : (n,) int array
        Which poles.
    """
    own = poles[group]
    reach = _REACH * np.abs(own.real).max() + frfs.decay
    omega = 2 * np.pi * frfs.frequency
    near = (omega > own.imag.min() - reach) & (omega < own.imag.max() + reach)
    if near.sum() < _LEAST_LINES:
        return None
    s = frfs.laplace[near]
    front = s ** FORMS.index(frfs.form)
    both = np.einsum("jr,rl->jl", residues[:, group], front / (s[None, :] - own[:, None]))
    weight = (
        weights.full[:, near] if len(weights.lines) > 1 else weights.level[:, None] * weights.lines[:, near]
    )
    target = both + residual[:, near]
    common = np.sum(weight * squared(residual[:, near]))
    energy = np.abs(residues[:, group]) ** 2
    mean = np.sum(energy * own, axis=1) / np.maximum(energy.sum(axis=1), np.finfo(float).tiny)
    starts = [np.broadcast_to(p, mean.shape) for p in own] + [mean]
    each = np.min([_single(s, front, target, weight, start, frfs.decay) for start in starts], axis=0)
    return Misfits(float(common), float(each.sum()), target.size)


def _single(
    s: ComplexArray,
    front: ComplexArray,
    target: ComplexArray,
    weight: FloatArray,
    start: ComplexArray,
    decay: float,
) -> FloatArray:
    """Return the weighted misfit of one pole and a constant fitted to each FRF, shape (n_frf,).

    With columns u = s^q / (s - p) and u / (s - p) the second factor over the first is the step of p.
    """
    poles, limit = np.array(start), np.abs(start.real)
    best, power = np.full(len(target), np.inf), np.sum(weight * squared(target), axis=1)
    for _ in range(_STEPS):
        inverse = 1.0 / (s - poles[:, None])
        u = front * inverse
        columns = np.stack([u, np.broadcast_to(front / front[0], u.shape), u * inverse], axis=1)
        two, factors = _solved(columns, target, weight, power)
        gain = float(np.sum(best) - np.sum(np.minimum(best, two)))
        best = np.minimum(best, two)
        if gain < _SETTLED * float(best.sum()):
            break
        step = factors[:, 2] / np.where(factors[:, 0] == 0, 1.0, factors[:, 0])
        step *= limit / np.maximum(np.abs(step), limit)
        moved = poles + step
        poles = np.where(moved.real < decay, moved, 0.5 * (poles.real + decay) + 1j * moved.imag)
    return best


def _solved(
    columns: ComplexArray, target: ComplexArray, weight: FloatArray, power: FloatArray
) -> tuple[FloatArray, ComplexArray]:
    """Solve each FRF's least squares; return its weighted misfit by the first two columns, and its factors by all."""
    weighted = columns.conj() * weight[:, None, :]
    gram = np.matmul(weighted, columns.transpose(0, 2, 1))
    right = np.matmul(weighted, target[:, :, None])[:, :, 0]
    length = np.maximum(np.sqrt(np.einsum("jkk->jk", gram).real), np.finfo(float).tiny)
    firm = gram / (length[:, :, None] * length[:, None, :]) + 1e-13 * np.eye(gram.shape[1])
    unit = right / length
    two = np.linalg.solve(firm[:, :2, :2], unit[:, :2, None])[:, :, 0]
    factors = np.linalg.solve(firm, unit[:, :, None])[:, :, 0]
    explained = np.sum((two.conj() * unit[:, :2]).real, axis=1)
    return np.maximum(power - explained, 0.0), np.asarray(factors / length)
