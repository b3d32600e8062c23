"""Run CalculiX for the matrices of a deck, and of each of its materials alone.

    python ccx.py bracket.inp OUT FOOT WALL

writes OUT/bracket.sti, .mas and .dof of the whole, and OUT/bracket_FOOT.sti ... of what is made of one material. A
region is what has a material of its own: give every region its own *MATERIAL, even if the numbers are the same.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

NEXT_TO_NOTHING = 1e-12
"""Factor on modulus and density of what is left out of a part: the rows stay, the matrices vanish."""

STEP = ["*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "1", "*END STEP"]


def store_matrices(deck: Path, folder: Path, materials: tuple[str, ...] = ()) -> None:
    """Let CalculiX write the matrices of a deck, and of each of some materials alone, into a folder.

    Parameters
    ----------
    deck : Path
        A deck with its mesh, sections, materials and *BOUNDARY before the first *STEP; steps are replaced.
    folder : Path
        Where the files go.
    materials : tuple of str
        Names of materials, one for each region.
    """
    lines = _model(deck)
    folder.mkdir(parents=True, exist_ok=True)
    _run(lines, folder, deck.stem)
    for material in materials:
        _run(alone(lines, material), folder, f"{deck.stem}_{material}")


def frequencies(deck: Path, folder: Path, count: int) -> list[float]:
    """Return the lowest natural frequencies that CalculiX itself finds [Hz]."""
    folder.mkdir(parents=True, exist_ok=True)
    job = f"{deck.stem}_modes"
    _call([*_model(deck), "*STEP", "*FREQUENCY", str(count), "*END STEP"], folder, job)
    found = []
    for line in (folder / f"{job}.dat").read_text(encoding="ascii").splitlines():
        words = line.split()
        if line.strip().startswith("P A R T I C"):
            break
        if len(words) == 5 and words[0].isdigit():
            found.append(float(words[3]))
    return found


def alone(lines: list[str], material: str) -> list[str]:
    """Return a deck in which every other material weighs and resists next to nothing."""
    changed, current, card = [], "", ""
    for line in lines:
        if line.startswith("*") and not line.startswith("**"):
            card = line.split(",")[0].strip().upper()
            if card == "*MATERIAL":
                current = line.upper().partition("NAME=")[2].split(",")[0].strip()
        elif card in ("*ELASTIC", "*DENSITY") and current != material.upper():
            first, comma, rest = line.partition(",")
            changed.append(f"{NEXT_TO_NOTHING * float(first):.12g}{comma}{rest}")
            continue
        changed.append(line)
    return changed


def _model(deck: Path) -> list[str]:
    """Return the lines before the first step."""
    lines = deck.read_text(encoding="ascii").splitlines()
    steps = [i for i, line in enumerate(lines) if line.upper().startswith("*STEP")]
    return lines[: steps[0]] if steps else lines


def _run(lines: list[str], folder: Path, job: str) -> None:
    _call([*lines, *STEP], folder, job)
    for ending in (".sti", ".mas", ".dof"):
        if not (folder / f"{job}{ending}").is_file():
            raise SystemExit(f"ccx wrote no {job}{ending}; see {folder / job}.sta and what it printed")


def _call(lines: list[str], folder: Path, job: str) -> None:
    program = shutil.which("ccx")
    if program is None:
        raise SystemExit("no program ccx; on Debian and Ubuntu: apt-get install calculix-ccx")
    (folder / f"{job}.inp").write_text("\n".join(lines) + "\n", encoding="ascii")
    done = subprocess.run([program, job], cwd=folder, capture_output=True, text=True, check=False)
    if "*ERROR" in done.stdout:
        raise SystemExit(done.stdout[done.stdout.index("*ERROR") :][:500])
    for ending in (".12d", ".cvg", ".frd", ".sta"):
        (folder / f"{job}{ending}").unlink(missing_ok=True)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    store_matrices(Path(sys.argv[1]), Path(sys.argv[2]), tuple(sys.argv[3:]))
