"""Structures written out by hand as matrices, for the tests of imported matrices."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy import sparse

from updating import Axes, Material, Measured, Spec, build_structure
from updating.models import Damping, PointMass, Region
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable
from updating.models.imported.nodes import read_table
from updating.models.reduced import Reduced
from updating.models.reduction import reduce_structure

EXAMPLES = Path(__file__).resolve().parents[3] / "examples" / "matrices"

LENGTH, WIDTH, DEPTH, E, DENSITY = 0.5, 0.03, 0.005, 210e9, 7850.0
STIFF, LINE = E * WIDTH * DEPTH**3 / 12, DENSITY * WIDTH * DEPTH
"""Bending stiffness [N m^2] and mass per length [kg/m] of the beam."""


def beam_matrices(elements: int, first: int = 0, last: int | None = None) -> tuple[Sparse, Sparse]:
    """Return the textbook matrices of a free Euler-Bernoulli beam, some elements only.

    Each node has w and the rotation about y, which is -dw/dx.
    """
    h = LENGTH / elements
    k = STIFF / h**3 * np.array(
        [[12, -6 * h, -12, -6 * h], [-6 * h, 4 * h**2, 6 * h, 2 * h**2],
         [-12, 6 * h, 12, 6 * h], [-6 * h, 2 * h**2, 6 * h, 4 * h**2]]
    )  # fmt: skip
    m = LINE * h / 420 * np.array(
        [[156, -22 * h, 54, 13 * h], [-22 * h, 4 * h**2, -13 * h, -3 * h**2],
         [54, -13 * h, 156, 22 * h], [13 * h, -3 * h**2, 22 * h, 4 * h**2]]
    )  # fmt: skip
    n = 2 * (elements + 1)
    stiffness, mass = np.zeros((n, n)), np.zeros((n, n))
    for e in range(first, elements if last is None else last):
        rows = slice(2 * e, 2 * e + 4)
        stiffness[rows, rows] += k
        mass[rows, rows] += m
    return Sparse(stiffness), Sparse(mass)


def clamp(matrix: Sparse) -> Sparse:
    """Leave out the two rows of the first node."""
    return Sparse(matrix[2:][:, 2:])


def beam_table(elements: int, *, clamped: bool) -> NodeTable:
    """Return where the rows of the beam are: along x, w along z and the rotation about y."""
    node = np.repeat(np.arange(elements + 1) + 1, 2)
    places = np.zeros((len(node), 3))
    places[:, 0] = LENGTH * (node - 1) / elements
    row = np.arange(len(node)) - (2 if clamped else 0)
    return NodeTable(node, places, np.tile([3, 5], elements + 1), np.maximum(row, -1))


def imported_beam(elements: int = 20, *, clamped: bool = True, parts: tuple[int, ...] = ()) -> Imported:
    """Return the beam as imported matrices, divided behind some of its elements."""
    edges = (0, *parts, elements)
    pieces = [beam_matrices(elements, a, b) for a, b in itertools.pairwise(edges)] if parts else []
    cut = clamp if clamped else (lambda matrix: matrix)
    k, m = beam_matrices(elements)
    return Imported(
        cut(k), cut(m), beam_table(elements, clamped=clamped),
        tuple(cut(k) for k, _ in pieces), tuple(cut(m) for _, m in pieces),
    )  # fmt: skip


def spec_of(imported: Imported, masses: tuple[PointMass, ...] = (), regions: tuple[Region, ...] = ()) -> Spec:
    """Return the specification of imported matrices."""
    count = max(len(imported.stiffness_parts), len(imported.mass_parts), 1)
    regions = regions or tuple(
        Region(f"part{i + 1}", (i / count, (i + 1) / count), (0, 1)) for i in range(count)
    )
    return Spec(
        "matrices",
        length=1.0,
        width=1.0,
        thickness=1.0,
        elements=(),
        clamped=(),
        theory="imported",
        material=Material(E, DENSITY),
        regions=regions,
        masses=masses,
        damping=Damping(),
        imported=imported,
    )


def seen_from(points: np.ndarray, directions: np.ndarray, frequency: np.ndarray | None = None) -> Measured:
    """Return a test that says where it hits, its sensor at the last point."""
    frequency = np.array([100.0]) if frequency is None else frequency
    n, m = len(points), len(frequency)
    nothing = np.full(m, np.nan)
    return Measured(
        frequency=frequency, frequency_sigma=np.zeros(m), damping=nothing, damping_sigma=nothing,
        points=points, nodes=tuple(range(1, n + 1)), seen=np.full(n, n - 1), hit=np.arange(n),
        constants=np.ones((n, m)), constants_sigma=np.ones((n, m)), absolute=True, directions=directions,
    )  # fmt: skip


def write_rsa(path: Path, matrix: Sparse) -> None:
    """Write the lower triangle as Nastran does: fixed fields that touch, exponents with D."""
    lower = sparse.tril(matrix).tocsc()
    lower.sort_indices()
    n, entries = lower.shape[0], lower.nnz

    def block(numbers: list[str], each: int) -> list[str]:
        return ["".join(numbers[i : i + each]) for i in range(0, len(numbers), each)]

    pointers = block([f"{p + 1:8d}" for p in lower.indptr], 10)
    indices = block([f"{i + 1:8d}" for i in lower.indices], 10)
    values = block([f"{v:25.16E}".replace("E", "D") for v in lower.data], 3)
    counts = [len(pointers) + len(indices) + len(values), len(pointers), len(indices), len(values), 0]
    head = [
        f"{'a beam':72s}{'BEAM':8s}",
        "".join(f"{c:14d}" for c in counts),
        f"{'RSA':14s}{n:14d}{n:14d}{entries:14d}{0:14d}",
        f"{'(10I8)':16s}{'(10I8)':16s}{'(1P,3D25.16)':20s}{'':20s}",
    ]
    path.write_text("\n".join([*head, *pointers, *indices, *values]) + "\n", encoding="ascii")


AXES = Axes()


@contextmanager
def bolted_frame() -> Iterator[ModuleType]:
    """Give the module of the example, and leave none of its neighbours behind."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(EXAMPLES))
        import frame  # type: ignore[import-not-found]

        yield frame
    for name in ("frame", "bars", "hits"):
        sys.modules.pop(name, None)


def frame_matrices(frame: ModuleType, folder: Path, *, named: bool = True) -> Imported:
    """Return the frame of the example, with the names of its joints' sides, or without any node set."""
    model, sets = frame.frame()
    path = folder / "nodes.csv"
    path.write_text(model.table(sets if named else {}))
    stiffness = model.matrix("stiffness")
    return Imported(stiffness, model.matrix("mass"), read_table(path, stiffness.shape[0]))


ROOTS = np.array([1.8751040687, 4.6940911330, 7.8547574382, 10.995540735])
"""cos x cosh x = -1."""


ANALYTIC = (ROOTS / LENGTH) ** 2 * np.sqrt(STIFF / LINE) / (2 * np.pi)


def reduced(imported: Imported, **options: object) -> Reduced:
    structure = build_structure(spec_of(imported, **options))  # type: ignore[arg-type]
    return reduce_structure(structure, np.array([[LENGTH, 0, 0], [0.3 * LENGTH, 0, 0]]), None, modes=12)
