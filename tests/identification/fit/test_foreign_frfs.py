"""FRFs of another mounting are set aside; what drifts, scatters or has another direction stays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from identification_cases import Structure, column, lines, structure

from acquisition import Dof, FrfSet
from identification import identify
from identification.fit.foreign import foreign_frfs

HERTZ, DAMPING, BAND = np.array([70.0, 150.0, 260.0]), 0.001, (20.0, 340.0)
LINES = lines(df=0.25, low=20.0, high=340.0)


def mixed(shifts: np.ndarray, seed: int, *, damping: float = DAMPING) -> FrfSet:
    """FRFs of one point each, whose frequencies are shifted by (n_frf, 3)."""
    truth, rng = structure(HERTZ, (damping,) * 3, len(shifts), seed), np.random.default_rng(seed)
    parts = [
        Structure(truth.poles * (1 + shift), truth.shapes).frfs(LINES, [pair], noise=0.005, rng=rng)
        for pair, shift in zip(column(len(shifts)), shifts, strict=True)
    ]
    return replace(
        parts[0],
        values=np.concatenate([p.values for p in parts]),
        responses=tuple(p.responses[0] for p in parts),
        references=tuple(p.references[0] for p in parts),
    )


@pytest.mark.parametrize("heavy", [-0.03, -0.01, 0.02])
@pytest.mark.parametrize("rows", [[5], [0, 7, 11]])
def test_a_minority_of_another_mounting_is_set_aside_and_named(heavy: float, rows: list[int]) -> None:
    for seed in range(3):
        shifts = np.zeros((13, 3))
        shifts[rows] = heavy * np.array([1.0, 0.95, 1.05])
        frfs = mixed(shifts, seed)
        assert np.flatnonzero(foreign_frfs(frfs).rows).tolist() == rows
    model = identify(frfs)
    np.testing.assert_allclose(model.modal.frequency, HERTZ, rtol=1e-4)
    np.testing.assert_allclose(model.modal.damping, DAMPING, rtol=0.05)
    named = ", ".join(f"{r + 1}+Z/4+Z" for r in rows)
    assert any(f"{len(rows)} of 13 FRFs contradict the others" in w and named in w for w in model.warnings)
    assert [reason.split(":")[0] for reason in model.points_rejected] == named.split(", ")
    assert len(model.frfs.values) == 13 - len(rows)


@pytest.mark.parametrize("course", ["line", "warming up", "set-ups", "loading"])
def test_what_drifts_or_scatters_stays(course: str) -> None:
    place = np.linspace(0.0, 1.0, 13)[:, None]
    for seed in range(4):
        rng = np.random.default_rng(seed)
        shifts = {
            "line": -0.01 * place,
            "warming up": -0.005 * (1 - np.exp(-4 * place)),
            "set-ups": 0.003 * rng.standard_normal((13, 1)),
            "loading": -0.002 * rng.standard_normal((13, 3)) ** 2,
        }[course]
        frfs = mixed(np.broadcast_to(shifts, (13, 3)), seed, damping=0.002)
        assert not foreign_frfs(frfs).rows.any(), (course, seed)


@pytest.mark.parametrize("rows", [[], [20]])
def test_a_course_that_quickens_beyond_the_width_of_peaks_stays(rows: list[int]) -> None:
    steps = np.maximum((np.arange(21) - 10) // 2, 0.0)
    for seed in range(3):
        shifts = np.tile(-1e-5 * steps[:, None] ** 3, 3)
        shifts[rows] = -0.03
        frfs = mixed(shifts, seed, damping=1e-4)
        assert np.flatnonzero(foreign_frfs(frfs).rows).tolist() == rows


def test_one_that_jumps_beside_a_course_is_set_aside() -> None:
    shifts = np.tile(-0.004 * np.linspace(0.0, 1.0, 13)[:, None], 3)
    shifts[12] = -0.03
    assert np.flatnonzero(foreign_frfs(mixed(shifts, 1)).rows).tolist() == [12]


def test_another_direction_may_show_other_modes() -> None:
    shifts = np.zeros((13, 3))
    shifts[5] = 0.04
    frfs = mixed(shifts, 2)
    turned = tuple(replace(d, direction=1) if i == 5 else d for i, d in enumerate(frfs.responses))
    assert not foreign_frfs(replace(frfs, responses=turned)).rows.any()


def test_halves_that_contradict_are_both_kept() -> None:
    shifts = np.zeros((12, 3))
    shifts[::2] = 0.03
    assert not foreign_frfs(mixed(shifts, 3)).rows.any()


def test_an_frf_near_a_node_stays() -> None:
    frfs = mixed(np.zeros((13, 3)), 4)
    rng = np.random.default_rng(4)
    values = np.array(frfs.values)
    values[6] = 1e-3 * (rng.standard_normal(len(LINES)) + 1j * rng.standard_normal(len(LINES)))
    assert not foreign_frfs(replace(frfs, values=values)).rows.any()
    assert frfs.responses[6] == Dof(7, 3)


def test_peaks_less_than_a_line_beside_the_others_are_others() -> None:
    coarse, rng = lines(df=1.0, low=20.0, high=340.0), np.random.default_rng(3)
    truth, pairs = structure(HERTZ, (0.003,) * 3, 13, 3), column(13)
    frfs = truth.frfs(coarse, pairs, noise=0.005, rng=rng)
    other = Structure(truth.poles * 0.994, truth.shapes).frfs(coarse, [pairs[5]], noise=0.005, rng=rng)
    values = np.array(frfs.values)
    values[5] = other.values[0]
    assert np.flatnonzero(foreign_frfs(replace(frfs, values=values)).rows).tolist() == [5]
    assert not foreign_frfs(frfs).rows.any()
