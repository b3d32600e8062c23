"""Coordinate systems, lines, and modes, against numbers worked out by hand."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import pyuff

from acquisition import (
    Dof,
    Geometry,
    HammerTest,
    Hits,
    InputError,
    ModalData,
    UffContent,
    read_uff,
    write_uff,
)
from acquisition.uff.writing.data_sets import units_set


def block(number: int, *lines: str) -> bytes:
    return "".join(f"{line}\n" for line in ("    -1", f"{number:6d}", *lines, "    -1")).encode()


def system18(label: int, kind: int, reference: int, *points: float) -> list[str]:
    numbers = [f"{p:13.5e}" for p in points]
    return [
        f"{label:10d}{kind:10d}{reference:10d}{8:10d}{1:10d}",
        f"CS{label}",
        "".join(numbers[:6]),
        "".join(numbers[6:]),
    ]


def system2420(label: int, kind: int, rows: list[list[float]]) -> list[str]:
    table = ["".join(f"{v:25.16E}".replace("E", "D") for v in row) for row in rows]
    return [f"{label:10d}{kind:10d}{8:10d}", f"CS{label}", *table]


def node15(node: int, given: int, moving: int, *place: float) -> str:
    return f"{node:10d}{given:10d}{moving:10d}{8:10d}" + "".join(f"{p:13.5e}" for p in place)


def node2411(node: int, given: int, moving: int, *place: float) -> list[str]:
    return [f"{node:10d}{given:10d}{moving:10d}{8:10d}", "".join(f"{p:25.16E}" for p in place)]


def read(path, *parts: bytes) -> UffContent:
    path.write_bytes(units_set() + b"".join(parts))
    return read_uff(path)


def test_places_in_shifted_turned_and_cylindrical_systems(tmp_path):
    systems = block(
        18,
        *system18(5, 0, 0, 1, 2, 3, 1, 3, 3, 1, 2, 4),  # origin (1, 2, 3), x along +y, z along +z
        *system18(6, 1, 0, 0, 0, 1, 1, 0, 1, 0, 0, 2),  # cylindrical, one metre up
        *system18(7, 0, 5, 1, 0, 0, 2, 0, 0, 1, 0, 1),  # one metre along x of system 5
    )
    nodes = block(
        15,
        node15(1, 5, 0, 1, 0, 0),
        node15(2, 6, 0, 2, 90, 0.5),
        node15(3, 7, 0, 0, 1, 0),
        node15(4, 0, 0, 7, 8, 9),
    )
    for parts in ((systems, nodes), (nodes, systems)):
        content = read(tmp_path / "a.uff", *parts)
        expected = [[1, 3, 3], [0, 2, 1.5], [0, 3, 3], [7, 8, 9]]
        assert np.allclose(content.geometry.at([1, 2, 3, 4]), expected, atol=1e-12)
        assert content.warnings == () and content.geometry.axes is None


def test_angles_are_no_lengths(tmp_path):
    """Millimetres: radius and height are divided by 1000, the angle is not."""
    millimetres = units_set().replace(b"1.00000000000000000D+00", b"1.00000000000000000D+03", 1)
    systems = block(18, *system18(6, 1, 0, 0, 0, 0, 1000, 0, 0, 0, 0, 1000))
    path = tmp_path / "a.uff"
    path.write_bytes(millimetres + systems + block(15, node15(1, 6, 0, 500, 180, 250)))
    assert np.allclose(read_uff(path).geometry.at([1]), [[-0.5, 0, 0.25]], atol=1e-12)


def hit_file(tmp_path, *dofs: Dof) -> bytes:
    rng = np.random.default_rng(2)
    hits = Hits(dofs[0], dofs, rng.standard_normal((2, 16)), rng.standard_normal((2, len(dofs), 16)))
    write_uff(tmp_path / "h.uff", tests=HammerTest(100.0, (hits,)))
    return (tmp_path / "h.uff").read_bytes()


QUARTER = [[0.0, 1, 0], [-1, 0, 0], [0, 0, 1], [0, 0, 0]]  # x' = +y, y' = -x


def test_directions_turned_by_right_angles(tmp_path):
    systems = block(2420, "         1", "part", *system2420(12, 0, QUARTER))
    nodes = block(2411, *node2411(1, 0, 12, 0, 0, 0), *node2411(2, 0, 0, 1, 0, 0))
    records = hit_file(tmp_path, Dof(1, 1), Dof(1, -2), Dof(1, 3), Dof(1, -4), Dof(2, 1))
    content = read(tmp_path / "a.uff", nodes, systems, records)
    (point,) = content.tests[0].points
    assert point.reference == Dof(1, 2)
    assert point.responses == (Dof(1, 2), Dof(1, 1), Dof(1, 3), Dof(1, -5), Dof(2, 1))
    assert any("nodes 1 are turned" in w for w in content.warnings) and content.geometry.axes is None


def test_cylindrical_directions(tmp_path):
    """Radial and tangential at 0, 90 and 45 degrees: the last is no axis and is carried with the geometry."""
    systems = block(18, *system18(6, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1))
    nodes = block(15, node15(1, 0, 6, 1, 0, 0), node15(2, 0, 6, 0, 1, 0), node15(3, 0, 6, 1, 1, 0))
    records = hit_file(tmp_path, Dof(1, 1), Dof(2, 1), Dof(2, 2), Dof(3, -1), Dof(3, 3))
    content = read(tmp_path / "a.uff", systems, nodes, records)
    (point,) = content.tests[0].points
    assert point.responses == (Dof(1, 1), Dof(2, 2), Dof(2, -1), Dof(3, -1), Dof(3, 3))
    half = np.sqrt(0.5)
    assert np.allclose(content.geometry.direction(Dof(3, -1)), [-half, -half, 0], atol=1e-12)
    assert np.allclose(content.geometry.direction(Dof(3, 2)), [-half, half, 0], atol=1e-12)
    assert np.array_equal(content.geometry.direction(Dof(2, -1)), [-1, 0, 0])
    assert np.array_equal(content.geometry.direction(Dof(99, 3)), [0, 0, 1])
    assert any("nodes 3 have local axes" in w for w in content.warnings)


def test_faulty_systems_are_said(tmp_path):
    systems = block(
        18, *system18(5, 0, 5, 0, 0, 0, 1, 0, 0, 0, 0, 1), *system18(6, 2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1)
    )
    nodes = block(15, node15(1, 5, 0, 1, 0, 0), node15(2, 0, 44, 1, 0, 0), node15(3, 6, 0, 1, 0, 0))
    content = read(tmp_path / "a.uff", systems, nodes)
    words = ("given in itself", "44 is not defined", "spherical")
    assert all(any(word in w for w in content.warnings) for word in words)
    assert content.geometry.nodes == (1, 2)
    skew = block(2420, "         1", "part", *system2420(3, 0, [[1, 0, 0], [1, 1, 0], [0, 0, 1], [0, 0, 0]]))
    assert not read(tmp_path / "b.uff", skew).datasets[-1].ok


def test_export_system_of_2411_is_said_and_not_applied(tmp_path):
    systems = block(2420, "         1", "part", *system2420(12, 0, QUARTER))
    content = read(tmp_path / "a.uff", systems, block(2411, *node2411(4, 12, 0, 1, 2, 3)))
    assert np.array_equal(content.geometry.at([4]), [[1, 2, 3]])
    assert any("nodes 4 name export system 12" in w for w in content.warnings)


def test_lines_of_elements_and_traces(tmp_path):
    nodes = block(15, *(node15(n, 0, 0, n, 0, 0) for n in range(1, 9)))
    elements = block(
        2412,
        *(
            "         1        94         1         1         7         4",
            "         1         2         3         4",
        ),
        *("         2        91         1         1         7         3", "         3         4         5"),
        *("         3        21         1         1         7         2", "         0         0         0"),
        "         6         7",
    )
    trace = block(
        82, "         1         5         0", "NONE", "         7         8         0         1         5"
    )
    content = read(tmp_path / "a.uff", nodes, elements, trace)
    expected = [[1, 2], [1, 4], [1, 5], [2, 3], [3, 4], [3, 5], [4, 5], [6, 7], [7, 8]]
    assert content.geometry.lines.tolist() == expected
    assert content.warnings == ()


def test_padding_behind_a_trace_is_no_line(shared_data):
    content = read_uff(shared_data("uff/pyuff/TestLab 161 164 18 15 82.uff"))
    assert [2, 5] in content.geometry.lines.tolist()
    pairs = content.geometry.lines
    assert len(pairs) == 30 and content.warnings == ()
    assert [31, 34] in pairs.tolist() and [32, 33] in pairs.tolist()


def test_lines_and_axes_survive_a_file(tmp_path, rng):
    turn = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    axes = np.stack([np.eye(3), turn, np.eye(3)])
    lines = np.array([[i, j] for i in range(1, 4) for j in range(1, 4) if i < j])
    geometry = Geometry((1, 2, 3), rng.standard_normal((3, 3)), lines, axes)
    write_uff(tmp_path / "a.uff", geometry=geometry)
    back = read_uff(tmp_path / "a.uff").geometry
    assert np.array_equal(back.coordinates, geometry.coordinates)
    assert np.array_equal(np.sort(back.lines, axis=0), np.sort(geometry.lines, axis=0))
    assert back.axes is not None and np.allclose(back.axes, axes, atol=1e-14)
    assert np.allclose(back.direction(Dof(2, -1)), -turn[0], atol=1e-14)


def test_many_lines_are_read_by_pyuff(tmp_path, rng):
    pairs = np.unique(np.sort(rng.integers(1, 400, (900, 2)), axis=1), axis=0)
    pairs = pairs[pairs[:, 0] != pairs[:, 1]]
    geometry = Geometry(tuple(range(1, 400)), np.zeros((399, 3)), pairs)
    write_uff(tmp_path / "a.uff", geometry=geometry)
    drawn = set()
    for one in pyuff.UFF(str(tmp_path / "a.uff")).read_sets()[3:]:
        way = one["nodes"].astype(int).tolist()
        assert one["type"] == 82 and one["n_nodes"] == len(way) <= 250
        drawn |= {(a, b) for a, b in pairwise(way) if a and b}
    assert drawn == {tuple(p) for p in pairs.tolist()}
    assert np.array_equal(read_uff(tmp_path / "a.uff").geometry.lines, pairs)


def test_geometry_refuses_lines_to_nowhere():
    with pytest.raises(InputError, match=r"\[7\]"):
        Geometry((1, 2), np.zeros((2, 3)), np.array([[1, 7]]))


def test_modes_of_2414(shared_data):
    path = shared_data("uff/pyuff/2411 and 2414.uff")
    modal = read_uff(path).modal
    theirs = [s for s in pyuff.UFF(str(path)).read_sets() if s["type"] == 2414]
    assert modal is not None and len(modal) == len(theirs)
    assert np.allclose(modal.frequency, sorted(s["record12_field2"] for s in theirs), rtol=1e-12)
    rows = [i for i, dof in enumerate(modal.dofs) if dof.direction == 3]
    first = {int(n): row[2] for n, row in zip(theirs[0]["node_nums"], theirs[0]["data_at_node"], strict=True)}
    assert modal.shapes is not None and not modal.scaled
    assert all(modal.shapes[i, 0] == first[modal.dofs[i].node] for i in rows)


def mode55(value: tuple[float, ...], title: str = "NONE", analysis: int = 3) -> bytes:
    heads = [title, *["NONE"] * 4, "".join(f"{v:10d}" for v in (1, analysis, 2, 8, 5, 3))]
    shape = [f"{1:10d}", "".join(f"{v:13.5e}" for v in (0, 0, 0, 0, 1, 0))]
    return block(
        55, *heads, "".join(f"{v:10d}" for v in (2, 6, 1, 1)), "".join(f"{v:13.5e}" for v in value), *shape
    )


# pole -0.5 + 100 i rad/s: 15.9157 Hz, damping ratio 0.5 %; the same in Hz
RADIAN, HERTZ = (-0.5, 100.0), (0.5 / 2 / np.pi, 100.0 / 2 / np.pi)
A_AND_B = (0.0, 200.0, 2e4, 1e2)  # modal A = 2 i omega_d m, modal B = -A pole


@pytest.mark.parametrize(
    ("value", "title", "hint"),
    [
        ((*RADIAN, *A_AND_B), "NONE", True),
        ((*HERTZ, *A_AND_B), "NONE", True),
        ((*RADIAN, 0, 0, 0, 0), "mode 1: 15.916 Hz", True),
        ((*HERTZ, 0, 0, 0, 0), "FR=15.916:d=0.5", True),
        ((*RADIAN, 0, 0, 0, 0), "NONE", False),
        ((*HERTZ, 0, 0, 0, 0), "NONE", False),
    ],
)
def test_unit_of_complex_eigenvalues(tmp_path, value, title, hint):
    content = read(tmp_path / "a.uff", mode55(value, title))
    assert content.modal is not None
    assert content.modal.frequency[0] == pytest.approx(15.9157, rel=1e-4)
    assert content.modal.damping[0] == pytest.approx(0.005, rel=1e-4)
    assert any("taken for" in w or "not stated; assumed: " in w for w in content.warnings) == (not hint)
    assert "taken for (" in content.datasets[-1].description
    if any(value[2:]):
        assert content.modal.scaled and abs(content.modal.shapes[0, 0]) == pytest.approx(1.0, rel=1e-3)


def test_complex_modes_of_2414(tmp_path):
    """Data type 5, three values a node: pole -0.5 + 100 i rad/s, modal A = 2 i omega_d 4 kg."""
    rows = [
        "".join(f"{v:13.5e}" for v in r)
        for r in ([0.0] * 6, [-0.5, 100, 0, 800, 8e4, 400], [0, 0, 0, 0, 3, 4])
    ]
    whole = ["".join(f"{v:10d}" for v in r) for r in ((1, 3, 2, 8, 5, 3), (0,) * 8, (0, 0))]
    heads = [f"{1:10d}", "one", f"{1:10d}", *["NONE"] * 5]
    modes = block(2414, *heads, *whole, *rows[:2], f"{9:10d}", rows[2])
    stress = block(
        2414, *heads, "         1         3         4         2         5         6", *whole[1:], *rows
    )
    content = read(tmp_path / "a.uff", modes, stress)
    modal = content.modal
    assert modal is not None and modal.scaled
    assert content.warnings == ("a.uff: not used: 1 data sets 2414 that hold no mode at nodes",)
    assert modal.frequency[0] == pytest.approx(abs(-0.5 + 100j) / 2 / np.pi, rel=1e-12)
    assert modal.dofs == (Dof(9, 3),) and modal.shapes[0, 0] == pytest.approx((3 + 4j) / 2, rel=1e-4)
    assert "not used" in content.datasets[-1].description and content.datasets[-1].ok


def test_one_mode_that_tells_decides_for_its_file(tmp_path):
    silent = mode55((-0.25, 40.0, 0, 0, 0, 0))
    stated = mode55((-0.5, 100.0, 0, 0, 0, 0), "FR=100.0:d=0.5")
    content = read(tmp_path / "a.uff", silent, stated)
    assert content.modal is not None and np.allclose(content.modal.frequency, [40, 100], rtol=1e-4)
    assert not any("taken for" in w for w in content.warnings)


def test_static_results_are_listed_and_bad_modes_are_said(tmp_path):
    static, bad = mode55((0.0,) * 6, analysis=1), mode55((0.0,) * 6)
    content = read(tmp_path / "a.uff", static, bad)
    assert [i.ok for i in content.datasets[-2:]] == [True, False]
    assert "not used" in content.datasets[-2].description and "above zero" in content.datasets[-1].message


def test_sigmas_and_all_digits_survive_a_file(tmp_path, rng):
    modal = ModalData(
        frequency=np.array([123.456789012345678, 456.1]),
        frequency_sigma=np.array([1.23456789e-5, np.nan]),
        damping=np.array([0.00123456789, 0.02]),
        damping_sigma=np.array([4.5e-6, np.nan]),
        dofs=(Dof(1, 3), Dof(2, -1), Dof(3, 5)),
        shapes=rng.standard_normal((3, 2)) + 1j * rng.standard_normal((3, 2)),
        scaled=True,
    )
    write_uff(tmp_path / "a.uff", modal=modal)
    content = read_uff(tmp_path / "a.uff")
    back = content.modal
    assert back is not None and content.warnings == ()
    assert np.allclose(back.frequency, modal.frequency, rtol=1e-15)
    assert np.allclose(back.damping, modal.damping, rtol=1e-13)
    assert np.array_equal(back.frequency_sigma, modal.frequency_sigma, equal_nan=True)
    assert np.array_equal(back.damping_sigma, modal.damping_sigma, equal_nan=True)
    assert back.dofs == (Dof(1, 3), Dof(2, 1), Dof(3, 5)) and back.scaled
    assert np.allclose(back.shapes, modal.shapes * np.array([[1], [-1], [1]]), rtol=2e-5)


def test_pyuff_reads_modes(tmp_path):
    shapes = np.array([[1.25], [-0.5 + 0.25j]])
    dofs = (Dof(1, 3), Dof(7, -2))
    write_uff(
        tmp_path / "a.uff",
        modal=ModalData(
            frequency=np.array([123.456]),
            frequency_sigma=np.array([0.1]),
            damping=np.array([0.01]),
            damping_sigma=None,
            dofs=dofs,
            shapes=shapes,
            scaled=True,
        ),
    )
    one = pyuff.UFF(str(tmp_path / "a.uff")).read_sets(2)
    pole = 2 * np.pi * 123.456 * (-0.01 + 1j * np.sqrt(1 - 1e-4))
    assert one["type"] == 55 and one["eig"] == pytest.approx(pole, rel=1e-5)
    assert one["modal_a"] == pytest.approx(2j * pole.imag, rel=1e-5)
    assert one["node_nums"].tolist() == [1, 7]
    assert one["r3"].tolist() == [1.25, 0] and one["r2"].tolist() == [0, 0.5 - 0.25j]


def test_lines_of_nodes_that_changed_places_are_no_nodes(tmp_path):
    first, second = node2411(1, 0, 0, 0, 0, 0), node2411(2, 0, 0, 0.25, 0.5, 0)
    content = read(tmp_path / "a.uff", block(2411, first[0], second[0], first[1], second[1]))
    assert content.geometry is None or len(content.geometry.nodes) == 0
    assert any("moved" in d.message for d in content.datasets)


def test_nodes_whose_columns_touch_keep_to_their_lines(tmp_path):
    rows = [node15(n, 0, 0, 0.25 * n, -0.5, 0.125) for n in range(1, 8)]
    touching = [row.replace(" -5.00000e-01", "-5.000000e-01") for row in rows]
    content = read(tmp_path / "a.uff", block(15, *touching))
    assert len(content.geometry.nodes) == 7 and content.warnings == ()
