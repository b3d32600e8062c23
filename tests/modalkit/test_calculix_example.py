"""The CalculiX examples: from a deck by ccx to an updated model. Skipped where ccx is not installed."""

from __future__ import annotations

import json
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from acquisition.errors import StudyError
from modalkit.cli import main
from modalkit.study.read import read_study
from modalkit.workflow.case import open_study
from updating import Material, Spec, build_structure
from updating.models.imported import read_imported
from updating.update import update

pytestmark = pytest.mark.long

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples" / "calculix"
SAMPLE = ROOT / "sample_data" / "plate_dry"

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="no ccx: apt-get install calculix-ccx")


@pytest.fixture(scope="module")
def example(example_of: Callable[[Path, str], ModuleType]) -> Callable[[str], ModuleType]:
    return lambda name: example_of(EXAMPLES, name)


@pytest.fixture(scope="module")
def bracket(example: Callable[[str], ModuleType], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(example("bracket").make(tmp_path_factory.mktemp("bracket")))


@pytest.fixture(scope="module")
def plate(example: Callable[[str], ModuleType], tmp_path_factory: pytest.TempPathFactory) -> Path:
    return Path(example("plate").make(tmp_path_factory.mktemp("plate"), SAMPLE / "plate_dry.uff"))


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


Run = Callable[..., str]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Run:
    def call(*arguments: str | Path) -> str:
        monkeypatch.setattr(sys, "argv", ["modalkit", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        text = capfd.readouterr()
        assert not ended.value.code, text.err
        return text.out

    return call


def updated(study: Path, run: Run) -> dict[str, float]:
    out = study.parent / "update.json"
    run("update", study, "--json", out)
    return {p["name"]: p["factor"] for p in json.loads(out.read_text())["parameters"]}


def test_the_shipped_deck_is_what_the_example_writes(example: Callable[[str], ModuleType]) -> None:
    module = example("bracket")
    assert (EXAMPLES / "bracket.inp").read_text() == module.deck(module.MESH)


@needs_ccx
@pytest.mark.parametrize("name", ["bracket", "plate"])
def test_frequencies_are_those_that_ccx_finds_itself(
    name: str, example: Callable[[str], ModuleType], request: pytest.FixtureRequest
) -> None:
    study: Path = request.getfixturevalue(name)
    own = example("ccx").frequencies(study.parent / f"{name}.inp", study.parent / "modes", 10)
    rigid, found = frequencies(study.parent, name, 10)
    assert rigid == 0
    assert len(own) == 10
    assert found == pytest.approx(
        own, rel=1e-5
    )  # ccx stores 14 digits of K, whose eigenvalues span 10 decades


@needs_ccx
def test_a_free_bracket_has_six_rigid_modes(example: Callable[[str], ModuleType], tmp_path: Path) -> None:
    text = (EXAMPLES / "bracket.inp").read_text()
    (tmp_path / "free.inp").write_text(text[: text.index("*BOUNDARY")])
    example("ccx").store_matrices(tmp_path / "free.inp", tmp_path / "run")
    own = example("ccx").frequencies(tmp_path / "free.inp", tmp_path / "modes", 10)
    rigid, found = frequencies(tmp_path / "run", "free", 4)
    assert rigid == 6
    assert found == pytest.approx(own[6:], rel=1e-5)


@needs_ccx
def test_the_plate_of_shells_gives_the_built_in_factor(plate: Path, run: Run) -> None:
    """Within 1 %; the paper's factor is 0.782."""
    built_in = plate.parent / "built_in.toml"
    text = (SAMPLE / "study.toml").read_text().replace('"plate_dry.uff"', f'"{SAMPLE / "plate_dry.uff"}"')
    built_in.write_text(text)
    ours, theirs = updated(plate, run), updated(built_in, run)
    assert ours["E"] == pytest.approx(theirs["E"], rel=0.01)
    assert ours["E"] == pytest.approx(0.782, rel=0.01)


@needs_ccx
def test_the_bracket_gives_its_wall_back(bracket: Path, run: Run) -> None:
    """The specimen's wall has 0.8 of the modulus, in a finer mesh: the meshes differ by 0.4 to 1 % in frequency."""
    factors = updated(bracket, run)
    assert factors["wall.E"] == pytest.approx(0.8, rel=0.02)
    assert factors["foot.E"] == pytest.approx(1.0, rel=0.02)


@needs_ccx
def test_the_parts_of_the_bracket_are_the_whole(bracket: Path) -> None:
    spec = read_study(bracket).spec()
    assert spec.imported is not None
    for kind in ("stiffness", "mass"):
        parts = getattr(spec.imported, f"{kind}_parts")
        difference = abs(parts[0] + parts[1] - getattr(spec.imported, kind))
        assert difference.max() < 1e-9 * abs(getattr(spec.imported, kind)).max()
    foot, wall = (region.x for region in spec.regions)
    assert foot == pytest.approx((0.005, 0.08), abs=1e-6)  # from the first nodes that move
    assert wall == pytest.approx((0.08, 0.08), abs=1e-6)


@needs_ccx
def test_points_of_the_bracket_move_along_z_and_x(bracket: Path) -> None:
    measured = open_study(read_study(bracket)).case.measured
    assert measured.directions is not None
    along = dict(zip(measured.nodes, measured.directions.tolist(), strict=True))
    assert along == {n: [0, 0, 1] if n < 5 else [1, 0, 0] for n in range(1, 12)}
    assert len([w for w in measured.warnings if "lie beside" in w]) == 1


@needs_ccx
def test_the_bracket_is_correlated_and_diagnosed(bracket: Path, run: Run) -> None:
    assert "6 pairs" in run("correlate", bracket)
    out = bracket.parent / "diagnosis.json"
    figures = bracket.parent / "figures"
    text = run("diagnose", bracket, "--json", out, "--figures", figures)
    assert "clamp_rotation" in " ".join(text.split())  # among what is not examined
    assert json.loads(out.read_text())["significant"] is True
    assert (figures / "diagnosis.png").is_file()


@needs_ccx
def test_a_region_without_its_part_cannot_be_updated(bracket: Path) -> None:
    study = bracket.parent / "bare.toml"
    kept = [line for line in bracket.read_text().splitlines() if "_parts" not in line]
    text = "\n".join(kept).replace('name = "foot"', 'name = "foot"\nx = [0.0, 0.08]')
    study.write_text(text.replace('name = "wall"', 'name = "wall"\nx = [0.08, 0.081]'))
    with pytest.raises(StudyError, match=r"foot\.E: needs stiffness_parts"):
        update(open_study(read_study(study)).case, parameters=("foot.E", "wall.E"))
