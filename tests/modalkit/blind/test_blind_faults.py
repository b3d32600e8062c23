"""The hammer test itself: bad hits, levels, angles, drift, and what a baseline shares with the test."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import estimate_frfs
from modalkit.blind.trial import draw_trial
from modalkit.simulator.conduct import Conduct
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.measurement import bad_hits, measure
from modalkit.simulator.scene import Scene, draw_scene, nominal_scene
from modalkit.simulator.setup import Setup, hit_points


def plain() -> Setup:
    for index in range(20):
        setup = draw_trial(12, index, plan=DrawRanges(kinds=("beam",), effects=("none",))).scene.setup
        if setup.drive and setup.clamped:
            still = replace(setup, noise=1e-9, bits=24, repeatability=0.0, position_sigma=0.0)
            return replace(still, bad_hits=0.0, hits=5, window=0.0)
    raise AssertionError("no setup with a drive point")


def peaks(scene: Scene, seed: int = 1) -> np.ndarray:
    """Return the peak force of every hit, (n_points, n_hits) [N]."""
    test = measure(scene, rng=np.random.default_rng(seed))
    return np.array([np.abs(point.force).max(axis=-1) for point in test.points])


def test_bad_hits_come_in_all_kinds_as_often_as_said_and_leave_most_good() -> None:
    setup = replace(plain(), bad_hits=0.05, hits=6)
    rng = np.random.default_rng(2)
    drawn = [bad_hits(setup, rng) for _ in range(300)]
    kinds = [kind for bad in drawn for kind in bad.values()]
    assert set(kinds) == {"double", "clipped", "weak", "cut", "wrong place"}
    hits = 300 * len(hit_points(setup)) * 6
    assert len(kinds) / hits == pytest.approx(0.05, rel=0.15)
    few = replace(setup, bad_hits=0.9, hits=3)
    for bad in (bad_hits(few, rng) for _ in range(20)):
        rows = np.bincount([row for row, _ in bad], minlength=1)
        assert rows.max() <= 1


@pytest.mark.long
def test_most_tests_have_bad_hits() -> None:
    setups = [draw_trial(50, i, plan=DrawRanges(kinds=("beam",))).scene.setup for i in range(40)]
    assert 0.4 < np.mean([s.bad_hits > 0 for s in setups]) < 0.9
    assert {s.hits for s in setups} == {3, 4, 5, 6}
    assert {s.bits for s in setups} == {16, 24}


def test_levels_scatter_as_said_and_span_two_to_one() -> None:
    setup = replace(plain(), level_scatter=0.5, hits=6, peak=80.0)
    found = peaks(nominal_scene(setup))
    assert np.exp(np.log(found).mean()) == pytest.approx(80.0, rel=0.35)
    assert np.log(found).std() == pytest.approx(0.5, rel=0.35)
    assert np.median(found.max(axis=1) / found.min(axis=1)) > 2.0


def ratios(scene: Scene) -> np.ndarray:
    """Return the largest response over the largest force of every hit, (n_points, n_hits)."""
    test = measure(scene, rng=np.random.default_rng(3))
    motion = np.array([np.abs(point.motion).max(axis=(-1, -2)) for point in test.points])
    return np.asarray(motion / [np.abs(point.force).max(axis=-1) for point in test.points])


@pytest.mark.long
def test_oblique_hits_push_less_and_unevenly() -> None:
    straight = nominal_scene(replace(plain(), level_scatter=0.0))
    tilted = straight.with_chain(tilt=0.5)
    left = ratios(tilted) / ratios(straight)
    assert left.max() < 1 + 1e-3
    assert 0.75 < left.mean() < 0.97
    assert left.std() > 0.02
    np.testing.assert_allclose(ratios(straight.with_chain(tilt=0.0)), ratios(straight))


def test_drift_moves_the_peaks_from_point_to_point() -> None:
    scene = nominal_scene(plain())
    first = scene.elastic().frequency[0]
    test = measure(scene.with_chain(drift=0.05), rng=np.random.default_rng(4))
    frfs = estimate_frfs(test)
    near = np.flatnonzero(np.abs(frfs.frequency / first - 1) < 0.08)
    tops = np.array([frfs.frequency[near[np.argmax(np.abs(row[near]))]] for row in frfs.values])
    resolution = np.diff(frfs.frequency[:2])[0] / first
    assert (tops[-1] - tops[0]) / first == pytest.approx(0.05 * (1 - 1 / len(tops)), abs=0.02 + resolution)


@pytest.mark.long
def test_levels_reach_the_records(monkeypatch: pytest.MonkeyPatch) -> None:
    """A joint that slips lowers the frequencies of hard hits, in the records themselves."""
    monkeypatch.setattr("modalkit.simulator.measurement.draw_conduct", lambda points, rng: Conduct())
    plan = DrawRanges(kinds=("beam",), effects=("joint_nonlinearity",), pairs=0.0, mild=0.0, strong=0.0)
    trial = draw_trial(5, 1, plan=plan)
    setup = replace(
        trial.scene.setup, noise=1e-9, bits=24, bad_hits=0.0, repeatability=0.0, position_sigma=0.0
    )
    scene = replace(trial.scene, setup=setup)
    test = measure(scene, rng=np.random.default_rng(2))
    row = int(np.argmax([np.ptp(np.log(np.abs(p.force).max(axis=-1))) for p in test.points]))
    point = test.points[row]
    level = np.abs(point.force).max(axis=-1)
    spectra = np.abs(np.fft.rfft(point.motion[:, 0], 64 * point.motion.shape[-1], axis=-1))
    line = np.arange(spectra.shape[-1]) * test.rate / (64 * point.motion.shape[-1])
    first = scene.elastic().frequency[0]
    near = np.flatnonzero(np.abs(line / first - 1) < 0.15)
    tops = line[near[np.argmax(spectra[:, near], axis=1)]]
    # between the levels that it was solved at the joint is interpolated, and the largest sample is less than the peak
    rest = scene.elastic(1e-6 * setup.peak).frequency[0]
    expected = np.array([scene.elastic(float(f)).frequency[0] for f in level])
    share = (rest - tops) / (rest - expected)
    assert (share > 0.95).all()
    assert (share < 1.3).all()
    assert np.corrcoef(level, tops)[0, 1] < -0.9


def test_baseline_shares_marks_and_calibration_with_the_test_and_is_mounted_anew() -> None:
    plan = DrawRanges(kinds=("beam",), effects=("lumped_mass",), baseline=1.0)
    trial = draw_trial(6, 1, plan=plan)
    assert trial.truth.baseline
    np.testing.assert_array_equal(trial.before.marks, trial.scene.marks)
    assert trial.before.chain == trial.scene.chain
    np.testing.assert_array_equal(trial.before.scatter, trial.scene.scatter)


def test_strays_split_into_marks_and_hits() -> None:
    setup = replace(plain(), position_sigma=0.002)
    drawn = np.array([draw_scene(setup, np.random.default_rng(k)).marks for k in range(200)])
    assert drawn.std() == pytest.approx(0.8 * 0.002, rel=0.06)
