"""Run CalculiX for the matrices of a deck, and of each of its materials alone.

    python ccx.py bracket.inp OUT FOOT WALL

writes OUT/bracket.sti, .mas and .dof of the whole, and OUT/bracket_FOOT.sti ... of what is made of one material. A
region is what has a material of its own: give every region its own *MATERIAL, even if the numbers are the same.
Steps are replaced, their *BOUNDARY cards are kept; the deck itself is not changed. Included files become part of the
deck that is run, OUT/bracket.inp. *MASS and *SPRING elements belong to the whole and to no part.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

NEXT_TO_NOTHING = 1e-12
"""Factor on modulus and density of what is left out of a part: the rows stay, the matrices vanish."""

STEP = ["*STEP", "*FREQUENCY, SOLVER=MATRIXSTORAGE", "1", "*END STEP"]

MODULI = {"ISO": (1, {0}), "ORTHO": (2, set(range(9))), "ANISO": (3, set(range(21))),
          "ENGINEERING CONSTANTS": (2, {0, 1, 2, 6, 7, 8})}  # fmt: skip
"""Lines of eight numbers under *ELASTIC by its type, and which of the numbers are moduli."""


def store_matrices(deck: Path, folder: Path, materials: tuple[str, ...] = ()) -> None:
    """Let CalculiX write the matrices of a deck, and of each of some materials alone, into a folder.

    Parameters
    ----------
    deck : Path
        A deck with its mesh, sections, materials and *BOUNDARY; steps are replaced.
    folder : Path
        Where the files go.
    materials : tuple of str
        Names of materials, one for each region.
    """
    lines = model(deck)
    known = [
        options["NAME"] for card, options, _ in _cards(lines) if card == "*MATERIAL" and "NAME" in options
    ]
    for material in materials:
        if material.upper() not in known:
            raise SystemExit(f"{deck}: no *MATERIAL {material}; there are {', '.join(dict.fromkeys(known))}")
    folder.mkdir(parents=True, exist_ok=True)
    _run(lines, folder, deck.stem)
    for material in materials:
        _run(alone(lines, material), folder, f"{deck.stem}_{material}")
    copy = folder / deck.name
    if copy.resolve() != deck.resolve():
        copy.write_text("\n".join(lines) + "\n", encoding="latin-1")


def frequencies(deck: Path, folder: Path, count: int) -> list[float]:
    """Return the lowest natural frequencies that CalculiX itself finds [Hz]."""
    folder.mkdir(parents=True, exist_ok=True)
    job = f"{deck.stem}_modes"
    _call([*model(deck), "*STEP", "*FREQUENCY", str(count), "*END STEP"], folder, job)
    found = []
    for line in (folder / f"{job}.dat").read_text(encoding="ascii").splitlines():
        words = line.split()
        if line.strip().startswith("P A R T I C"):
            break
        if len(words) == 5 and words[0].isdigit():
            found.append(float(words[3]))
    return found


def alone(lines: list[str], material: str) -> list[str]:
    """Return a deck in which every other material weighs and resists next to nothing; so do masses and springs."""
    changed, current, count = list[str](), "", 0
    for card, options, given in _cards(lines, every_line=True):
        line = given
        if line.startswith("*"):
            count = 0
            current = options.get("NAME", "") if card == "*MATERIAL" else current
        else:
            count += 1
            others = current != material.upper()
            if others and card == "*ELASTIC":
                each, moduli = MODULI.get(options.get("TYPE", "ISO"), MODULI["ISO"])
                line = _lessened(line, moduli, 8 * ((count - 1) % each))
            elif (others and card == "*DENSITY") or card == "*MASS" or (card == "*SPRING" and count > 1):
                line = _lessened(line, {0})
        changed.append(line)
    return changed


def _lessened(line: str, which: set[int], first: int = 0) -> str:
    """Return a line of numbers, the first being number ``first`` of its card, some of them next to nothing."""
    numbers = [part.strip() for part in line.split(",")]
    return ", ".join(
        f"{NEXT_TO_NOTHING * float(n.upper().replace('D', 'E')):.12e}" if first + i in which and n else n
        for i, n in enumerate(numbers)
    )


def model(deck: Path) -> list[str]:
    """Return the lines of a deck and of what it includes, without its steps but with their supports."""
    kept, stepping, holding = list[str](), False, False
    for card, options, line in _cards(list(_lines(deck)), every_line=True):
        is_card = line.startswith("*")
        if is_card:
            stepping = card == "*STEP" or (stepping and card != "*END STEP")
            holding = stepping and card == "*BOUNDARY" and "BASE MOTION" not in options
        if holding or not (stepping or card == "*END STEP"):
            kept.append("*BOUNDARY" if holding and is_card else line)
    return kept


def _lines(deck: Path) -> Iterator[str]:
    """Yield the lines of a deck and of the files it includes, without comments."""
    for line in deck.read_text(encoding="latin-1").splitlines():
        card, _, name = line.partition("=")
        if card.upper().replace(" ", "").startswith("*INCLUDE"):
            yield from _lines(deck.parent / name.strip().strip("\"'"))
        elif not line.startswith("**"):
            yield line


def _cards(lines: list[str], *, every_line: bool = False) -> Iterator[tuple[str, dict[str, str], str]]:
    """Yield the lines of cards, or all lines, with the card they belong to and its options, in capitals."""
    card, options = "", dict[str, str]()
    for line in lines:
        if line.startswith("*"):
            card, *rest = (" ".join(part.upper().split()) for part in line.split(","))
            options = {key.strip(): value.strip() for key, _, value in (part.partition("=") for part in rest)}
        if every_line or line.startswith("*"):
            yield card, options, line


def _run(lines: list[str], folder: Path, job: str) -> None:
    """Let CalculiX work in a folder of its own and keep what was asked for."""
    with tempfile.TemporaryDirectory(dir=folder) as aside:
        _call([*lines, *STEP], Path(aside), "job")
        for ending in (".sti", ".mas", ".dof"):
            written = Path(aside) / f"job{ending}"
            if not written.is_file():
                raise SystemExit(
                    f"ccx wrote no {ending} file for {job}; does it run with a plain *FREQUENCY step?"
                )
            written.replace(folder / f"{job}{ending}")


def _call(lines: list[str], folder: Path, job: str) -> None:
    program = shutil.which("ccx")
    if program is None:
        raise SystemExit("no program ccx; on Debian and Ubuntu: apt-get install calculix-ccx")
    (folder / f"{job}.inp").write_text("\n".join(lines) + "\n", encoding="latin-1")
    done = subprocess.run(
        [program, job], cwd=folder, capture_output=True, text=True, errors="replace", check=False
    )
    if "*ERROR" in done.stdout:
        raise SystemExit(done.stdout[done.stdout.index("*ERROR") :][:500])
    for ending in (".12d", ".cvg", ".frd", ".sta"):
        (folder / f"{job}{ending}").unlink(missing_ok=True)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    store_matrices(Path(sys.argv[1]), Path(sys.argv[2]), tuple(sys.argv[3:]))
