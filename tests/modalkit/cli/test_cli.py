"""The command line on shipped data: what it prints, what it writes, how it fails."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from conforming import departures

from modalkit.output.schemas import DiagnosisDocument, LocalisationDocument, ModesDocument, UpdateDocument
from modalkit.samples import sample_file

Run = Callable[..., tuple[int, str, str]]


def beam(name: str = "beam_dry.uff") -> Path:
    return sample_file("beam_dry/study.toml").parent / name


def test_inspect_lists_what_is_usable(run: Run) -> None:
    code, out, _ = run("inspect", beam())
    assert code == 0
    assert "75 hits at 5 points (1+Z, 2+Z, 3+Z, 4+Z, 5+Z), seen at 1 point (" in " ".join(out.split())


def test_inspect_names_the_degrees_of_freedom_of_text(run: Run, tmp_path: Path) -> None:
    columns = "".join(
        f'[[column]]\nname = "{name}"\nquantity = "accelerance"\npart = "{part}"\n'
        for name, part in (("re", "real"), ("im", "imag"))
    )
    rules = "".join(f'[[file]]\nmatch = "p{n}.csv"\nnode = {n}\n' for n in (1, 2, 3))
    (tmp_path / "layout.toml").write_text('frequency_column = "f"\n' + columns + rules)
    files = [tmp_path / f"p{n}.csv" for n in (1, 2, 3)]
    for file in files:
        file.write_text("f,re,im\n1,1,0\n2,1,0\n3,1,0\n")
    code, out, _ = run("inspect", *files, "--layout", tmp_path / "layout.toml")
    assert code == 0
    assert "hit at 3 points (1+Z, 2+Z, 3+Z), seen at 1 point (1+Z)" in " ".join(out.split())


def test_identify_finds_the_published_frequencies(run: Run, tmp_path: Path) -> None:
    target = tmp_path / "modes.json"
    code, out, _ = run("identify", beam(), "--band", "5", "500", "--json", target)
    assert code == 0
    assert "3 modes" in out
    record = json.loads(target.read_text())
    assert not departures(record, ModesDocument)
    found = [mode["frequency_hz"] for mode in record["modes"]]
    assert found == pytest.approx([24.47, 153.96, 429.15], rel=5e-4)
    assert record["window_decay_removed"] == pytest.approx(8.0)
    assert len(record["hits"]) == 75


@pytest.mark.long
def test_frf_writes_what_identify_reads_alike(run: Run, tmp_path: Path) -> None:
    target, first, second = (tmp_path / n for n in ("frf.uff", "a.json", "b.json"))
    assert run("frf", beam(), "-o", target)[0] == 0
    assert run("identify", beam(), "--band", "5", "500", "--json", first)[0] == 0
    assert run("identify", target, "--band", "5", "500", "--json", second)[0] == 0
    a, b = (json.loads(path.read_text())["modes"] for path in (first, second))
    for one, other in zip(a, b, strict=True):
        assert one["frequency_hz"] == pytest.approx(other["frequency_hz"], rel=1e-5)
        assert one["damping_ratio"] == pytest.approx(other["damping_ratio"], rel=0.02)


def test_inspect_tells_the_band_of_the_force(run: Run) -> None:
    out = run("inspect", beam())[1]
    line = next(row for row in out.splitlines() if row.startswith("Force: "))
    assert "10 dB down at" in line and "20 dB down at" in line


@pytest.mark.long
def test_a_sensor_and_an_estimator_in_small_letters_are_taken(run: Run, tmp_path: Path) -> None:
    plain, light = tmp_path / "a.uff", tmp_path / "b.uff"
    assert run("frf", beam(), "-o", plain)[0] == 0
    code, out, _ = run("frf", beam(), "-o", light, "--estimator", "h1", "--sensor-mass", "5+Z=0.005")
    assert code == 0
    assert "mass of the accelerometers was removed from the FRFs: 5 g at 5+Z" in out
    found = []
    for path in (plain, light):
        target = tmp_path / "modes.json"
        assert run("identify", path, "--band", "5", "500", "--json", target)[0] == 0
        found.append(json.loads(target.read_text())["modes"][0]["frequency_hz"])
    assert found[1] > 1.001 * found[0]
    code, _, err = run("identify", beam(), "--sensor-mass", "25+Z")
    assert (code, len(err.strip().splitlines())) == (2, 1)
    assert "POINT=MASS" in err


def test_options_for_hits_are_refused_for_frfs(run: Run, tmp_path: Path) -> None:
    target = tmp_path / "frf.uff"
    assert run("frf", beam(), "-o", target)[0] == 0
    code, _, err = run("identify", target, "--leave", "1+Z:1")
    assert code == 2
    assert "--leave" in err and "the files hold FRFs" in err


@pytest.mark.long
def test_diagnose_writes_the_contract(run: Run, tmp_path: Path) -> None:
    target, figures = tmp_path / "d.json", tmp_path / "figures"
    code, out, _ = run("diagnose", sample_file("beam_wet/study.toml"), "--json", target, "--figures", figures)
    assert code == 0
    answer = [line.split(":")[0] for line in out.splitlines()[1:6]]
    assert answer == ["Cause", "Where", "Closes", "Sure", "Next"]
    record = json.loads(target.read_text())
    assert not departures(record, DiagnosisDocument)
    # how much of a wall the clamp is, is not stated: three frequencies leave a second cause beside the water possible
    assert record["cause"]["verdict"] == "class"
    assert all("fluid_added_mass" in one for one in record["cause"]["sets"])
    assert record["cause"]["ranking"][0]["effects"] == ["fluid_added_mass"]
    assert record["where"]["channel"] == "mass"
    assert (figures / "diagnosis.png").stat().st_size > 10_000


@pytest.mark.long
def test_correlate_and_update_print_their_tables(run: Run, tmp_path: Path) -> None:
    study = sample_file("beam_dry/study.toml")
    assert "MAC" in run("correlate", study)[1]
    target = tmp_path / "u.json"
    assert run("update", study, "--json", target)[0] == 0
    record = json.loads(target.read_text())
    assert not departures(record, UpdateDocument)
    assert record["parameters"][0]["name"] == "E"
    assert 0.74 < record["parameters"][0]["factor"] < 0.77


@pytest.mark.long
def test_localise_puts_the_tape_where_it_is(run: Run, tmp_path: Path) -> None:
    target, figures = tmp_path / "l.json", tmp_path / "figures"
    study = sample_file("tape_taped/study.toml")
    code, out, _ = run("localise", study, "--json", target, "--figures", figures)
    assert code == 0
    assert "methods put taped first" in out.splitlines()[0]
    assert "x [m]" in out
    record = json.loads(target.read_text())
    assert not departures(record, LocalisationDocument)
    assert [region["name"] for region in record["regions"]] == ["bare", "taped", "bare"]
    assert record["methods"][0]["method"] == "evidence"
    assert record["methods"][0]["ranks"][1] == 1
    assert record["unchanged"] < 1e-3
    assert (figures / "localisation.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--kind", "colour"), "--kind colour: write one of stiffness, mass, damping"),
        (("--method", "guess"), "--method guess: write one of evidence"),
        (("--kind", "damping"), "needs damping, both measured and expected"),
    ],
)
def test_localise_says_what_it_cannot_compare(run: Run, options: tuple[str, ...], message: str) -> None:
    code, _, err = run("localise", beam("published.toml"), *options)
    assert code == 2
    assert message in err


def test_effects_lists_the_names_of_the_contract(run: Run, tmp_path: Path) -> None:
    target = tmp_path / "effects.json"
    assert run("effects", "--json", target)[0] == 0
    names = {effect["name"] for effect in json.loads(target.read_text())["effects"]}
    assert names >= {
        "E", "density", "length", "clamp_rotation", "sensor_mass", "local_stiffness", "shear",
        "fluid_added_mass", "exponential_window", "calibration_gain",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["identify", "nowhere.uff"], "nowhere.uff"),
        (["diagnose", "nowhere.toml"], "nowhere.toml"),
        (["identify", "BEAM", "--band", "700", "800"], "band"),
        (["sing"], "sing"),
        (["identify", "BEAM", "--json", "no/such/folder/x.json", "--band", "5", "500"], "x.json"),
    ],
)
def test_a_mistake_is_one_line_and_code_2(run: Run, arguments: list[str], message: str) -> None:
    code, _, err = run(*[beam() if a == "BEAM" else a for a in arguments])
    assert code == 2
    assert message in err
    assert "Traceback" not in err
    assert len(err.strip().splitlines()) == 1
