"""Points hit in several runs, dead channels, pairs that disagree: whose verdict is whose."""

from __future__ import annotations

from dataclasses import replace

import hit_cases
import numpy as np
import pytest

from acquisition import (
    Dof,
    HammerPlan,
    HammerTest,
    Hits,
    InputError,
    decide,
    estimate_frfs,
    force_range,
    hammer_test,
    hits_table,
    judge_hits,
    modal_system,
    unstated_window,
    verdicts_of,
)
from acquisition.frfs.estimators import kept_hits

SYSTEM = modal_system(
    frequency=np.array([60.0, 140.0]),
    damping=np.array([0.01, 0.01]),
    response_shapes=np.array([[1.0, 0.7], [0.4, -0.8]]),
    point_shapes=np.array([[1.0, 0.7], [0.1, 0.9]]),
    responses=(Dof(1, 3), Dof(2, 3)),
    points=(Dof(1, 3), Dof(4, 3)),
)
PLAN = HammerPlan(rate=1024.0, samples=2048, width=4e-3, response_noise=1e-3, adc_bits=None)


def hits(seed: int, count: int, point: int = 0) -> Hits:
    plan = replace(PLAN, hits=count)
    return hammer_test(SYSTEM, plan, rng=np.random.default_rng(seed)).points[point]


def runs(counts: tuple[int, ...] = (3, 5, 5), weak: tuple[int, int] = (1, 3)) -> HammerTest:
    """Return runs at one point, of which one hit is too weak."""
    points = []
    for run, count in enumerate(counts):
        one = hits(run, count)
        if run == weak[0]:
            force, motion = np.array(one.force), np.array(one.motion)
            force[weak[1]] *= 0.02
            motion[weak[1]] *= 0.02
            one = replace(one, force=force, motion=motion)
        points.append(one)
    return HammerTest(1024.0, tuple(points))


def masks(test, verdicts):
    return [mask.tolist() for _, mask in kept_hits(test, verdicts)]


def test_runs_are_numbered_through_and_their_verdicts_stay_with_them():
    test = runs()
    verdicts = judge_hits(test)
    assert [v.hit for v in verdicts] == list(range(1, 14))
    assert [v.hit for v in verdicts if not v.used] == [7]
    expected = [[True] * 3, [True, True, True, False, True], [True] * 5]
    assert masks(test, verdicts) == expected
    assert masks(test, verdicts[::-1]) == expected
    assert estimate_frfs(test, verdicts=verdicts).averages.tolist() == [3, 3, 4, 4, 5, 5]


def test_a_decision_meets_one_hit_of_one_run():
    test = runs()
    decided = decide(judge_hits(test), use=[("1+Z", 7)], leave=[("1+Z", 9)])
    assert masks(test, decided) == [[True] * 3, [True] * 5, [False, True, True, True, True]]
    assert hits_table(decided)["hit"].is_unique
    with pytest.raises(InputError, match=r"no hit 14 at 1\+Z; hits there: 1 to 13"):
        decide(decided, leave=[("1+Z", 14)])


def test_verdicts_on_some_hits_find_them_by_number():
    test = runs()
    some = [v for v in judge_hits(test) if v.hit in (7, 12)]
    stated = verdicts_of(test, some)
    assert [[None if v is None else v.hit for v in run] for run in stated] == [
        [None] * 3,
        [None, None, None, 7, None],
        [None, None, None, 12, None],
    ]


def dead(test: HammerTest, which: list[int], value: float = 0.0) -> HammerTest:
    def one(p: Hits) -> Hits:
        motion = np.array(p.motion)
        motion[:, which] = value
        return replace(p, motion=motion)

    return replace(test, points=tuple(one(p) for p in test.points))


@pytest.mark.parametrize("value", [0.0, 3.5])
def test_a_dead_response_is_noted_and_refuses_only_what_has_no_other(value):
    test = HammerTest(1024.0, (hits(1, 4),))
    for verdict in judge_hits(dead(test, [1], value)):
        assert verdict.used
        assert any("2+Z is dead" in reason for reason in verdict.reasons)
    for verdict in judge_hits(dead(test, [0, 1], value)):
        assert not verdict.used
        assert verdict.reasons[0] == "no response: 1+Z, 2+Z dead, the record is constant"
    assert not any("dead" in reason for v in judge_hits(test) for reason in v.reasons)


def test_two_hits_that_disagree_are_both_noted():
    here, there = hits(1, 2), hits(1, 2, point=1)
    mixed = replace(
        here,
        force=np.stack([here.force[0], there.force[1]]),
        motion=np.stack([here.motion[0], there.motion[1]]),
    )
    verdicts = judge_hits(HammerTest(1024.0, (mixed,)))
    assert all(v.used and "the two hits at this point disagree" in v.reasons[-1] for v in verdicts)


def test_two_hits_that_agree_are_not():
    """Random chains with noise of up to 1 % of the peak."""
    message = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        test, _ = hit_cases.several(rng, hit_cases.setting(rng), None, hits=2)
        message += [r for v in judge_hits(test) for r in v.reasons if "disagree" in r]
    assert message == []


def test_the_force_range_is_that_of_the_used_hits():
    verdicts = judge_hits(runs())
    found = force_range(verdicts)
    peaks = [v.peak for v in verdicts if v.used]
    assert found is not None
    assert (found.weakest, found.strongest) == (min(peaks), max(peaks))
    assert found.band10 < found.band20
    assert "20 dB down at" in str(found)
    assert force_range([replace(v, used=False) for v in verdicts]) is None


def test_an_unstated_window_is_heard_and_none_is_imagined():
    """A window that leaves a twentieth at the end of the record, on random chains."""
    imagined, heard = 0, 0
    for seed in range(120):
        rng = np.random.default_rng(seed)
        s = hit_cases.setting(rng)
        test = hit_cases.one_force(rng, s)
        imagined += unstated_window(test) is not None
        decay = 3.0 * s.rate / s.samples
        (point,) = test.points
        force = point.force * np.exp(-decay * np.arange(s.samples) / s.rate)
        found = unstated_window(replace(test, points=(replace(point, force=force),)))
        heard += found is not None and abs(found - decay) < 0.3 * decay
    assert imagined == 0
    assert heard >= 114
