"""CalculiX decks of C3D20R bricks in a box, and what CalculiX prints about them."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from acquisition.errors import StudyError

TIME_LIMIT = 120.0
_CORNERS = np.array([(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)])
_SIDES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
_BRICK = np.vstack([_CORNERS, [(_CORNERS[a] + _CORNERS[b]) // 2 for a, b in _SIDES]])


@dataclass(frozen=True, eq=False)
class Bricks:
    """Bricks between lines along three axes, some of them cut out.

    Parameters
    ----------
    x, y, z : (n + 1,) arrays
        Lines [m].
    cut : (n_x, n_y, n_z) bool array
        Bricks that are missing.
    """

    x: FloatArray
    y: FloatArray
    z: FloatArray
    cut: BoolArray

    @cached_property
    def _shape(self) -> tuple[int, int, int]:
        return 2 * len(self.x) - 1, 2 * len(self.y) - 1, 2 * len(self.z) - 1

    def number(self, i: IntArray, j: IntArray, k: IntArray) -> IntArray:
        """Return node numbers from places on the lines (even) and between them (odd)."""
        return np.asarray(1 + np.ravel_multi_index((i, j, k), self._shape))

    @cached_property
    def elements(self) -> IntArray:
        """Node numbers of the bricks, shape (n_elements, 20)."""
        first = 2 * np.argwhere(~self.cut)
        i, j, k = np.moveaxis(first[:, None, :] + _BRICK, -1, 0)
        return self.number(i, j, k)

    @cached_property
    def nodes(self) -> tuple[IntArray, FloatArray]:
        """Numbers of the nodes in use, and their places, shape (n, 3) [m]."""
        used = np.unique(self.elements)
        indices = np.unravel_index(used - 1, self._shape)
        lines = [
            np.interp(np.arange(2 * len(a) - 1), 2 * np.arange(len(a)), a) for a in (self.x, self.y, self.z)
        ]
        places = np.column_stack([line[i] for line, i in zip(lines, indices, strict=True)])
        return used, places

    def bottom(self) -> IntArray:
        """Return the nodes where lines cross on the lowest plane, shape (n_x + 1, n_y + 1)."""
        i, j = np.meshgrid(2 * np.arange(len(self.x)), 2 * np.arange(len(self.y)), indexing="ij")
        return self.number(i, j, np.zeros_like(i))


@dataclass(frozen=True)
class Point:
    """A mass and a spring across the surface, at a node.

    Parameters
    ----------
    node : int
        Number of the node.
    mass : float
        [kg].
    spring : float
        To the ground [N/m].
    direction : int
        Of the spring: 1, 2, 3 for x, y, z.
    """

    node: int
    mass: float = 0.0
    spring: float = 0.0
    direction: int = 3


def mesh_lines(bricks: Bricks, element: str) -> list[str]:
    """Return nodes and elements of one type as lines of a deck."""
    numbers, places = bricks.nodes
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{n}, {x:.12g}, {y:.12g}, {z:.12g}" for n, (x, y, z) in zip(numbers, places, strict=True)]
    lines.append(f"*ELEMENT, TYPE={element}, ELSET=BODY")
    for e, nodes in enumerate(bricks.elements, start=1):
        lines += [", ".join(map(str, (e, *nodes[:15]))) + ",", ", ".join(map(str, nodes[15:]))]
    return lines


def deck(
    bricks: Bricks,
    *,
    E: float,
    density: float,
    poisson: float,
    held: list[tuple[int, int]],
    points: list[Point],
    count: int,
) -> str:
    """Return the input of CalculiX for the lowest modes.

    Parameters
    ----------
    bricks : Bricks
        The mesh.
    E, density, poisson : float
        Material [Pa], [kg/m3], [-].
    held : list of (node, direction)
        What does not move.
    points : list of Point
        Masses and springs.
    count : int
        Modes [-].
    """
    lines = mesh_lines(bricks, "C3D20R")
    lines += ["*MATERIAL, NAME=BULK", "*ELASTIC", f"{E:.12e}, {poisson:.12e}", "*DENSITY", f"{density:.12e}"]
    lines.append("*SOLID SECTION, ELSET=BODY, MATERIAL=BULK")
    lines += _loose(points, first=len(bricks.elements) + 1)
    lines += ["*NSET, NSET=READ", *(f"{n}," for n in bricks.bottom().ravel())]
    lines += ["*BOUNDARY", *(f"{n}, {d}, {d}" for n, d in held)]
    lines += ["*STEP", "*FREQUENCY", f"{count}", "*NODE PRINT, NSET=READ", "U", "*END STEP"]
    return "\n".join(lines) + "\n"


def _loose(points: list[Point], *, first: int) -> list[str]:
    """Return the cards of masses and springs; equal ones share a card, without which CalculiX loses them."""
    kinds: dict[tuple[str, int, str], list[int]] = {}
    for point in points:
        if point.mass:
            kinds.setdefault(("MASS", 0, f"{point.mass:.12e}"), []).append(point.node)
        if point.spring:
            kinds.setdefault(("SPRING", point.direction, f"{point.spring:.12e}"), []).append(point.node)
    lines = []
    for number, ((card, direction, value), nodes) in enumerate(kinds.items()):
        kind = "SPRING1" if card == "SPRING" else card
        lines.append(f"*ELEMENT, TYPE={kind}, ELSET=LOOSE{number}")
        lines += [f"{first + i}, {node}" for i, node in enumerate(nodes)]
        first += len(nodes)
        lines += [f"*{card}, ELSET=LOOSE{number}", *([str(direction)] if direction else []), value]
    return lines


def run(text: str, *, read: IntArray, time_limit: float = TIME_LIMIT) -> tuple[FloatArray, FloatArray]:
    """Run CalculiX in a folder of its own and return its modes.

    Parameters
    ----------
    text : str
        The deck.
    read : (n,) int array
        Nodes whose displacements are wanted.
    time_limit : float
        After which it is stopped [s].

    Returns
    -------
    omega : (n_modes,) array
        Angular frequencies [rad/s].
    shapes : (n_modes, n, 3) array
        Displacements in mass-normalised modes [kg^-1/2].

    Raises
    ------
    StudyError
        If CalculiX is missing, fails, or takes too long.
    """
    with finished(text, ("dat",), time_limit=time_limit) as (table,):
        return printed(table.read_text(), read)


@contextmanager
def finished(
    text: str, endings: Sequence[str], *, time_limit: float = TIME_LIMIT
) -> Iterator[tuple[Path, ...]]:
    """Run CalculiX in a folder of its own, and lend the files that it wrote.

    Parameters
    ----------
    text : str
        The deck.
    endings : sequence of str
        Of the files wanted.
    time_limit : float
        After which it is stopped [s].

    Raises
    ------
    StudyError
        If CalculiX is missing, fails, or takes too long.
    """
    ccx = program()
    if ccx is None:
        raise StudyError("bodies of bricks need CalculiX, and there is no ccx: install calculix-ccx")
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "job.inp").write_text(text, encoding="ascii")
        try:
            done = subprocess.run(
                [ccx, "job"], cwd=folder, capture_output=True, text=True, timeout=time_limit, check=False,
                env={**os.environ, "OMP_NUM_THREADS": "1"},
            )  # fmt: skip
        except subprocess.TimeoutExpired as late:
            message = f"ccx has not ended within {time_limit:g} s: ask for fewer elements or modes"
            raise StudyError(message) from late
        files = tuple(Path(folder, f"job.{ending}") for ending in endings)
        if done.returncode or not all(file.is_file() and file.stat().st_size for file in files):
            raise StudyError(f"ccx failed on a body of bricks: {' '.join(done.stdout.split()[-30:])}")
        yield files


def program() -> str | None:
    """Return where CalculiX is installed; one in the current folder is not meant, nor one beside a study."""
    folders = [p for p in os.environ.get("PATH", os.defpath).split(os.pathsep) if Path(p).is_absolute()]
    found = shutil.which("ccx", path=os.pathsep.join(folders))
    return found if found is not None and Path(found).is_absolute() else None


def printed(text: str, read: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return frequencies [rad/s] and displacements from CalculiX's table of results.

    Fortran leaves out the letter of an exponent of three digits.
    """
    text = re.sub(r"(?<=\d)([+-]\d{3})(?!\d)", r"E\1", text)
    values = re.findall(
        r"^ +\d+ +(\S+) +(\S+) +\S+ +\S+\s*$", text.split("P A R T I C I P A T I O N", maxsplit=1)[0], re.M
    )
    omega = np.array([float(row[1]) for row in values])
    tables = text.split("displacements (vx,vy,vz)")[1:]
    rows = np.array([np.array(t.split("\n\n")[1].split(), float).reshape(-1, 4) for t in tables])
    order = np.argsort(rows[0, :, 0])
    where = order[np.searchsorted(rows[0, order, 0], read)]
    return omega[: len(rows)], rows[:, where, 1:]


def trapezoid(lines: FloatArray) -> FloatArray:
    """Return weights of values at lines [m]."""
    return np.asarray(0.5 * (np.diff(lines, prepend=lines[0]) + np.diff(lines, append=lines[-1])))


def simpson(lines: FloatArray) -> FloatArray:
    """Return weights of values at lines and half-way between them [m]."""
    weights = np.zeros(2 * len(lines) - 1)
    weights[::2], weights[1::2] = trapezoid(lines) / 3, 2 * np.diff(lines) / 3
    return weights
