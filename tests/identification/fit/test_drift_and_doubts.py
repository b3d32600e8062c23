"""One mode whose frequency differs from FRF to FRF is one mode; and what is said of doubtful ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from identification_cases import column, lines, structure

from acquisition.dof import Dof
from identification import identify

HERTZ, DAMPING = np.array([70.0, 150.0, 260.0]), (0.004, 0.003, 0.002)


def joined(parts):
    return replace(
        parts[0],
        values=np.concatenate([p.values for p in parts]),
        responses=sum((p.responses for p in parts), ()),
        references=sum((p.references for p in parts), ()),
    )


@pytest.mark.long
@pytest.mark.parametrize("drift", [0.0005, 0.002, 0.004])
def test_a_drift_over_the_test_invents_no_mode(drift):
    rng = np.random.default_rng(3)
    parts = [
        structure(HERTZ * (1 - drift * i / 12), DAMPING, 13, seed=5).frfs(
            lines(df=0.25, high=350.0), [(i + 1, 4)], noise=0.005, rng=rng
        )
        for i in range(13)
    ]
    model = identify(joined(parts), band=(20.0, 340.0))
    assert len(model) == 3, model.table()
    np.testing.assert_allclose(model.modal.frequency, HERTZ * (1 - drift / 2), rtol=0.3 * drift)
    np.testing.assert_allclose(model.modal.damping, DAMPING, rtol=0.05)
    assert any("differ from FRF to FRF" in w for w in model.warnings)


@pytest.mark.parametrize("separation", [1.003, 1.005, 1.01])
def test_two_modes_remain_two(separation):
    truth = structure((70.0, 150.0, 150.0 * separation, 260.0), (0.004, 0.003, 0.003, 0.002), 13, seed=5)
    frfs = truth.frfs(lines(df=0.25, high=350.0), column(13), noise=0.005, rng=np.random.default_rng(1))
    model = identify(frfs, band=(20.0, 340.0))
    assert len(model) == 4, model.table()
    np.testing.assert_allclose(model.modal.frequency, truth.hertz, rtol=2e-4)


def test_a_heavily_damped_mode_alone_in_its_band_is_found():
    truth = structure((100.0,), (0.08,), 4, seed=1)
    frfs = truth.frfs(
        lines(df=0.5, low=60.0, high=140.0), column(3), noise=0.005, rng=np.random.default_rng(0)
    )
    model = identify(frfs)
    assert len(model) == 1
    assert abs(model.modal.damping[0] - 0.08) < 4 * model.modal.damping_sigma[0]


def test_hum_and_a_foreign_frf_are_named():
    truth = structure((70.0, 130.0), (0.01, 0.008), 6, seed=2)
    frfs = truth.frfs(lines(df=1.0, high=200.0), column(6), noise=0.003, rng=np.random.default_rng(0))
    values = np.array(frfs.values)
    share = np.random.default_rng(1).standard_normal((6, 1))
    values += 0.02 * share * np.abs(values).max() / (frfs.frequency - 100.02)  # a tone leaks over the lines
    model = identify(replace(frfs, values=values))
    assert len(model) == 2
    assert any("tone at 100.0 Hz" in w and "mains" in w for w in model.warnings)
    other = structure((95.0, 160.0), (0.01, 0.008), 6, seed=3)
    foreign, values = other.frfs(frfs.frequency, [(3, 4)]).values[0], np.array(frfs.values)
    values[2] = foreign
    model = identify(replace(frfs, values=values))
    np.testing.assert_allclose(model.modal.frequency, truth.hertz, rtol=1e-3)
    assert any("contradict the others and are set aside: 3+Z/4+Z" in w for w in model.warnings)
    values[2] = frfs.values[2] + 0.05 * foreign  # modes of its own beside those of all others
    assert any("3+Z/4+Z only" in w for w in identify(replace(frfs, values=values)).warnings)


def test_a_reference_of_wrong_gain_is_told_by_reciprocity():
    truth = structure((70.0, 130.0), (0.01, 0.008), 8, seed=2)
    pairs = [(i, j) for j in (2, 5) for i in range(1, 9)]
    frfs = truth.frfs(lines(high=200.0), pairs, noise=0.003, rng=np.random.default_rng(0))
    assert not identify(frfs).warnings
    values = np.array(frfs.values)
    values[8:] *= 1.15
    assert any("2+Z" in w and "5+Z" in w for w in identify(replace(frfs, values=values)).warnings)


def test_a_drive_point_that_is_none_gives_no_scale():
    truth = structure((70.0, 130.0, 170.0), (0.01, 0.008, 0.01), 6, seed=2)
    truth.shapes[4] = truth.shapes[3] * [1, -1, 1]  # the sensor called 4 sits at 5
    frfs = truth.frfs(
        lines(high=200.0), [(i, 4) for i in (1, 2, 3, 5)], noise=0.003, rng=np.random.default_rng(0)
    )
    named = replace(frfs, responses=(Dof(1, 3), Dof(2, 3), Dof(3, 3), Dof(4, 3)))
    model = identify(named)
    assert not model.modal.scaled
    assert any("cannot have been at one place" in w for w in model.warnings)


def test_a_pair_is_found_in_a_matrix_with_gaps():
    truth = structure((70.0, 150.0, 150.08, 260.0), (0.004, 0.003, 0.0035, 0.002), 20, seed=7)
    pairs = [(i, j) for j in (2, 5, 11) for i in range(1, 21)]
    keep = np.flatnonzero(np.random.default_rng(1).random(60) < 0.6)
    frfs = truth.frfs(lines(df=0.25, high=350.0), pairs, noise=0.005, rng=np.random.default_rng(1)).select(
        keep
    )
    model = identify(frfs, band=(20.0, 340.0))
    assert len(model) == 4, (model.table(), model.warnings)
