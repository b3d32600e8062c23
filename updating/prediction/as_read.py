"""Modes as a test reads them: turned to be real, at the level of the measurement chain, at the force of the hits."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from updating.models.state import State
from updating.test_data.chain import MeasurementChain
from updating.test_data.chain_phase import chain_phases


def level_of(read: MeasurementChain, slowing: FloatArray) -> FloatArray:
    """Return what modes slowed by a layer (n_modes,) are read times, (n_frf, n_modes) [-].

    What a layer carries along is modal mass.
    """
    return np.asarray(read.gain[:, None] * np.where(read.hit[:, None] < 0, slowing, slowing**2))


def made_real(product: ComplexArray, chains: IntArray | None) -> tuple[FloatArray, FloatArray | None]:
    """Return complex constants (n_frf, n_modes) turned to the real axis, and by how much in each chain [rad]."""
    if not len(product):
        return np.real(product), None
    chains = np.zeros(len(product), dtype=np.int64) if chains is None else chains
    phase = chain_phases(product, chains)
    return np.real(product * np.exp(-1j * phase[chains])), phase


def turned(modes: ComplexArray, undamped: FloatArray, rows: FloatArray) -> ComplexArray:
    """Return complex modes (r, n_modes), each turned to be as real as it can be at points with rows (n_points, r).

    Their signs are those of the undamped ones, whose derivatives are theirs.
    """
    seen, before = rows[:, : len(modes)] @ modes, rows[:, : len(modes)] @ undamped
    turned = modes * np.exp(-0.5j * np.angle(np.sum(seen**2, axis=0)))
    same = np.sum(np.real(rows[:, : len(modes)] @ turned) * before, axis=0)
    return np.asarray(turned * np.where(same < 0, -1.0, 1.0))


def gained_per_newton(state: State, values: FloatArray, vectors: FloatArray) -> FloatArray:
    """Return d ln f per newton of modes (r, n_modes), by the strain energy in what stiffens with the force [1/N]."""
    total = np.zeros(len(values))
    for matrix in state.per_newton:
        size = len(vectors)
        total += np.sum(vectors * (matrix[:size, :size] @ vectors), axis=0)
    return np.asarray(total / (2 * np.maximum(values, 1e-12)))


def constants_change(shape: FloatArray, changes: FloatArray, read: MeasurementChain) -> FloatArray:
    """Return what changes (k, n_points, n_modes) of the shapes change the constants by, (n_frf, n_modes, k)."""
    left, right = shape[read.seen], shape[read.hit]
    d_left, d_right = changes[:, read.seen], changes[:, read.hit]
    whole = np.where(read.hit[:, None] < 0, d_left, d_left * right + left * d_right)
    return np.asarray(np.moveaxis(whole, 0, -1))
