"""Several references: residues of rank one, close pairs, and what is no pair."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from identification_cases import (
    ABOVE_DAMPING,
    ABOVE_HZ,
    BENCH_DAMPING,
    BENCH_HZ,
    column,
    lines,
    structure,
)

from acquisition.errors import InputError
from identification import identify, mac
from identification.fit.poly_reference import hold_to_rank_one, sorted_frfs
from identification.identify import prepare

REFERENCES = (4, 9, 17)


def close_pair(separation: float, seed: int, n_points: int = 25):
    """Return the benchmark structure, its pair ``separation`` (relative) from one another."""
    hertz = tuple(402.0 * (1 + separation) if f == 405.5 else f for f in BENCH_HZ)
    return structure(hertz + ABOVE_HZ, BENCH_DAMPING + ABOVE_DAMPING, n_points, seed)


def matrix(n_points: int = 25) -> list[tuple[int, int]]:
    return [(i, j) for j in REFERENCES for i in range(1, n_points + 1)]


@pytest.mark.long
@pytest.mark.parametrize(
    ("low", "order", "noise"),
    [(0.0, 60, 0.03), (10.0, 40, 0.01), (100.0, 100, 0.01), (300.0, 40, 0.03), (300.0, 100, 0.001)],
)
def test_pair_two_in_a_thousand_apart(low, order, noise):
    truth = close_pair(0.002, seed=2)
    frfs = truth.frfs(lines(), matrix(), noise=noise, rng=np.random.default_rng(102))
    model = identify(frfs, band=(low, 1000.0), order=order)
    wanted = truth.within(low, 1000)
    assert len(model) == wanted.sum(), model.table()
    np.testing.assert_allclose(model.modal.frequency, truth.hertz[wanted], rtol=0.01 * noise)
    assert np.diag(mac(model.modal.shapes, truth.shapes[:, wanted])).min() > 1 - 2 * noise


@pytest.mark.long
def test_constants_are_of_rank_one_and_their_sigmas_right():
    scores, shape_scores = [], []
    for seed in range(1, 5):
        truth = close_pair(0.002, seed)
        frfs = truth.frfs(lines(), matrix(), noise=0.01, rng=np.random.default_rng(seed))
        model = identify(frfs, band=(300.0, 600.0))
        wanted = truth.within(300, 600)
        table = model.constants.reshape(3, 25, -1)
        values = np.linalg.svd(table.transpose(2, 0, 1), compute_uv=False)
        assert (values[:, 1] < 1e-9 * values[:, 0]).all()
        exact = np.array([truth.shapes[i - 1, wanted] * truth.shapes[j - 1, wanted] for i, j in matrix()])
        scores.append((model.constants.real - exact) / model.constant_sigma)
        found, shapes = model.modal.shapes.real, truth.shapes[:, wanted]
        sign = np.sign(np.sum(found * shapes, axis=0))
        shape_scores.append((found * sign - shapes) / model.modal.shape_sigma)
    for score in (scores, shape_scores):
        assert np.sqrt(np.mean(np.array(score) ** 2)) == pytest.approx(1.0, abs=0.15)


@pytest.mark.long
def test_rank_one_halves_the_error_of_a_close_pair(monkeypatch):
    from identification.fit import fit

    held, free = [], []
    for seed in range(1, 7):
        truth = close_pair(0.002, seed)
        frfs = truth.frfs(lines(), matrix(), noise=0.01, rng=np.random.default_rng(seed))
        for errors, search in ((held, sorted_frfs), (free, lambda _: None)):
            monkeypatch.setattr(fit, "sorted_frfs", search)
            model = identify(frfs, band=(300.0, 600.0))
            pair = np.abs(model.modal.frequency - 402.4) < 2
            errors.append(model.modal.frequency[pair] / (402.0, 402.0 * 1.002) - 1)
    assert np.std(held) < 0.75 * np.std(free)


def test_gaps_in_the_matrix_do_no_harm():
    truth = close_pair(0.005, seed=3)
    frfs = truth.frfs(lines(), matrix(), noise=0.01, rng=np.random.default_rng(3))
    some = np.flatnonzero(np.random.default_rng(0).random(75) < 0.8)
    model = identify(frfs.select(some), band=(300.0, 600.0))
    wanted = truth.within(300, 600)
    np.testing.assert_allclose(model.modal.frequency, truth.hertz[wanted], rtol=5e-5)
    exact = truth.shapes[[d.node - 1 for d in model.modal.dofs]][:, wanted]
    assert np.diag(mac(model.modal.shapes, exact)).min() > 0.999


@pytest.mark.long
def test_frequencies_that_drift_from_point_to_point_make_no_second_mode():
    """A sensor that roves moves each point's frequencies; the shapes differ from row to row alone."""
    rng = np.random.default_rng(5)
    parts = []
    for point in range(1, 13):
        drift = 1 + 3e-4 * rng.standard_normal()
        truth = structure((120.0 * drift, 200.0 * drift, 330.0 * drift), (0.004, 0.003, 0.002), 17, seed=11)
        parts.append(truth.frfs(lines(high=500.0), [(point, j) for j in REFERENCES], noise=0.003, rng=rng))
    frfs = replace(
        parts[0],
        values=np.concatenate([p.values for p in parts]),
        responses=sum((p.responses for p in parts), ()),
        references=sum((p.references for p in parts), ()),
    )
    model = identify(frfs, band=(50.0, 450.0))
    assert len(model) == 3
    error = (model.modal.frequency - (120, 200, 330)) / model.modal.frequency_sigma
    assert np.abs(error).max() < 4


def test_references_that_disagree_on_the_shape_are_left_free():
    """One reference sees every shape of a changed structure: rank one is refused, and said so."""
    rng = np.random.default_rng(6)
    one = structure((120.0, 200.0), (0.006, 0.005), 12, seed=21)
    other = structure((120.0, 200.0), (0.006, 0.005), 12, seed=22)
    parts = [
        s.frfs(lines(high=300.0), [(i, j) for i in range(1, 13)], noise=0.003, rng=rng)
        for s, j in ((one, 4), (other, 9))
    ]
    frfs = replace(
        parts[0],
        values=np.concatenate([p.values for p in parts]),
        responses=sum((p.responses for p in parts), ()),
        references=sum((p.references for p in parts), ()),
    )
    model = identify(frfs, band=(50.0, 290.0))
    assert any("references do not agree" in w for w in model.warnings)
    exact = np.array([one.shapes[i - 1] * one.shapes[3] for i in range(1, 13)])
    np.testing.assert_allclose(model.constants[:12].real, exact, atol=0.02)


def test_what_watches_the_poles_can_end_the_refinement():
    found = structure((60.0, 110.0, 170.0), (0.01, 0.008, 0.006), 6, seed=31)
    pairs = column(6, 1) + column(6, 4)
    frfs = found.frfs(lines(high=250.0), pairs, noise=0.01, rng=np.random.default_rng(3))
    fitted = prepare(frfs).fitted
    places, modes = sorted_frfs(fitted.frfs), np.ones(len(fitted.fit.poles), dtype=bool)
    moved = replace(fitted.fit, poles=fitted.fit.poles * 1.0002)
    seen = []
    held = hold_to_rank_one(fitted.frfs, moved, fitted.weights, places, modes, watch=seen.append)
    np.testing.assert_array_equal(np.sort(seen[-1].imag), np.sort(held.fit.poles.imag))

    def refuse(poles):
        raise InputError("left")

    with pytest.raises(InputError, match="left"):
        hold_to_rank_one(fitted.frfs, moved, fitted.weights, places, modes, watch=refuse)
