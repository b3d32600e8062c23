"""Stiffness and mass of a Reissner-Mindlin plate on a grid of quintic elements.

Moments and shear forces follow from curvatures (theta_x,x  theta_y,y  theta_x,y + theta_y,x) and slides
(w,x - theta_x  w,y - theta_y): Mindlin, J. Appl. Mech. 18 (1951) 31. Where moduli differ along x and y,
coupling and twist follow their geometric mean (Huber; Timoshenko and Woinowsky-Krieger, Theory of Plates and
Shells, 2nd ed., section 86).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.plate.grid import GAUSS_COUNT, Grid, gauss_line
from modalkit.simulator.bodies.plate.parts import PlateAttached, Rib

Sparse = scipy.sparse.csr_array


@dataclass(frozen=True, eq=False)
class Section:
    """Properties at the Gauss points of a grid.

    Parameters
    ----------
    bending, shear : (n,) arrays
        D along x [N m] and kappa G t [N/m].
    ratio, poisson : float
        D across over D along, and Poisson's ratio [-].
    shear_ratio : float
        Stiffness against twist over that of the geometric mean [-].
    """

    bending: FloatArray
    shear: FloatArray
    ratio: float
    poisson: float
    shear_ratio: float = 1.0


def _blocks(grid: Grid) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return shape functions and derivatives with their roots of weights, shape (n_elements, 49, 36)."""
    _, _, weight, read = grid.gauss
    shape = (-1, GAUSS_COUNT**2, read.value.shape[1])
    root = np.sqrt(weight)[:, None]
    return (
        (root * read.value).reshape(shape),
        (root * read.dx).reshape(shape),
        (root * read.dy).reshape(shape),
    )


def _pair(left: FloatArray, weight: FloatArray, right: FloatArray) -> FloatArray:
    """Integrate weight times left times right over every element, shape (n_elements, 36, 36)."""
    scaled = left * weight.reshape(len(left), -1, 1)
    return np.asarray(np.matmul(scaled.transpose(0, 2, 1), right))


def _spread(grid: Grid, blocks: dict[tuple[int, int], FloatArray]) -> Sparse:
    """Add element blocks, (n_elements, 36, 36) for a pair of fields, into one sparse matrix."""
    nodes = grid.gauss[3].nodes[:: GAUSS_COUNT**2]
    rows, columns, data = [], [], []
    for (left, right), block in blocks.items():
        rows.append(np.broadcast_to(3 * nodes[:, :, None] + left, block.shape).ravel())
        columns.append(np.broadcast_to(3 * nodes[:, None, :] + right, block.shape).ravel())
        data.append(block.ravel())
    where = np.concatenate(rows), np.concatenate(columns)
    whole = scipy.sparse.coo_array((np.concatenate(data), where), shape=(3 * grid.count,) * 2)
    return whole.tocsr()


def stiffness_matrix(grid: Grid, section: Section, *, shear: bool = True) -> Sparse:
    """Return the stiffness of the plate's material.

    Parameters
    ----------
    grid : Grid
        Elements.
    section : Section
        Properties at the Gauss points.
    shear : bool
        False leaves the slides out, for what only bends.

    Returns
    -------
    (3 n_nodes, 3 n_nodes) sparse array
        In w, theta_x, theta_y of each node [N/m, N, N m].
    """
    value, dx, dy = _blocks(grid)
    root = np.sqrt(section.ratio)
    d11, d22 = section.bending, section.bending * section.ratio
    d12 = section.bending * section.poisson * root
    d66 = section.bending * 0.5 * (1 - section.poisson) * root * section.shear_ratio
    blocks = {
        (1, 1): _pair(dx, d11, dx) + _pair(dy, d66, dy),
        (2, 2): _pair(dy, d22, dy) + _pair(dx, d66, dx),
        (1, 2): _pair(dx, d12, dy) + _pair(dy, d66, dx),
    }
    if shear:
        slide = section.shear
        both = _pair(value, slide, value)
        blocks |= {
            (1, 1): blocks[1, 1] + both,
            (2, 2): blocks[2, 2] + both,
            (0, 0): _pair(dx, slide, dx) + _pair(dy, slide, dy),
            (0, 1): -_pair(dx, slide, value),
            (0, 2): -_pair(dy, slide, value),
        }
    mirrored = {(b, a): block.transpose(0, 2, 1) for (a, b), block in blocks.items() if a != b}
    return _spread(grid, blocks | mirrored)


def mass_matrix(grid: Grid, area: FloatArray, rotary: FloatArray) -> Sparse:
    """Return the plate's mass from mass and rotary inertia per area at the Gauss points [kg/m2], [kg]."""
    value, _, _ = _blocks(grid)
    turn = _pair(value, rotary, value)
    return _spread(grid, {(0, 0): _pair(value, area, value), (1, 1): turn, (2, 2): turn})


def load_matrix(grid: Grid, along: FloatArray | float, across: FloatArray | float) -> Sparse:
    """Return the stiffness that loads in the plane give, from forces per length along x and y, also at the
    Gauss points [N/m].
    """
    value, dx, dy = _blocks(grid)
    ones = np.ones(value.shape[0] * value.shape[1])
    return _spread(grid, {(0, 0): _pair(dx, along * ones, dx) + _pair(dy, across * ones, dy)})


def rib_matrices(grid: Grid, rib: Rib) -> tuple[Sparse, Sparse]:
    """Return stiffness and mass of a rib, whose points follow the plate's surface."""
    share = np.unique(np.concatenate([np.linspace(0, 1, 9), *_crossings(grid, rib)]))
    at, weight = (a.ravel() for a in gauss_line(share))
    x = rib.start[0] + at * (rib.end[0] - rib.start[0])
    y = rib.start[1] + at * (rib.end[1] - rib.start[1])
    read = grid.read(grid.find(x, y), y)
    c, s = rib.direction
    along = c * read.dx + s * read.dy
    bend = read.rows({1: c * along, 2: s * along}, 3 * grid.count)
    twist = read.rows({1: -s * along, 2: c * along}, 3 * grid.count)
    move = read.rows({0: read.value}, 3 * grid.count)
    scale = scipy.sparse.diags_array(weight * rib.length)
    stiff = rib.bending * (bend.T @ scale @ bend) + rib.torsion * (twist.T @ scale @ twist)
    return stiff.tocsr(), (rib.line_mass * (move.T @ scale @ move)).tocsr()


def _crossings(grid: Grid, rib: Rib) -> list[FloatArray]:
    """Return where a rib meets the lines of an unslanted grid, as shares of its length."""
    found = []
    for lines, low, high in ((grid.x, rib.start[0], rib.end[0]), (grid.y, rib.start[1], rib.end[1])):
        if abs(high - low) > 1e-9:
            shares = (lines - low) / (high - low)
            found.append(shares[(shares > 0) & (shares < 1)])
    return found


def attached_mass(grid: Grid, parts: tuple[PlateAttached, ...]) -> Sparse:
    """Return the mass of what is fixed to the plate."""
    x, y = np.array([(p.x, p.y) for p in parts]).T
    read = grid.read(grid.find(x, y), y)
    mass = scipy.sparse.diags_array([p.mass for p in parts])
    inertia = scipy.sparse.diags_array([p.inertia for p in parts])
    whole = Sparse((3 * grid.count, 3 * grid.count))
    for field, weight in ((0, mass), (1, inertia), (2, inertia)):
        rows = read.rows({field: read.value}, 3 * grid.count)
        whole = whole + rows.T @ weight @ rows
    return whole.tocsr()
