"""Which response belongs to which force, when records are missing, doubled or spread over files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from acquisition import Dof, HammerTest, Hits, UffContent, read_uff, write_uff

SAMPLES = 32
A, B, HAMMER = Dof(1, 3), Dof(2, 3), Dof(1, 3)


def some_test(count: int = 4, responses: tuple[Dof, ...] = (A, B), seed: int = 1) -> HammerTest:
    """Return hits whose first sample is the number of the hit, in every record."""
    rng = np.random.default_rng(seed)
    force = rng.standard_normal((count, SAMPLES))
    motion = rng.standard_normal((count, len(responses), SAMPLES))
    force[:, 0] = np.arange(count)
    motion[:, :, 0] = np.arange(count)[:, None]
    return HammerTest(512.0, (Hits(HAMMER, responses, force, motion),))


def split(test: HammerTest, folder: Path) -> tuple[bytes, list[bytes]]:
    """Return what stands before the records, and each record."""
    write_uff(folder / "whole.uff", tests=test)
    parts = (folder / "whole.uff").read_bytes().split(b"    -1\n    58b")
    return parts[0], [b"    -1\n    58b" + p for p in parts[1:]]


def unnumbered(record: bytes) -> bytes:
    """Take the number of the hit out of the ID line, keeping its length."""
    at = record.find(b"hit ")
    return record if at < 0 else record[:at] + b"-----" + record[at + 5 :]


def stamped(record: bytes, hit: int) -> bytes:
    """Put a time of day into the third ID line."""
    lines = unnumbered(record).split(b"\n", 5)
    lines[4] = f"{f'21-Nov-26 10:{hit:02d}:30':<80s}".encode()
    return b"\n".join(lines)


def read(folder: Path, head: bytes, records: list[bytes]) -> UffContent:
    (folder / "a.uff").write_bytes(head + b"".join(records))
    return read_uff(folder / "a.uff")


def hits_of(content: UffContent) -> list[tuple[Dof, int, int]]:
    """Return (response, number of the force, number of the response) of all pairs."""
    return sorted(
        (dof, int(force[0]), int(wave[0]))
        for test in content.tests
        for point in test.points
        for force, motion in zip(point.force, point.motion, strict=True)
        for dof, wave in zip(point.responses, motion, strict=True)
    )


def all_pairs(numbers: tuple[int, ...], dofs: tuple[Dof, ...] = (A, B)) -> list[tuple[Dof, int, int]]:
    return sorted((dof, n, n) for dof in dofs for n in numbers)


@pytest.mark.parametrize("label", ["number", "time", "order"])
@pytest.mark.parametrize("gone", [3, 4, 5])
def test_missing_record_costs_its_hit_and_shifts_nothing(tmp_path, label, gone):
    head, records = split(some_test(), tmp_path)
    marked = {
        "number": records,
        "time": [stamped(r, i // 3) for i, r in enumerate(records)],
        "order": [unnumbered(r) for r in records],
    }[label]
    content = read(tmp_path, head, marked[:gone] + marked[gone + 1 :])
    keep = (
        (2, 3) if (label, gone) == ("order", 3) else (0, 2, 3)
    )  # two sets of responses follow the first force
    assert hits_of(content) == all_pairs(keep)
    assert any("forces at 1+Z but responses" in w and "paired by" in w for w in content.warnings)


def test_force_and_response_of_different_hits_missing(tmp_path):
    """Equal counts, and yet the second response is not that of the second force."""
    head, records = split(some_test(responses=(A,)), tmp_path)
    del records[5], records[2]  # the third response, the second force
    content = read(tmp_path, head, records)
    assert hits_of(content) == all_pairs((0, 3), (A,))
    assert any("left out" in w for w in content.warnings)


def test_blocks_without_marks_are_left_out_and_said(tmp_path):
    """All forces, then all responses, one of them missing: nothing tells which."""
    head, records = split(some_test(responses=(A,)), tmp_path)
    plain = [unnumbered(r) for r in records]
    content = read(tmp_path, head, plain[0::2] + plain[1::2][1:])
    assert content.tests == ()
    assert any("all are left out" in w and "4 forces at 1+Z but responses 3" in w for w in content.warnings)


def test_blocks_with_equal_counts_pair_by_their_place(tmp_path):
    head, records = split(some_test(), tmp_path)
    plain = [unnumbered(r) for r in records]
    content = read(tmp_path, head, plain[1::3] + plain[0::3] + plain[2::3])
    assert hits_of(content) == all_pairs((0, 1, 2, 3)) and content.warnings == ()


def test_irregular_order_with_equal_counts_is_spoken_of(tmp_path):
    """Nothing but their place pairs them, and their place is odd."""
    head, records = split(some_test(responses=(A,)), tmp_path)
    plain = [unnumbered(r) for r in records]
    content = read(tmp_path, head, [plain[i] for i in (0, 2, 1, 4, 3, 5, 6, 7)])
    assert hits_of(content) == all_pairs((0, 1, 2, 3), (A,))
    assert any("check it" in w for w in content.warnings)


def test_any_order_with_numbers(tmp_path, rng):
    head, records = split(some_test(), tmp_path)
    content = read(tmp_path, head, [records[i] for i in rng.permutation(len(records))])
    assert hits_of(content) == all_pairs((0, 1, 2, 3))


def test_roving_accelerometer_at_one_hammer_point(tmp_path):
    """Ten forces at one point; the accelerometer was moved after five hits: two sets, none mispaired."""
    head, first = split(some_test(5, (A,), 1), tmp_path)
    _, second = split(some_test(5, (B,), 2), tmp_path)
    content = read(tmp_path, head, [unnumbered(r) for r in first + second])
    assert hits_of(content) == sorted(all_pairs(tuple(range(5)), (A,)) + all_pairs(tuple(range(5)), (B,)))
    assert sorted(p.responses for t in content.tests for p in t.points) == [(A,), (B,)]


def test_responses_before_their_force(tmp_path):
    head, records = split(some_test(responses=(A,)), tmp_path)
    plain = [unnumbered(r) for r in records]
    turned = [r for n in range(4) for r in (plain[2 * n + 1], plain[2 * n])]
    del turned[2]  # the response of the second hit
    content = read(tmp_path, head, turned)
    assert hits_of(content) == all_pairs((0, 2, 3), (A,))


def test_copies_in_two_files_count_once(tmp_path):
    test = some_test()
    write_uff(tmp_path / "a.uff", tests=test)
    write_uff(tmp_path / "b.uff", tests=test)
    other = some_test(seed=9)
    write_uff(tmp_path / "c.uff", tests=other)
    content = read_uff([tmp_path / "a.uff", tmp_path / "b.uff"])
    assert hits_of(content) == all_pairs((0, 1, 2, 3))
    assert any("12 records" in w and "a.uff" in w and "b.uff" in w for w in content.warnings)
    content = read_uff([tmp_path / "a.uff", tmp_path / "c.uff"])
    assert content.tests[0].points[0].count == 8 and not any("count once" in w for w in content.warnings)


def test_same_modes_in_two_files_count_once(tmp_path):
    from acquisition import ModalData

    modal = ModalData(
        frequency=np.array([5.0]),
        frequency_sigma=np.array([0.1]),
        damping=np.array([0.01]),
        damping_sigma=None,
        dofs=(A,),
        shapes=np.ones((1, 1)) + 0j,
    )
    write_uff(tmp_path / "a.uff", modal=modal)
    write_uff(tmp_path / "b.uff", modal=modal)
    content = read_uff([tmp_path / "a.uff", tmp_path / "b.uff"])
    assert content.modal is not None and len(content.modal) == 1
    assert any("counts once" in w for w in content.warnings)


def test_single_precision_stays_and_double_stays(tmp_path):
    test = some_test()
    write_uff(tmp_path / "s.uff", tests=test, precision="single")
    write_uff(tmp_path / "d.uff", tests=test)
    write_uff(tmp_path / "t.uff", tests=test, precision="single", form="ascii")
    single, double, text = (read_uff(tmp_path / f"{n}.uff").tests[0].points[0] for n in "sdt")
    assert single.force.dtype == single.motion.dtype == text.motion.dtype == np.float32
    assert np.allclose(text.motion, single.motion, rtol=6e-6, atol=0)
    assert double.force.dtype == double.motion.dtype == np.float64
    assert np.array_equal(single.motion, test.points[0].motion.astype(np.float32))


def test_progress_rises_to_one(tmp_path):
    write_uff(tmp_path / "a.uff", tests=some_test(40))
    stated: list[float] = []
    read_uff(tmp_path / "a.uff", progress=stated.append)
    assert stated == sorted(stated) and stated[-1] == 1.0 and len(stated) > 10 and stated[0] < 0.1
