"""H1, H2, Hv and what is said of their uncertainty."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from acquisition import (
    Dof,
    EstimationError,
    HammerPlan,
    HammerTest,
    Hits,
    HitVerdict,
    InputError,
    Windows,
    apply_windows,
    estimate_frfs,
    hammer_test,
    modal_system,
    random_error,
)

SYSTEM = modal_system(
    frequency=np.array([60.0, 140.0]),
    damping=np.array([0.02, 0.015]),
    response_shapes=np.array([[1.0, 0.7], [0.4, -0.8]]),
    point_shapes=np.array([[1.0, 0.7]]),
    responses=(Dof(1, 3), Dof(2, 3)),
    points=(Dof(1, 3),),
)
NOISY = HammerPlan(rate=1024.0, samples=2048, hits=5, width=4e-3, response_noise=5e-3, adc_bits=None)


def noisy(seed: int, **more: object) -> HammerTest:
    return hammer_test(SYSTEM, replace(NOISY, **more), rng=np.random.default_rng(seed))


def exact(laplace):
    return SYSTEM.receptance(laplace, 0) * laplace**2


def verdict(hit: int, used: bool) -> HitVerdict:
    return HitVerdict(
        point=Dof(1, 3),
        hit=hit,
        used=used,
        reasons=() if used else ("by hand",),
        peak=1.0,
        width=1e-3,
        band10=100.0,
        band20=200.0,
    )


def test_variance_is_the_scatter_that_occurs():
    """Over many tests, the mean of the estimated variance equals the mean squared error, line by line."""
    sets = [estimate_frfs(noisy(seed)).band(20.0, 200.0) for seed in range(150)]
    error = np.mean([np.abs(s.values - exact(s.laplace)) ** 2 for s in sets], axis=0)
    stated = np.mean([s.variance for s in sets], axis=0)
    assert np.median(stated / error) == pytest.approx(1.0, abs=0.05)
    assert stated.sum() / error.sum() == pytest.approx(1.0, abs=0.1)


def test_random_error_is_that_of_the_magnitude():
    sets = [estimate_frfs(noisy(seed)).band(50.0, 70.0) for seed in range(150)]
    scatter = np.std([np.abs(s.values) for s in sets], axis=0) / np.abs(exact(sets[0].laplace))
    stated = np.sqrt(np.mean([random_error(s) ** 2 for s in sets], axis=0))
    without = np.sqrt(np.mean([random_error(replace(s, variance=None)) ** 2 for s in sets], axis=0))
    assert np.median(stated / scatter) == pytest.approx(1.0, abs=0.1)
    assert np.median(without / scatter) == pytest.approx(1.0, abs=0.15)


def test_estimators_lie_in_order_and_agree_without_noise():
    h1, h2, hv = (estimate_frfs(noisy(1), estimator=e) for e in ("H1", "H2", "Hv"))  # type: ignore[arg-type]
    assert np.all(np.abs(h1.values) <= np.abs(hv.values) * (1 + 1e-12))
    assert np.all(np.abs(hv.values) <= np.abs(h2.values) * (1 + 1e-12))
    assert np.allclose(hv.values**2, h1.values * h2.values)
    assert np.allclose(h1.values, h2.values * h1.coherence)
    clean = [
        estimate_frfs(noisy(1, response_noise=0.0), estimator=e).band(20, 200).values for e in ("H1", "H2")
    ]  # type: ignore[arg-type]
    assert np.allclose(*clean, rtol=1e-3)


def white_test(rng, *, force_noise: float, motion_noise: float, hits: int, samples: int) -> HammerTest:
    """X = 2 F at every line, with white noise of given power relative to the true signals."""
    force = rng.standard_normal((hits, samples))
    seen = force + np.sqrt(force_noise) * rng.standard_normal(force.shape)
    motion = 2 * force + 2 * np.sqrt(motion_noise) * rng.standard_normal(force.shape)
    return HammerTest(float(samples), (Hits(Dof(1, 3), (Dof(1, 3),), seen, motion[:, None]),))


@pytest.mark.parametrize(("n", "m"), [(0.0, 0.0), (0.25, 0.0), (0.0, 0.25), (0.25, 0.5)])
def test_biases_are_those_of_the_textbook(rng, n, m):
    """Bendat and Piersol, Random Data, section 9.2: N/S on the force lowers H1 by 1 + N/S, on the response

    raises H2 by 1 + M/S; the coherence falls by both; Hv is their geometric mean. Bounds are five standard deviations
    of these estimates over so many hits (same section), and of their mean over all lines.
    """
    count = 2000
    test = white_test(rng, force_noise=n, motion_noise=m, hits=count, samples=600)
    h1, h2, hv = (estimate_frfs(test, estimator=e) for e in ("H1", "H2", "Hv"))  # type: ignore[arg-type]
    coherence, lines = 1 / ((1 + n) * (1 + m)), len(h1.frequency)
    relative = 5 * np.sqrt((1 - coherence) / coherence / count) + 1e-9
    expected = {"H1": 2 / (1 + n), "H2": 2 * (1 + m), "Hv": 2 * np.sqrt((1 + m) / (1 + n))}
    for frfs, value in zip((h1, h2, hv), expected.values(), strict=True):
        assert np.abs(frfs.values - value).max() < relative * value
        assert np.abs(frfs.values.mean() - value) < relative * value / np.sqrt(lines)
    scatter = 5 * (1 - coherence) * np.sqrt(2 * coherence / count) + 1e-9
    assert h1.coherence == pytest.approx(coherence, abs=scatter)
    assert h1.coherence.mean() == pytest.approx(coherence, abs=scatter / np.sqrt(lines))
    if n and m:
        assert expected["H1"] < expected["Hv"] < expected["H2"]


@pytest.mark.parametrize("estimator", ["H1", "H2", "Hv"])
@pytest.mark.parametrize(("n", "m"), [(0.0, 0.05), (0.05, 0.0), (0.03, 0.03)])
def test_random_error_of_each_estimator(rng, estimator, n, m):
    """Relative scatter of |H| over many averages of 50 hits: stated from hits, from coherence, and seen."""
    averages = 60
    test = white_test(rng, force_noise=n, motion_noise=m, hits=50 * averages, samples=80)
    (hits,) = test.points
    sets = [
        estimate_frfs(
            replace(test, points=(replace(hits, force=hits.force[part], motion=hits.motion[part]),)),
            estimator=estimator,
        ).band(1.0, 39.0)
        for part in np.arange(50 * averages).reshape(averages, 50)
    ]
    size = np.array([np.abs(s.values[0]) for s in sets])
    seen = np.sqrt(np.mean((size.std(axis=0, ddof=1) / size.mean(axis=0)) ** 2))
    stated = np.sqrt(np.mean([random_error(s) ** 2 for s in sets]))
    from_coherence = np.sqrt(np.mean([random_error(replace(s, variance=None)) ** 2 for s in sets]))
    assert stated == pytest.approx(seen, rel=0.07)  # 60 averages at 39 lines: 1.5 %
    assert from_coherence == pytest.approx(seen, rel=0.07)


def test_verdicts_of_two_runs_at_one_point_do_not_mix():
    """A degree of freedom that was hit in two runs has two verdicts on its first hit."""
    (hits,) = noisy(2).points
    runs = replace(noisy(2), points=(hits, replace(hits, motion=2 * hits.motion)))
    known = [verdict(n, n > 1) for n in range(1, 6)] + [verdict(n, True) for n in range(1, 6)]
    frfs = estimate_frfs(runs, verdicts=known)
    assert frfs.averages.tolist() == [4, 4, 5, 5]
    assert estimate_frfs(runs, verdicts=known[:1]).averages.tolist() == [4, 4, 5, 5]
    assert estimate_frfs(runs, verdicts=[verdict(6, False)]).averages.tolist() == [5, 5, 4, 4]


def test_one_hit_has_no_coherence_and_no_variance():
    frfs = estimate_frfs(noisy(1, hits=1))
    assert frfs.coherence is None and frfs.variance is None and frfs.averages.tolist() == [1, 1]
    with pytest.raises(EstimationError, match="coherence"):
        random_error(frfs)


def test_refused_hits_are_as_if_they_were_not_there():
    test = noisy(2)
    (hits,) = test.points
    less = replace(
        test, points=(Hits(hits.reference, hits.responses, hits.force[[0, 2, 4]], hits.motion[[0, 2, 4]]),)
    )
    some = estimate_frfs(test, verdicts=[verdict(n, n % 2 == 1) for n in range(1, 6)])
    assert np.array_equal(some.values, estimate_frfs(less).values) and some.averages.tolist() == [3, 3]
    with pytest.raises(EstimationError, match="no usable hit"):
        estimate_frfs(test, verdicts=[verdict(n, False) for n in range(1, 6)])


def test_a_point_without_usable_hits_is_left_out():
    test = noisy(2)
    other = replace(test.points[0], reference=Dof(9, 3))
    frfs = estimate_frfs(
        replace(test, points=(*test.points, other)), verdicts=[verdict(n, False) for n in range(1, 6)]
    )
    assert set(frfs.references) == {Dof(9, 3)}


@settings(max_examples=20)
@given(order=st.permutations(range(5)), force=st.floats(1e-3, 1e3), motion=st.floats(1e-3, 1e3))
def test_order_of_hits_and_units_do_not_matter(order, force, motion):
    test = noisy(4, samples=256)
    (hits,) = test.points
    turned = Hits(hits.reference, hits.responses, force * hits.force[order], motion * hits.motion[order])
    one, two = estimate_frfs(test), estimate_frfs(replace(test, points=(turned,)))
    scale = motion / force
    assert np.allclose(two.values, scale * one.values, rtol=1e-9)
    assert np.allclose(two.coherence, one.coherence, rtol=1e-9)
    assert np.allclose(two.variance, scale**2 * one.variance, rtol=1e-6)


def test_exponential_window_leaves_amplitude_and_damping_exact():
    """The window's decay is handed on, and the FRF is that of the structure beside the imaginary axis."""
    test = apply_windows(noisy(1, response_noise=0.0), Windows(decay=10.0))
    frfs = estimate_frfs(test).band(20.0, 200.0)
    assert frfs.decay == 10.0
    assert np.abs(frfs.values - exact(frfs.laplace)).max() < 2e-4 * np.abs(frfs.values).max()
    (hits,) = test.points
    assert np.allclose(hits.force.max(axis=-1), noisy(1, response_noise=0.0).points[0].force.max(axis=-1))


def test_windows_add_up():
    test = apply_windows(apply_windows(noisy(1), Windows(decay=2.0)), Windows(decay=3.0))
    assert test.decay == 5.0
    assert np.allclose(test.points[0].motion, apply_windows(noisy(1), Windows(decay=5.0)).points[0].motion)


def test_force_window_takes_noise_and_leaves_the_pulse():
    test = noisy(1, force_noise=1.0)
    short = apply_windows(test, Windows(force_length=0.02))
    before, after = test.points[0].force, short.points[0].force
    before = before - np.median(before, axis=-1, keepdims=True)  # an offset is taken off first
    top = int(before[0].argmax())
    assert np.array_equal(after[0, : top + 15], before[0, : top + 15])
    assert not after[:, 100:].any() and before[:, 100:].any()
    clean = exact(estimate_frfs(test).band(20.0, 200.0).laplace)
    worse, better = (np.abs(estimate_frfs(t).band(20.0, 200.0).values - clean).mean() for t in (test, short))
    assert better < worse


def test_nonsense_is_refused():
    with pytest.raises(InputError, match="H3"):
        estimate_frfs(noisy(1), estimator="H3")  # type: ignore[arg-type]
    with pytest.raises(InputError):
        Windows(decay=-1.0)
    (hits,) = noisy(1).points
    with pytest.raises(EstimationError, match="force"):
        estimate_frfs(replace(noisy(1), points=(replace(hits, force=0 * hits.force),)))
