"""FRFs that have poles of their own, as a roving hammer or drift makes them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from identification_cases import Structure, column, lines, structure

from identification import identify
from identification.fit.noise.disagreement import between_frfs, scatter_beyond_noise

SHIFT = 3e-4


def drifting(truth: Structure, rng, *, shift: float, noise: float):
    """One FRF after the other, with the frequencies scattered by ``shift`` between them."""
    points = column(len(truth.shapes))
    sets = []
    for pair in points:
        factor = 1.0 + shift * rng.standard_normal(len(truth.poles))
        moved = Structure(truth.poles * factor, truth.shapes)
        sets.append(moved.frfs(lines(df=0.1, low=20.0, high=300.0), [pair], noise=noise, rng=rng))
    return replace(
        sets[0],
        values=np.concatenate([s.values for s in sets]),
        responses=tuple(s.responses[0] for s in sets),
        references=tuple(s.references[0] for s in sets),
    )


@pytest.mark.long
def test_sigma_of_the_frequency_covers_the_drift():
    frequency = []
    for seed in range(12):
        truth = structure((60.0, 140.0, 250.0), (0.006, 0.004, 0.003), 9, seed=seed)
        model = identify(drifting(truth, np.random.default_rng(90 + seed), shift=SHIFT, noise=0.003))
        assert len(model) == 3, model.table()
        error = model.modal.frequency / truth.hertz - 1.0
        sigma = model.modal.frequency_sigma / model.modal.frequency
        assert (sigma > SHIFT / 9).all() and (sigma < 3 * SHIFT).all()
        frequency.append(error / sigma)
    score = np.concatenate(frequency)
    assert np.mean(np.abs(score) < 2.3) > 0.85  # Student's t of 8 degrees of freedom at 95 %


def test_frfs_that_agree_leave_the_variance_alone(rng):
    normal = np.broadcast_to(np.array([[4.0, 0.5], [0.5, 3.0]]), (200, 12, 5, 2, 2))
    root = np.linalg.cholesky(normal / 2)
    added = 0
    for n, r in zip(normal, root, strict=True):
        gradient = np.einsum("jnab,jnb->jna", r, rng.standard_normal((12, 5, 2)))
        added += np.count_nonzero(between_frfs(gradient, n, np.ones(5)).mean)
    assert added <= 10  # of 1000 modes, at one chance in a thousand


def test_scatter_of_equal_variances_is_the_textbook_excess(rng):
    values = rng.standard_normal((7, 3)) * np.array([0.1, 2.0, 5.0])
    wanted = np.maximum(values.var(axis=0, ddof=1) - 1.0, 0.0)
    np.testing.assert_allclose(scatter_beyond_noise(values, np.ones((7, 3))), wanted, rtol=1e-9)


def test_an_frf_at_a_node_has_no_say(rng):
    values, variance = rng.standard_normal((6, 2)), np.full((6, 2), 0.1)
    more = np.concatenate([values, [[1e6, -1e6]]]), np.concatenate([variance, [[np.inf, np.inf]]])
    np.testing.assert_allclose(scatter_beyond_noise(*more), scatter_beyond_noise(values, variance), rtol=1e-9)


def test_few_frfs_that_disagree_have_intervals_of_students_t(rng):
    draws, few, scatter = 4000, 4, 30.0
    normal = np.tile(np.eye(2), (few, draws, 1, 1))
    own = scatter * rng.standard_normal((few, draws, 2)) + rng.standard_normal((few, draws, 2)) / np.sqrt(2.0)
    mean = own.mean(axis=0)
    found = between_frfs(own - mean, normal, np.ones(draws)).mean
    sigma = np.sqrt(np.einsum("naa->na", found) + 0.5 / few)
    inside = np.mean(np.abs(mean) < 1.96 * sigma)
    assert abs(inside - 0.95) < 4 * np.sqrt(0.95 * 0.05 / (2 * draws))  # without the widening 0.855
