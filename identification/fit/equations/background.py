"""What modes outside the band leave inside it: poles beyond its edges and more residual terms."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.frfs.frf import FrfSet
from identification.fit.equations import basis, normal_equations
from identification.fit.equations.line_selection import selected_lines

_STEPS = np.array([0.003, 0.01, 0.02, 0.04, 0.07, 0.11, 0.16, 0.22, 0.3, 0.4, 0.55, 0.75])
_DAMPING = 0.004


def trial_poles(band: tuple[float, float]) -> ComplexArray:
    """Return lightly damped poles at growing distances outside the band [rad/s]."""
    width = band[1] - band[0]
    frequency = np.concatenate([band[0] - width * _STEPS, band[1] + width * _STEPS])
    frequency = frequency[frequency > 0.02 * band[1]]
    return np.asarray(2 * np.pi * frequency * (1j - _DAMPING))


def gains(
    frfs: FrfSet,
    poles: ComplexArray,
    powers: tuple[int, ...],
    weights: normal_equations.Weights,
    trials: ComplexArray,
) -> FloatArray:
    """Return by how much each trial pole alone would lower the weighted misfit, shape (n_trials,) [-].

    Colours that differ between FRFs are replaced by their mean: this is a search, not the fit.
    """
    shared = normal_equations.Weights(weights.level, weights.lines.mean(axis=0, keepdims=True))
    lines, shared = selected_lines(frfs, np.append(poles, trials), shared)
    columns = basis.build(lines.axis, poles, powers).linear
    extra = basis.build(lines.axis, trials, ()).modes
    k = columns.shape[1]
    products = normal_equations.form(
        np.hstack([columns, extra]), normal_equations.prepared(lines.values, shared)
    )
    g = products.gram
    follow = normal_equations.solve(g[:, :k, :k], g[:, :k, k:])[0]
    left = products.cross[:, k:] - products.cross[:, :k] @ follow
    projected = g[0, k:, k:] - g[0, :k, k:].T @ follow
    blocks = np.stack([projected[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] for i in range(len(trials))])
    pairs = left.reshape(len(left), len(trials), 2)
    solved = np.einsum("tab,jtb->jta", np.linalg.pinv(blocks, hermitian=True), pairs)
    return np.asarray(np.einsum("j,jta,jta->t", shared.level, pairs, solved))


def term_ladder(band: tuple[float, float]) -> tuple[tuple[int, ...], ...]:
    """Return sets of residual terms of growing size; low powers only where the band is clear of zero."""
    if band[0] > 0.1 * band[1]:
        return ((-2, 0), (-3, -2, -1, 0, 1), (-4, -3, -2, -1, 0, 1, 2))
    return ((-2, 0), (-2, 0, 1, 2), (-2, 0, 1, 2, 3, 4))
