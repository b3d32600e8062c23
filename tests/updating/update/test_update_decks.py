"""Numbers of a deck, updated by frequencies that CalculiX itself finds of a deck with other numbers."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from acquisition import ModalData
from acquisition.errors import StudyError
from updating import Axes, Case, Material, Spec, Tolerances, measured_from_modes
from updating.models import Region
from updating.models.imported.decks import read_deck_model
from updating.models.imported.of_deck import imported as made_of
from updating.update import Update, update

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "calculix"

pytestmark = pytest.mark.skipif(shutil.which("ccx") is None, reason="no ccx: apt-get install calculix-ccx")


@pytest.fixture(scope="module")
def shells(example_of: Callable[[Path, str], ModuleType]) -> ModuleType:
    return example_of(EXAMPLES, "mesh")


def angle(shells: ModuleType, wall: float = 0.003, spring: float = 2e4, modulus: float = 210e9) -> list[str]:
    """Return an angle of shells, its foot held along an edge, a spring under the far corner of its wall."""

    def place(u: float, v: float) -> tuple[float, float, float]:
        x, y = 0.1 * u, 0.04 * v
        return (x, y, 0.0) if u <= 0.5 else (0.05, y, x - 0.05)

    def region(u: float, v: float) -> str:
        return "FOOT" if u < 0.5 else "WALL"

    materials = dict.fromkeys(("FOOT", "WALL"), (modulus, 0.3, 7850.0))
    lines: list[str] = shells.shell_deck((8, 4), place, region, materials, 0.003)
    at = next(i for i, line in enumerate(lines) if line.startswith("*SHELL SECTION, ELSET=WALL"))
    lines[at + 1] = f"{wall}"
    corner = next(line.split(",")[0] for line in lines if line.endswith(", 0.05, 0.04, 0.05"))
    more = ["*ELEMENT, TYPE=SPRING1, ELSET=SEAT", f"9000, {corner}", "*SPRING, ELSET=SEAT", "1", f"{spring}"]
    held = lines.index("*BOUNDARY")
    return [*lines[:held], *more, *lines[held:]]


def by_ccx(folder: Path, lines: list[str], count: int) -> np.ndarray:
    """Return the frequencies that CalculiX itself finds [Hz]."""
    text = "\n".join([*lines, "*STEP", "*FREQUENCY", str(count), "*END STEP"]) + "\n"
    (folder / "modes.inp").write_text(text)
    subprocess.run(["ccx", "modes"], cwd=folder, check=True, capture_output=True)
    rows = (folder / "modes.dat").read_text().split("P A R T I C", maxsplit=1)[0].splitlines()
    return np.array([float(r.split()[3]) for r in rows if len(r.split()) == 5 and r.split()[0].isdigit()])


def updated(folder: Path, deck: list[str], found: np.ndarray, *parameters: str) -> Update:
    """Update some numbers of a deck by frequencies known to 1e-4."""
    (folder / "angle.inp").write_text("\n".join(deck) + "\n")
    imported = made_of(read_deck_model(folder / "angle.inp"))
    regions = (Region("FOOT", (0.0, 0.05)), Region("WALL", (0.049, 0.051)))
    size = imported.extents[1] - imported.extents[0]
    steel = Material(210e9, 7850.0)
    spec = Spec(
        "matrices",
        **dict(zip(("length", "width", "thickness"), size.tolist(), strict=True)),
        elements=(),
        clamped=(),
        theory="imported",
        material=steel,
        regions=regions,
        imported=imported,
    )
    test = measured_from_modes(ModalData(frequency=found, frequency_sigma=1e-4 * found), Axes(), spec)
    case = Case("angle", spec, test, baseline=None, tolerances=Tolerances({}))
    return update(case, parameters=parameters)


@pytest.mark.long
def test_thickness_spring_and_modulus_come_back_together(shells: ModuleType, tmp_path: Path) -> None:
    """On the same mesh, to what a tenth of a per mille of noise and the digits of thin shells allow."""
    true = angle(shells, 0.003 * 0.92, 1.2e4, 0.97 * 210e9)
    found = by_ccx(tmp_path, true, 8)
    result = updated(tmp_path, angle(shells), found, "WALL.thickness", "SEAT.stiffness", "E")
    values = {p.name: p for p in result.parameters}
    assert result.exact
    assert values["WALL.thickness"].value == pytest.approx(0.00276, rel=1e-3)
    assert values["SEAT.stiffness"].value == pytest.approx(1.2e4, rel=2e-3)
    assert values["E"].factor == pytest.approx(0.97, rel=2e-3)
    assert [values[n].unit for n in ("WALL.thickness", "SEAT.stiffness")] == ["m", "N/m"]
    assert result.pairs["after_hz"].to_numpy() == pytest.approx(found, rel=2e-5)


def test_a_material_is_all_that_is_made_of_it(shells: ModuleType, tmp_path: Path) -> None:
    """Here each region has a material of its own: the region's name and the material's are the same parameter."""
    found = by_ccx(tmp_path, angle(shells), 6)
    result = updated(tmp_path, [x.replace("NAME=WALL", "NAME=ALU").replace("MATERIAL=WALL", "MATERIAL=ALU")
                                for x in angle(shells)], found, "alu.E")  # fmt: skip
    assert [p.name for p in result.parameters] == ["alu.E"]
    assert result.parameters[0].factor == pytest.approx(1.0, abs=1e-4)
    with pytest.raises(StudyError, match=r"no parameter 'tin.E'; .*of the deck: MATERIAL.E"):
        updated(tmp_path, angle(shells), found, "tin.E")


@pytest.mark.parametrize("name", ["sensor_mass.mass", "lumped_mass.mass", "ground_spring.stiffness"])
def test_an_effect_is_no_number_of_the_deck(name: str, shells: ModuleType, tmp_path: Path) -> None:
    """Though it ends as those of springs and point masses do: what the library says of it is the answer."""
    found = by_ccx(tmp_path, angle(shells), 6)
    with pytest.raises(StudyError) as caught:
        updated(tmp_path, angle(shells), found, name)
    assert "ELSET" not in str(caught.value)
