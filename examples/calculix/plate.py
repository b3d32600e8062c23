"""The cantilever plate of the sample data by CalculiX: 376 x 200 x 3.175 mm of steel, shells of eight nodes.

    python plate.py OUT
    modalkit update OUT/study.toml

writes the deck, lets CalculiX write the matrices, and puts a study beside them that updates E by the sample test.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from ccx import store_matrices
from mesh import Place, shell_deck

LENGTH, WIDTH, THICKNESS = 0.376, 0.2, 0.003175
STEEL = (210e9, 0.3, 7850.0)


def _flat(along: float, across: float) -> Place:
    return LENGTH * along, WIDTH * across, 0.0


def make(folder: Path, test: Path) -> Path:
    """Write deck, matrices and study into a folder, a copy of the sample test beside them; return the study."""
    here = Path(__file__).parent
    folder.mkdir(parents=True, exist_ok=True)
    deck = folder / "plate.inp"
    lines = shell_deck((19, 10), _flat, lambda *_: "PLATE", {"PLATE": STEEL}, THICKNESS)
    deck.write_text("\n".join(lines) + "\n", encoding="ascii")
    store_matrices(deck, folder)
    shutil.copy(test, folder / "plate_dry.uff")
    return Path(shutil.copy(here / "plate.toml", folder / "study.toml"))


if __name__ == "__main__":
    sample = Path(__file__).parents[2] / "sample_data" / "plate_dry" / "plate_dry.uff"
    sys.stdout.write(f"{make(Path(sys.argv[1]), sample)}\n")
