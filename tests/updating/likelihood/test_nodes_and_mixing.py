"""What transducers read besides, and what a doubtful change makes of close modes: against two-by-two problems."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from updating_cases import BEAM, DOUBTS, POINTS, blank

from updating import Case, Measured, Predictor, Tolerances
from updating.diagnosis.diagnose import pose
from updating.likelihood.base import Setting
from updating.likelihood.mixing import mixed
from updating.likelihood.nodes import Nodes
from updating.thresholds import COUPLED_SHARE, LEAST_CONSTANT_NOISE

MODES = 4


def measured() -> Measured:
    evaluation = Predictor(BEAM, blank(POINTS))
    truth = evaluation.predict(count=MODES)
    return replace(
        evaluation.measured,
        frequency=truth.frequency,
        frequency_sigma=1e-4 * truth.frequency,
        damping=truth.damping,
        damping_sigma=0.03 * truth.damping,
        constants=truth.constants,
        constants_sigma=0.01 * np.abs(truth.constants).max(axis=0) * np.ones_like(truth.constants),
    )


@pytest.fixture(scope="module")
def setting() -> Setting:
    return pose(Case("a beam", BEAM, measured(), tolerances=Tolerances(DOUBTS)))[0].setting


def test_the_level_of_a_mode_is_in_doubt_by_how_little_it_moves_where_all_frfs_meet(setting: Setting) -> None:
    now, test = setting.nominal, setting.measured
    columns = Nodes(setting).columns(now, np.ones_like(now.constants)).reshape(*now.constants.shape, -1)
    shapes = setting.predictor.nominal_rows["w"][:, : len(now.vectors)] @ now.vectors
    (there,) = np.unique(test.seen)
    for m in range(MODES):
        share = columns[:, m, m] / now.constants[:, m]
        besides = np.sqrt(np.mean(shapes[:, m] ** 2)) / shapes[there, m]
        assert share == pytest.approx(LEAST_CONSTANT_NOISE * besides)
    assert np.count_nonzero(columns.any(axis=0)) == MODES


def test_no_level_no_doubt_in_it(setting: Setting) -> None:
    shapes_only = replace(setting, measured=replace(setting.measured, absolute=False))
    assert Nodes(shapes_only).columns(setting.nominal, np.ones_like(setting.nominal.constants)).size == 0


@pytest.mark.parametrize("near", [0.05, 0.1])
def test_close_modes_mix_as_a_coupling_mass_has_it(setting: Setting, near: float) -> None:
    """The eigenvectors of two modes with m_12 beside unit masses, and m_11 that moves the first by the doubt."""
    now, fidelity, shift = setting.nominal, 0.02, 0.1
    frequency = now.frequency.copy()
    frequency[1] = frequency[0] * np.exp(near)
    close = replace(now, frequency=frequency)
    before = replace(setting, nominal=replace(now, frequency=frequency * np.exp(shift)))
    level = np.ones_like(now.constants)
    column = mixed(before, close, close, level, fidelity).reshape(*now.constants.shape, MODES)[:, 0, 0]
    coupling = COUPLED_SHARE * 2 * fidelity * shift
    _, vectors = eigh(np.diag(frequency[:2] ** 2), np.array([[1.0, coupling], [coupling, 1.0]]))
    first = vectors[:, 0] / vectors[0, 0]
    rows = setting.predictor.nominal_rows["w"][:, : len(now.vectors)] @ now.vectors
    shape, test = rows[:, :2] @ first, setting.measured
    exact = shape[test.seen] * shape[test.hit] - rows[test.seen, 0] * rows[test.hit, 0]
    assert np.abs(column) == pytest.approx(np.abs(exact), rel=0.15)


def test_distant_modes_hardly_mix(setting: Setting) -> None:
    now = setting.nominal
    before = replace(setting, nominal=replace(now, frequency=1.1 * now.frequency))
    columns = mixed(before, now, now, np.ones_like(now.constants), 0.02)
    assert np.abs(columns).max() < 2e-3 * np.abs(now.constants).max()
