"""What several of the tests beside it need."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from updating import Material, Spec, build_structure
from updating.models.imported import Imported

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="no ccx: apt-get install calculix-ccx")


Bricks = Callable[..., list[str]]


def bar(bricks: Bricks, *more: str, length: float = 200.0, steps: int = 10, kind: str = "C3D20") -> list[str]:
    """Return a bar of 20 x 10 mm along x, in mm, t and s, one half ROOT and one TIP, held at x = 0."""
    lines = (np.linspace(0, length, steps + 1).tolist(), [0.0, 10.0, 20.0], [0.0, 5.0, 10.0])
    sets = {"CLAMP": lambda x, y, z: x == 0, "END": lambda x, y, z: x == length}
    deck = bricks(lines, lambda x, y, z: "ROOT" if x < length / 2 else "TIP", sets, kind)
    deck += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.", "*DENSITY", "7.85e-9"]
    deck += [f"*SOLID SECTION, ELSET={name}, MATERIAL=STEEL" for name in ("ROOT", "TIP")]
    return [*deck, *more, "*BOUNDARY", "CLAMP, 1, 3"]


def written(folder: Path, lines: list[str], name: str = "part.inp") -> Path:
    (folder / name).write_text("\n".join(lines) + "\n", encoding="latin-1")
    return folder / name


def frequencies(imported: Imported, count: int) -> np.ndarray:
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
    return np.sqrt(build_structure(spec).eigen(count)[0]) / (2 * np.pi)


def by_ccx(folder: Path, lines: list[str], count: int) -> list[float]:
    """Return the frequencies that CalculiX itself finds [Hz]."""
    written(folder, [*lines, "*STEP", "*FREQUENCY", str(count), "*END STEP"], "modes.inp")
    subprocess.run(["ccx", "modes"], cwd=folder, check=True, capture_output=True)
    rows = (folder / "modes.dat").read_text().split("P A R T I C", maxsplit=1)[0].splitlines()
    return [float(r.split()[3]) for r in rows if len(r.split()) == 5 and r.split()[0].isdigit()]
