"""A bracket of solids whose web came out 8 % thin: deck, hammer test and study, from nothing.

    python bracket.py OUT
    modalkit update OUT/study.toml
    modalkit diagnose OUT/study.toml

The bracket is a base, a wall and a web between them, of steel, in millimetres; the far end of the base is held.
The model is `bracket.inp`, of bricks of reduced integration, the web 5 mm thick. The specimen behind the test is
another deck: finer, of bricks of full integration, its web milled to 4.6 mm from one side. CalculiX solves both.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import numpy as np
from bricks import Lines, brick_deck

from acquisition import Dof, Geometry, hammer_test, write_uff
from acquisition.arrays import FloatArray
from acquisition.synthetic import HammerPlan, modal_system
from updating.models import Material, Spec, build_structure
from updating.models.imported.decks import read_deck_model
from updating.models.imported.of_deck import imported as made_of

LENGTH, WIDTH, HEIGHT, SHEET = 100.0, 60.0, 80.0, 8.0
"""Of the base, of both, of the wall above it, and how thick these are [mm]."""

WEB = (68.0, 58.0)
"""How far the web reaches along the base, and up the wall [mm]."""

SIDES = (27.5, 32.5)
"""Its two faces [mm]; the upper one is milled deeper in the specimen."""

MILLED = 0.4
HELD = 80.0

POINTS: dict[int, tuple[tuple[float, float, float], int]] = {
    1: ((0.0, 10.0, 80.0), -1), 2: ((0.0, 50.0, 80.0), -1), 3: ((0.0, 10.0, 50.0), -1), 4: ((0.0, 50.0, 50.0), -1),
    5: ((0.0, 30.0, 65.0), -1), 6: ((0.0, 30.0, 35.0), -1), 7: ((4.0, 0.0, 80.0), 2), 8: ((4.0, 0.0, 45.0), 2),
    9: ((30.0, 10.0, 8.0), -3), 10: ((30.0, 50.0, 8.0), -3), 11: ((60.0, 10.0, 8.0), -3), 12: ((50.0, 27.5, 40.0), 2),
}  # fmt: skip
"""Where the bracket is hit [mm], and along which axis (UFF code); the second and the seventh carry accelerometers."""

SENSORS = (1, 6)


def between(low: float, high: float, steps: int) -> list[float]:
    """Return where steps end, the first not."""
    return [low + (high - low) * (i + 1) / steps for i in range(steps)]


def mesh(finer: int, face: float) -> Lines:
    """Return the lines of the grid, the web's upper face at ``face``; ``finer`` blocks more in each stretch."""
    x = [0.0, *between(0, SHEET, 2), *between(SHEET, WEB[0], 6 + 2 * finer)]
    x += [*between(WEB[0], HELD, 2 + finer), *between(HELD, LENGTH, 2)]
    y = [0.0, *between(0, SIDES[0], 3 + finer), *between(SIDES[0], face, 2), *between(face, WIDTH, 3 + finer)]
    z = [0.0, *between(0, SHEET, 2), *between(SHEET, WEB[1], 5 + 2 * finer)]
    return x, y, [*z, *between(WEB[1], HEIGHT, 2 + finer)]


def deck(finer: int = 0, *, face: float = SIDES[1], kind: str = "C3D20R") -> str:
    """Return the deck of the bracket, in mm, t and s."""

    def part(x: float, y: float, z: float) -> str | None:
        if z < SHEET:
            return "BASE"
        if x < SHEET:
            return "WALL"
        return "WEB" if x < WEB[0] and z < WEB[1] and SIDES[0] < y < face else None

    sets = {
        "CLAMP": lambda x, y, z: x >= HELD - 1e-6 and z <= SHEET + 1e-6,
        "WEBFACE": lambda x, y, z: abs(y - face) < 1e-6 and SHEET <= x <= WEB[0] and SHEET <= z <= WEB[1],
    }
    lines = brick_deck(mesh(finer, face), part, sets, kind)
    lines += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3", "*DENSITY", "7.85e-9"]
    lines += [f"*SOLID SECTION, ELSET={name}, MATERIAL=STEEL" for name in ("BASE", "WALL", "WEB")]
    return "\n".join([*lines, "*BOUNDARY", "CLAMP, 1, 3"]) + "\n"


def modes_of(path: Path, count: int) -> tuple[FloatArray, FloatArray]:
    """Return frequencies [Hz] and mass-normalised shapes at the test's points of a deck."""
    imported = made_of(read_deck_model(path, units="mm-t-s"), divided=False)
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
    points = np.array([where for where, _ in POINTS.values()]) / 1000
    directions = np.array([Dof(n, code).unit_vector for n, (_, code) in POINTS.items()])
    return np.sqrt(values) / (2 * np.pi), structure.rows(points, directions)["w"] @ vectors


def hit(path: Path, folder: Path, rng: np.random.Generator) -> None:
    """Hit a specimen five times at each point, and write the hits as `bracket.uff`."""
    frequency, shapes = modes_of(path, 16)
    dofs = [Dof(node, code) for node, (_, code) in POINTS.items()]
    own = list(SENSORS)
    system = modal_system(
        frequency=frequency, damping=np.full(len(frequency), 0.003), response_shapes=shapes[own],
        point_shapes=shapes, responses=[dofs[i] for i in own], points=dofs,
    )  # fmt: skip
    plan = HammerPlan(
        rate=25600.0, samples=16384, hits=5, peak=200.0, width=1e-4, pre_trigger=0.005, force_noise=0.02,
        response_noise=3e-3,
    )  # fmt: skip
    geometry = Geometry(tuple(POINTS), np.array([where for where, _ in POINTS.values()]) / 1000)
    test = hammer_test(system, plan, rng=rng, geometry=geometry)
    write_uff(folder / "bracket.uff", tests=test, precision="single", title="bracket")


def make(folder: Path) -> Path:
    """Write the deck, the test of a specimen and the study into a folder; return the study."""
    here = Path(__file__).parent
    folder.mkdir(parents=True, exist_ok=True)
    specimen = folder / "specimen.inp"
    specimen.write_text(deck(1, face=SIDES[1] - MILLED, kind="C3D20"), encoding="ascii")
    hit(specimen, folder, np.random.default_rng(11))
    (folder / "bracket.inp").write_text(deck(), encoding="ascii")
    return Path(shutil.copy(here / "bracket.toml", folder / "study.toml"))


if __name__ == "__main__":
    sys.stdout.write(f"{make(Path(sys.argv[1]))}\n")
