"""Points of a test and of its baseline are the same by where they are, not by their numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import case_of, specimen, struck

from updating import LIBRARY, Measured, diagnose
from updating.diagnosis.diagnose import pose
from updating.test_data.same_places import same_points, same_rows, unmatched


def renumbered(test: Measured, order: np.ndarray, *, first: int = 101) -> Measured:
    """The same test with its points in another order and under other numbers."""
    place = np.argsort(order)
    return replace(
        test,
        points=test.points[order],
        nodes=tuple(range(first, first + len(order))),
        seen=place[test.seen],
        hit=place[test.hit],
    )


def pair() -> tuple[Measured, Measured]:
    """A beam on a soft clamp, which its model does not have, tested twice."""
    rng = np.random.default_rng(5)
    beam = specimen(rng, rotation=60.0)
    return struck(beam, rng), struck(beam, rng)


def test_rows_are_found_by_place() -> None:
    test, baseline = pair()
    order = np.random.default_rng(1).permutation(len(test.points))
    here, there = same_rows(test, renumbered(baseline, order))
    assert here.tolist() == there.tolist() == list(range(len(test.seen)))
    assert same_points(test, renumbered(baseline, order)).tolist() == np.argsort(order).tolist()


@pytest.mark.long
def test_a_baseline_under_other_numbers_gives_the_same_answer() -> None:
    """No gap, whatever the points are called: what the model's shapes miss the baseline has shown."""
    test, baseline = pair()
    other = renumbered(baseline, np.random.default_rng(1).permutation(len(test.points)))
    found = [
        diagnose(case_of(test, baseline=one), library=[LIBRARY["E"]], rng=np.random.default_rng(0))
        for one in (baseline, other)
    ]
    # a maximum is found to steps of 1e-6 sigma, and points in another order end it at another of these
    assert found[0].p_value == pytest.approx(found[1].p_value, rel=1e-6)
    assert not found[0].significant and not found[1].significant
    assert not any("were not measured in it" in w for one in found for w in one.warnings)


def test_points_that_a_baseline_lacks_are_said() -> None:
    test, baseline = pair()
    fewer = replace(
        baseline,
        seen=baseline.seen[2:],
        hit=baseline.hit[2:],
        constants=baseline.constants[2:],
        constants_sigma=baseline.constants_sigma[2:],
        points=np.vstack([baseline.points[:2] + 0.02, baseline.points[2:]]),
    )
    _, warnings = pose(case_of(test, baseline=fewer))
    (message,) = [w for w in warnings if "were not measured in it" in w]
    assert message.startswith(f"baseline: 2 of the test's {len(test.seen)} FRFs")
    assert (
        "point(s) 1, 2 are not among its points (number 1 lies 20 mm from its place in the baseline)"
        in message
    )


def test_the_same_number_at_another_place_is_another_point() -> None:
    test, baseline = pair()
    moved = replace(baseline, points=baseline.points[::-1].copy())
    assert same_points(test, moved).tolist() == list(range(len(test.points)))[::-1]


def test_points_whose_places_are_known_to_a_millimetre_may_differ_by_some() -> None:
    test, baseline = pair()
    shifted = replace(baseline, points=baseline.points + 0.003)
    assert len(same_rows(test, shifted)[0]) == len(test.seen)
    assert unmatched(test, shifted) == ()
    precise = [replace(one, position_sigma=1e-4) for one in (test, shifted)]
    assert len(same_rows(*precise)[0]) == 0
    (message,) = unmatched(*precise)
    assert "3 mm from its place in the baseline" in message


def test_shapes_alone_have_no_rows() -> None:
    test, baseline = pair()
    bare = replace(baseline, hit=np.full(len(baseline.hit), -1), absolute=False)
    assert len(same_rows(test, bare)[0]) == 0
    assert unmatched(test, bare) == ()
