"""Trial participations of two modes: the misfit is that of all equations solved together."""

from __future__ import annotations

import numpy as np
import pytest
from identification_cases import BENCH_DAMPING, BENCH_HZ, lines, structure

from identification.fit.equations.normal_equations import Weights
from identification.fit.equations.residues import uniform_weights
from identification.fit.poly_reference import sorted_frfs
from identification.fit.poly_reference.equations import Problem, evaluate, project
from identification.fit.poly_reference.pairs import PairEquations

REFERENCES, POINTS = (4, 9, 17), 20


def problem(rng, n_modes: int, n_missing: int, *, own_weights: bool) -> tuple[Problem, np.ndarray]:
    """Return FRFs of a matrix with gaps, modes beyond the first ``n_modes`` left free, and poles."""
    truth = structure(BENCH_HZ, BENCH_DAMPING, POINTS, 3)
    places = [(i, j) for j in REFERENCES for i in range(1, POINTS + 1)]
    frfs = truth.frfs(lines(), places[: len(places) - n_missing], noise=0.01, rng=rng).band(10.0, 1000.0)
    weights = uniform_weights(frfs)
    if own_weights:
        weights = Weights(weights.level, rng.uniform(0.5, 2.0, frfs.values.shape))
    omega, damping = 2 * np.pi * np.array(BENCH_HZ), np.array(BENCH_DAMPING)
    poles = omega * (-damping + 1j * np.sqrt(1 - damping**2))
    free = np.ones((len(REFERENCES), n_modes), dtype=bool)
    free[0] = False
    return Problem(frfs, weights, (-2, 0), sorted_frfs(frfs), free), poles


@pytest.mark.parametrize(("n_held", "n_missing"), [(2, 0), (12, 0), (7, 4)])
@pytest.mark.parametrize("own_weights", [False, True])
def test_misfit_of_a_pair_is_that_of_all_equations(rng, n_held, n_missing, own_weights):
    posed, poles = problem(rng, n_held, n_missing, own_weights=own_weights)
    share = rng.standard_normal((3, n_held)) + 0.1j * rng.standard_normal((3, n_held))
    pair = (n_held - 2, n_held - 1)
    trials = rng.standard_normal((4, 3, 2)) + 0.1j * rng.standard_normal((4, 3, 2))
    found = PairEquations.of(posed, project(posed, poles, n_held), share, pair).misfits(trials)
    exact = []
    for trial in trials:
        share[:, pair] = trial
        exact.append(evaluate(posed, poles, share).cost)
    np.testing.assert_allclose(found, exact, rtol=1e-8)
