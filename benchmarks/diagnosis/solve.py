"""Real modes of a body: Timoshenko's beam and Mindlin's plate, by high polynomials that do not lock."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy import linalg, sparse
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from diagnosis.body import Body, Box
from diagnosis.fluid import modal_inertia
from diagnosis.mesh import Floats, Line, graded

BEAM_ELEMENTS, BEAM_DEGREE, BEAM_MODES = 60, 3, 36
PLATE_ELEMENTS, PLATE_DEGREE, PLATE_MODES = (7, 5), 5, 40


@dataclass(frozen=True, eq=False)
class Solved:
    """Modes of a body in the coordinates of a basis of its own.

    Parameters
    ----------
    omega : (m,) array
        Angular frequencies without damping, rigid modes left out [rad/s].
    vectors : (n, m) array
        Mass-normalised modes at all nodal degrees of freedom, fixed ones included.
    proportional : two (m, m) arrays
        Mass and bending stiffness of the plain body in modal coordinates.
    losses : (m, m) array
        Structural damping of what was added, modal.
    drag : (m, m) array
        Coefficient of sqrt(omega) in the viscous damping, modal.
    lines : tuple of Line
        The mesh.
    """

    omega: Floats
    vectors: Floats
    proportional: tuple[Floats, Floats]
    losses: Floats
    drag: Floats
    lines: tuple[Line, ...]
    body: Body

    def shapes(self, points: Floats) -> Floats:
        """Return the modes at places (n_points, dim) [m], shape (n_points, m)."""
        return np.asarray(rows_at(self.lines, points) @ self.vectors[: _nodes(self.lines)])


def solve(body: Body, cuts: tuple[Box, ...] = ()) -> Solved:
    """Return the modes of a body; the mesh meets the edges of ``cuts`` as well as those of the body's own boxes."""
    lines = _mesh(body, (*body.boxes(), *cuts))
    parts = _Beam(body, lines) if body.kind == "beam" else _Plate(body, lines)
    stiffness = parts.stiffness() + _attached_stiffness(body, lines, parts.size)
    mass = parts.inertia() + _attached_mass(body, lines, parts.size)
    free = parts.free()
    values, vectors = _lowest(stiffness[free][:, free], mass[free][:, free], parts.modes)
    full = np.zeros((parts.size, len(values)))
    full[free] = vectors
    if body.fluid:
        values, full = _wetted(values, full, body, lines)
    elastic = values > 1e-5 * values[6]
    values, full = values[elastic], full[:, elastic]

    def modal(matrix: sparse.csr_array) -> Floats:
        return np.asarray(full.T @ (matrix @ full))

    plain = body.but(masses=(), patches=())
    bare = type(parts)(plain, lines)
    losses = sum(
        (p.loss * modal(parts.box_stiffness(p.box)) for p in body.patches), np.zeros((len(values),) * 2)
    )
    losses = losses + body.loss * modal(bare.stiffness())
    return Solved(
        np.sqrt(values),
        full,
        (modal(bare.inertia()), modal(bare.stiffness())),
        losses,
        body.drag * modal(parts.area()),
        lines,
        body,
    )


def _mesh(body: Body, boxes: tuple[Box, ...]) -> tuple[Line, ...]:
    x = np.unique([v for b in boxes for v in b[:2]])
    if body.kind == "beam":
        return (Line(body.length * graded(x, BEAM_ELEMENTS), BEAM_DEGREE),)
    y = np.unique([v for b in boxes for v in b[2:]])
    return (
        Line(body.length * graded(x, PLATE_ELEMENTS[0], 0.6), PLATE_DEGREE),
        Line(body.width * graded(y, PLATE_ELEMENTS[1], 0.6), PLATE_DEGREE),
    )


def _nodes(lines: tuple[Line, ...]) -> int:
    return int(np.prod([line.size for line in lines]))


def rows_at(lines: tuple[Line, ...], points: Floats) -> sparse.csr_array:
    """Return nodal displacements to displacements at places [m]."""
    first = lines[0].rows(points[:, 0])
    if len(lines) == 1:
        return first
    second = lines[1].rows(points[:, 1])
    return sparse.csr_array(
        sparse.vstack(
            [sparse.kron(first[[i]], second[[i]], format="csr") for i in range(len(points))], format="csr"
        )
    )


def _wide(block: sparse.csr_array, size: int, offset: int = 0) -> sparse.csr_array:
    """Put a block of columns for one field into rows over all fields."""
    given = block.tocoo()
    shape = (given.shape[0], size)
    return sparse.csr_array((given.data, (given.coords[0], given.coords[1] + offset)), shape=shape)


def _gram(row: sparse.csr_array, weight: Floats, other: sparse.csr_array | None = None) -> sparse.csr_array:
    return sparse.csr_array(row.T @ sparse.diags_array(weight) @ (row if other is None else other))


def _inside(box: Box, x: Floats, length: float) -> Floats:
    return ((x >= box[0] * length) & (x <= box[1] * length)).astype(float)


class _Beam:
    modes = BEAM_MODES

    def __init__(self, body: Body, lines: tuple[Line, ...]) -> None:
        self.body, self.line = body, lines[0]
        n = self.line.size
        self.size = 2 * n
        self.w = _wide(self.line.values, self.size)
        self.turn = _wide(self.line.values, self.size, n)
        self.slope = _wide(self.line.slopes, self.size)
        self.bend = _wide(self.line.slopes, self.size, n)

    def _within(self, box: Box) -> Floats:
        return _inside(box, self.line.points, self.body.length)

    @property
    def _thickness(self) -> Floats:
        share = self.line.points / self.body.length - 0.5
        return np.asarray(self.body.thickness * (1 + 2 * self.body.taper * share))

    def _rigidity(self) -> Floats:
        b = self.body
        rigidity = b.E * b.width * self._thickness**3 / 12
        for box, loss in b.soft:
            rigidity = rigidity * (1 - loss * self._within(box))
        for box, factor in b.ribs:
            rigidity = rigidity * (1 + (factor - 1) * self._within(box))
        return np.asarray(rigidity)

    def stiffness(self) -> sparse.csr_array:
        b, w = self.body, self.line.weights
        cowper = 10 * (1 + b.poisson) / (12 + 11 * b.poisson)  # Cowper 1966
        shear = cowper * b.E / (2 * (1 + b.poisson)) * b.width * self._thickness
        rigidity = self._rigidity()
        for patch in b.patches:
            rigidity = rigidity * (1 + patch.stiffness * self._within(patch.box))
        total = _gram(self.bend, w * rigidity) + _gram(self.slope - self.turn, w * shear)
        return sparse.csr_array(total + _gram(self.slope, w * b.axial) if b.axial else total)

    def box_stiffness(self, box: Box) -> sparse.csr_array:
        return _gram(self.bend, self.line.weights * self._rigidity() * self._within(box))

    def inertia(self) -> sparse.csr_array:
        b, w = self.body, self.line.weights
        spread = b.density * b.width * self._thickness
        turning = b.density * b.width * self._thickness**3 / 12
        for patch in b.patches:
            spread = spread * (1 + patch.mass * self._within(patch.box))
        return sparse.csr_array(_gram(self.w, w * spread) + _gram(self.turn, w * turning))

    def area(self) -> sparse.csr_array:
        return _gram(self.w, self.line.weights * self.body.width)

    def free(self) -> Floats:
        n, b = self.line.size, self.body
        fixed: list[int] = []
        for edge in b.clamped:
            end = 0 if edge == "x0" else n - 1
            fixed += [end] * (b.translation is None) + [n + end] * (b.rotation is None)
        return np.setdiff1d(np.arange(self.size), fixed)

    def clamp_springs(self) -> sparse.csr_array:
        n, b = self.line.size, self.body
        diagonal = np.zeros(self.size)
        for edge in b.clamped:
            end = 0 if edge == "x0" else n - 1
            diagonal[end] += b.translation or 0.0
            diagonal[n + end] += b.rotation or 0.0
        return sparse.csr_array(sparse.diags_array(diagonal))


class _Plate:
    modes = PLATE_MODES

    def __init__(self, body: Body, lines: tuple[Line, ...]) -> None:
        self.body, self.lines = body, lines
        x, y = lines
        n = x.size * y.size
        self.size = 3 * n
        self.x, self.y = (m.ravel() for m in np.meshgrid(x.points, y.points, indexing="ij"))
        self.weights = np.outer(x.weights, y.weights).ravel()

        value = sparse.csr_array(sparse.kron(x.values, y.values))
        by_x = sparse.csr_array(sparse.kron(x.slopes, y.values))
        by_y = sparse.csr_array(sparse.kron(x.values, y.slopes))
        self.w = _wide(value, self.size)
        self.turns = _wide(value, self.size, n), _wide(value, self.size, 2 * n)
        self.kx, self.ky = _wide(by_x, self.size, n), _wide(by_y, self.size, 2 * n)
        self.twist = sparse.csr_array(_wide(by_y, self.size, n) + _wide(by_x, self.size, 2 * n))
        self.wx, self.wy = _wide(by_x, self.size), _wide(by_y, self.size)

    def _within(self, box: Box) -> Floats:
        along = _inside(box, self.x, self.body.length)
        return np.asarray(along * _inside((box[2], box[3], 0, 0), self.y, self.body.width))

    @property
    def _thickness(self) -> Floats:
        return np.asarray(self.body.thickness * (1 + 2 * self.body.taper * (self.x / self.body.length - 0.5)))

    def _rigidity(self) -> Floats:
        b = self.body
        rigidity = b.E * self._thickness**3 / (12 * (1 - b.poisson**2))
        for box, loss in b.soft:
            rigidity = rigidity * (1 - loss * self._within(box))
        for box, factor in b.ribs:
            rigidity = rigidity * (1 + (factor - 1) * self._within(box))
        return np.asarray(rigidity)

    def _bending(self, rigidity: Floats) -> sparse.csr_array:
        b, w = self.body, self.weights * rigidity
        across = w * b.across
        mixed = w * b.poisson * np.sqrt(b.across)
        shearing = w * (1 - b.poisson) / 2 * np.sqrt(b.across)
        coupled = _gram(self.kx, mixed, self.ky)
        return sparse.csr_array(
            _gram(self.kx, w) + _gram(self.ky, across) + coupled + coupled.T + _gram(self.twist, shearing)
        )

    def stiffness(self) -> sparse.csr_array:
        b, w = self.body, self.weights
        rigidity = self._rigidity()
        for patch in b.patches:
            rigidity = rigidity * (1 + patch.stiffness * self._within(patch.box))
        shear = w * 5 / 6 * b.E / (2 * (1 + b.poisson)) * self._thickness
        total = self._bending(rigidity)
        for slope, turn in zip((self.wx, self.wy), self.turns, strict=True):
            total = total + _gram(sparse.csr_array(slope - turn), shear)
        if b.axial:
            total = total + _gram(self.wx, w * b.axial / b.width)
        return sparse.csr_array(total)

    def box_stiffness(self, box: Box) -> sparse.csr_array:
        return self._bending(self._rigidity() * self._within(box))

    def inertia(self) -> sparse.csr_array:
        b, w = self.body, self.weights
        spread = b.density * self._thickness
        for patch in b.patches:
            spread = spread * (1 + patch.mass * self._within(patch.box))
        turning = w * b.density * self._thickness**3 / 12
        total = _gram(self.w, w * spread)
        for turn in self.turns:
            total = total + _gram(turn, turning)
        return sparse.csr_array(total)

    def area(self) -> sparse.csr_array:
        return _gram(self.w, self.weights)

    def _edge(self, edge: str) -> tuple[Floats, Line, int]:
        """Return the nodes of an edge, the line along it, and the field of the rotation across it."""
        x, y = self.lines
        grid = np.arange(x.size * y.size).reshape(x.size, y.size)
        nodes = {"x0": grid[0], "x1": grid[-1], "y0": grid[:, 0], "y1": grid[:, -1]}[edge]
        return nodes, y if edge[0] == "x" else x, 1 if edge[0] == "x" else 2

    def free(self) -> Floats:
        b, n = self.body, self.lines[0].size * self.lines[1].size
        fixed: list[Floats] = []
        for edge in b.clamped:
            nodes, _, across = self._edge(edge)
            if b.translation is None:
                fixed += [nodes, nodes + (3 - across) * n]
            if b.rotation is None:
                fixed.append(nodes + across * n)
        return np.setdiff1d(np.arange(self.size), np.concatenate([[], *fixed]).astype(int))

    def clamp_springs(self) -> sparse.csr_array:
        b, n = self.body, self.lines[0].size * self.lines[1].size
        total: Any = sparse.csr_array((self.size, self.size))
        for edge in b.clamped:
            nodes, line, across = self._edge(edge)
            along: Any = _gram(line.values, line.weights)
            for field, spring in ((0, b.translation), (across, b.rotation)):
                if spring:
                    where = np.arange(len(nodes)), nodes + field * n
                    pick = sparse.csr_array((np.ones(len(nodes)), where), shape=(len(nodes), self.size))
                    total = total + spring * (pick.T @ along @ pick)
        return total.tocsr()  # type: ignore[no-any-return]


def _attached_stiffness(body: Body, lines: tuple[Line, ...], size: int) -> sparse.csr_array:
    parts = (_Beam if body.kind == "beam" else _Plate)(body, lines)
    total = parts.clamp_springs()
    for x, y, spring in body.springs:
        row = _wide(rows_at(lines, np.array([[x * body.length, y * body.width]])), size)
        total = total + spring * (row.T @ row)
    return sparse.csr_array(total)


def _attached_mass(body: Body, lines: tuple[Line, ...], size: int) -> sparse.csr_array:
    total = sparse.csr_array((size, size))
    n = _nodes(lines)
    for x, y, mass, inertia in body.masses:
        plain = rows_at(lines, np.array([[x * body.length, y * body.width]]))
        for field, value in ((0, mass), *((i + 1, inertia) for i in range(len(lines)))):
            row = _wide(plain, size, field * n)
            total = total + value * (row.T @ row)
    return sparse.csr_array(total)


def _lowest(stiffness: sparse.csr_array, mass: sparse.csr_array, count: int) -> tuple[Floats, Floats]:
    shift = -1e-6 * stiffness.diagonal().mean() / mass.diagonal().mean()
    factor = splu((stiffness - shift * mass).tocsc(), permc_spec="MMD_AT_PLUS_A")
    inverse = LinearOperator(stiffness.shape, matvec=factor.solve)
    start = np.random.default_rng(0).standard_normal(stiffness.shape[0])
    values, vectors = eigsh(stiffness, count, M=mass, sigma=shift, OPinv=inverse, v0=start)
    order = np.argsort(values)
    return values[order], vectors[:, order]


def _wetted(values: Floats, vectors: Floats, body: Body, lines: tuple[Line, ...]) -> tuple[Floats, Floats]:
    """Add the fluid's inertia in the coordinates of the dry modes."""
    added = modal_inertia(body, lambda points: np.asarray(rows_at(lines, points) @ vectors[: _nodes(lines)]))
    wet, turn = linalg.eigh(np.diag(np.maximum(values, 0.0)), np.eye(len(values)) + added)
    return wet, vectors @ turn
