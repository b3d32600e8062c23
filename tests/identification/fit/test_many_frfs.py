"""Many FRFs: combinations of them in their place, and iterations that end at rest."""

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, FrfSet
from identification import identify
from identification.fit.equations import iteration, projection
from identification.fit.equations.pruning import pole_covariance
from identification.fit.equations.refine import refine
from identification.fit.equations.residues import uniform_weights
from identification.fit.noise.weights import search_weights
from identification.fit.poly_reference import equations, rank_one

POINTS, REFERENCES, LINES = 120, 2, 400
HERTZ = np.array([112.0, 131.0, 131.9, 160.0, 188.0])


@pytest.fixture
def poles():
    omega = 2 * np.pi * HERTZ
    return omega * (-0.004 + 1j * np.sqrt(1 - 0.004**2))


@pytest.fixture
def frfs(rng, poles):
    """FRFs of five modes at many points, with noise that differs from FRF to FRF."""
    shapes = rng.standard_normal((POINTS, len(poles)))
    frequency = np.linspace(100.0, 200.0, LINES)
    s = 2j * np.pi * frequency
    terms = (1 / (s[:, None] - poles) - 1 / (s[:, None] - poles.conj())) / (2j * poles.imag)
    values = np.concatenate([(shapes * shapes[r]) @ terms.T * s**2 for r in range(REFERENCES)])
    size = 0.01 * np.sqrt(np.mean(np.abs(values) ** 2) / 2) * rng.uniform(0.5, 2.0, (len(values), 1))
    noise = rng.standard_normal((2, *values.shape)) * size
    responses = tuple(Dof(i + 1, 3) for _ in range(REFERENCES) for i in range(POINTS))
    references = tuple(Dof(r + 1, 3) for r in range(REFERENCES) for _ in range(POINTS))
    return FrfSet(frequency, values + noise[0] + 1j * noise[1], responses, references)


def counted(monkeypatch, module, name):
    """Return a list that grows with every call of a function of a module."""
    calls, plain = [], getattr(module, name)

    def count(*args, **kwargs):
        calls.append(args)
        return plain(*args, **kwargs)

    monkeypatch.setattr(module, name, count)
    return calls


def test_combinations_of_frfs_have_the_poles_of_all(frfs, poles, monkeypatch):
    start = poles * (1 + 2e-4)
    weights = search_weights(frfs, refine(frfs, start, uniform_weights(frfs), iterations=3))
    steps = counted(monkeypatch, iteration, "state_at")
    found = refine(frfs, start, weights)
    sizes = [len(args[0].data.power) for args in steps]
    assert min(sizes) < len(frfs.values) / 5
    assert sizes.count(len(frfs.values)) < sizes.count(min(sizes))
    monkeypatch.setattr(projection, "_FEWER", np.inf)
    every = refine(frfs, start, weights)
    sigma = np.sqrt(np.diag(pole_covariance(every))).reshape(-1, 2).min(axis=1)
    assert np.all(np.abs(found.poles - every.poles) < 1e-3 * sigma)
    assert found.cost == pytest.approx(every.cost, abs=1e-3)
    assert found.information == pytest.approx(every.information, rel=1e-3, abs=1e-6 * every.information.max())


def test_combinations_are_the_same_problem_at_the_poles_they_were_made_at(frfs, poles):
    weights = uniform_weights(frfs)
    every = projection.Problem.of(projection.Lines.of(frfs), weights, (-2, 0))
    there = projection.state_at(every, poles)
    few = projection.state_at(every.combined(there.products.cross), poles)
    assert few.cost == pytest.approx(there.cost, rel=1e-9)
    assert few.step.normal == pytest.approx(there.step.normal, rel=1e-9, abs=1e-9 * there.step.normal.max())
    size = np.abs(there.step.gradient).max()
    assert few.step.gradient == pytest.approx(there.step.gradient, abs=1e-6 * size)


def test_few_frfs_are_fitted_as_they_are(frfs, poles):
    weights = uniform_weights(frfs)
    few = frfs.select(np.arange(40))
    problem = projection.Problem.of(projection.Lines.of(few), uniform_weights(few), (-2, 0))
    assert problem.combined(projection.state_at(problem, poles).products.cross) is None
    own = replace(weights, lines=np.ones(frfs.values.shape))
    problem = projection.Problem.of(projection.Lines.of(frfs), own, (-2, 0))
    assert problem.combined(np.ones((len(frfs.values), 20))) is None


def test_a_fit_at_rest_is_not_tried_with_ever_more_damping(frfs, poles, monkeypatch):
    weights = uniform_weights(frfs)
    found = refine(frfs, poles, weights)
    steps = counted(monkeypatch, iteration, "state_at")
    again = refine(frfs, found.poles, weights, known=found.equations, enough=1e-4)
    assert again.converged
    assert len(steps) <= 4


def test_a_rank_one_fit_at_rest_is_not_tried_with_ever_more_damping(frfs, monkeypatch):
    steps = counted(monkeypatch, rank_one, "evaluate")
    assert len(identify(frfs).poles) == len(HERTZ)
    assert len(steps) <= 6


def test_products_of_the_rank_one_fit_are_formed_once_for_each_reference(frfs, monkeypatch):
    steps = counted(monkeypatch, equations, "_turned")
    evaluations = counted(monkeypatch, rank_one, "evaluate")
    identify(frfs)
    assert len(steps) == REFERENCES * len(evaluations)
