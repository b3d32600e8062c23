"""Modes that exist already get what identified ones get, and what is written is read back."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from conforming import departures

import modalkit as mk
from acquisition import Dof, FrfSet, Geometry, InputError, ModalData, read_modes
from modalkit.output.schemas import ComparisonDocument
from modalkit.samples import sample_file

Run = Callable[..., tuple[int, str, str]]

PLACES = Geometry((1, 2, 3), np.array([[0.1, 0, 0], [0.2, 0, 0], [0.3, 0, 0]]))
MODAL = ModalData(
    frequency=np.array([10.25, 63.5, 180.125]),
    frequency_sigma=np.array([0.001, np.nan, 0.003]),
    damping=np.array([0.01, 0.002, np.nan]),
    damping_sigma=np.array([1e-4, 2e-5, np.nan]),
    dofs=(Dof(1, 3), Dof(2, 3), Dof(3, 1)),
    shapes=np.array([[1.0, -0.5 + 0.1j, 0.3], [0.7, 0.9, -0.8j], [0.1, 0.2, 1.1]]),
    shape_sigma=np.full((3, 3), 0.01),
    scaled=True,
    geometry=PLACES,
)


def written(folder: Path, ending: str, modal: ModalData = MODAL) -> Path:
    path = folder / f"modes{ending}"
    mk.write_modes(str(path), mk.Modes(modal))
    return path


def same(one: ModalData, other: ModalData) -> None:
    for name in ("frequency", "frequency_sigma", "damping", "damping_sigma", "shapes", "shape_sigma"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    assert (one.dofs, one.scaled) == (other.dofs, other.scaled)


@pytest.mark.parametrize("ending", [".csv", ".json"])
def test_what_is_written_is_read_back_to_the_last_bit(tmp_path: Path, ending: str) -> None:
    same(read_modes(written(tmp_path, ending)), MODAL)
    bare = ModalData(frequency=np.array([1 / 3, 5.0]), frequency_sigma=np.full(2, np.nan))
    again = read_modes(written(tmp_path, ending, bare))
    assert again.frequency.tolist() == [1 / 3, 5.0] and again.shapes is None


@pytest.mark.parametrize("ending", [".csv", ".json"])
def test_the_places_of_the_nodes_are_kept(tmp_path: Path, ending: str) -> None:
    back = read_modes(written(tmp_path, ending)).geometry
    assert back.nodes == PLACES.nodes and np.array_equal(back.coordinates, PLACES.coordinates)


@pytest.mark.parametrize("ending", [".uff", ".csv", ".json"])
def test_existing_modes_get_table_mac_and_figures(tmp_path: Path, ending: str) -> None:
    modes = mk.read(str(written(tmp_path, ending)))
    assert isinstance(modes, mk.Modes)
    assert list(modes.table().columns) == list(mk.Modes(MODAL).table().columns)
    np.testing.assert_allclose(modes.table()["MPC"], mk.Modes(MODAL).table()["MPC"], rtol=1e-6)
    assert np.allclose(np.diag(mk.mac(modes)), 1.0)
    assert set(mk.draw(modes, folder=str(tmp_path / "f"))) == {"damping", "auto_mac", "shapes"}
    assert (tmp_path / "f" / "auto_mac.png").stat().st_size > 1000
    assert len(modes.identify(band=(50.0, 100.0))) == 1
    with pytest.raises(InputError, match="no mode between"):
        modes.identify(band=(500.0, 600.0))


def test_two_tests_are_compared_by_shape(tmp_path: Path) -> None:
    other = replace(MODAL, frequency=MODAL.frequency * 1.1, shapes=-2.0 * MODAL.shapes)
    found = mk.compare(written(tmp_path, ".uff"), mk.Modes(other))
    assert [(p.test, p.model) for p in found.pairs] == [(0, 0), (1, 1), (2, 2)]
    assert np.allclose([p.error for p in found.pairs], 0.1)
    table = mk.mac(MODAL, other)
    assert isinstance(table, pd.DataFrame) and np.allclose(np.diag(table), 1.0)
    assert np.allclose(mk.mac(MODAL.shapes, other.shapes), table)
    with pytest.raises(InputError, match="arrays for both"):
        mk.mac(MODAL, MODAL.shapes)
    with pytest.raises(InputError, match="has no modes"):
        mk.mac(3)  # type: ignore[arg-type]


@pytest.mark.long
def test_a_study_reads_the_table_that_identify_writes(tmp_path: Path, run: Run) -> None:
    source = sample_file("beam_dry/study.toml")
    data = source.parent / "beam_dry.uff"
    target = tmp_path / "modes.csv"
    code, out, _ = run("identify", data, "--band", "5", "500", "-o", target)
    assert code == 0 and f"written: {target}" in out
    assert target.read_text().startswith("frequency,sigma,damping,damping_sigma,scaled,1+Z,")
    found = mk.modes_of(target)
    assert found.scaled and found.frequency == pytest.approx([24.47, 153.96, 429.15], rel=5e-4)
    study = tmp_path / "study.toml"
    study.write_text('[test]\nmodes = "modes.csv"\n')
    assert np.array_equal(mk.modes_of(str(study)).frequency, found.frequency)
    study.write_text('[test]\nmodes = "modes.csv"\nband = [100.0, 500.0]\n')
    assert np.array_equal(mk.modes_of(str(study)).frequency, found.frequency[1:])


def test_the_ending_says_what_is_written(tmp_path: Path, run: Run) -> None:
    modes = written(tmp_path, ".json")
    for ending, start in ((".csv", "frequency,"), (".json", "{"), (".uff", "    -1")):
        target = tmp_path / f"again{ending}"
        assert run("identify", modes, "-o", target)[0] == 0
        assert target.read_text(errors="replace").startswith(start)
    code, _, err = run("identify", modes, "-o", tmp_path / "modes.xlsx")
    assert code == 2 and ".csv" in err and not (tmp_path / "modes.xlsx").exists()


def test_the_commands_take_modes(tmp_path: Path, run: Run) -> None:
    first, second = written(tmp_path, ".json"), written(tmp_path, ".uff")
    for command in ("inspect", "identify"):
        code, out, _ = run(command, first)
        assert code == 0 and "180.1250" in out and "MPC" in out
    target = tmp_path / "c.json"
    code, out, _ = run("correlate", first, second, "--json", target, "--figures", tmp_path / "f")
    assert code == 0 and "3 pairs" in out and (tmp_path / "f" / "mac.png").exists()
    document = json.loads(target.read_text())
    assert not departures(document, ComparisonDocument)
    assert [p["mac"] for p in document["pairs"]] == pytest.approx([1.0, 1.0, 1.0])
    for wrong in (
        ("identify", first, "--order", "10"),
        ("identify", first, "--decay", "3"),
        ("frf", first, "-o", "x.uff"),
    ):
        code, _, err = run(*wrong)
        assert code == 2 and "contains modes" in err and len(err.strip().splitlines()) == 1
    code, _, err = run("correlate", first)
    assert code == 2 and "is not a study" in err


def test_lines_of_frfs_are_no_modes(tmp_path: Path) -> None:
    table = tmp_path / "frf.csv"
    rows = [f"{0.5 * k},{np.cos(k)},{np.sin(k)}" for k in range(1, 40)]
    table.write_text("\n".join(["frequency,1+Z,1+Z imag", *rows]))
    with pytest.raises(InputError, match=r"lines, not modes.*layout"):
        mk.read(table)


def test_text_that_is_no_table_of_modes_still_asks_for_its_layout(tmp_path: Path) -> None:
    text = tmp_path / "hits.csv"
    text.write_text("time,force\n0.0,1.0\n0.1,2.0\n")
    with pytest.raises(InputError, match=r"no column 'frequency'.*layout"):
        mk.read(text)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"schema": "modalkit.modes/2"}, "schema"),
        ({"modes": []}, "no mode"),
        ({"modes": 3}, "not a list"),
        ({"modes": [1]}, "not a record"),
        ({"modes": [{"frequency_hz": None}]}, "frequency_hz"),
        ({"modes": [{"frequency_hz": True}]}, "frequency_hz"),
        ({"modes": [{"frequency_hz": 10**400}]}, "frequency_hz"),
        ({"modes": [{"frequency_hz": -3.0}]}, "positive"),
        (
            {"modes": [{"frequency_hz": 3.0, "shape": [{"node": 1, "direction": 9, "re": 1, "im": 0}]}]},
            "-6 to 6",
        ),
        (
            {"modes": [{"frequency_hz": 3.0, "shape": [{"node": 1.5, "direction": 3, "re": 1, "im": 0}]}]},
            "whole",
        ),
        (
            {"modes": [{"frequency_hz": 3.0, "shape": [{"node": 1, "direction": 3, "re": 1, "im": 0}] * 2}]},
            "twice",
        ),
        ({"modes": [{"frequency_hz": 3.0, "dampingratio": 0.01}]}, "'damping_ratio' is probably meant"),
        ({"modes": [{"frequency_hz": 3.0, "mpc": 1.0}, {"frequency_hz": 4.0}]}, "'mpc' is missing from some"),
        (
            {
                "modes": [
                    {
                        "frequency_hz": 3.0,
                        "shape": [
                            {"node": 1, "direction": 3, "re": 1, "im": 0, "sigma": 0.1},
                            {"node": 2, "direction": 3, "re": 1, "im": 0},
                        ],
                    }
                ]
            },
            "'sigma' is missing from some",
        ),
        ({"nods": [{"node": 1, "x": 0.0, "y": 0.0, "z": 0.0}]}, "'nodes' is probably meant"),
        ({"nodes": [{"node": 1, "x": 0.0, "y": 0.0}]}, "z = None"),
        ({"nodes": [{"node": 1, "x": 0, "y": 0, "z": 0}] * 2}, "more than once"),
    ],
)
def test_damaged_json_is_refused_in_one_line(tmp_path: Path, change: dict[str, object], word: str) -> None:
    path = tmp_path / "modes.json"
    record = {"schema": "modalkit.modes/1", "modes": [{"frequency_hz": 3.0}]} | change
    path.write_text(json.dumps(record))
    with pytest.raises(InputError, match=word) as error:
        read_modes(path)
    assert str(path) in str(error.value)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[" * 100_000,
        "3",
        "[]",
        '{"schema": "modalkit.modes/1", "modes": NaN}',
        '{"schema": "modalkit.modes/1", "modes": [{"frequency_hz": 3.0, "frequency_hz": 4.0}]}',
    ],
)
def test_what_is_no_record_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "modes.json"
    path.write_text(text)
    with pytest.raises(InputError, match=r"modes\.json"):
        mk.read(path)


def test_cmif_has_a_peak_for_each_of_two_modes_at_one_frequency() -> None:
    """Two modes at 100 Hz with orthogonal shapes: exactly 1/|2 i zeta w0^2|^2 times the squared norms."""
    lines = np.arange(1.0, 200.0)
    w, w0, zeta = 2 * np.pi * lines, 2 * np.pi * 100.0, 0.01
    h = 1 / (w0**2 - w**2 + 2j * zeta * w0 * w)
    residues = np.array([[2.0, 0.0], [0.0, 1.0], [0.0, 1.0]])  # singular values 2 and sqrt 2
    dofs = [(Dof(i + 1, (-1) ** i * 3), Dof(j + 1, 3)) for i in range(3) for j in range(2)]
    signs = np.array([a.sign * b.sign for a, b in dofs])
    frfs = FrfSet(
        lines,
        (residues.reshape(-1) * signs)[:, None] * h,
        tuple(a for a, _ in dofs),
        tuple(b for _, b in dofs),
        "receptance",
    )
    table = mk.cmif(frfs)
    np.testing.assert_allclose(table[1], 4.0 * np.abs(h) ** 2, rtol=1e-12)
    np.testing.assert_allclose(table[2], 2.0 * np.abs(h) ** 2, rtol=1e-12)
    assert table.index.name == "frequency [Hz]" and table[2].idxmax() == 100.0
    assert mk.cmif(frfs.select(np.arange(5))).attrs["left_out"] == ["3+Z"]
    assert set(mk.draw(frfs)) == {"frf", "cmif", "mvmif"}
    with pytest.raises(InputError, match="every reference"):
        mk.cmif(frfs.select(np.array([0, 3])))


def test_what_has_no_figures_is_said() -> None:
    with pytest.raises(InputError, match="no figures of a int"):
        mk.draw(3)


@pytest.mark.long
def test_the_page_on_python_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    root = Path(__file__).resolve().parents[3]
    page = (root / "docs" / "howto" / "python.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "sample_data").symlink_to(root / "sample_data")
    names: dict[str, object] = {}
    exec(code, names)
    assert (tmp_path / "figures" / "auto_mac.png").exists() and (tmp_path / "modes.csv").exists()
    assert set(names["figures"]) == {"frf", "stabilisation", "damping", "auto_mac", "shapes"}  # type: ignore[call-overload]
