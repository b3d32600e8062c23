"""A ribbed plate, or a bracket, of solid bricks, by matrices of CalculiX: truth and model differ in their mesh.

It offers what ``Beam`` and ``Plate`` do (``body.Body``) in two axes: places are on the upper face of its plate, which
is hit across. What a study models (:mod:`modalkit.simulator.block_model`) is this body with fewer bricks and nothing
hidden. Needs ``ccx`` on the path.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import scipy.interpolate
from scipy import sparse
from scipy.sparse.linalg import eigsh

from acquisition.arrays import FloatArray, IntArray, frozen_array
from modalkit.simulator.bodies.block.assembled import Assembled, Matrix, added, assembled
from modalkit.simulator.bodies.block.shape import SHAPES
from modalkit.simulator.bodies.body import Loss
from modalkit.simulator.bodies.parted import Parted

BOLT = 0.1
"""A bolt as drawn, over E t: firm, and not rigid [-]."""

ELEMENT = "C3D20R"
"""Kind of brick."""


@dataclass(frozen=True, kw_only=True)
class Block(Parted):
    """The body.

    Parameters
    ----------
    kind : {"ribbed", "bracket"}
        Which.
    start, end, width, thickness : float
        Of its plate, as a plate's [m].
    height, breadth : float
        Of the ribs, or of the angle beneath it [m].
    E, density, poisson : float
        Material [Pa], [kg/m3], [-].
    elements : int
        Bricks along its length [-].
    **more
        As of :class:`Parted`: joints are bolts, feet shift along z, each as one [N/m], and a mass that is fixed moves
        along all axes and does not turn.
    """

    kind: str
    start: float
    end: float
    width: float
    thickness: float
    height: float
    breadth: float
    E: float
    density: float
    poisson: float
    elements: int = 16

    @property
    def bricks(self) -> Assembled:
        """Its mesh and matrices."""
        shape = SHAPES[self.kind](
            self.end - self.start, self.width, self.thickness, self.height, self.breadth
        )
        return assembled(shape, self.elements, ELEMENT, self.poisson)

    @property
    def mass(self) -> float:
        """Mass as drawn [kg]."""
        return self.density * self.bricks.volume

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its parts."""
        return tuple(self.bricks.parts)

    @property
    def bolt_stiffness(self) -> float:
        """Stiffness of a bolt as drawn, in every direction [N/m]."""
        return BOLT * self.E * self.thickness

    def place_of(self, name: str) -> tuple[float, float]:
        """Return the middle of a part, a bolt or a foot along x and y [m]."""
        shape = self.bricks.mesh.shape
        boxes = {known: box for known, box, _ in shape.parts} | dict(shape.feet) | dict(shape.bolts)
        (x0, x1), (y0, y1), _ = boxes[name]
        return self.start + (x0 + x1) / 2, (y0 + y1) / 2

    def parts(self) -> dict[str, tuple[Matrix, Matrix]]:
        """Return stiffness and mass of every part as it is, (order, order) [SI]."""
        stiff, heavy = dict(self.stiff), dict(self.heavy)
        return {
            name: (self.E * stiff.get(name, 1.0) * k, self.density * heavy.get(name, 1.0) * m)
            for name, (k, m) in self.bricks.parts.items()
        }

    def material(self) -> tuple[Matrix, Matrix]:
        """Return stiffness, that of bolts among it, and mass of the material, (order, order) [SI]."""
        left, bricks, parts = dict(self.loose), self.bricks, self.parts().values()
        bolts = [
            Matrix(self.bolt_stiffness * left.get(bolt, 1.0) * bricks.springs(bolt)) for bolt in bricks.bolts
        ]
        return added([*(k for k, _ in parts), *bolts]), added([m for _, m in parts])

    def fixed(self) -> tuple[Matrix, Matrix, Matrix]:
        """Return stiffness, mass and dashpots of what is fixed to it, (order, order) [SI]."""
        found = [Matrix((self.bricks.order,) * 2) for _ in range(3)]
        for part in self.attached:
            along = [self._beside(part.x, part.y, axis) for axis in range(3)]
            across = Matrix(along[2].T @ along[2])
            every = added([Matrix(row.T @ row) for row in along])
            adds = part.stiffness * across, part.mass * every, part.damping * across
            found = [Matrix(known + more) for known, more in zip(found, adds, strict=True)]
        return found[0], found[1], found[2]

    def _beside(self, x: float, y: float, axis: int) -> Matrix:
        """Return the row that reads the motion at a place of the upper face, by the crossings about it."""
        bricks = self.bricks
        along, across = (
            _cubic(lines, np.array([at]), slope=False)[0]
            for lines, at in ((bricks.mesh.x, x - self.start), (bricks.mesh.y, y))
        )
        shares = np.multiply.outer(along, across)
        used = np.flatnonzero(shares.ravel())
        columns = 3 * bricks.top.ravel()[used] + axis
        return Matrix(
            sparse.coo_array(
                (shares.ravel()[used], (np.zeros(len(used), int), columns)), shape=(1, bricks.order)
            )
        )

    def free(self) -> Matrix:
        """Return what the rows are of the motions that nothing holds, (order, n): feet that shift come last."""
        bricks, soft = self.bricks, dict(self.feet)
        held = np.concatenate([(3 * nodes[:, None] + np.arange(3)).ravel() for nodes in bricks.feet.values()])
        loose = np.setdiff1d(np.arange(bricks.order), held)
        columns = [np.arange(len(loose))]
        rows: list[IntArray] = [loose]
        for i, foot in enumerate(soft):
            rows.append(3 * bricks.feet[foot] + 2)
            columns.append(np.full(len(rows[-1]), len(loose) + i))
        ones = np.ones(sum(map(len, rows)))
        places = (np.concatenate(rows), np.concatenate(columns))
        return Matrix(sparse.coo_array((ones, places), shape=(bricks.order, len(loose) + len(soft))))

    def real_modes(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest undamped modes: omega (count,) [rad/s], shapes (order, count) [kg^-1/2]."""
        plain = replace(
            self, alpha=0.0, beta=0.0, added_alpha=0.0, added_beta=0.0, added_loss=0.0,
            attached=tuple(replace(part, damping=0.0) for part in self.attached if part.mass or part.stiffness),
        )  # fmt: skip
        omega, shapes = _solved(plain, -(-count // 8) * 8)
        return omega[:count], shapes[:, :count]

    def rows(self, places: FloatArray, quantity: str) -> FloatArray:
        """Return rows, (n, order), that read ``w``, ``slope_x`` or ``slope_y`` at places (n, 2) [m]."""
        places = np.asarray(places, dtype=float).reshape(-1, 2)
        bricks = self.bricks
        along = _cubic(bricks.mesh.x, places[:, 0] - self.start, slope=quantity == "slope_x")
        across = _cubic(bricks.mesh.y, places[:, 1], slope=quantity == "slope_y")
        found = np.zeros((len(places), bricks.order))
        found[:, 3 * bricks.top.ravel() + 2] = np.einsum("ni,nj->nij", along, across).reshape(len(places), -1)
        return found

    def modal_damping(self, shapes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the damping that the modeller expects, and what else is viscous, of what ``real_modes`` gave."""
        stiffness, mass = (shapes.T @ (matrix @ shapes) for matrix in self.material())
        dashpots = shapes.T @ (self.fixed()[2] @ shapes)
        others = self.added_alpha * mass + self.added_beta * stiffness + dashpots
        return self.alpha * mass + self.beta * stiffness, others

    def modal_losses(self, shapes: FloatArray) -> tuple[Loss, ...]:
        """Return structural damping of the whole."""
        if not self.added_loss:
            return ()
        return (Loss(self.added_loss * (shapes.T @ (self.material()[0] @ shapes)), -1.0),)


@lru_cache(maxsize=64)
def _solved(block: Block, count: int) -> tuple[FloatArray, FloatArray]:
    own, more, moves = block.material(), block.fixed(), block.free()
    stiffness, mass = (Matrix(moves.T @ (a + b) @ moves) for a, b in zip(own, more[:2], strict=True))
    springs = np.zeros(moves.shape[1])
    springs[len(springs) - len(block.feet) :] = [spring for _, spring in block.feet]
    held = sparse.csc_array(stiffness + sparse.diags_array(springs))
    start = np.random.default_rng(0).standard_normal(len(springs))
    values, vectors = eigsh(held, count, sparse.csc_array(mass), sigma=0.0, v0=start)
    order = np.argsort(values)
    return frozen_array(np.sqrt(values[order])), frozen_array(moves @ vectors[:, order])


def _cubic(lines: FloatArray, places: FloatArray, *, slope: bool) -> FloatArray:
    """Return weights of the values at lines in a local cubic's value or slope at places.

    Its slope at a line is that of the parabola through the neighbours. A spline over all lines rings above the edge of
    a foot.
    """
    values = np.eye(len(lines))
    local = scipy.interpolate.CubicHermiteSpline(
        lines, values, np.gradient(values, lines, axis=0, edge_order=2)
    )
    return np.asarray(local(places, nu=int(slope)))
