"""Springs along a stretch of a clamped edge, the rest of which holds.

In a plate so large that nothing else matters, an edge that is let go along a stretch moves by (1 - s^2)^p C_j(s), s
from -1 to 1, with Gegenbauer's polynomials of order p + 1/2; p = 1/2 where it rotates, p = 3/2 where it shifts. The
plate resists these one by one: the fractional Laplacian of order p of each is a multiple of its polynomial (Dyda,
Kuznetsov and Kwasnicki, Constr. Approx. 45 (2017) 427-448), and a half-plane of bending stiffness D answers an edge
that rotates, or shifts, by cos(k y) with moments, or forces, 2 D k^2p cos(k y).

The edge of the model moves by what its mesh has of these. Of what is too short for the mesh the half-plane is taken, so
that the edge is as stiff as it is at any length of the stretch. The compliance of both together stands in place of the
clamp.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

import numpy as np
from scipy.special import eval_gegenbauer, gammaln

from acquisition.arrays import BoolArray, FloatArray
from updating.effects.base import bending_stiffness
from updating.effects.box import gauss
from updating.models.edges import Kind, Trace, released_along, trace
from updating.models.fields import Sparse
from updating.models.reduced import Reduced
from updating.models.state import State
from updating.prediction.predict import Predictor

ORDER: dict[Kind, float] = {"rotation": 0.5, "translation": 1.5}
"""Order p of what a half-plane resists with [-]."""

FUNCTIONS = 8
"""Functions along a stretch [-]: with half as many a half edge on soft springs gives way less by 1 %."""

NODES = 12
"""Gauss points in each element of a stretch [-]: what is missed of the functions would hold the edge."""

CORNER = 0.05
"""What holds at a corner of the plate lets go over so much of the edge [-], an element of the mesh: where no more is
left of the clamp there, it holds less than the mesh can tell."""


@dataclass(frozen=True, eq=False)
class Edge:
    """A clamped edge on a basis.

    Parameters
    ----------
    trace : Trace
        The functions by which it moves.
    coefficients : (m, r) array
        Their coefficients in each column of the basis, sparse where that is all degrees of freedom.
    beyond : (r, r) array
        Integral of the square of what moves otherwise.
    corners : (2,) bool array
        Whether each end of it is at an edge that is free.
    """

    trace: Trace
    coefficients: FloatArray
    beyond: FloatArray
    corners: BoolArray


def on_a_stretch(
    predictor: Predictor, kind: Kind, edge: str, stretch: tuple[float, float], stiffness: float, rigid: float
) -> State:
    """Return the plate with a clamped edge on springs along a stretch, the rest of which holds.

    Parameters
    ----------
    predictor : Predictor
        The specimen.
    kind : {"rotation", "translation"}
        What the edge no longer holds there.
    edge : str
        Which edge.
    stretch : (low, high)
        From where to where along it [m].
    stiffness : float
        Of the springs per length [N or N/m^2].
    rigid : float
        Stiffness per length of what holds.
    """
    held = _edge(predictor.reduced, kind, edge)
    compliance = along(held, kind, bending_stiffness(predictor.spec), stretch, stiffness)
    springs = np.linalg.inv(compliance + np.eye(len(compliance)) / rigid)
    across = held.coefficients
    inner = Sparse(springs) if predictor.reduced.whole else springs
    matrix = across.T @ cast(FloatArray, inner) @ across + rigid * held.beyond
    return State(stiffness=(matrix,), released=frozenset({released_along(kind, edge)}))


def along(
    held: Edge, kind: Kind, bending: float, stretch: tuple[float, float], stiffness: float
) -> FloatArray:
    """Return the compliance of an edge between its functions, (m, m), springs along a stretch and nothing elsewhere.

    Where the clamp ends within an element of a free corner, it goes over to one that ends there.
    """
    low, high = stretch
    size, count = held.trace.size, held.trace.shapes.shape[1]
    gaps = np.array([low, size - high]) / (CORNER * size)
    holds = np.where(held.corners, np.clip(gaps, 0.0, 1.0) ** 2 * (3 - 2 * np.clip(gaps, 0.0, 1.0)), 1.0)
    total = np.zeros((count, count))
    for ends in ((False, False), (False, True), (True, False), (True, True)):
        share = float(np.prod(np.where(ends, holds, 1 - holds)))
        if share == 0 or high - low < 1e-9 * size:  # a stretch of no width gives way by nothing
            continue
        if any(ends):
            total += share * _compliance(held.trace, kind, bending, stretch, stiffness, ends)
        else:
            total += share / stiffness * np.eye(count)
    return total


def _compliance(
    one: Trace,
    kind: Kind,
    bending: float,
    stretch: tuple[float, float],
    stiffness: float,
    holds: tuple[bool, bool],
) -> FloatArray:
    """Return the compliance of a stretch that is held at one end or at both, (m, m).

    At an end that is not held the functions are those of a stretch twice as long, about the corner.
    """
    (low, high), order = stretch, ORDER[kind]
    low, high = (low if holds[0] else 0.0), (high if holds[1] else one.size)
    both = all(holds)
    middle, half = ((low + high) / 2, (high - low) / 2) if both else (low if holds[1] else high, high - low)
    places, weights = _nodes(one.lines - one.lines[0], low, high, holds)
    s = np.clip((places - middle) / half, -1.0, 1.0)
    number = np.arange(FUNCTIONS, dtype=float)
    shapes = ((1 - s) * (1 + s))[:, None] ** order * eval_gegenbauer(number, order + 0.5, s[:, None])
    own = shapes.T @ (weights[:, None] * shapes)
    there = one.at(places).T @ (weights[:, None] * shapes)
    missing = 1 - np.clip(np.einsum("ij,ij->j", there, there) / np.diag(own), 0.0, 1.0)
    resisted = 2 * bending * half ** (1 - 2 * order) * _resistance(order, number) * (1.0 if both else 0.5)
    springs = stiffness * own + np.diag(missing * resisted)
    return np.asarray(there @ np.linalg.solve(springs, there.T))


def _nodes(
    lines: FloatArray, low: float, high: float, holds: tuple[bool, bool]
) -> tuple[FloatArray, FloatArray]:
    """Return Gauss points on every element between two places, and their weights [m].

    Towards an end that holds they are those of the root of the distance to it, by which the functions go there.
    """
    cuts = np.concatenate([[low], lines[(lines > low) & (lines < high)], [high]])
    nodes, own = gauss(NODES)
    nodes, own = (nodes + 1) / 2, own / 2
    sizes = np.diff(cuts)
    places, weights = cuts[:-1, None] + nodes * sizes[:, None], own * sizes[:, None]
    if len(sizes) == 1 and all(holds):
        angle = nodes * np.pi
        return low + sizes[0] * (1 - np.cos(angle)) / 2, own * np.pi * np.sin(angle) * sizes[0] / 2
    if holds[0]:
        places[0], weights[0] = low + nodes**2 * sizes[0], 2 * nodes * own * sizes[0]
    if holds[1]:
        places[-1], weights[-1] = high - nodes**2 * sizes[-1], 2 * nodes * own * sizes[-1]
    return places.ravel(), weights.ravel()


def _resistance(order: float, number: FloatArray) -> FloatArray:
    """Return the work of each function against what the fractional Laplacian makes of it, on (-1, 1) [-]."""
    alpha = order + 0.5
    factor = gammaln(2 * order + number + 1) - gammaln(number + 1)
    norm = (
        np.log(np.pi)
        + (1 - 2 * alpha) * np.log(2)
        + gammaln(number + 2 * alpha)
        - gammaln(number + 1)
        - np.log(number + alpha)
        - 2 * gammaln(alpha)
    )
    return np.asarray(np.exp(factor + norm))


def _edge(reduced: Reduced, kind: Kind, edge: str) -> Edge:
    """Return a clamped edge on a basis, computed the first time it is asked for."""
    key = "clamped edge", kind, edge
    if key not in reduced.kept:
        structure = reduced.fielded
        one = trace(structure, released_along(kind, edge))
        across, square = one.coefficients()
        beyond = reduced.project(Sparse(square - across.T @ across))
        clamped = structure.spec.clamped
        corners = np.array([end not in clamped for end in (("y0", "y1") if edge[0] == "x" else ("x0", "x1"))])
        on_basis = across if reduced.whole else across @ reduced.basis
        reduced.kept[key] = Edge(one, cast(FloatArray, on_basis), beyond, corners)
    found: Edge = reduced.kept[key]
    return found
