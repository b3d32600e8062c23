"""How a plate is held at its edges: which DOFs are fixed, and springs in their place."""

from __future__ import annotations

import numpy as np
import scipy.sparse

from acquisition.arrays import BoolArray, FloatArray
from modalkit.simulator.bodies.plate.grid import Grid, gauss_line

Sparse = scipy.sparse.csr_array

_ON = 1e-9
"""So near to the end of a stretch a node is on it [m]."""


def on_edge(grid: Grid, edge: str) -> BoolArray:
    """Return which nodes lie on the edge ``x0``, ``x1``, ``y0`` or ``y1``."""
    places, lines = (grid.nodes[0], grid.x) if edge[0] == "x" else (grid.nodes[1], grid.y)
    return np.asarray(np.abs(places - (lines[0] if edge[1] == "0" else lines[-1])) < 1e-9)


WHOLE = (-np.inf, np.inf)
"""All along an edge [m]."""


def free_motions(
    grid: Grid, edges: tuple[str, ...], *, shift: bool, turn: bool, stretch: tuple[float, float] = WHOLE
) -> Sparse:
    """Return what the held edges leave: columns of motions in all DOFs.

    Parameters
    ----------
    grid : Grid
        Elements.
    edges : tuple of {"x0", "x1", "y0", "y1"}
        Those held.
    shift, turn : bool
        Whether they may move, and rotate about themselves, on springs. Where they do not move they do not
        rotate across either.
    stretch : (low, high)
        Along the edges, between which places they may do so [m].

    Returns
    -------
    (3 n_nodes, n_kept) sparse array
        With orthonormal columns.
    """
    fixed = np.zeros((grid.count, 3), bool)
    cosine, sine = np.ones(grid.count), np.zeros(grid.count)
    for edge in edges:
        here = on_edge(grid, edge)
        normal = 1 if edge[0] == "x" else 2
        along = grid.nodes[1 if edge[0] == "x" else 0]
        low, high = (
            stretch[0] > along.min() + _ON,
            stretch[1] < along.max() - _ON,
        )  # what reaches a corner frees it
        firm = (low & (along <= stretch[0] + _ON)) | (high & (along >= stretch[1] - _ON))
        fixed[here & (firm | (not shift)), 0] = True
        fixed[here & (firm | (not turn)), normal] = True
        fixed[here & (firm | (not shift)), 3 - normal] = True
        if edge == "x0" and grid.slant:
            angle = np.arctan(grid.slant)
            others = np.any(
                [on_edge(grid, e) for e in edges if e != edge] + [np.zeros(grid.count, bool)], axis=0
            )
            alone = here & ~others
            cosine[alone], sine[alone] = np.cos(angle), np.sin(angle)
    node = np.arange(grid.count)
    rows = [3 * node, 3 * node + 1, 3 * node + 2, 3 * node + 1, 3 * node + 2]
    columns = [3 * node, 3 * node + 1, 3 * node + 1, 3 * node + 2, 3 * node + 2]
    data = [np.ones(grid.count), cosine, -sine, sine, cosine]
    turned = scipy.sparse.coo_array(
        (np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=(3 * grid.count,) * 2
    )
    kept: Sparse = turned.tocsc()[:, np.flatnonzero(~fixed.ravel())].tocsr()
    return kept


def edge_springs(
    grid: Grid,
    edges: tuple[str, ...],
    *,
    shift: float,
    turn: float,
    stretch: tuple[float, float] = WHOLE,
) -> Sparse:
    """Return the stiffness of springs along edges.

    Parameters
    ----------
    grid : Grid
        Elements.
    edges : tuple of str
        Where.
    shift, turn : float
        Against moving [N/m2] and rotating [N] per metre of edge; infinite ones are left out.
    stretch : (low, high)
        Along the edges, between which places they are [m].

    Returns
    -------
    (3 n_nodes, 3 n_nodes) sparse array
        Stiffness.
    """
    whole = Sparse((3 * grid.count, 3 * grid.count))
    for edge in edges:
        x, y, weight, normal = _edge_line(grid, edge)
        along = y if edge[0] == "x" else x
        weight = weight * ((along > stretch[0]) & (along < stretch[1]))
        read = grid.read(x, y)
        move = read.rows({0: read.value}, 3 * grid.count)
        rotate = read.rows({1: normal[0] * read.value, 2: normal[1] * read.value}, 3 * grid.count)
        for rows, stiffness in ((move, shift), (rotate, turn)):
            if np.isfinite(stiffness):
                whole = whole + rows.T @ scipy.sparse.diags_array(stiffness * weight) @ rows
    return whole.tocsr()


def _edge_line(grid: Grid, edge: str) -> tuple[FloatArray, FloatArray, FloatArray, tuple[float, float]]:
    """Return grid positions and weights of Gauss points on an edge [m], and its normal."""
    end = 0 if edge[1] == "0" else -1
    at, weight = (a.ravel() for a in gauss_line(grid.y if edge[0] == "x" else grid.x))
    fixed = np.full_like(at, (grid.x if edge[0] == "x" else grid.y)[end])
    if edge[0] == "y":
        return at, fixed, weight * grid.stretch(fixed), (0.0, 1.0)
    slant = grid.slant if edge == "x0" else 0.0
    long = np.hypot(1.0, slant)
    return fixed, at, weight * long, (1 / long, -slant / long)
