"""Flat structures of 20-node bricks for CalculiX, with what is fixed to them; no theory of plates is in them."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="no ccx: apt-get install calculix-ccx")

CORNERS = ((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2))
MIDDLES = ((1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2))
UPRIGHT = ((0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1))
"""Nodes of a brick in the order that CalculiX wants, in half elements from its first corner."""


@dataclass(frozen=True)
class Bricks:
    """One layer of bricks with reduced integration, clamped at x = 0.

    Parameters
    ----------
    x, y : sequence of float
        Where elements end [m].
    thickness : float
        Along z [m].
    elastic : str
        The elasticity's lines of a deck, keyword included.
    density : float
        [kg/m^3].
    place : function of (x, y) of an element's middle
        Tells whether it is of another elasticity.
    elastic_there : str
        That elasticity.
    clamped : bool
        Whether all nodes at x = 0 are held.
    """

    x: Sequence[float]
    y: Sequence[float]
    thickness: float
    elastic: str
    density: float
    place: Callable[[float, float], bool] = lambda x, y: False
    elastic_there: str = ""
    clamped: bool = True

    @property
    def grid(self) -> tuple[np.ndarray, np.ndarray]:
        """Places of nodes along x and y: ends and middles of elements [m]."""
        return _halved(self.x), _halved(self.y)

    def numbers(self) -> dict[tuple[int, int, int], int]:
        """Node numbers by place in the grid of half elements; middles of faces and bricks have none."""
        x, y = self.grid
        places = ((i, j, k) for k in range(3) for j in range(len(y)) for i in range(len(x)))
        return {place: n for n, place in enumerate((p for p in places if sum(i % 2 for i in p) < 2), start=1)}

    def column(self, x: float, y: float) -> list[int]:
        """Return the three nodes, from below, where corners of elements meet next to a place."""
        i, j = (2 * int(np.argmin(np.abs(np.asarray(s) - at))) for s, at in ((self.x, x), (self.y, y)))
        return [self.numbers()[i, j, k] for k in range(3)]

    def lines(self) -> list[str]:
        """Return nodes, elements, materials and the clamp of a deck."""
        numbers, (x, y) = self.numbers(), self.grid
        lines = ["*NODE, NSET=ALL"]
        height = self.thickness / 2
        lines += [f"{n}, {x[i]:.9g}, {y[j]:.9g}, {(k - 1) * height:.9g}" for (i, j, k), n in numbers.items()]
        sets: dict[str, list[str]] = {"PLAIN": [], "PLACE": []}
        count = 0
        for i in range(0, len(x) - 1, 2):
            for j in range(0, len(y) - 1, 2):
                count += 1
                own = [numbers[i + a, j + b, c] for a, b, c in CORNERS + MIDDLES + UPRIGHT]
                chosen = "PLACE" if self.place(x[i + 1], y[j + 1]) else "PLAIN"
                sets[chosen] += [f"{count}, {', '.join(map(str, own[:14]))},", ", ".join(map(str, own[14:]))]
        for name, elements in sets.items():
            if elements:
                lines += [f"*ELEMENT, TYPE=C3D20R, ELSET={name}", *elements]
                lines += [f"*MATERIAL, NAME=M{name}", self.elastic_there if name == "PLACE" else self.elastic]
                lines += ["*DENSITY", f"{self.density}", f"*SOLID SECTION, ELSET={name}, MATERIAL=M{name}"]
        if not self.clamped:
            return lines
        return [*lines, "*BOUNDARY", *(f"{n}, 1, 3, 0." for (i, _, _), n in numbers.items() if i == 0)]


def _halved(ends: Sequence[float]) -> np.ndarray:
    """Return places with the middles between them."""
    at = np.asarray(ends, dtype=float)
    return np.sort(np.concatenate([at, (at[1:] + at[:-1]) / 2]))


def isotropic(E: float, poisson: float) -> str:
    """Return the lines of an isotropic elasticity [Pa]."""
    return f"*ELASTIC\n{float(E)!r}, {float(poisson)!r}"


def spring(bricks: Bricks, at: tuple[float, float], stiffness: float) -> list[str]:
    """Return a spring along z from the middle of the thickness to the ground [N/m]."""
    return [
        "*ELEMENT, TYPE=SPRING1, ELSET=HELD",
        f"90001, {bricks.column(*at)[1]}",
        "*SPRING, ELSET=HELD",
        "3",
        f"{float(stiffness)!r}",
    ]


def body(bricks: Bricks, at: tuple[float, float], mass: float, height: float) -> list[str]:
    """Return a point mass [kg] so far above the middle of the thickness [m], on a rigid stalk that is normal to it."""
    low, _, top = bricks.column(*at)
    share = 0.5 + height / bricks.thickness
    lines = [
        "*NODE",
        f"90001, {float(at[0])!r}, {float(at[1])!r}, {float(height)!r}",
        "*ELEMENT, TYPE=MASS, ELSET=BODY",
    ]
    lines += ["90001, 90001", "*MASS, ELSET=BODY", f"{float(mass)!r}", "*EQUATION"]
    for axis in (1, 2, 3):
        up, down = (share, 1 - share) if axis < 3 else (0.5, 0.5)
        lines += ["3", f"90001, {axis}, -1., {top}, {axis}, {float(up)!r}, {low}, {axis}, {float(down)!r}"]
    return lines


def frequencies(folder: Path, bricks: Bricks, count: int, more: Sequence[str] = ()) -> np.ndarray:
    """Return the lowest frequencies that CalculiX finds, (count,) [Hz]."""
    return _frequencies(_solve(folder, bricks, [*more, "*STEP", "*FREQUENCY", f"{count}", "*END STEP"]))[
        :count
    ]


def modes(
    folder: Path, bricks: Bricks, count: int, points: np.ndarray, more: Sequence[str] = ()
) -> tuple[np.ndarray, np.ndarray]:
    """Return the lowest frequencies (count,) [Hz] and the mass-normalised shapes across, (n_points, count) [kg^-1/2].

    Points (n_points, 2) [m] are where corners of elements meet; the shapes are those of the upper face.
    """
    nodes = [bricks.column(*at)[2] for at in points]
    wanted = ["*NSET, NSET=POINTS", *(f"{n}," for n in nodes), *more, "*STEP", "*FREQUENCY", f"{count}"]
    text = _solve(folder, bricks, [*wanted, "*NODE PRINT, NSET=POINTS", "U", "*END STEP"])
    blocks = text.split("displacements (vx,vy,vz) for set POINTS")[1:]
    rows = [re.findall(r"^\s+(\d+)\s+\S+\s+\S+\s+(\S+)\s*$", block, flags=re.MULTILINE) for block in blocks]
    across = [dict(row[: len(nodes)]) for row in rows]
    return _frequencies(text)[:count], np.array([[float(own[str(n)]) for own in across] for n in nodes])


def _solve(folder: Path, bricks: Bricks, more: Sequence[str]) -> str:
    """Run a deck, and return what is printed."""
    deck = folder / "flat.inp"
    deck.write_text("\n".join([*bricks.lines(), *more, ""]))
    subprocess.run(["ccx", deck.stem], cwd=folder, check=True, capture_output=True, timeout=300)
    return (folder / "flat.dat").read_text()


def _frequencies(text: str) -> np.ndarray:
    table = text.split("P A R T I C I P A T I O N", maxsplit=1)[0]
    rows = re.findall(r"^\s+\d+((?:\s+[-\d.E+]+){4})\s*$", table, flags=re.MULTILINE)
    return np.array([float(row.split()[2]) for row in rows])
