"""Raw hits and FRFs in one call, FRFs that are copies of each other, and FRFs that are none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from acquisition import Dof, InputError, estimate_frfs, hammer_test, write_uff
from acquisition.synthetic import HammerPlan, modal_system
from modalkit.workflow.frf_checks import identical
from modalkit.workflow.identification import read

SYSTEM = modal_system(
    frequency=np.array([80.0, 200.0]),
    damping=np.array([0.01, 0.01]),
    response_shapes=np.array([[1.0, 0.8]]),
    point_shapes=np.array([[1.0, 0.8], [0.6, -0.9], [0.3, 0.7], [-0.5, 0.4]]),
    responses=[Dof(1, 3)],
    points=[Dof(n, 3) for n in (1, 2, 3, 4)],
)
PLAN = HammerPlan(rate=1024.0, samples=4096, hits=3, width=4e-3, response_noise=1e-4, adc_bits=None)
TEST = hammer_test(SYSTEM, PLAN, rng=np.random.default_rng(3))
HITS = replace(TEST, points=TEST.points[:2])
FRFS = estimate_frfs(TEST)


def written(folder: Path, frfs, hits=HITS) -> list[Path]:
    write_uff(folder / "hits.uff", tests=hits)
    write_uff(folder / "frfs.uff", frfs=frfs)
    return [folder / "hits.uff", folder / "frfs.uff"]


@pytest.mark.parametrize("kind", ["all lines", "to rate / 2.56", "receptance"])
def test_hits_and_frfs_at_other_points_are_both_used(tmp_path: Path, kind: str) -> None:
    frfs = FRFS.select([2, 3])
    if kind == "receptance":
        frfs = frfs.to("receptance")
    elif kind == "to rate / 2.56":
        frfs = frfs.band(0.0, 400.0)
    found = read(written(tmp_path, frfs))
    assert [d.node for d in found.frfs.references] == [1, 2, 3, 4]
    assert any("FRFs without raw hits are used as read (1+Z/3+Z, 1+Z/4+Z)" in w for w in found.warnings)
    model = found.identify(band=(40, 300))
    np.testing.assert_allclose(model.modal.frequency, [80, 200], rtol=1e-4)
    assert model.modal.shapes.shape[0] == 4


def test_frfs_at_the_points_of_hits_give_way_to_them_even_where_these_are_refused(tmp_path: Path) -> None:
    dead = replace(HITS.points[1], motion=np.zeros_like(HITS.points[1].motion))
    found = read(written(tmp_path, FRFS, replace(HITS, points=(HITS.points[0], dead))))
    assert [d.node for d in found.frfs.references] == [1, 3, 4]
    assert any("estimated again from the hits" in w for w in found.warnings)


def test_frfs_that_do_not_go_with_the_hits_are_left_out_by_name(tmp_path: Path) -> None:
    other = estimate_frfs(hammer_test(SYSTEM, replace(PLAN, samples=3000), rng=np.random.default_rng(4)))
    found = read(written(tmp_path, other.select([3])))
    assert [d.node for d in found.frfs.references] == [1, 2]
    assert any("left out (1+Z/4+Z)" in w and "Hz apart" in w for w in found.warnings)
    windowed = replace(FRFS.select([3]), decay=2.0)
    found = read(written(tmp_path, windowed))
    assert any("left out (1+Z/4+Z)" in w and "window" in w for w in found.warnings)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_one_measurement_at_two_points_is_said(tmp_path: Path, sign: float) -> None:
    values = np.array(FRFS.values)
    values[3] = sign * values[1]
    write_uff(tmp_path / "copy.uff", frfs=replace(FRFS, values=values, variance=None, scatter=None))
    message = [w for w in read(tmp_path / "copy.uff").warnings if "identical" in w]
    assert len(message) == 1 and "1+Z/2+Z, 1+Z/4+Z" in message[0]
    same = replace(TEST, points=(*TEST.points[:3], replace(TEST.points[0], reference=Dof(4, 3))))
    write_uff(tmp_path / "hits.uff", tests=same)
    message = [w for w in read(tmp_path / "hits.uff").warnings if "identical" in w]
    assert len(message) == 1 and "1+Z/1+Z, 1+Z/4+Z" in message[0]


def test_reciprocal_and_different_frfs_are_no_copies() -> None:
    assert identical(FRFS) == ()
    turned = replace(
        FRFS.select([1, 1]),
        responses=(Dof(1, 3), Dof(2, 3)),
        references=(Dof(2, 3), Dof(1, 3)),
        variance=None,
        scatter=None,
    )
    assert identical(turned) == ()


def test_constant_frfs_are_left_out_or_refused_in_one_line(tmp_path: Path) -> None:
    points = tuple(replace(p, motion=np.array(p.force)[:, None]) for p in TEST.points)
    write_uff(tmp_path / "all.uff", tests=replace(TEST, points=points))
    with pytest.raises(InputError, match="every FRF is the same at all frequencies"):
        read(tmp_path / "all.uff")
    write_uff(tmp_path / "one.uff", tests=replace(TEST, points=(points[0], *TEST.points[1:])))
    found = read(tmp_path / "one.uff")
    assert any("FRF 1+Z/1+Z is the same at all frequencies and was left out" in w for w in found.warnings)
    np.testing.assert_allclose(found.identify(band=(40, 300)).modal.frequency, [80, 200], rtol=1e-4)
