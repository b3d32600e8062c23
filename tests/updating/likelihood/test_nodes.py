"""What transducers read besides is a doubt in the levels of modes that hardly move there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, DOUBTS, POINTS, blank, exactly

from updating import Case, Measured, Predictor, Tolerances
from updating.diagnosis.diagnose import pose
from updating.likelihood.base import Setting
from updating.likelihood.nodes import Nodes
from updating.thresholds import LEAST_CONSTANT_NOISE

MODES = 4


def measured() -> Measured:
    evaluation = Predictor(BEAM, blank(POINTS))
    return exactly(evaluation, evaluation.predict(count=MODES))


@pytest.fixture(scope="module")
def setting() -> Setting:
    return pose(Case("a beam", BEAM, measured(), tolerances=Tolerances(DOUBTS)))[0].setting


def test_the_level_of_a_mode_is_in_doubt_by_how_little_it_moves_where_all_frfs_meet(setting: Setting) -> None:
    now, test = setting.nominal, setting.measured
    columns = Nodes(setting).columns(now, np.ones_like(now.constants)).reshape(*now.constants.shape, -1)
    shapes = setting.predictor.nominal_rows["w"][:, : len(now.vectors)] @ now.vectors
    shapes = shapes * np.sign(np.sum(shapes[test.hit] * now.hit, axis=0))
    (there,) = np.unique(test.seen)
    for m in range(MODES):
        share = columns[:, m, m] / now.constants[:, m]
        besides = np.sqrt(np.mean(shapes[:, m] ** 2)) / shapes[there, m]
        assert share == pytest.approx(LEAST_CONSTANT_NOISE * besides)
    assert np.count_nonzero(columns.any(axis=0)) == MODES


def test_no_level_no_doubt_in_it(setting: Setting) -> None:
    shapes_only = replace(setting, measured=replace(setting.measured, absolute=False))
    assert Nodes(shapes_only).columns(setting.nominal, np.ones_like(setting.nominal.constants)).size == 0


def test_a_shape_that_is_turned_round_changes_nothing(setting: Setting) -> None:
    now = setting.nominal
    level = np.ones_like(now.constants)
    turned = replace(now, vectors=-now.vectors, seen=-now.seen, hit=-now.hit)
    assert Nodes(setting).columns(turned, level) == pytest.approx(Nodes(setting).columns(now, level))
