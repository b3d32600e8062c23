"""A hit beside its point changes constants by how far the sensor moves, which near a node only the test knows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import PLATE, STEEL, blank, exactly

from identification.hit_errors import HitErrors
from updating import Case, Measured, Predictor, Spec, Tolerances
from updating.diagnosis.diagnose import pose
from updating.likelihood.base import Setting
from updating.likelihood.places import Places

SIGMA, ASIDE = 1e-3, 5e-4
FREE = Spec(
    "plate",
    length=0.4,
    width=0.3,
    thickness=0.003,
    elements=(12, 10),
    clamped=(),
    theory="kirchhoff",
    material=STEEL,
    damping=PLATE.damping,
)


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


@pytest.mark.long
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


def with_hits(test: Measured, place: float) -> Measured:
    """State what five hits a point add to the errors of its constants, where they scatter about it by so much [m]."""
    predictor = Predictor(FREE, test)
    truth = predictor.predict(count=5)
    rng, hits = np.random.default_rng(1), 5
    along = truth.along[:, :, None, :]
    away = place * rng.standard_normal((2, len(test.hit), hits, 1))
    white = 1e-4 * np.abs(truth.constants).max(axis=0) * np.ones_like(truth.constants)
    noise = np.sqrt(hits) * white[:, None] * rng.standard_normal((len(test.hit), hits, 5))
    each = np.sum(along * away, axis=0) + noise
    deviations = (each - each.mean(axis=1, keepdims=True)) / np.sqrt(hits * (hits - 1))
    errors = HitErrors(
        deviations, np.full(len(test.hit), hits - 1.0), white, np.arange(len(test.hit)), np.ones(5)
    )
    return replace(exactly(predictor, truth, sigma=1e-6), position_sigma=SIGMA, hit_errors=errors)


def doubts(case: Case) -> np.ndarray:
    """Return how far each place is in doubt, by the columns of what roves [m]."""
    setting = pose(case)[0].setting
    now = setting.nominal
    moved_by = Places(setting).columns(now, np.ones_like(now.constants), setting.measured.constants)[0]
    slopes = now.gain * now.seen * now.hit_slopes[0]
    strong = np.abs(slopes).argmax(axis=1)
    found = moved_by.reshape(*now.constants.shape, -1)
    rows = np.arange(len(strong))
    return np.asarray(np.abs(found[rows, strong, 2 * rows] / slopes[rows, strong]))


@pytest.mark.long
def test_after_a_baseline_of_the_same_marks_the_scatter_of_the_hits_is_all_that_is_in_doubt() -> None:
    tested, before = with_hits(stated(), 2e-4), with_hits(stated(), 2e-4)
    alone = Case("a plate", FREE, tested, tolerances=Tolerances({"E": 0.01}))
    x = stated().points[:, 0]
    inner = (x > 0.05) & (x < 0.35)
    assert doubts(alone)[inner] == pytest.approx(np.full(inner.sum(), SIGMA), rel=0.05)
    both = replace(alone, baseline=before)
    expected = 2e-4 * np.sqrt(2 / 5)
    assert doubts(both)[inner] == pytest.approx(np.full(inner.sum(), expected), rel=0.4)


def test_hits_that_scatter_more_than_stated_are_believed() -> None:
    far = Case("a plate", FREE, with_hits(stated(), 5e-3), tolerances=Tolerances({"E": 0.01}))
    x = stated().points[:, 0]
    inner = (x > 0.05) & (x < 0.35)
    assert doubts(far)[inner] == pytest.approx(np.full(inner.sum(), 5e-3 / np.sqrt(5)), rel=0.4)
