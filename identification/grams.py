"""Weighted normal equations of many FRFs at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray

_RIDGE, _SINGULAR = 1e-15, 1e-10  # added to columns of unit length; the second where the first does not do


@dataclass(frozen=True, eq=False)
class Weights:
    """Reciprocal noise variances of the FRF values.

    Parameters
    ----------
    level : (n_frf,) array
        Factor of each FRF [1 / unit of the FRFs squared].
    lines : (n_frf or 1, n_lines) array
        Factor of each line; one row if all FRFs share it [-].
    fade : float
        How far the noise fades over the record, w T, see :mod:`identification.fading`; 0 if it is steady and
        the lines' errors are independent [-].
    """

    level: FloatArray
    lines: FloatArray
    fade: float = 0.0

    @property
    def full(self) -> FloatArray:
        """Weight of every value, shape (n_frf, n_lines)."""
        return self.level[:, None] * self.lines


@dataclass(frozen=True, eq=False)
class Grams:
    """Products of columns with columns and with data, real parts, weighted by line (not by FRF level).

    Parameters
    ----------
    gram : (n_frf or 1, n_columns, n_columns) array
        Re C^H W C.
    cross : (n_frf, n_columns) array
        Re C^H W y.
    power : (n_frf,) array
        y^H W y.
    """

    gram: FloatArray
    cross: FloatArray
    power: FloatArray


def form(columns: ComplexArray, values: ComplexArray, weights: Weights) -> Grams:
    """Form the normal equations.

    Parameters
    ----------
    columns : (n_lines, n_columns) complex array
        The basis.
    values : (n_frf, n_lines) complex array
        The data.
    weights : Weights
        One per value.
    """
    root = np.sqrt(weights.lines)
    real = np.concatenate([columns.real, columns.imag], axis=0)
    weighted = np.concatenate([(values * root).real, (values * root).imag], axis=1)
    both = np.concatenate([root, root], axis=1)
    power = np.einsum("jn,jn->j", weighted, weighted)
    cross = (weighted * both) @ real
    return Grams(_products(real, both), cross, power)


def _products(real: FloatArray, root: FloatArray) -> FloatArray:
    """Return one weighted Gram matrix per row of ``root``, in chunks that stay in cache."""
    gram = np.empty((len(root), real.shape[1], real.shape[1]))
    for j, row in enumerate(root):
        scaled = real * row[:, None]
        gram[j] = scaled.T @ scaled
    return gram


def solve(gram: FloatArray, right: FloatArray) -> FloatArray:
    """Solve stacked normal equations, (n or 1, k, k) by (n, k, m), with columns of unit length.

    Columns that are the same to rounding, as those of two poles that fell together, share their unknown.
    """
    length = np.sqrt(np.maximum(np.einsum("jkk->jk", gram), np.finfo(float).tiny))
    unit = gram / (length[:, :, None] * length[:, None, :])
    scaled = right / length[:, :, None]
    try:
        solved = _solve_unit(unit, scaled, _RIDGE)
    except np.linalg.LinAlgError:
        solved = _solve_unit(unit, scaled, _SINGULAR)
    return np.asarray(solved / length[:, :, None])


def _solve_unit(unit: FloatArray, right: FloatArray, ridge: float) -> FloatArray:
    firm = unit + ridge * np.eye(unit.shape[-1])
    if len(unit) > 1:
        return np.asarray(np.linalg.solve(firm, right))
    flat = np.moveaxis(right, 0, 1)
    solved = np.linalg.solve(firm[0], flat.reshape(len(flat), -1)).reshape(flat.shape)
    return np.asarray(np.moveaxis(solved, 1, 0))
