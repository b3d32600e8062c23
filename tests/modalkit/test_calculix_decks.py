"""Decks of all kinds by the CalculiX helper: supports in steps, included files, masses, solids in millimetres."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from acquisition.errors import StudyError
from modalkit.study.read import read_study
from updating import Material, Spec, build_structure
from updating.models.imported import read_imported

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "calculix"

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="no ccx: apt-get install calculix-ccx")


@pytest.fixture(scope="module")
def example(example_of: Callable[[Path, str], ModuleType]) -> Callable[[str], ModuleType]:
    return lambda name: example_of(EXAMPLES, name)


def frequencies(folder: Path, job: str, count: int) -> tuple[int, np.ndarray]:
    imported = read_imported(folder / f"{job}.sti", folder / f"{job}.mas", folder / f"{job}.inp")
    spec = Spec(
        "matrices",
        length=1,
        width=1,
        thickness=1,
        elements=(),
        clamped=(),
        theory="imported",
        material=Material(1, 1),
        imported=imported,
    )
    structure = build_structure(spec)
    first = structure.rigid_modes
    return first, np.sqrt(structure.eigen(first + count)[0][first:]) / (2 * np.pi)


def block(stem: str = "C3D20", across: int = 1, *, factor: float = 1.0) -> list[str]:
    """Return a bar of 200 x 20 x 10 mm in two materials, in mm, t and s, clamped at x = 0 in its step."""
    node: dict[tuple[float, float, float], int] = {}

    def number(at: np.ndarray) -> int:
        x, y, z = (round(float(c), 6) for c in at)
        return node.setdefault((x, y, z), len(node) + 1)

    corners = np.array(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1.0)]
    )
    sides = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    unit = np.vstack([corners, [(corners[a] + corners[b]) / 2 for a, b in sides]])
    rows: dict[str, list[list[int]]] = {"ROOT": [], "TIP": []}
    size = np.array([20.0, 20.0 / across, 10.0 / across])
    for i in range(10):
        for j in range(across * across):
            low = size * [i, j % across, j // across]
            rows["ROOT" if i < 5 else "TIP"].append([number(low + p * size) for p in unit])
    lines = ["*NODE, NSET=ALL", *(f"{n}, {x}, {y}, {z}" for (x, y, z), n in node.items())]
    element = 0
    for name, each in rows.items():
        lines.append(f"*ELEMENT, TYPE={stem}, ELSET={name}")
        for nodes in each:
            element += 1
            lines += [", ".join(map(str, (element, *nodes[:15]))) + ",", ", ".join(map(str, nodes[15:]))]
        modulus = 210000.0 * (factor if name == "TIP" else 1.0)
        lines += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{modulus}, 0.3", "*DENSITY", "7.85e-9"]
        lines.append(f"*SOLID SECTION, ELSET={name}, MATERIAL={name}")
    lines += ["*NSET, NSET=CLAMP", *(f"{n}," for (x, _, _), n in node.items() if x == 0)]
    return [
        *lines,
        "*STEP",
        "*FREQUENCY",
        "10",
        "*BOUNDARY, OP=NEW",
        "CLAMP, 1, 3",
        "*NODE FILE",
        "U",
        "*END STEP",
    ]


def written(folder: Path, lines: list[str], name: str = "block.inp") -> Path:
    (folder / name).write_text("\n".join(lines) + "\n", encoding="latin-1")
    return folder / name


def test_supports_of_a_step_and_included_files_stay(
    example: Callable[[str], ModuleType], tmp_path: Path
) -> None:
    lines = block()
    cut = lines.index("*MATERIAL, NAME=TIP")
    written(tmp_path, lines[cut : cut + 5], "tip.inp")
    path = written(tmp_path, ["** Träger", *lines[:cut], "*INCLUDE, INPUT=tip.inp", *lines[cut + 5 :]])
    kept = example("ccx").model(path)
    assert kept[-2:] == ["*BOUNDARY", "CLAMP, 1, 3"]
    assert kept[cut : cut + 5] == lines[cut : cut + 5]
    assert not any(line.startswith(("*STEP", "*FREQ", "*NODE FILE", "*END", "*INCLUDE")) for line in kept)


ALONE = """*MATERIAL, NAME = ONE
*ELASTIC, TYPE=ENGINEERING CONSTANTS
100., 200., 300., 0.1, 0.2, 0.3, 40., 50.
60., 293.
*DENSITY
7.,
*MATERIAL, NAME=two
*ELASTIC
210.D0, 0.3
*MASS, ELSET=M
2.
*SPRING, ELSET=S
3
50.""".splitlines()


def test_what_is_left_out_of_a_part(example: Callable[[str], ModuleType]) -> None:
    """Moduli and densities of other materials, of every kind; masses and springs, which belong to the whole."""
    rows = {name: example("ccx").alone(ALONE, name) for name in ("one", "TWO")}
    numbers = {name: [line.split(",") for line in lines] for name, lines in rows.items()}
    assert rows["one"][:7] == ALONE[:7]
    assert float(numbers["one"][8][0]) == pytest.approx(210e-12)
    assert [float(n) for n in numbers["TWO"][2]] == pytest.approx(
        [1e-10, 2e-10, 3e-10, 0.1, 0.2, 0.3, 4e-11, 5e-11]
    )
    assert [float(n) for n in numbers["TWO"][3]] == pytest.approx([6e-11, 293.0])
    assert float(numbers["TWO"][5][0]) == pytest.approx(7e-12)
    for lines in numbers.values():
        assert [float(lines[i][0]) for i in (10, 12, 13)] == pytest.approx([2e-12, 3.0, 5e-11])


@needs_ccx
def test_a_solid_in_millimetres(example: Callable[[str], ModuleType], tmp_path: Path) -> None:
    """Supports in the step, deck and files in one folder; against the frequencies that ccx finds, and Euler's."""
    path = written(tmp_path, block())
    before = path.read_text()
    ccx = example("ccx")
    with pytest.raises(SystemExit, match=r"no .MATERIAL TAIL; there are ROOT, TIP"):
        ccx.store_matrices(path, tmp_path, ("TAIL",))
    ccx.store_matrices(path, tmp_path, ("ROOT", "TIP"))
    assert path.read_text() == before
    parts = {kind: [tmp_path / f"block_{name}.{kind}" for name in ("ROOT", "TIP")] for kind in ("sti", "mas")}
    imported = read_imported(
        tmp_path / "block.sti", tmp_path / "block.mas", path,
        stiffness_parts=parts["sti"], mass_parts=parts["mas"], units="mm-t-s",
    )  # fmt: skip
    spec = Spec(
        "matrices",
        length=1,
        width=1,
        thickness=1,
        elements=(),
        clamped=(),
        theory="imported",
        material=Material(1, 1),
        imported=imported,
    )
    found = np.sqrt(build_structure(spec).eigen(6)[0]) / (2 * np.pi)
    assert found == pytest.approx(ccx.frequencies(path, tmp_path / "modes", 6), rel=1e-5)
    bending = 1.8751040687**2 / (2 * np.pi * 0.2**2) * np.sqrt(210e9 * 0.01**2 / 12 / 7850)
    assert found[0] == pytest.approx(bending, rel=0.02)
    assert imported.extents[1].tolist() == pytest.approx([0.2, 0.02, 0.01])
    assert imported.total_mass == pytest.approx(
        0.2 * 0.02 * 0.01 * 7850, rel=0.05
    )  # the clamp's share is not in it
    assert imported.rest["stiffness"] is None


@needs_ccx
def test_masses_and_springs_belong_to_no_part(example: Callable[[str], ModuleType], tmp_path: Path) -> None:
    lines = block()
    added = ["*ELEMENT, TYPE=MASS, ELSET=M", "900, 100", "*MASS, ELSET=M", "1e-5"]
    added += ["*ELEMENT, TYPE=SPRING1, ELSET=S", "901, 90", "*SPRING, ELSET=S", "3", "50."]
    at = lines.index("*STEP")
    path = written(tmp_path, [*lines[:at], *added, *lines[at:]])
    example("ccx").store_matrices(path, tmp_path, ("ROOT", "TIP"))
    parts = {kind: [tmp_path / f"block_{name}.{kind}" for name in ("ROOT", "TIP")] for kind in ("sti", "mas")}
    imported = read_imported(
        tmp_path / "block.sti", tmp_path / "block.mas", path,
        stiffness_parts=parts["sti"], mass_parts=parts["mas"], units="mm-t-s",
    )  # fmt: skip
    rest = imported.rest["mass"]
    assert rest is not None
    assert rest.diagonal().sum() == pytest.approx(3 * 0.01, rel=1e-3)


@needs_ccx
def test_elements_of_reduced_integration_that_leave_motions_loose(
    example: Callable[[str], ModuleType], tmp_path: Path
) -> None:
    path = written(tmp_path, block("C3D20R"))
    example("ccx").store_matrices(path, tmp_path)
    with pytest.raises(StudyError, match=r"have neither stiffness nor mass.*C3D20R"):
        frequencies(tmp_path, "block", 3)
    path = written(tmp_path, block("C3D20R", 2))
    example("ccx").store_matrices(path, tmp_path)
    assert frequencies(tmp_path, "block", 3)[0] == 0


@pytest.mark.long
@needs_ccx
def test_shapes_are_those_that_ccx_prints(example: Callable[[str], ModuleType], tmp_path: Path) -> None:
    """Displacements at the nodes, an oblique direction too: same shape, one sign for a mode."""
    lines = block(factor=0.6)
    at = lines.index("*NODE FILE")
    path = written(tmp_path, [*lines[:at], "*NODE PRINT, NSET=ALL", "U", "*END STEP"])
    example("ccx").store_matrices(path, tmp_path / "run")
    subprocess.run(["ccx", "block"], cwd=tmp_path, check=True, capture_output=True)
    text = (tmp_path / "block.dat").read_text()
    tables = [t.split("\n\n")[1] for t in text.split("displacements (vx,vy,vz)")[1:]]
    printed = np.array(
        [[[float(w) for w in row.split()] for row in t.splitlines() if row.split()] for t in tables]
    )
    run = tmp_path / "run"
    imported = read_imported(run / "block.sti", run / "block.mas", run / "block.inp", units="mm-t-s")
    structure = build_structure(
        Spec(
            "matrices",
            length=1,
            width=1,
            thickness=1,
            elements=(),
            clamped=(),
            theory="imported",
            material=Material(1, 1),
            imported=imported,
        )
    )
    _, vectors = structure.eigen(4)
    where = {int(n): p for n, p in zip(imported.nodes.node, imported.nodes.places, strict=True)}
    nodes = [int(n) for n in printed[0, :, 0]]
    points = np.array([where[n] for n in nodes])
    for along in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.6, -0.8)):
        ours = structure.rows(points, np.tile(along, (len(points), 1)))["w"] @ vectors
        for mode in range(4):
            theirs = printed[mode, :, 1:] @ np.array(along)
            scale = printed[mode, :, 1:].ravel()
            every = np.stack(
                [
                    structure.rows(points, np.tile(e, (len(points), 1)))["w"] @ vectors[:, mode]
                    for e in np.eye(3)
                ]
            )
            level = float(every.T.ravel() @ scale / (scale @ scale))
            np.testing.assert_allclose(ours[:, mode], level * theirs, atol=1e-4 * np.abs(every).max())


SUPPOSED = """
[test]
modes = "modes.csv"
[model]
type = "calculix"
deck = "block.inp"
units = "mm-t-s"
[[hypothesis]]
name = "tip is softer"
deck = "softer.inp"
"""


@needs_ccx
def test_a_deck_may_be_what_is_supposed(tmp_path: Path) -> None:
    """Half way to a deck whose tip has 0.8 of its modulus the tip has 0.9; the mass stays."""
    written(tmp_path, block())
    written(tmp_path, block(factor=0.8), "softer.inp")
    study = tmp_path / "study.toml"
    study.write_text(SUPPOSED)
    spec = read_study(study).spec()
    (supposed,) = spec.hypotheses
    assert supposed.mass is None
    assert supposed.stiffness is not None
    assert spec.imported is not None
    half = spec.imported.stiffness + 0.5 * supposed.stiffness
    written(tmp_path, block(factor=0.9), "half.inp")
    study.write_text(SUPPOSED.replace("softer.inp", "half.inp"))
    (between,) = read_study(study).spec().hypotheses
    assert between.stiffness is not None
    difference = abs(half - spec.imported.stiffness - between.stiffness).max()
    assert difference < 1e-9 * abs(between.stiffness).max()


@needs_ccx
@pytest.mark.parametrize(
    ("lines", "what"),
    [
        (block(), "identical to the model's own, so it changes nothing"),
        (block(across=2), "give a deck on the same mesh"),
    ],
)
def test_decks_that_suppose_nothing_or_another_mesh_are_refused(
    tmp_path: Path, lines: list[str], what: str
) -> None:
    written(tmp_path, block())
    written(tmp_path, lines, "softer.inp")
    (tmp_path / "study.toml").write_text(SUPPOSED)
    with pytest.raises(StudyError, match=what):
        read_study(tmp_path / "study.toml").spec()
