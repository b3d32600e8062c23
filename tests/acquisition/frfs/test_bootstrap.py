"""Hits drawn anew: their scatter is that of the average, their mean the average itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import (
    Dof,
    EstimationError,
    HammerPlan,
    HitVerdict,
    InputError,
    Windows,
    estimate_frfs,
    hammer_test,
    modal_system,
)
from acquisition.frfs.bootstrap import bootstrap_frfs

SYSTEM = modal_system(
    frequency=np.array([60.0]),
    damping=np.array([0.02]),
    response_shapes=np.array([[1.0], [0.4]]),
    point_shapes=np.array([[1.0], [0.7]]),
    responses=(Dof(1, 3), Dof(2, 3)),
    points=(Dof(1, 3), Dof(2, 3)),
)
PLAN = HammerPlan(
    rate=512.0, samples=512, hits=6, width=4e-3, response_noise=5e-3, force_noise=0.3, adc_bits=None
)
BAND = (40.0, 80.0)


def rig(seed: int, **more: object):
    return hammer_test(SYSTEM, replace(PLAN, **more), rng=np.random.default_rng(seed))


def drawn(test, rng, n, **more):
    return np.array([f.values for f in bootstrap_frfs(test, rng=rng, n=n, band=BAND, **more)])


@pytest.mark.parametrize("estimator", ["H1", "H2", "Hv"])
@pytest.mark.parametrize("hits", [4, 12])
def test_its_variance_agrees_with_that_of_the_hits(rng, estimator, hits):
    """Two ways from the same hits to the variance: pooled over tests they agree."""
    stated, found = [], []
    for seed in range(20):
        test = rig(seed, hits=hits, level_scatter=0.1)
        stated.append(estimate_frfs(test, estimator=estimator, band=BAND).variance)
        sets = drawn(test, rng, 100, estimator=estimator)
        found.append(np.var(sets, axis=0, ddof=1))
    ratio = np.sum(found, axis=(0, 2)) / np.sum(stated, axis=(0, 2))
    assert ratio == pytest.approx(1.0, abs=0.12)


def test_its_covariance_between_responses_agrees(rng):
    test = rig(1, hits=12, response_noise=1e-4, force_noise=1.0)
    sets = drawn(test, rng, 400) - estimate_frfs(test, band=BAND).values
    frfs = estimate_frfs(test, band=BAND)
    peak = int(np.abs(frfs.values[0]).argmax())
    found = np.mean(sets[:, 0, peak] * sets[:, 1, peak].conj())
    stated = frfs.scatter.covariance(0, 1)[peak, peak]
    assert found == pytest.approx(stated, rel=0.3)
    assert abs(np.mean(sets[:, 0, peak] * sets[:, 2, peak].conj())) < 0.2 * abs(found)


def test_hits_left_out_are_never_drawn(rng):
    verdicts = [
        HitVerdict(
            point=Dof(1, 3),
            hit=1,
            used=False,
            reasons=("by hand",),
            peak=1.0,
            width=1e-3,
            band10=1.0,
            band20=1.0,
        )
    ]
    test = rig(2)
    spoiled = np.array(test.points[0].motion)
    spoiled[0] *= 1e6
    bad = replace(test, points=(replace(test.points[0], motion=spoiled), test.points[1]))
    largest = np.abs(estimate_frfs(test).values).max()
    assert np.abs(drawn(bad, rng, 20, verdicts=verdicts)).max() < 2 * largest
    assert np.abs(drawn(bad, rng, 20)).max() > 100 * largest


def test_windows_form_and_names_are_kept(rng):
    frfs = next(bootstrap_frfs(rig(2), rng=rng, n=1, windows=Windows(decay=4.0), band=BAND))
    plain = estimate_frfs(rig(2), windows=Windows(decay=4.0), band=BAND)
    assert frfs.decay == 4.0 and frfs.responses == plain.responses and frfs.references == plain.references
    assert np.array_equal(frfs.frequency, plain.frequency) and frfs.averages.tolist() == [5] * 4
    quiet = rig(2, response_noise=0.0, force_noise=0.0, samples=2048, pre_trigger=0.2)
    exact = estimate_frfs(quiet, windows=Windows(decay=4.0), band=BAND)
    (again,) = drawn(quiet, rng, 1, windows=Windows(decay=4.0))
    assert np.abs(again - exact.values).max() < 1e-4 * np.abs(exact.values).max()


def test_the_seed_decides():
    one, two, three = (drawn(rig(2), np.random.default_rng(s), 3) for s in (1, 1, 2))
    assert np.array_equal(one, two) and not np.array_equal(one, three)


def test_what_cannot_be_drawn_is_refused(rng):
    with pytest.raises(EstimationError, match="only one usable hit at 1"):
        bootstrap_frfs(rig(1, hits=1), rng=rng)
    with pytest.raises(InputError, match="bootstrap"):
        bootstrap_frfs(rig(1), rng=rng, n=0)
