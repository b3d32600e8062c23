"""Any kind of file through one door; the examples of the how-tos run."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from acquisition import (
    Dof,
    FrfSet,
    HammerTest,
    InputError,
    ModalData,
    own_readers,
    read_modes,
    register_reader,
)
from acquisition.columns import layout_from
from acquisition.readers import read_test

HOWTO = Path(__file__).resolve().parents[3] / "docs" / "howto"
PAGES = [HOWTO / name for name in ("arrays.md", "own_reader.md")]


def examples():
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    return re.findall(r"```python\n(.*?)```", text, flags=re.DOTALL)


def run(code):
    names: dict[str, object] = {}
    exec(compile(code, "howto", "exec"), names)
    return names


@pytest.fixture
def abc(tmp_path):
    generator = np.random.default_rng(1)
    records = np.round(generator.standard_normal((3, 50, 2)), 4)
    path = tmp_path / "beam.ABC"
    text = ""
    for node, rows in zip((3, 3, 5), records, strict=True):
        text += f"HIT {node} -3 2048\n" + "\n".join(f"{a} {b}" for a, b in rows) + "\n"
    path.write_text(text)
    return path, records


def test_the_example_with_arrays_runs():
    names = run(examples()[0])
    assert all(v.used for v in names["verdicts"])
    np.testing.assert_array_equal(names["same"].values, names["frfs"].values)
    assert isinstance(names["test"], HammerTest) and isinstance(names["same"], FrfSet)


def test_the_readers_own_reader_reads_in_some_twenty_lines(abc):
    path, records = abc
    code = examples()[1]
    body = code[code.index("def ") :]
    assert len([line for line in body.splitlines() if line.strip()]) <= 25
    (test,) = read_test(path, readers={".abc": run(code)["read_abc"]})
    assert test.rate == 2048.0
    assert [(p.reference, p.count) for p in test.points] == [(Dof(3, -3), 2), (Dof(5, -3), 1)]
    np.testing.assert_array_equal(test.points[0].force, records[:2, :, 0])
    np.testing.assert_array_equal(test.points[1].motion[0, 0], records[2, :, 1])
    path.write_text("nothing")
    with pytest.raises(InputError, match="no line that begins with HIT"):
        read_test(path, readers={"abc": run(code)["read_abc"]})


def test_readers_of_installed_packages_are_found(abc, monkeypatch):
    class Point:
        name = ".abc"

        def load(self):
            return run(examples()[1])["read_abc"]

    monkeypatch.setattr(
        own_readers, "entry_points", lambda group: [Point()] if group == "modalkit.readers" else []
    )
    assert read_test(abc[0])[0].rate == 2048.0


@pytest.fixture
def registered(monkeypatch):
    """A registry that is empty again afterwards."""
    monkeypatch.setattr(own_readers, "_REGISTERED", {})


def test_the_page_s_reader_of_modes_is_known_everywhere_once_it_is_registered(tmp_path, registered):
    path = tmp_path / "beam.XYZ"
    np.savetxt(path, [[24.5, 0.006], [153.9, 0.0012]])
    run(examples()[2])
    (modes,) = read_test(path)
    assert isinstance(modes, ModalData)
    assert modes.frequency.tolist() == read_modes(path).frequency.tolist() == [24.5, 153.9]
    assert modes.damping[1] == 0.0012


def test_a_registered_reader_may_return_frfs_or_hits_but_not_where_modes_are_asked_for(abc, registered):
    path, _ = abc
    register_reader("ABC", run(examples()[1])["read_abc"])
    (test,) = read_test(path)
    assert isinstance(test, HammerTest)
    with pytest.raises(InputError, match="returned HammerTest, but modes are needed"):
        read_modes(path)
    same = run(examples()[0])["same"]
    register_reader(".abc", lambda _: same)
    assert read_test(path) == [same]


def test_column_text_goes_through_the_same_door(tmp_path):
    (tmp_path / "a.csv").write_text("f,a\n1,2\n3,4\n5,6\n")
    (tmp_path / "layout.toml").write_text(
        'rate = 10.0\n[[column]]\nname = "f"\nquantity = "force"\n[[column]]\nname = "a"\nquantity = "velocity"\n'
    )
    (test,) = read_test(tmp_path / "a.csv", layout=tmp_path / "layout.toml")
    assert test.form == "mobility" and test.points[0].force.tolist() == [[1, 3, 5]]
    with pytest.raises(InputError, match="needs a layout file"):
        read_test(tmp_path / "a.csv")


def test_universal_files_go_through_the_same_door(shared_data):
    (test,) = read_test(shared_data("impacts/pyFRF/hits.uff"))
    assert isinstance(test, HammerTest) and test.points[0].count == 5
    (frfs,) = read_test(str(shared_data("uff/pyuff/measurement.uff")))
    assert isinstance(frfs, FrfSet)


def test_unknown_files_and_wrong_readers_are_named(tmp_path):
    (tmp_path / "x.xyz").write_text("1 2 3\n")
    with pytest.raises(InputError, match=r"x\.xyz: no reader for \.xyz"):
        read_test(tmp_path / "x.xyz")
    with pytest.raises(InputError, match="its reader returned list"):
        read_test(tmp_path / "x.xyz", readers={".xyz": lambda path: []})


FRF_COLUMNS = [
    {"name": "re", "quantity": "accelerance", "part": "real"},
    {"name": "im", "quantity": "accelerance", "part": "imag"},
]


def frf_texts(folder: Path, count: int) -> list[Path]:
    """Write text files of one FRF each, whose real part is the number of the file."""
    files = []
    for n in range(1, count + 1):
        lines = ["f,re,im", *(f"{f},{n},0" for f in (1.0, 2.0, 3.0))]
        files.append(folder / f"p{n}.csv")
        files[-1].write_text("\n".join(lines))
    return files


@pytest.mark.parametrize("column", [None, "re", "im"])
def test_rules_of_files_place_frfs(tmp_path, column):
    """Five files, one point each: hit there, or seen there where the rule names a column of the FRF."""
    files = frf_texts(tmp_path, 5)
    own = {} if column is None else {"column": column}
    rules = [{"match": f"p{n}.csv", "node": 10 * n, "direction": "-z", **own} for n in range(1, 6)]
    layout = {"frequency_column": "f", "column": FRF_COLUMNS, "file": rules}
    (frfs,) = read_test(files, layout=layout_from(layout))
    there, fixed = tuple(Dof(10 * n, -3) for n in range(1, 6)), (Dof(1, 3),) * 5
    placed = (frfs.references, frfs.responses) if column is None else (frfs.responses, frfs.references)
    assert placed == (there, fixed)
    assert frfs.values[:, 0].real.tolist() == [1, 2, 3, 4, 5]


def test_one_frf_in_two_files_is_refused(tmp_path):
    """Without rules five files would become one degree of freedom."""
    files = frf_texts(tmp_path, 2)
    layout = {"frequency_column": "f", "column": FRF_COLUMNS}
    with pytest.raises(InputError, match=r"p2\.csv, line 2: FRF 1\+Z/1\+Z is in .*p1\.csv, line 2 already"):
        read_test(files, layout=layout_from(layout))
    rules = [{"match": "q*.csv", "node": 3}]
    with pytest.raises(InputError, match=r"no \[\[file\]\] rule"):
        read_test(files, layout=layout_from({**layout, "file": rules}))


@pytest.mark.parametrize(
    ("rule", "says"),
    [
        (
            {"match": "p1.csv", "node": 3, "column": "ree"},
            r"\[\[file\]\] 1: there is no \[\[column\]\] 'ree'",
        ),
        ({"match": "p1.csv", "node": 3, "direction": "up"}, r"\[\[file\]\] 1: direction 'up' is invalid"),
    ],
)
def test_a_rule_that_means_nothing_is_refused(rule, says):
    with pytest.raises(InputError, match=says):
        layout_from({"frequency_column": "f", "column": FRF_COLUMNS, "file": [rule]})


@pytest.mark.long
def test_a_layout_takes_units_as_a_study_does():
    column = {"index": 0, "quantity": "force"}
    nodes = {"1": ["80 mm", 0, 0.0], "2": [0.5, "-2 in", "1 m"]}
    layout = layout_from({"column": [column], "rate": "51.2 kHz", "decay": "3 1/s", "nodes": nodes})
    assert (layout.rate, layout.decay) == (51200.0, 3.0)
    np.testing.assert_allclose(layout.nodes.at([1, 2]), [[0.08, 0, 0], [0.5, -0.0508, 1.0]], rtol=1e-12)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"nodes": {"1": ["80 mn", 0, 0]}}, r"\[nodes\] 1: '80 mn'"),
        ({"nodes": {"1": ["80 kg", 0, 0]}}, r"\[nodes\] 1: '80 kg' is not a quantity in m"),
        ({"nodes": {"1": ["80 mm", 0]}}, r"\[nodes\] 1 = \['80 mm', 0\]; give node number"),
        ({"rate": "51.2 m"}, "rate: '51.2 m' is not a quantity in Hz"),
    ],
)
def test_a_unit_of_another_kind_in_a_layout_is_refused_by_its_place(more, message):
    with pytest.raises(InputError, match=message):
        layout_from({"column": [{"index": 0, "quantity": "force"}], **more})


ROVING = """rate = 1000.0
[[column]]
index = 0
quantity = "force"
node = 9
[[column]]
index = 1
quantity = "acceleration"
"""


def roving(folder: Path, *names: str) -> list[Path]:
    """Write files of one point each; the second hit at a point (2.csv) ends a little higher."""
    for name in names:
        end = "7" if name.endswith("2.csv") else "5"
        (folder / name).write_text("".join(f"{k}.{end},{-k}.25\n" for k in range(5)))
    return [folder / name for name in names]


def test_a_pattern_takes_nodes_and_directions_from_names(tmp_path):
    """All digits that stand together are the node: P12 is not point 2, whatever stands before it."""
    files = roving(tmp_path, "P12_+x_1.csv", "P012_+x_2.csv", "P3_-y_1.csv")
    for match in ("P{node}_{direction}_*.csv", "*{node}_{direction}_?.csv"):
        plan = layout_from(tomllib.loads(ROVING + f'[[file]]\nmatch = "{match}"\n'))
        (test,) = read_test(files, layout=plan)
        assert [(p.reference, p.count) for p in test.points] == [(Dof(12, 1), 2), (Dof(3, -2), 1)]
    with pytest.raises(InputError, match=r"odd\.csv: no \[\[file\]\] rule .* takes the nodes from the names"):
        read_test([*files, *roving(tmp_path, "odd.csv")], layout=plan)


def test_units_and_scale_of_single_files(tmp_path):
    """Two days, two amplifiers: force in newtons and in kilonewtons, of which the second also halves the response."""
    rules = (
        '[[file]]\nmatch = "P{node}_*"\n[[file]]\nmatch = "*_b.csv"\nunit = "kN"\n'
        '[[file]]\nmatch = "*_b.csv"\ncolumn = 1\nscale = 2.0\nunit = "g"\n'
    )
    (test,) = read_test(
        roving(tmp_path, "P1_a.csv", "P2_b.csv"), layout=layout_from(tomllib.loads(ROVING + rules))
    )
    one, two = test.points
    assert (one.reference, two.reference) == (Dof(1, 3), Dof(2, 3))
    np.testing.assert_allclose(two.force, 1000 * one.force)
    np.testing.assert_allclose(two.motion, 2 * 9.80665 * one.motion)


@pytest.mark.parametrize(
    ("rule", "says"),
    [
        ('match = "P{node}_{node}.csv"', r"\{node\} may occur once in match"),
        (
            'match = "P{node}.csv"\nnode = 3',
            r"\{node\} may occur once in match, and not together with the key",
        ),
        ('match = "P*.csv"', "states nothing about these files"),
        ('match = "P*.csv"\nscale = "two"', "scale = 'two' is not of type float"),
    ],
)
def test_a_pattern_that_means_nothing_is_refused(rule, says):
    with pytest.raises(InputError, match=says):
        layout_from(tomllib.loads(ROVING + f"[[file]]\n{rule}\n"))
