"""How much work an identification is: counted, not timed."""

from __future__ import annotations

import sys
from dataclasses import replace

import numpy as np
import pytest
from identification_cases import bench, column, lines, structure
from threadpoolctl import threadpool_info, threadpool_limits

from identification import identify, prepare
from identification.fit.equations import basis, normal_equations
from identification.fit.equations.refine import fit_at
from identification.uncertainty.doubts import not_at_rest

REFERENCES = (4, 9, 17)


@pytest.fixture
def bases(monkeypatch) -> list[int]:
    """Collect the number of poles at which columns over all lines were formed."""
    found: list[int] = []
    build = basis.build

    def counted(axis, poles, terms):
        found.append(len(poles))
        return build(axis, poles, terms)

    monkeypatch.setattr(basis, "build", counted)
    return found


def test_one_thread_whatever_the_caller_has(monkeypatch):
    """Matrices of some 50 columns: two threads take several times the processor time of one."""
    threads, module = [], sys.modules["identification.identify"]
    fit = module.fit_shaped

    def seen(*args, **kwargs):
        threads.extend(pool["num_threads"] for pool in threadpool_info() if pool["user_api"] == "blas")
        return fit(*args, **kwargs)

    monkeypatch.setattr(module, "fit_shaped", seen)
    truth = structure((120.0, 200.0), (0.006, 0.005), 6, seed=21)
    frfs = truth.frfs(lines(high=300.0), column(6), noise=0.003, rng=np.random.default_rng(1))
    with threadpool_limits(2, user_api="blas"):
        identify(frfs)
    assert set(threads) == {1}


def test_products_of_columns_with_a_row_of_weights_each():
    rng = np.random.default_rng(3)
    columns = rng.standard_normal((700, 9)) + 1j * rng.standard_normal((700, 9))
    weights = rng.uniform(0.1, 2.0, (40, 700))
    real = np.concatenate([columns.real, columns.imag])
    found = normal_equations.products(real, weights)
    exact = np.einsum("la,jl,lb->jab", columns.conj(), weights, columns).real
    np.testing.assert_allclose(found, exact, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(
        found[:5], normal_equations.products(real, weights[:5]), rtol=1e-11, atol=1e-11
    )


def test_close_modes_of_several_references_are_told_apart_by_one_set_of_sums(bases):
    truth = bench(seed=2)
    pairs = [(i, j) for j in REFERENCES for i in range(1, 26)]
    frfs = truth.frfs(lines(), pairs, noise=0.01, rng=np.random.default_rng(2))
    model = identify(replace(frfs, window="none"), band=(300.0, 600.0))
    assert len(model) == 5
    # 64 to 84 over seeds and BLAS, some 20 more where a residual term in 1/s comes in last, as here; a projection per
    # trial would be 56 more for each close pair
    assert len(bases) < 120


def test_lengths_of_lines_for_many_matrices_as_for_few():
    rng = np.random.default_rng(4)
    real, half = rng.standard_normal((2 * 600, 7)), rng.standard_normal((30, 7, 5))
    exact = (np.einsum("lk,jkm->jlm", real, half) ** 2).sum(axis=2)
    found = normal_equations.forms(real, half)
    np.testing.assert_allclose(found, exact[:, :600] + exact[:, 600:], rtol=1e-11)
    np.testing.assert_allclose(found[:5], normal_equations.forms(real, half[:5]), rtol=1e-11)


def test_a_fit_is_made_once_more_only_if_the_noise_turns_out_another(bases):
    """Steady noise: what the first fit leaves gives the weights of the last, and nothing follows from scratch."""
    truth = bench()
    frfs = truth.frfs(lines(), column(), noise=0.01, rng=np.random.default_rng(2))
    model = identify(replace(frfs, window="none"), band=(0.0, 1000.0))
    assert len(model) == 12
    assert len(bases) < 60  # some 50 as rounding goes; from scratch again would be twice as many


def test_a_fit_that_does_not_come_to_rest_says_how_far_it_is_off():
    """The next step brings back a pole that lies a tenth of a hertz beside."""
    frfs = bench().frfs(lines(0.5, 20.0), column(), noise=1e-3, rng=np.random.default_rng(1))
    prepared = prepare(frfs, band=(20.0, 1000.0))
    fitted, rest = prepared.fitted, "did not converge"
    assert not any(rest in w for w in prepared.modes().warnings)
    modes = fitted.fit.poles.copy()
    modes[2] += 2j * np.pi * 0.1
    early = fit_at(fitted.frfs, modes, fitted.weights, fitted.fit.linear.powers, converged=False)
    text = not_at_rest(early, modes[:12])
    assert rest in text and "by up to 0.1 Hz" in text and "narrow the band" in text
