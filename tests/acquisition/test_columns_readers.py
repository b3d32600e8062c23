"""Any kind of file through one door; the examples of docs/readers.md run."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from acquisition import Dof, FrfSet, HammerTest, InputError
from acquisition import readers as doors
from acquisition.readers import read_test

PAGE = Path(__file__).resolve().parents[2] / "docs" / "readers.md"


def examples():
    text = PAGE.read_text(encoding="utf-8")
    return re.findall(r"<!-- executed -->\n```python\n(.*?)```", text, flags=re.DOTALL)


def run(code):
    names: dict[str, object] = {}
    exec(compile(code, str(PAGE), "exec"), names)
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

    monkeypatch.setattr(doors, "entry_points", lambda group: [Point()] if group == "modalkit.readers" else [])
    assert read_test(abc[0])[0].rate == 2048.0


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
