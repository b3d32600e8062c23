"""A bracket from its CalculiX deck to an updated model, with a synthetic hammer test in between.

    python bracket.py OUT
    modalkit update OUT/study.toml

The bracket is a bent and pierced sheet: a foot, clamped along its far edge, and a wall that tapers upwards and has a
window. `bracket.inp` is its model. The specimen behind the test has another mesh and a wall of 0.8 times the
modulus; its foot is hit along z, its wall along x, and one accelerometer sits at the top of the wall.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import numpy as np
from ccx import store_matrices
from mesh import Place, shell_deck

from acquisition import Dof, Geometry, hammer_test, write_uff
from acquisition.arrays import FloatArray
from acquisition.synthetic import HammerPlan, modal_system
from updating.models import Material, Spec, build_structure
from updating.models.imported import read_imported

FOOT, WALL, WIDTH, TOP, THICKNESS = 0.08, 0.10, 0.06, 0.04, 0.003
STEEL = (210e9, 0.3, 7850.0)
WALL_FACTOR = 0.8
BEND = FOOT / (FOOT + WALL)
WINDOW = (BEND + 0.4 * (1 - BEND), BEND + 0.6 * (1 - BEND), 1 / 3, 2 / 3)
MESH, SPECIMEN = (18, 6), (36, 9)

PLACES: dict[int, tuple[Place, int]] = {
    1: ((0.03, 0.01, 0.0), 3), 2: ((0.03, 0.05, 0.0), 3), 3: ((0.055, 0.01, 0.0), 3), 4: ((0.055, 0.05, 0.0), 3),
    5: ((0.08, 0.012, 0.02), -1), 6: ((0.08, 0.048, 0.02), -1), 7: ((0.08, 0.012, 0.055), -1),
    8: ((0.08, 0.047, 0.055), -1), 9: ((0.08, 0.03, 0.085), -1), 10: ((0.08, 0.014, 0.097), -1),
    11: ((0.08, 0.046, 0.097), -1),
}  # fmt: skip
"""Where the bracket is hit [m], and along which axis (UFF code); the last point carries the accelerometer."""


def place(along: float, across: float) -> Place:
    """Bend the grid and taper what stands [m]."""
    way = along * (FOOT + WALL)
    if way <= FOOT:
        return way, WIDTH * across, 0.0
    height = way - FOOT
    width = WIDTH + (TOP - WIDTH) * height / WALL
    return FOOT, WIDTH / 2 + width * (across - 0.5), height


def region(along: float, across: float) -> str | None:
    """Tell foot from wall and leave the window open."""
    if WINDOW[0] < along < WINDOW[1] and WINDOW[2] < across < WINDOW[3]:
        return None
    return "FOOT" if along < BEND else "WALL"


def deck(mesh: tuple[int, int], wall_factor: float = 1.0) -> str:
    """Return the deck of the bracket."""
    modulus, poisson, density = STEEL
    materials = {"FOOT": STEEL, "WALL": (wall_factor * modulus, poisson, density)}
    return "\n".join(shell_deck(mesh, place, region, materials, THICKNESS)) + "\n"


def modes_of(folder: Path, job: str, count: int) -> tuple[FloatArray, FloatArray]:
    """Return frequencies [Hz] and mass-normalised shapes at the test's points, from the matrices of a job."""
    imported = read_imported(folder / f"{job}.sti", folder / f"{job}.mas", folder / f"{job}.inp")
    size = imported.extents[1] - imported.extents[0]
    spec = Spec(
        "matrices",
        **dict(zip(("length", "width", "thickness"), size.tolist(), strict=True)),
        elements=(),
        clamped=(),
        theory="imported",
        material=Material(1.0, 1.0),
        imported=imported,
    )
    structure = build_structure(spec)
    values, vectors = structure.eigen(count)
    points = np.array([where for where, _ in PLACES.values()])
    directions = np.array([Dof(n, code).unit_vector for n, (_, code) in PLACES.items()])
    return np.sqrt(values) / (2 * np.pi), structure.rows(points, directions)["w"] @ vectors


def hit(folder: Path, rng: np.random.Generator) -> None:
    """Make the specimen, hit it, and write the hits as `bracket.uff`."""
    specimen = folder / "specimen.inp"
    specimen.write_text(deck(SPECIMEN, WALL_FACTOR), encoding="ascii")
    store_matrices(specimen, folder)
    frequency, shapes = modes_of(folder, "specimen", 14)
    dofs = [Dof(node, code) for node, (_, code) in PLACES.items()]
    system = modal_system(
        frequency=frequency, damping=np.full(len(frequency), 0.004),
        response_shapes=shapes[-1:], point_shapes=shapes, responses=dofs[-1:], points=dofs,
    )  # fmt: skip
    plan = HammerPlan(
        rate=6400.0, samples=4096, hits=5, peak=50.0, width=3e-4, pre_trigger=0.005, force_noise=0.01,
        response_noise=3e-4,
    )  # fmt: skip
    geometry = Geometry(tuple(PLACES), np.array([where for where, _ in PLACES.values()]))
    test = hammer_test(system, plan, rng=rng, geometry=geometry)
    write_uff(folder / "bracket.uff", tests=test, precision="single", title="bracket")


def make(folder: Path) -> Path:
    """Write deck, matrices, test and study into a folder; return the study."""
    here = Path(__file__).parent
    folder.mkdir(parents=True, exist_ok=True)
    hit(folder, np.random.default_rng(7))
    store_matrices(here / "bracket.inp", folder, ("FOOT", "WALL"))
    return Path(shutil.copy(here / "bracket.toml", folder / "study.toml"))


if __name__ == "__main__":
    sys.stdout.write(f"{make(Path(sys.argv[1]))}\n")
