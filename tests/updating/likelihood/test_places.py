"""A hit beside its point changes constants by how far the sensor moves, which near a node only the test knows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import PLATE, STEEL, blank, exactly

from updating import Case, Measured, Predictor, Spec, Tolerances
from updating.diagnosis.diagnose import pose
from updating.likelihood.base import Setting
from updating.likelihood.places import Places

SIGMA, ASIDE = 1e-3, 5e-4
FREE = Spec("plate", 0.4, 0.3, 0.003, (12, 10), (), "kirchhoff", STEEL, damping=PLATE.damping)


def stated() -> Measured:
    """A grid of points, the sensor on a line of symmetry: half of the modes have a node there."""
    x, y = np.meshgrid([0.01, 0.13, 0.27, 0.39], [0.01, 0.15, 0.29], indexing="ij")
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    return replace(
        blank(points), seen=np.full(len(points), 1), hit=np.arange(len(points)), position_sigma=SIGMA
    )


def moved(test: Measured, point: int, away: tuple[float, float]) -> Measured:
    points = test.points.copy()
    points[point] += away
    return replace(test, points=points)


@pytest.fixture(scope="module")
def setting() -> Setting:
    test = stated()
    truth = Predictor(FREE, moved(test, 1, (0.0, ASIDE))).predict(count=5)
    measured = replace(exactly(Predictor(FREE, test), truth, sigma=1e-6), position_sigma=SIGMA)
    return pose(Case("a plate", FREE, measured, tolerances=Tolerances({"E": 0.01})))[0].setting


@pytest.mark.parametrize(("point", "axis"), [(0, 0), (6, 1), (11, 1)])
def test_a_hit_beside_its_point_changes_what_the_sensor_really_reads(
    setting: Setting, point: int, axis: int
) -> None:
    now, test = setting.nominal, stated()
    at_node = np.abs(now.seen[0]) < 1e-6 * np.abs(now.seen).max()
    assert 0 < np.count_nonzero(at_node) < len(at_node)
    hits = Places(setting).columns(now, np.ones_like(now.constants), setting.measured.constants)[0]
    found = hits.reshape(*now.constants.shape, -1)[point, :, 2 * point + axis]
    really = moved(test, 1, (0.0, ASIDE))
    step = tuple(1e-5 * np.eye(2)[axis])
    there, beside = (Predictor(FREE, one).predict(count=5) for one in (really, moved(really, point, step)))
    # in units of how large each mode's constants are: those at a node are small
    size = np.sqrt(np.mean(there.constants**2, axis=0))
    expected = (beside.constants - there.constants)[point] * SIGMA / 1e-5 / size
    assert np.abs(expected[at_node]).max() > 0.003
    assert found / size == pytest.approx(expected, rel=0.02, abs=3e-4)
