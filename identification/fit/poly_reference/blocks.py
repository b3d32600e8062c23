"""Products with 2 x 2 blocks: complex factors acting on (Re, Im) of many modes at once."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray


def rotations(values: ComplexArray) -> FloatArray:
    """Return multiplication by complex numbers as 2 x 2 blocks acting on (Re, Im), shape (..., 2, 2)."""
    a, b = values.real, values.imag
    return np.stack([np.stack([a, -b], axis=-1), np.stack([b, a], axis=-1)], axis=-2)


def paired(interleaved: FloatArray) -> ComplexArray:
    """Return complex numbers of (Re, Im) interleaved along the last axis."""
    return np.asarray(interleaved[..., 0::2] + 1j * interleaved[..., 1::2])


def times_blocks(matrix: FloatArray, blocks: FloatArray) -> FloatArray:
    """Return matrix times blockdiag(blocks), (..., k, 2 n) by (..., n, 2, 2)."""
    parts = matrix.reshape(*matrix.shape[:-1], matrix.shape[-1] // 2, 2, 1)
    wide = blocks[..., None, :, :, :]
    product = parts[..., 0, :] * wide[..., 0, :] + parts[..., 1, :] * wide[..., 1, :]
    return np.asarray(product.reshape(*product.shape[:-2], matrix.shape[-1]))


def blocks_times(blocks: FloatArray, matrix: FloatArray) -> FloatArray:
    """Return blockdiag(blocks)^T times matrix, (..., n, 2, 2) by (..., 2 n, q)."""
    parts = matrix.reshape(*matrix.shape[:-2], matrix.shape[-2] // 2, 2, 1, matrix.shape[-1])
    tall = blocks[..., None]
    product = tall[..., 0, :, :] * parts[..., 0, :, :] + tall[..., 1, :, :] * parts[..., 1, :, :]
    return np.asarray(product.reshape(*product.shape[:-3], *matrix.shape[-2:]))


def inverses(normal: FloatArray) -> FloatArray:
    """Return the inverse of each normal matrix, in unit columns and firm against rounding."""
    diagonal = np.einsum("jkk->jk", normal)
    largest = diagonal.max(axis=1, initial=np.finfo(float).tiny, keepdims=True)
    length = np.sqrt(np.maximum(diagonal, 1e-24 * largest))
    unit = normal / (length[:, :, None] * length[:, None, :]) + 1e-15 * np.eye(normal.shape[-1])
    try:
        inverse = np.linalg.inv(unit)
    except np.linalg.LinAlgError:
        inverse = np.linalg.inv(unit + 1e-10 * np.eye(normal.shape[-1]))
    return np.asarray(inverse / (length[:, :, None] * length[:, None, :]))
