"""Text imported by the form of the app: what is guessed, what is corrected, what is written."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from nptdms import ChannelObject, TdmsWriter
from scipy.io import savemat
from starlette.testclient import TestClient
from text_hits import RATE, TIME, hits

from acquisition.arrays import FloatArray
from acquisition.columns.proposal import propose_layout
from acquisition.columns.reasons import reasons_in
from acquisition.errors import InputError
from modalkit.app.import_form import Form, layout_of, proposed_form
from modalkit.app.importing import Importing, alike
from modalkit.app.serve import subject_of
from modalkit.app.server import application


def frfs(folder: Path) -> list[str]:
    """Write the FRFs of three points that were hit, and return their names."""
    lines = np.arange(401) * 0.5
    names = [f"point{node}.csv" for node in (1, 2, 3)]
    for node, name in enumerate(names, start=1):
        values = -(lines**2) * node / (85.0**2 - lines**2 + 0.02j * 85.0 * lines)
        rows = np.stack([lines, values.real, values.imag], axis=1)
        np.savetxt(folder / name, rows, "%.8g", ";", header="Frequency [Hz];real;imag", comments="")
    return names


def form_of(folder: Path, names: list[str]) -> Form:
    """Return the form of some files."""
    return proposed_form([folder / name for name in names], {})


def test_the_form_of_guesses_is_the_layout_that_is_proposed(tmp_path: Path) -> None:
    for write in (hits, frfs):
        names = write(tmp_path)
        table, layout = layout_of(form_of(tmp_path, names))
        proposed = tomllib.loads(propose_layout([tmp_path / name for name in names]))
        if write is frfs:
            for entry in proposed["column"]:
                entry |= {"direction": "+z", "reference_direction": "+z"}
        assert table == proposed
        assert len(layout.columns) == 2


def test_every_guess_has_its_reason(tmp_path: Path) -> None:
    form = form_of(tmp_path, hits(tmp_path))
    time, force, response = form["rows"]
    assert time["role"] == "time" and "rises in even steps" in time["why"][0]
    assert force["role"] == "force" and "quantity: by its unit, N" in force["why"]
    assert "node: by the file's name" in force["why"]
    assert response["unit"] == "m/s2" and "unit: by its heading" in response["why"]
    assert "follows a word for points" in form["why"]["match"]
    assert reasons_in("# rate = ...  # needed\n[[column]]\n# unit: stated\n") == {
        ("", 0): {"rate": "needed"},
        ("column", 0): {"unit": "stated"},
    }


def _unit(form: Form) -> None:
    form["rows"][1]["unit"] = "V"


def _node(form: Form) -> None:
    form["rows"][2]["node"] = "tip"


def _two_times(form: Form) -> None:
    form["rows"][2]["role"] = "time"


def _no_force(form: Form) -> None:
    form["rows"][1]["role"] = ""


def _of_frfs(form: Form) -> None:
    form["rows"][2]["role"] = "mobility"


def _rate(form: Form) -> None:
    form["rate"] = "fast"


def _pattern(form: Form) -> None:
    form["match"] = "Q{node}_*.csv"


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_unit, "column 'hammer [N]': 'V' is not a known unit of force"),
        (_node, "column 'acc 1 [m/s2]': node: 'tip' is not a whole number"),
        (_two_times, "columns 'time' and 'acc 1 [m/s2]' are both time"),
        (_no_force, "this form: 0 columns of force and 1 of response"),
        (_of_frfs, "mobility does not belong to hits, without a column of frequencies"),
        (_rate, "rate: 'fast' is not a number"),
        (_pattern, "no [[file]] rule of this form matches it"),
    ],
)
def test_what_cannot_be_read_is_stated_at_once(
    tmp_path: Path, change: Callable[[Form], None], message: str
) -> None:
    names = hits(tmp_path)
    importing = Importing(tmp_path)
    form = form_of(tmp_path, names)
    change(form)
    found = importing.checked(names, form)
    assert message in found["error"]
    with pytest.raises(InputError):
        importing.write(names, form, title="", layout="layout.toml", study="study.toml")
    assert not list(tmp_path.glob("*.toml"))


def test_a_correction_changes_what_is_read(tmp_path: Path) -> None:
    names = hits(tmp_path)
    importing = Importing(tmp_path)
    form = form_of(tmp_path, names)
    found = importing.checked(names, form)
    assert found["usable"][0].startswith("4 hits at 2 points (1+Z, 2+Z), seen at 1 point (1+Z), 1024 samples")
    assert [row[:2] for row in found["table"]] == [["1+Z", 2], ["2+Z", 2]]
    form["rows"][1] |= {"unit": "kN", "direction": "-x"}
    form |= {"rate": "2.048 kHz", "match": "", "samples": "512"}
    found = importing.checked(names, form)
    assert found["usable"][0].endswith("512 samples at 2048 Hz")
    assert found["table"][0][:2] == ["1-X", 4]
    assert float(found["table"][0][3]) == pytest.approx(1e5, rel=0.1)


def test_lines_that_hinder_are_skipped(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("3;x 4\n" + "0,1;2,5\n" * 9)
    importing = Importing(tmp_path)
    refused = importing.proposed(["a.txt"], {"skip": "0"})
    assert refused["form"] is None and "almost a line of numbers" in refused["error"]
    assert refused["lines"][0] == "3;x 4"
    found = importing.proposed(["a.txt"], {"skip": "1", "separator": "semicolon", "decimal": ","})
    assert found["error"] == ""
    assert (found["form"]["skip"], found["form"]["separator"], found["form"]["decimal"]) == (
        "1",
        "semicolon",
        ",",
    )
    for row in found["form"]["rows"]:
        row["node"] = "1"
    assert layout_of(found["form"])[1].skip == 1


def test_files_that_are_probably_one_test() -> None:
    names = ["P1_1.csv", "P1_2.csv", "P2_1.csv", "modes.csv", "notes.txt"]
    assert alike(names) == names[:3]
    assert alike(names, "modes.csv") == ["modes.csv"]
    assert alike(["root.csv", "tip.csv", "notes.txt"]) == ["root.csv", "tip.csv"]


def test_a_folder_becomes_a_study_that_the_server_goes_on_with(tmp_path: Path) -> None:
    names = hits(tmp_path)
    subject = subject_of(tmp_path)
    assert isinstance(subject, Importing)
    app = application(subject, token="t", port=8000)
    headers = {"content-type": "application/json"}
    client = TestClient(app, base_url="http://127.0.0.1:8000", headers=headers)
    assert client.get("/t/api/state").json()["importing"]
    assert client.get("/t/api/hits").status_code == 404
    assert client.get("/t/report/diagnose").status_code == 404
    page = client.get("/t/api/import").json()
    assert page["chosen"] == names
    strange = client.post("/t/api/proposed", json={"files": ["../secret.csv"]})
    assert strange.status_code == 422 and "not among the files" in strange.json()["error"]
    form = client.post("/t/api/proposed", json={"files": names}).json()["form"]
    wanted = {"files": names, "form": form, "title": "Beam", "layout": page["layout"], "study": page["study"]}
    for name in ("../study.toml", "study.csv", ".toml"):
        refused = client.post("/t/api/write", json=wanted | {"study": name})
        assert refused.status_code == 422 and "without a folder" in refused.json()["error"]
    state = client.post("/t/api/write", json=wanted).json()
    assert (state["title"], state["is_study"]) == ("Beam", True)
    assert len(client.get("/t/api/hits").json()["hits"]) == 4
    subject.close()
    study = subject_of(tmp_path)
    assert not isinstance(study, Importing)
    study.close()


def test_files_of_several_folders_are_one_test_and_the_folder_states_the_point(tmp_path: Path) -> None:
    flat = tmp_path / "flat"
    flat.mkdir()
    for name in hits(flat):
        node, hit = name[1], name[3]
        (tmp_path / "test" / f"P{node}").mkdir(parents=True, exist_ok=True)
        (flat / name).rename(tmp_path / "test" / f"P{node}" / f"hit{hit}.csv")
    (tmp_path / ".hidden").mkdir()
    (tmp_path / ".hidden" / "P1_1.csv").write_text("1")
    importing = Importing(tmp_path)
    names = importing.page()["chosen"]
    assert names == [f"test/P{node}/hit{hit}.csv" for node in (1, 2) for hit in (1, 2)]
    assert importing.page()["files"] == names
    form = importing.proposed(names, {})["form"]
    assert form["match"] == "P{node}/hit*.csv"
    assert [row[:2] for row in importing.checked(names, form)["table"]] == [["1+Z", 2], ["2+Z", 2]]
    importing.write(names, form, title="", layout="layout.toml", study="study.toml")
    assert importing.controller is not None
    assert [hit["point"] for hit in importing.controller.hits()["hits"]] == ["1+Z", "1+Z", "2+Z", "2+Z"]
    importing.close()


def _npz(folder: Path, force: FloatArray, motion: FloatArray) -> None:
    np.savez(folder / "P1.npz", fs=RATE, force=force, acc=motion)


def _mat(folder: Path, force: FloatArray, motion: FloatArray) -> None:
    savemat(folder / "P1.mat", {"fs": RATE, "force": force, "acc": motion})


def _hdf5(folder: Path, force: FloatArray, motion: FloatArray) -> None:
    with h5py.File(folder / "P1.h5", "w") as file:
        file["fs"], file["force"], file["acc"] = RATE, force, motion


def _tdms(folder: Path, force: FloatArray, motion: FloatArray) -> None:
    with TdmsWriter(folder / "P1.tdms") as file:
        for hit in range(len(force)):
            named = (("force", force[hit], "N"), ("acc", motion[hit], "m/s2"))
            told = [
                ChannelObject(f"hit {hit}", name, values, {"wf_increment": 1 / RATE, "unit_string": unit})
                for name, values, unit in named
            ]
            file.write_segment(told)


@pytest.mark.parametrize("write", [_npz, _mat, _hdf5, _tdms])
def test_files_of_recorders_are_imported(tmp_path: Path, write: Callable[..., None]) -> None:
    strength = np.array([[1.0], [0.8], [0.9]])
    force = 90.0 * strength * np.exp(-(((TIME - 0.02) / 0.0015) ** 2))
    write(tmp_path, force, 4.0 * strength * np.exp(-5 * TIME) * np.sin(530 * TIME))
    importing = Importing(tmp_path)
    names = importing.page()["chosen"]
    found = importing.proposed(names, {})
    assert found["recorded"] and found["error"] == ""
    assert any(line.startswith("force: ") for line in found["lines"])
    unknown = [row for row in found["form"]["rows"] if row["node"] == ""]
    assert unknown  # no guess stands where nothing states the point
    assert "the number of the point where it was" in importing.checked(names, found["form"])["error"]
    for row in unknown:
        row["node"] = "1"
    checked = importing.checked(names, found["form"])
    assert checked["error"] == ""
    assert checked["table"] == [["1+Z", 3, "1+Z", f"{force.max():.3g}", "3.94"]]
    importing.write(names, found["form"], title="", layout="layout.toml", study="study.toml")
    assert importing.controller is not None
    assert len(importing.controller.hits()["hits"]) == 3
    importing.close()


def test_frfs_of_a_matlab_file_are_imported(tmp_path: Path) -> None:
    lines = np.arange(401) * 0.5
    frfs = np.stack([-(lines**2) * k / (85.0**2 - lines**2 + 2j * lines) for k in (1, 2, 3)], axis=1)
    savemat(tmp_path / "frfs.mat", {"f": lines, "H": frfs[:, :, None]})
    importing = Importing(tmp_path)
    found = importing.proposed(["frfs.mat"], {})
    assert "H: 401 x 3 x 1, complex" in found["lines"]
    form = found["form"]
    assert form["mat"]["axes"] == "line, response, reference"
    form["mat"] |= {"quantity": "mobility", "responses": "4+Z, 5+Z", "references": "4-Z"}
    assert "responses" in importing.checked(["frfs.mat"], form)["error"]
    form["mat"]["responses"] = "4+Z, 5+Z, 6+Z"
    checked = importing.checked(["frfs.mat"], form)
    assert checked["usable"][0].startswith("3 FRFs (mobility), hit at 1 point (4-Z)")
    assert checked["table"][0][:2] == ["4-Z", 3]


def test_what_is_there_is_not_replaced(tmp_path: Path) -> None:
    names = hits(tmp_path)
    (tmp_path / "layout.toml").write_text("mine")
    importing = Importing(tmp_path)
    assert importing.page()["layout"] == "layout-2.toml"
    form = form_of(tmp_path, names)
    with pytest.raises(InputError, match="is there already"):
        importing.write(names, form, title="", layout="layout.toml", study="study.toml")
    assert (tmp_path / "layout.toml").read_text() == "mine"
    with pytest.raises(InputError, match="different names"):
        importing.write(names, form, title="", layout="a.toml", study="a.toml")


def test_what_opens_the_import(tmp_path: Path) -> None:
    names = hits(tmp_path)
    subject = subject_of(tmp_path / names[0])
    assert isinstance(subject, Importing)
    assert subject.page()["chosen"] == names
    assert "layout" in subject.page()["why"]
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="no column text or recorder file in it"):
        subject_of(tmp_path / "empty")
    with pytest.raises(InputError, match="there is no such file"):
        subject_of(tmp_path / "absent.csv")
    (tmp_path / "modes.csv").write_text("frequency,sigma\n10.0,0.1\n27.0,0.2\n")
    assert not isinstance(subject_of(tmp_path / "modes.csv"), Importing)
