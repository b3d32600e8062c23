"""Studies of type ``matrices``: what they take, what they refuse, and that a beam by matrices is the beam."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from nastran_cases import write_op4
from scipy import sparse
from scipy.io import mmread, mmwrite

from acquisition.errors import EstimationError, StudyError
from modalkit.cli import main
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from updating import Material, Spec, build_structure
from updating.correlation.correlate import correlate
from updating.update import update

SAMPLE = Path(__file__).resolve().parents[3] / "sample_data" / "beam_dry" / "beam_dry.uff"
STEEL = Material(210e9, 7850.0, 0.3)
BEAM = Spec(
    "beam",
    length=0.376,
    width=0.0305,
    thickness=0.0047625,
    elements=(30,),
    clamped=("x0",),
    theory="euler-bernoulli",
    material=STEEL,
)

STUDY = f"""[test]
files = ["{SAMPLE}"]
band = [5.0, 500.0]
exponential_window = 8.0
[model]
type = "matrices"
stiffness = "k.npz"
mass = "m.mtx"
nodes = "nodes.csv"
[model.material]
E = 210e9
density = 7850.0
"""


def exported(folder: Path, text: str = STUDY, spec: Spec = BEAM) -> Path:
    """Write the built-in beam's own matrices and their node table, on the beam's middle line y = width / 2."""
    built = build_structure(spec)
    free = built.free()
    cut = {kind: built.matrix(kind)[free][:, free] for kind in ("stiffness", "mass")}
    sparse.save_npz(folder / "k.npz", cut["stiffness"])
    mmwrite(folder / "m.mtx", cut["mass"], precision=17)
    x = np.linspace(0, spec.length, spec.elements[0] + 1)
    lines = ["node, x, y, z, direction, row"]
    for i, rows in enumerate(built.rows(x[:, None])["w"][:, free].toarray()):
        row = int(np.argmax(np.abs(rows))) + 1 if np.any(rows) else ""
        lines.append(f"{i + 1}, {float(x[i])!r}, 0, 0, 3, {row}")
    (folder / "nodes.csv").write_text("\n".join(lines) + "\n")
    path = folder / "study.toml"
    path.write_text(text)
    return path


@pytest.mark.long
def test_a_beam_by_its_matrices_is_the_beam(tmp_path: Path) -> None:
    """Same test, same frequencies before, same factor, though points and levels come by interpolation."""
    case = open_study(read_study(exported(tmp_path))).case
    native = tmp_path / "native.toml"
    keep = STUDY[: STUDY.index("[model]")]
    native.write_text(
        keep
        + '[model]\ntype = "beam"\nlength = 0.376\nwidth = 0.0305\nthickness = 0.0047625\nelements = 30\n'
        'clamped = ["x0"]\n[model.material]\nE = 210e9\ndensity = 7850.0\n'
    )
    other = open_study(read_study(native)).case
    found, expected = correlate(case), correlate(other)
    assert found.table["model [Hz]"].to_numpy() == pytest.approx(
        expected.table["model [Hz]"].to_numpy(), rel=1e-6
    )
    assert found.table["MAC"].to_numpy() == pytest.approx(expected.table["MAC"].to_numpy(), abs=1e-4)
    factors = [update(c, weights="relative").parameters[0].factor for c in (case, other)]
    assert factors[0] == pytest.approx(factors[1], rel=1e-4)


def test_without_a_material_values_are_factors(tmp_path: Path) -> None:
    text = STUDY[: STUDY.index("[model.material]")]
    estimate = update(open_study(read_study(exported(tmp_path, text))).case, weights="relative").parameters[0]
    assert estimate.unit == "-"
    assert estimate.value == pytest.approx(estimate.factor)


def test_frequencies_alone_need_no_points(tmp_path: Path) -> None:
    path = exported(tmp_path)
    (tmp_path / "modes.csv").write_text("frequency, sigma\n24.47, 0.01\n153.96, 0.05\n429.15, 0.1\n")
    path.write_text('[test]\nmodes = "modes.csv"\n' + STUDY[STUDY.index("[model]") :])
    result = update(open_study(read_study(path)).case, weights="relative")
    assert result.parameters[0].factor == pytest.approx(0.75, abs=0.02)


@pytest.mark.parametrize("factor", [1e3, 1e-3, 3.0])
def test_frequencies_that_have_nothing_in_common(tmp_path: Path, factor: float) -> None:
    path = exported(tmp_path)
    values = "\n".join(f"{factor * f}, {0.01 * factor}" for f in (24.47, 153.96, 429.15))
    (tmp_path / "modes.csv").write_text(f"frequency, sigma\n{values}\n")
    path.write_text('[test]\nmodes = "modes.csv"\n' + STUDY[STUDY.index("[model]") :])
    case = open_study(read_study(path)).case
    if factor == 3.0:
        assert any("paired by their order alone" in warning for warning in correlate(case).warnings)
    else:
        for command in (correlate, update):
            with pytest.raises(EstimationError, match="no modes in common: the test's frequencies are"):
                command(case)


def test_the_key_mass_is_a_file_or_a_list(tmp_path: Path) -> None:
    text = STUDY.replace('mass = "m.mtx"', 'mass_matrix = "m.mtx"')
    text += "[[model.mass]]\nat = [0.376, 0.0, 0.0]\nmass = 0.01\n"
    spec = read_study(exported(tmp_path, text)).spec()
    assert spec.masses[0].mass == 0.01
    heavier, bare = build_structure(spec), build_structure(read_study(exported(tmp_path)).spec())
    assert heavier.eigen(1)[0][0] < 0.95 * bare.eigen(1)[0][0]


def test_one_file_of_nastran_with_two_pairs_and_names_is_the_beam(tmp_path: Path) -> None:
    """KGG, with half the stiffness, is not taken."""
    study = exported(tmp_path)
    k, m = sparse.load_npz(tmp_path / "k.npz"), sparse.csr_array(mmread(tmp_path / "m.mtx"))
    write_op4(tmp_path / "model.op4", "sparse binary", KGG=0.5 * k, KAA=k, MGG=m, MAA=m)
    expected = build_structure(read_study(study).spec()).eigen(3)[0]
    one_file = STUDY.replace("k.npz", "model.op4").replace("m.mtx", "model.op4")
    study.write_text(one_file)
    with pytest.raises(StudyError, match="KGG, KAA, MGG, MAA: write stiffness_name"):
        read_study(study).spec()
    study.write_text(one_file.replace("nodes =", 'stiffness_name = "KAA"\nmass_name = "MAA"\nnodes ='))
    assert build_structure(read_study(study).spec()).eigen(3)[0] == pytest.approx(expected, rel=1e-9)


def test_matrices_are_read_once(tmp_path: Path) -> None:
    study = read_study(exported(tmp_path))
    assert study.spec().imported is study.spec().imported


MODEL = STUDY[STUDY.index("[model]") :]
REFUSED = [
    (STUDY.replace('nodes = "nodes.csv"\n', ""), "needs nodes"),
    (STUDY.replace('mass = "m.mtx"\n', ""), "needs mass"),
    (STUDY.replace("k.npz", "missing.npz"), r"missing\.npz: no such file"),
    (STUDY.replace("k.npz", "study.toml"), r"no reader for \.toml"),
    (STUDY.replace("[model.material]", "length = 0.4\n[model.material]"), "takes no length"),
    (STUDY.replace("[model.material]", 'clamped = ["x0"]\n[model.material]'), "takes no clamped"),
    (
        STUDY.replace("[model.material]", 'stiffness_parts = ["k.npz"]\n[model.material]'),
        r"1 files for 0 \[\[model.region",
    ),
    (STUDY + '[[model.region]]\nname = "a"\n', "'a' needs x, or a part"),
    (STUDY + '[[model.region]]\nname = "a"\nx = [0, 1]\nthickness = 0.01\n', "have no thickness"),
    (STUDY.replace("nodes =", "knots ="), "unknown key model.knots"),
    (STUDY.replace("[model.material]", 'units = "mm"\n[model.material]'), "model.units: .*mm-t-s"),
    (STUDY.replace("7850.0", "7.85e-9"), "density = 7.85e-09: no solid is so light; it is in kg/m3"),
    (STUDY.replace("210e9", "inf"), "model.material.E: .*finite"),
    (STUDY + '[[model.region]]\nname = ""\nx = [0, 1]\n', "model.region.0.name: "),
    (STUDY + '[update]\nparameters = ["E", "E"]\n', "update.parameters: .*'E' is given twice"),
    (
        STUDY + '[update]\nmethod = "frf"\nstages = [["E"], []]\n',
        "update.stages: .*a stage without parameters",
    ),
    (STUDY + "[[model.mass]]\nat = [0.1]\nmass = 1.0\n", "not a valid TOML|mass"),
    (
        STUDY.replace('type = "matrices"', 'type = "beam"\nlength = 1.0\nwidth = 0.1\nthickness = 0.1'),
        "takes no stiffness",
    ),
]


@pytest.mark.parametrize(("text", "message"), REFUSED)
def test_what_does_not_fit_is_refused(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(StudyError, match=message) as error:
        read_study(exported(tmp_path, text)).spec()
    assert str(tmp_path) in str(error.value)
    assert "\n" not in str(error.value)


def test_parts_must_be_the_regions_own(tmp_path: Path) -> None:
    text = STUDY.replace("[model.material]", 'stiffness_parts = ["k.npz", "k.npz"]\n[model.material]')
    text += '[[model.region]]\nname = "a"\n[[model.region]]\nname = "b"\n'
    with pytest.raises(StudyError, match="stiffness_parts: they sum to more than the stiffness"):
        read_study(exported(tmp_path, text)).spec()


@pytest.mark.parametrize("name", ["thickness", "length", "clamp_rotation.*support", "width"])
def test_what_matrices_do_not_know_cannot_be_updated(tmp_path: Path, name: str) -> None:
    case = open_study(read_study(exported(tmp_path))).case
    with pytest.raises(StudyError, match=rf"update: {name}.*(imported matrices|unknown)"):
        update(case, parameters=(name.partition(".")[0],))


def scaled_to_millimetres(folder: Path) -> None:
    """Write the beam's files anew in mm, t and s; its free rows are displacements and slopes dw/dx."""
    sparse.save_npz(folder / "k.npz", sparse.load_npz(folder / "k.npz") / 1000)
    mmwrite(folder / "m.mtx", mmread(folder / "m.mtx", spmatrix=False) / 1000, precision=17)
    lines = (folder / "nodes.csv").read_text().splitlines()
    for i, line in enumerate(lines[1:], start=1):
        node, x, *rest = line.split(", ")
        lines[i] = ", ".join((node, repr(1000 * float(x)), *rest))
    (folder / "nodes.csv").write_text("\n".join(lines) + "\n")


@pytest.mark.long
def test_a_beam_in_millimetres_and_tonnes_is_the_beam(tmp_path: Path) -> None:
    """Level and all: FRFs and masses are in SI, whatever the matrices came in."""
    path = exported(tmp_path)
    session = open_study(read_study(path))
    expected = correlate(session.case)
    assert session.case.spec.imported is not None
    weight = session.case.spec.imported.total_mass
    scaled_to_millimetres(tmp_path)
    with pytest.raises(StudyError, match='write units = "mm-t-s"'):
        open_study(read_study(path))
    path.write_text(STUDY.replace("[model.material]", 'units = "mm-t-s"\n[model.material]'))
    study = read_study(path)
    found = correlate(open_study(study).case)
    assert found.table["model [Hz]"].to_numpy() == pytest.approx(
        expected.table["model [Hz]"].to_numpy(), rel=1e-9
    )
    assert found.table["MAC"].to_numpy() == pytest.approx(expected.table["MAC"].to_numpy(), abs=1e-9)
    imported = study.spec().imported
    assert imported is not None
    assert imported.total_mass == pytest.approx(weight, rel=1e-9)


Fails = Callable[..., str]


@pytest.fixture
def fails(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Fails:
    def call(*arguments: str | Path) -> str:
        monkeypatch.setattr(sys, "argv", ["modalkit", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        assert ended.value.code == 2
        return " ".join(capfd.readouterr().err.split())

    return call


@pytest.mark.parametrize("command", ["correlate", "update", "diagnose"])
def test_a_result_is_never_written_over_the_study(tmp_path: Path, fails: Fails, command: str) -> None:
    path = exported(tmp_path)
    assert "this command reads it" in fails(command, path, "--json", path)
    assert path.read_text() == STUDY
    assert "no such folder" in fails(command, path, "--json", tmp_path / "nowhere" / "x.json")
    assert "is a folder" in fails(command, path, "--json", tmp_path)


@pytest.mark.parametrize("name", ["study.toml", "k.npz", "nodes.csv"])
def test_a_simulated_test_is_never_written_over_what_the_study_reads(
    tmp_path: Path, fails: Fails, name: str
) -> None:
    path = exported(tmp_path)
    before = (tmp_path / name).read_bytes()
    assert "this command reads it" in fails("simulate", path, "--output", tmp_path / name)
    assert (tmp_path / name).read_bytes() == before


def test_tables_say_at_once_that_their_folder_does_not_exist(tmp_path: Path, fails: Fails) -> None:
    assert "no such folder" in fails("tables", "--paper", "A", "-o", tmp_path / "nowhere" / "t.md")


def test_the_same_study_twice_is_no_second_specimen(tmp_path: Path, fails: Fails) -> None:
    path = exported(tmp_path)
    assert "given twice" in fails("update", path, path, "--shared", "E")
