"""A frame in space by its own dense finite elements, told as modes: a truth that shares nothing with the effects.

Bars are cubic Hermite and linear elements, integrated by Gauss's rule; feet and joints are springs between nodes, so
that in the truth a foot has rows of its own, which the matrices handed over have lost.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from scipy.linalg import eigh

from acquisition import Dof, Geometry, ModalData
from updating import Axes, Case, Measured, Spec, Tolerances, measured_from_modes
from updating.models import Damping, Region
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable
from updating.models.spec import Material

MODULUS, DENSITY, POISSON = 210e9, 7850.0, 0.3
TIED = np.array([3e8, 3e8, 3e8, 3e5, 3e5, 3e5])
"""Springs of a joint that is tight [N/m, N m/rad]."""

Place = tuple[float, float, float]
FOOT_1, FOOT_2, TOP_1, TOP_2 = (0.0, 0.0, 0.0), (0.5, 0.1, 0.0), (0.0, 0.0, 0.45), (0.5, 0.1, 0.38)
ARM = (0.15, 0.35, 0.45)
BARS: Mapping[str, tuple[Place, Place, float, float]] = {
    "column_1": (FOOT_1, TOP_1, 0.014, 0.022),
    "column_2": (FOOT_2, TOP_2, 0.016, 0.020),
    "beam": (TOP_1, TOP_2, 0.012, 0.026),
    "arm": (TOP_1, ARM, 0.010, 0.018),
}
"""From where to where, and sides [m]; the beam is joined to the first column by a joint, the rest is welded."""
ELEMENTS = 3


@dataclass
class Assembly:
    """Nodes, and matrices over all their rows, part by part."""

    places: list[Place] = field(default_factory=list)
    entries: list[tuple[str, np.ndarray, np.ndarray, np.ndarray]] = field(default_factory=list)

    def node(self, at: Sequence[float]) -> int:
        x, y, z = (float(c) for c in at)
        self.places.append((x, y, z))
        return len(self.places) - 1

    def add(self, part: str, nodes: Sequence[int], k: np.ndarray, m: np.ndarray | None = None) -> None:
        rows = np.concatenate([np.arange(6 * n, 6 * n + 6) for n in nodes])
        self.entries.append((part, rows, k, np.zeros_like(k) if m is None else m))

    def matrices(self, *parts: str) -> tuple[np.ndarray, np.ndarray]:
        size = 6 * len(self.places)
        k, m = np.zeros((size, size)), np.zeros((size, size))
        for part, rows, stiff, heavy in self.entries:
            if not parts or part in parts:
                k[np.ix_(rows, rows)] += stiff
                m[np.ix_(rows, rows)] += heavy
        return k, m


def bar(first: np.ndarray, last: np.ndarray, width: float, height: float) -> tuple[np.ndarray, np.ndarray]:
    """Return stiffness and mass (12, 12) of a bar by Gauss's rule on its shape functions."""
    length = float(np.linalg.norm(last - first))
    along = (last - first) / length
    side = np.cross([0.0, 0.0, 1.0], along) if abs(along[2]) < 0.9 else np.array([0.0, 1.0, 0.0])
    side = side / np.linalg.norm(side)
    axes = np.stack([along, side, np.cross(along, side)])
    area, polar = width * height, width * height * (width**2 + height**2) / 12
    thin, thick = sorted((width, height))
    torsion = thick * thin**3 / 3 * (1 - 0.63 * thin / thick)
    k, m = np.zeros((12, 12)), np.zeros((12, 12))
    for s, weight in zip(*np.polynomial.legendre.leggauss(5), strict=True):
        x, w = (s + 1) / 2, weight / 2 * length
        plain, slope = np.zeros((4, 12)), np.zeros((4, 12))  # u, twist, v, w; and u', twist', v'', w''
        for row, rows in ((0, (0, 6)), (1, (3, 9))):
            plain[row, rows], slope[row, rows] = (1 - x, x), (-1 / length, 1 / length)
        shape = (
            1 - 3 * x**2 + 2 * x**3,
            length * (x - 2 * x**2 + x**3),
            3 * x**2 - 2 * x**3,
            length * (x**3 - x**2),
        )
        bend = np.array([-6 + 12 * x, length * (-4 + 6 * x), 6 - 12 * x, length * (-2 + 6 * x)]) / length**2
        for row, rows, signs in ((2, (1, 5, 7, 11), (1, 1, 1, 1)), (3, (2, 4, 8, 10), (1, -1, 1, -1))):
            plain[row, rows], slope[row, rows] = np.multiply(shape, signs), np.multiply(bend, signs)
        shear = MODULUS / (2 * (1 + POISSON))
        bending = MODULUS * area / 12 * np.array([width**2, height**2])
        rigid = np.array([MODULUS * area, shear * torsion, *bending])
        heavy = DENSITY * np.array([area, polar, area, area])
        k += w * slope.T @ (rigid[:, None] * slope)
        m += w * plain.T @ (heavy[:, None] * plain)
    turn = np.kron(np.eye(4), axes)
    return turn.T @ k @ turn, turn.T @ m @ turn


@dataclass(frozen=True)
class Frame:
    """The frame put together.

    Parameters
    ----------
    made : Assembly
        Its matrices.
    feet : tuple of int
        Nodes of the feet.
    sides : tuple of int
        The joint's two nodes, of the column and of the beam.
    """

    made: Assembly
    feet: tuple[int, int]
    sides: tuple[int, int]


def frame(joint: Sequence[float] | float = 1.0) -> Frame:
    """Put the frame together, its joint with so much of its stiffness, in each direction."""
    made, knots = Assembly(), {}
    for at in (FOOT_1, FOOT_2, TOP_1, TOP_2, ARM):
        knots[at] = made.node(at)
    loose = made.node(TOP_1)
    for name, (first, last, width, height) in BARS.items():
        start = loose if name == "beam" else knots[first]
        ends = np.array(first), np.array(last)
        inner = [made.node(ends[0] + (ends[1] - ends[0]) * i / ELEMENTS) for i in range(1, ELEMENTS)]
        nodes = [start, *inner, knots[last]]
        for a, b in pairwise(nodes):
            made.add(name, (a, b), *bar(np.array(made.places[a]), np.array(made.places[b]), width, height))
    springs = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.diag(TIED * np.asarray(joint)))
    made.add("joint", (knots[TOP_1], loose), springs)
    return Frame(made, (knots[FOOT_1], knots[FOOT_2]), (knots[TOP_1], loose))


def handed_over() -> Spec:
    """Return the model: matrices without the rows of the feet, a part for each bar, and node sets."""
    own = frame()
    free = free_rows(own, ())
    row = {int(r): i for i, r in enumerate(free)}
    count = len(own.made.places)
    table = NodeTable(
        np.repeat(np.arange(count) + 1, 6), np.repeat(np.array(own.made.places), 6, axis=0),
        np.tile(np.arange(1, 7), count), np.array([row.get(r, -1) for r in range(6 * count)]),
        sets={
            "foot_1": np.array([own.feet[0] + 1]), "foot_2": np.array([own.feet[1] + 1]),
            "bolt_column": np.array([own.sides[0] + 1]), "bolt_beam": np.array([own.sides[1] + 1]),
        },
    )  # fmt: skip

    def cut(matrix: np.ndarray) -> Sparse:
        return Sparse(matrix[np.ix_(free, free)])

    whole = [cut(matrix) for matrix in own.made.matrices()]
    parts = [own.made.matrices(name) for name in BARS]
    imported = Imported(*whole, table, tuple(cut(k) for k, _ in parts), tuple(cut(m) for _, m in parts))
    regions = tuple(Region(name, (0.0, 1.0), (0.0, 1.0)) for name in BARS)
    size = np.ptp(np.array(own.made.places), axis=0)
    return Spec(
        "matrices", length=float(size[0]), width=float(size[1]), thickness=float(size[2]), elements=(),
        clamped=(), theory="imported", material=Material(MODULUS, DENSITY), regions=regions, masses=(),
        damping=Damping(), imported=imported,
    )  # fmt: skip


def free_rows(own: Frame, given: Sequence[int]) -> np.ndarray:
    """Return the rows of all nodes but of feet that are held."""
    held = [n for i, n in enumerate(own.feet) if i not in given]
    return np.array(
        [r for n in range(len(own.made.places)) if n not in held for r in range(6 * n, 6 * n + 6)]
    )


@dataclass(frozen=True)
class Hidden:
    """What the specimen has and the model has not.

    Parameters
    ----------
    feet : mapping of int to six springs
        Feet that give way, 0 or 1 [N/m, N m/rad].
    joint : six floats or one
        What is left of the joint's stiffness [-].
    springs : tuple of (node, axis, stiffness)
        To the ground [N/m].
    masses : tuple of (node, mass)
        Steel cubes [kg].
    """

    feet: Mapping[int, Sequence[float]] = field(default_factory=dict)
    joint: Sequence[float] | float = 1.0
    springs: tuple[tuple[int, int, float], ...] = ()
    masses: tuple[tuple[int, float], ...] = ()


def nearest(at: Place) -> int:
    """Return the first node at, or nearest to, a place."""
    return int(np.argmin(np.linalg.norm(np.array(frame().made.places) - at, axis=1)))


def specimen(hidden: Hidden) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies [Hz] and shapes over all rows [kg^-1/2] of the specimen."""
    own = frame(hidden.joint)
    for foot, springs in hidden.feet.items():
        own.made.add("ground", (own.feet[foot],), np.diag(np.asarray(springs, dtype=float)))
    for node, axis, stiffness in hidden.springs:
        own.made.add("ground", (node,), stiffness * np.diag(np.eye(6)[axis]))
    for node, mass in hidden.masses:
        inertia = mass * (mass / DENSITY) ** (2 / 3) / 6
        own.made.add("body", (node,), np.zeros((6, 6)), np.diag([mass] * 3 + [inertia] * 3))
    k, m = own.made.matrices()
    free = free_rows(own, tuple(hidden.feet))
    values, vectors = eigh(k[np.ix_(free, free)], m[np.ix_(free, free)], subset_by_index=(0, 19))
    shapes = np.zeros((len(k), 20))
    shapes[free] = vectors
    return np.sqrt(values) / (2 * np.pi), shapes


def case(
    hidden: Hidden,
    points: Sequence[tuple[int, int]],
    *,
    modes: int = 10,
    seed: int = 0,
    scatter: float = 2e-4,
) -> Case:
    """Return the frame's model with the modes of a specimen at some nodes, each along an axis 0, 1, 2.

    Frequencies scatter by a stated share, shapes by half a per cent of their size; without points there are none.
    """
    rng, spec = np.random.default_rng(seed), handed_over()
    frequency, shapes = specimen(hidden)
    measured = frequency[:modes] * (1 + scatter * rng.standard_normal(modes))
    modal = ModalData(frequency=measured, frequency_sigma=scatter * frequency[:modes])
    if points:
        seen = shapes[[6 * node + axis for node, axis in points]][:, :modes]
        sigma = 5e-3 * np.sqrt(np.mean(seen**2, axis=0)) * np.ones_like(seen)
        nodes = sorted({node for node, _ in points})
        modal = replace(
            modal,
            shapes=seen + sigma * rng.standard_normal(seen.shape),
            shape_sigma=sigma,
            dofs=tuple(Dof(node + 1, axis + 1) for node, axis in points),
            geometry=Geometry(tuple(n + 1 for n in nodes), np.array(frame().made.places)[nodes]),
            scaled=True,
        )
    doubts = {"repeatability": scatter, "position_sigma": 0.0, "calibration": 0.02}
    test: Measured = measured_from_modes(modal, Axes(), spec, **doubts)
    return Case("frame", spec, test, baseline=None, tolerances=Tolerances({"E": 0.01, "density": 0.003}))
