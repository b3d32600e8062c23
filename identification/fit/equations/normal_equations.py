"""Weighted normal equations of many FRFs at once."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, row_blocks

_RIDGE, _SINGULAR = 1e-15, 1e-10  # added to columns of unit length; the second where the first does not do
_MANY = (
    16  # rows of weights beyond which products of columns are formed once for all; at twice as many it pays
)
_STRETCH = 256  # lines whose products of columns stay in cache; twice as many take a tenth longer


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
        How far the noise fades over the record, w T, see :mod:`identification.fit.noise.window_shaped`; 0 if it
        is steady and the lines' errors are independent [-].
    unknowns : float
        Numbers beside one per FRF that the law of the noise took from what a fit leaves [-].
    """

    level: FloatArray
    lines: FloatArray
    fade: float = 0.0
    unknowns: float = 0.0

    @property
    def full(self) -> FloatArray:
        """Weight of every value, shape (n_frf, n_lines)."""
        return self.level[:, None] * self.lines


@dataclass(frozen=True, eq=False)
class NormalEquations:
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


@dataclass(frozen=True, eq=False)
class Data:
    """FRF values times weights: what all normal equations of the same data share.

    Parameters
    ----------
    weighted : (n_frf, 2 n_lines) array
        W y, real parts and then imaginary parts.
    power : (n_frf,) array
        y^H W y.
    weights : Weights
        One per value.
    """

    weighted: FloatArray
    power: FloatArray
    weights: Weights


def prepared(values: ComplexArray, weights: Weights) -> Data:
    """Multiply data by their weights.

    Parameters
    ----------
    values : (n_frf, n_lines) complex array
        The data.
    weights : Weights
        One per value.
    """
    n_frf, n = values.shape
    weighted, power = np.empty((n_frf, 2 * n)), np.empty(n_frf)
    lines = np.broadcast_to(weights.lines, values.shape)
    for rows in row_blocks(values.shape):
        real, imaginary = values.real[rows], values.imag[rows]
        np.multiply(real, lines[rows], out=weighted[rows, :n])
        np.multiply(imaginary, lines[rows], out=weighted[rows, n:])
        power[rows] = np.einsum("jn,jn->j", weighted[rows, :n], real)
        power[rows] += np.einsum("jn,jn->j", weighted[rows, n:], imaginary)
    return Data(weighted, power, weights)


def form(columns: ComplexArray, data: Data) -> NormalEquations:
    """Form the normal equations.

    Parameters
    ----------
    columns : (n_lines, n_columns) complex array
        The basis.
    data : Data
        The data, with their weights.
    """
    real = np.concatenate([columns.real, columns.imag], axis=0)
    return NormalEquations(products(real, data.weights.lines), data.weighted @ real, data.power)


def products(real: FloatArray, lines: FloatArray) -> FloatArray:
    """Return one weighted Gram matrix Re C^H W C per row of weights, shape (n_rows, n_columns, n_columns).

    Parameters
    ----------
    real : (2 n_lines, n_columns) array
        The basis C, real parts and then imaginary parts.
    lines : (n_rows, n_lines) array
        Weights.
    """
    if len(lines) > _MANY:
        return _products_of_many(real, lines)
    gram = np.empty((len(lines), real.shape[1], real.shape[1]))
    for j, row in enumerate(lines):
        if (row == row[0]).all():
            gram[j] = row[0] * (real.T @ real)
            continue
        root = np.sqrt(row)
        scaled = real * np.concatenate([root, root])[:, None]
        gram[j] = scaled.T @ scaled
    return gram


def _products_of_many(real: FloatArray, lines: FloatArray) -> FloatArray:
    """Return the same as one product of matrices: weights times the products of any two columns.

    Those are formed once for all rows of weights, over stretches of lines that stay in cache.
    """
    n = real.shape[1]
    total = np.zeros((len(lines), n * (n + 1) // 2))
    for part, pairs in _pairs(real):
        total += lines[:, part] @ pairs.T
    gram, upper = np.empty((len(lines), n, n)), np.triu_indices(n)
    gram[:, upper[0], upper[1]] = total
    gram[:, upper[1], upper[0]] = total
    return gram


def _pairs(real: FloatArray) -> Iterator[tuple[slice, FloatArray]]:
    """Yield stretches of lines and Re conj(c_a) c_b on them for all columns a <= b, (n_pairs, n_stretch)."""
    n, n_lines = real.shape[1], len(real) // 2
    both = np.ascontiguousarray(real.T).reshape(n, 2, n_lines)
    start = np.concatenate([[0], np.cumsum(np.arange(n, 0, -1))])
    pairs = np.empty((start[-1], min(_STRETCH, n_lines)))
    for first in range(0, n_lines, _STRETCH):
        stretch = both[:, :, first : first + _STRETCH]
        here = pairs[:, : stretch.shape[2]]
        for i in range(n):
            np.multiply(stretch[i, 0], stretch[i:, 0], out=here[start[i] : start[i + 1]])
            here[start[i] : start[i + 1]] += stretch[i, 1] * stretch[i:, 1]
        yield slice(first, first + here.shape[1]), here


def forms(real: FloatArray, half: FloatArray) -> FloatArray:
    """Return the squared length of each line's columns times a matrix, |c_l B_j|^2, shape (n_rows, n_lines).

    Parameters
    ----------
    real : (2 n_lines, n_columns) array
        The basis C, real parts and then imaginary parts.
    half : (n_rows, n_columns, m) array
        The matrices B.
    """
    n_lines, n = len(real) // 2, real.shape[1]
    result = np.empty((len(half), n_lines))
    if len(half) <= _MANY:
        for j, matrix in enumerate(half):
            turned = real @ matrix
            each = np.einsum("nk,nk->n", turned, turned)
            result[j] = each[:n_lines] + each[n_lines:]
        return result
    upper = np.triu_indices(n)
    square = np.matmul(half, half.transpose(0, 2, 1))[:, upper[0], upper[1]]
    square = np.where(upper[0] == upper[1], 1.0, 2.0) * square
    for part, pairs in _pairs(real):
        result[:, part] = square @ pairs
    return result


def scaled_eigen(gram: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return lengths of columns (n, k), and eigenvalues (n, k) and vectors (n, k, k) of products of unit columns.

    Parameters
    ----------
    gram : (n, k, k) array
        Products of the columns.
    """
    length, unit = _unit_columns(gram)
    values, vectors = np.linalg.eigh(unit)
    return length, values, vectors


def solve(gram: FloatArray, right: FloatArray) -> FloatArray:
    """Solve stacked normal equations, (n or 1, k, k) by (n, k, m), with columns of unit length.

    Columns that are the same to rounding, as those of two poles that fell together, share their unknown.
    """
    length, unit = _unit_columns(gram)
    scaled = right / length[:, :, None]
    try:
        solved = _solve_unit(unit, scaled, _RIDGE)
    except np.linalg.LinAlgError:
        solved = _solve_unit(unit, scaled, _SINGULAR)
    return np.asarray(solved / length[:, :, None])


def _unit_columns(gram: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the lengths of columns (n, k), and their products (n, k, k) as if all had the length 1."""
    length = np.sqrt(np.maximum(np.einsum("jkk->jk", gram), np.finfo(float).tiny))
    unit = gram / (length[:, :, None] * length[:, None, :])
    return length, unit


def _solve_unit(unit: FloatArray, right: FloatArray, ridge: float) -> FloatArray:
    firm = unit + ridge * np.eye(unit.shape[-1])
    if len(unit) > 1:
        return np.asarray(np.linalg.solve(firm, right))
    flat = np.moveaxis(right, 0, 1)
    solved = np.linalg.solve(firm[0], flat.reshape(len(flat), -1)).reshape(flat.shape)
    return np.asarray(np.moveaxis(solved, 1, 0))
