"""Studies of type ``matrices``: what they take, what they refuse, and that a beam by matrices is the beam."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy import sparse
from scipy.io import mmwrite

from acquisition.errors import StudyError
from modalkit.process import open_study
from modalkit.study import read_study
from updating import Material, Spec, build_structure
from updating.correlation import correlate
from updating.update import update

SAMPLE = Path(__file__).resolve().parents[2] / "sample_data" / "beam_dry" / "beam_dry.uff"
STEEL = Material(210e9, 7850.0, 0.3)
BEAM = Spec("beam", 0.376, 0.0305, 0.0047625, (30,), ("x0",), "euler-bernoulli", STEEL)

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


def test_the_key_mass_is_a_file_or_a_list(tmp_path: Path) -> None:
    text = STUDY.replace('mass = "m.mtx"', 'mass_matrix = "m.mtx"')
    text += "[[model.mass]]\nat = [0.376, 0.0, 0.0]\nmass = 0.01\n"
    spec = read_study(exported(tmp_path, text)).spec()
    assert spec.masses[0].mass == 0.01
    heavier, bare = build_structure(spec), build_structure(read_study(exported(tmp_path)).spec())
    assert heavier.eigen(1)[0][0] < 0.95 * bare.eigen(1)[0][0]


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
    (STUDY + '[[model.region]]\nname = "a"\nx = [0, 1]\nthickness = 0.01\n', "know no thickness"),
    (STUDY.replace("nodes =", "knots ="), "unknown key model.knots"),
    (STUDY + "[[model.mass]]\nat = [0.1]\nmass = 1.0\n", "not a valid TOML|mass"),
    (
        STUDY.replace('type = "matrices"', 'type = "beam"\nlength = 1.0\nwidth = 0.1\nthickness = 0.1'),
        "takes no stiffness",
    ),
]


@pytest.mark.parametrize(("text", "said"), REFUSED)
def test_what_does_not_fit_is_refused(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(StudyError, match=said) as error:
        read_study(exported(tmp_path, text)).spec()
    assert str(tmp_path) in str(error.value)
    assert "\n" not in str(error.value)


def test_parts_must_be_the_regions_own(tmp_path: Path) -> None:
    text = STUDY.replace("[model.material]", 'stiffness_parts = ["k.npz", "k.npz"]\n[model.material]')
    text += '[[model.region]]\nname = "a"\n[[model.region]]\nname = "b"\n'
    with pytest.raises(StudyError, match="stiffness_parts: they sum to more than the stiffness"):
        read_study(exported(tmp_path, text)).spec()


@pytest.mark.parametrize("name", ["thickness", "length", "clamp_rotation", "width"])
def test_what_matrices_do_not_know_cannot_be_updated(tmp_path: Path, name: str) -> None:
    case = open_study(read_study(exported(tmp_path))).case
    with pytest.raises(StudyError, match=rf"update: {name}.*imported matrices"):
        update(case, parameters=(name,))
