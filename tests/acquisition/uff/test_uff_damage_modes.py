"""Damaged tables of nodes, lines and modes: nothing is silent."""

from __future__ import annotations

import numpy as np
import pytest
from uff_damage_cases import row, silent, table

from acquisition import (
    Dof,
    Geometry,
    ModalData,
    read_uff,
    write_uff,
)


@pytest.fixture
def drawn(rng) -> bytes:
    """Return units, nodes, trace lines and modes of two kinds."""
    nodes = (1, 2, 13, 104)
    unit = "  1.00000000000000000D+00"
    header = table(164, f"{1:10d}{'SI':20s}{2:10d}", 3 * unit, "  0.00000000000000000D+00")
    grid = table(15, *[row("%10d", (n, 1, 0, 8)) + row("%13.5E", rng.standard_normal(3)) for n in nodes])
    trace = table(82, row("%10d", (1, 8, 0)), "NONE", row("%10d", (1, 2, 13, 104, 0, 2, 13, 1)))
    normal = [
        table(
            55,
            *["NONE"] * 5,
            row("%10d", (1, 2, 2, 8, 2, 3)),
            row("%10d", (2, 4, 1, k)),
            row("%13.5e", (10.0 * k, 2.5, 0.01, 0)),
            *[line for n in nodes for line in (f"{n:10d}", row("%13.5e", rng.standard_normal(3)))],
        )
        for k in (1, 2)
    ]
    return header + grid + trace + b"".join(normal)


@pytest.mark.long
def test_damage_to_tables_of_nodes_lines_and_modes(drawn, reread):
    before = reread(drawn)
    assert before.warnings == () and len(before.modal) == 2 and len(before.geometry.nodes) == 4
    start = drawn.index(b"\n", drawn.index(b"    15\n")) + 1
    for place in range(start, len(drawn)):
        old = drawn[place : place + 1]
        if old in b" +-\n" or (drawn[place - 1 : place] == b" " and drawn[place + 1 : place + 2].isdigit()):
            continue  # signs, and first digits of whole numbers: other numbers as good
        assert not silent(before, reread(drawn[:place] + b" " + drawn[place + 1 :])), place
        assert not silent(before, reread(drawn[:place] + drawn[place + 1 :])), place


def test_one_mode_twice_in_a_file_counts_once(tmp_path, drawn, reread):
    modes = drawn[drawn.index(b"    -1\n    55") :]
    first = modes[: modes.index(b"    -1\n    55", 8)]
    content = reread(drawn + first)
    assert len(content.modal) == 2
    assert any(
        "the same mode stands in x.uff, data set 55" in w and "counts once" in w for w in content.warnings
    )
    turned = first.replace(
        b"         2         4         1         1", b"         2         4         1         3"
    )
    assert len(reread(drawn + turned).modal) == 2
    other = first.replace(b"  1.00000e+01", b"  1.10000e+01")
    assert len(reread(drawn + other).modal) == 3


def test_a_copy_of_a_mode_that_lost_a_node_is_not_silent(drawn, reread):
    modes = drawn[drawn.index(b"    -1\n    55") :]
    lines = modes[: modes.index(b"    -1\n    55", 8)].split(b"\n")
    cut = b"\n".join(lines[:-4] + lines[-2:])  # without its last node
    content = reread(drawn + cut)
    assert len(content.modal) == 3
    assert any("frequency and damping are exactly those of" in w for w in content.warnings)


def test_exchanged_lines_of_a_shape_are_not_silent(tmp_path, reread, rng):
    shapes = rng.standard_normal((3, 1)) + 0j
    one = np.array([0.01])
    modal = ModalData(
        frequency=np.array([12.5]),
        frequency_sigma=one,
        damping=one,
        damping_sigma=one,
        dofs=tuple(Dof(n, 3) for n in (1, 2, 3)),
        shapes=shapes,
        shape_sigma=None,
        scaled=True,
    )
    write_uff(tmp_path / "x.uff", modal=modal)
    lines = (tmp_path / "x.uff").read_bytes().split(b"\n")
    before = reread(b"\n".join(lines))
    assert before.warnings == () and len(before.modal) == 1
    first = lines.index(b"    55") + 9
    for a in range(first, first + 5):
        for b in range(a + 1, first + 6):
            changed = list(lines)
            changed[a], changed[b] = lines[b], lines[a]
            if (b - a) % 2:  # a node's number and another line of values
                assert not silent(before, reread(b"\n".join(changed))), (a, b)


def test_what_is_not_used_is_stated_in_one_line(drawn, reread):
    content = reread(drawn + table(161, "x") + table(161, "y") + table(17, "z"))
    assert content.warnings == ("x.uff: not used: 2 data sets 161; 1 data sets 17",)


def chained(count: int, first: int = 0) -> bytes:
    """Return a node and systems each given in the one before."""
    lines = []
    for label in range(2, count + 2):
        lines += [row("%10d", (label, 0, label - 1 if label > 2 else first, 8, 1)), "CS"]
        lines += [row("%13.5E", (1e-3, 0, 0, 1.001, 0, 0)), row("%13.5E", (0.001, 0, 1))]
    nodes = [row("%10d", (n, n, 0, 8)) + row("%13.5E", (0, 0, 0)) for n in range(2, count + 2)]
    return table(18, *lines) + table(15, *nodes)


@pytest.mark.long
@pytest.mark.usefixtures("no_hang")  # each system is placed once; through all others it was minutes
def test_chain_of_3000_coordinate_systems(reread):
    content = reread(chained(3000))
    assert np.allclose(content.geometry.coordinates[-1], [3.0, 0, 0])
    content = reread(chained(3000, first=7777))
    assert any("coordinate system 7777 is not defined" in w for w in content.warnings)


def test_modal_data_of_some_scaled_modes(tmp_path, drawn, reread):
    assert reread(drawn).modal.scaled
    content = reread(drawn.replace(b"  2.00000e+01  2.50000e+00", b"  2.00000e+01  0.00000e+00"))
    assert not content.modal.scaled and any("modal mass" in w for w in content.warnings)


def test_shape_sigmas_come_back(tmp_path, rng):
    dofs = (Dof(1, 3), Dof(2, 1), Dof(2, 3))
    shapes = rng.standard_normal((3, 2)) + 0j
    sigma = np.abs(rng.standard_normal((3, 2)))
    modal = ModalData(
        frequency=np.array([5.0, 7.0]),
        frequency_sigma=np.array([0.1, 0.2]),
        damping=np.array([0.01, 0.02]),
        damping_sigma=None,
        dofs=dofs,
        shapes=shapes,
        shape_sigma=sigma,
        scaled=True,
        geometry=Geometry((1, 2), np.eye(3)[:2]),
    )
    write_uff(tmp_path / "a.uff", modal=modal)
    content = read_uff(tmp_path / "a.uff")
    back = content.modal
    assert (
        content.warnings == () and back is not None and len(back) == 2 and back.dofs == dofs and back.scaled
    )
    assert np.allclose(back.shapes, shapes, rtol=1e-5) and np.allclose(back.shape_sigma, sigma, rtol=1e-5)
