"""One body for every pole estimator: it recovers the poles it was given, on any band."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from identification_cases import bench, column, lines, structure

from acquisition.errors import EstimationError
from identification import identify
from identification.poles import ESTIMATORS, lscf
from identification.poles.lsce import prediction_normal
from identification.poles.lscf import _reduced_normal
from identification.poles.stable import stable_roots


def nearest_error(found, wanted):
    return (np.abs(found[:, None] - wanted[None, :]).min(axis=0) / np.abs(wanted)).max()


@pytest.mark.parametrize("name", sorted(ESTIMATORS))
@pytest.mark.parametrize("low", [0.5, 10.0, 100.0, 300.0, 550.0])
def test_recovers_clean_poles(name, low):
    truth = bench()
    frfs = truth.frfs(lines(low=low), column())
    sets = ESTIMATORS[name](frfs, orders=[40, 60])
    wanted = truth.poles[truth.within(low, 1000)]
    for poles in sets.poles:
        assert nearest_error(poles, wanted) < 5e-5


@pytest.mark.parametrize("name", sorted(ESTIMATORS))
@pytest.mark.parametrize("form", ["receptance", "mobility", "accelerance"])
def test_form_and_decay_leave_the_poles_alone(name, form):
    truth = bench()
    frfs = truth.frfs(lines(low=250.0), column(), form=form, decay=6.0)
    (poles,) = ESTIMATORS[name](frfs, orders=[50]).poles
    assert nearest_error(poles, truth.poles[truth.within(250, 1000)]) < 5e-5


@pytest.mark.parametrize("name", sorted(ESTIMATORS))
def test_mathematical_poles_are_unstable(name, rng):
    truth = bench()
    frfs = truth.frfs(lines(low=10.0), column(), noise=0.01, rng=rng)
    (poles,) = ESTIMATORS[name](frfs, orders=[60]).poles
    hertz, ratio = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    lightly = (hertz > 10) & (hertz < 1000) & (ratio < 0.1)
    assert 12 <= lightly.sum() <= 14
    assert nearest_error(poles, truth.poles[truth.within(10, 1000)]) < 2e-3


def test_several_references_part_modes_of_almost_one_frequency(rng):
    truth = structure((200.0, 200.4, 260.0), (0.005, 0.005, 0.004), 10, seed=3)
    pairs = [(i, j) for j in (1, 4, 7) for i in range(1, 11)]
    frfs = truth.frfs(lines(low=150.0, high=300.0, df=0.25), pairs, noise=0.001, rng=rng)
    sets = lscf(frfs, orders=[6, 10])
    assert nearest_error(sets.poles[-1], truth.poles) < 1e-4
    row = np.abs(sets.poles[-1][:, None] - truth.poles[None, :]).argmin(axis=0)
    for found, mode in zip(sets.participation[-1][row], range(3), strict=True):
        wanted = truth.shapes[[0, 3, 6], mode]
        cosine = abs(found.conj() @ wanted) / np.linalg.norm(wanted)
        assert cosine > 0.999


def test_prediction_normal_equals_the_product_of_its_windows(rng):
    signals = rng.standard_normal((3, 50)) + 1j * rng.standard_normal((3, 50))
    windows = np.concatenate([np.stack([s[k : k + 40] for k in range(11)], axis=1) for s in signals])
    np.testing.assert_allclose(
        prediction_normal(signals, 10), windows.conj().T @ windows, rtol=1e-12, atol=1e-12
    )


@pytest.mark.parametrize("n_references", [1, 3])
def test_reduced_normal_equals_what_a_projection_leaves(rng, n_references):
    order, circle = 7, 48
    data = rng.standard_normal((4, n_references, 40)) + 1j * rng.standard_normal((4, n_references, 40))
    z = np.exp(2j * np.pi / circle * (np.arange(40) - 19.5))
    powers = np.vander(z, order + 1, increasing=True)
    onto, _ = np.linalg.qr(powers)
    wanted = 0.0
    for row in data:
        columns = (powers[:, :, None] * row.T[:, None, :]).reshape(40, -1)
        left = columns - onto @ (onto.conj().T @ columns)
        wanted = wanted + left.conj().T @ left
    np.testing.assert_allclose(_reduced_normal(data, order, circle), wanted, rtol=1e-10, atol=1e-10)


def drawn(rng, n, low, high):
    return rng.uniform(low, high, n) * np.exp(2j * np.pi * (np.arange(n) + 0.3 * rng.random(n)) / n)


@pytest.mark.parametrize("n_stable", [0, 1, 12])
def test_stable_roots_are_those_inside_the_unit_circle(rng, n_stable):
    inside, outside = drawn(rng, n_stable, 0.6, 0.9995), drawn(rng, 40, 1.1, 1.5)
    coefficients = np.poly(np.concatenate([inside, outside]))[::-1]
    found = stable_roots(coefficients / coefficients[0])
    assert found is not None
    assert len(found) == n_stable
    assert np.abs(found[:, None] - inside).min(axis=0, initial=1.0).max(initial=0.0) < 1e-8


def test_stable_roots_part_a_close_pair(rng):
    pair = 0.99 * np.exp(1j * np.array([1.0, 1.001]))
    coefficients = np.poly(np.concatenate([pair, drawn(rng, 30, 1.1, 1.5)]))[::-1]
    found = stable_roots(coefficients)
    assert found is not None
    np.testing.assert_allclose(np.sort(np.angle(found)), [1.0, 1.001], atol=1e-9)


def test_stable_roots_does_not_guess(rng):
    twice = np.poly(np.concatenate([[0.9, 0.9], drawn(rng, 30, 1.1, 1.5)]))[::-1]
    assert stable_roots(twice) is None
    beside_every_circle = np.poly([1.003, 1.006, 1.012])[::-1]
    assert stable_roots(beside_every_circle) is None


@pytest.mark.parametrize("name", sorted(ESTIMATORS))
def test_says_when_there_are_too_few_lines(name):
    frfs = bench().frfs(lines(low=390.0, high=420.0), column())
    with pytest.raises(EstimationError, match=f"61 lines cannot carry {name.upper()} of order 40"):
        ESTIMATORS[name](frfs, orders=[40])


@pytest.mark.long
def test_the_estimator_on_the_page_identifies(monkeypatch, rng):
    page = (Path(__file__).resolve().parents[3] / "docs" / "howto" / "own_estimator.md").read_text(
        encoding="utf-8"
    )
    (block,) = (b for b in re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL) if "ESTIMATORS[" in b)
    assert len([line for line in block.splitlines() if line.strip()]) <= 20
    monkeypatch.setitem(ESTIMATORS, "htls", ESTIMATORS["lsce"])  # it is gone again after the test
    exec(compile(block, "docs/howto/own_estimator.md", "exec"), {})
    truth = bench()
    frfs = truth.frfs(lines(low=250.0, high=700.0), column(), noise=0.003, rng=rng)
    wanted = truth.poles[truth.within(250, 700)]
    found = identify(frfs, method="htls").poles
    assert len(found) == len(wanted)
    assert nearest_error(found, wanted) < 1e-3
