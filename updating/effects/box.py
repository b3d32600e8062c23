"""A stretch of a beam or a rectangle of a plate, as shares at the quadrature points."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import cache
from itertools import product

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.effects.base import EDGES, Parameter, Values
from updating.models.reduced import Reduced
from updating.models.spec import Spec
from updating.models.structure import FieldStructure
from updating.prediction.predict import Predictor

Place = tuple[float, float, float]

AXES = ("x", "y", "z")
"""Names of the coordinates of a place."""

CELLS = 200
"""So many cells a plate is divided into at most, by elements, where boxes are summed up from cells."""

SOFT = 1 / 16
"""Width of the edges of a place softer or stiffer, relative to its extents [-]: at its best a sharp one is off by 0.006
of the shift, a smooth one by 0.013; doubled, by 0.017 and 0.010."""

DENSE = {"beam": 24, "plate": 12}
"""Gauss points along each side of a box: enough for the square of a shape of a dozen half waves [-]."""

EXACT = 4
"""Gauss points along a part of an element: exact for the square of a cubic [-]."""

SHARP = 1 / 3
"""Width of the edges of anything relative to an element: what the quadrature still resolves [-]."""

LIKE = 1e-6
"""So near to each other, relative to the size, two places are one [-]."""


def shares(structure: FieldStructure, values: Values, *, soft: float = 0.0) -> FloatArray:
    """Return how far every quadrature point lies inside a box about ``x`` (and ``y``), shape (n_points,) [-].

    Parameters
    ----------
    structure : FieldStructure
        The beam or plate with its mesh.
    values : mapping
        ``x``, for plates ``y``, and ``extent``: the length of the stretch, or of the rectangle along x; along y that
        is ``extent_y``, or as long [m].
    soft : float
        Width of the edges relative to the extents, at least what the mesh resolves [-].
    """
    points, spec = structure.fields.points, structure.spec
    dim = points.shape[1]
    centre = np.array([values[name] for name in ("x", "y")[:dim]])
    spacing = np.array([spec.length, spec.width])[:dim] / np.array(spec.elements)
    size = np.array(extents(values)[:dim])
    return _inside(points - centre, size, np.maximum(size * soft, SHARP * spacing))


def _inside(away: FloatArray, size: FloatArray, edge: FloatArray) -> FloatArray:
    """Return how far places (n, dim), relative to its centre, lie inside a box with soft edges, (n,) [-]."""
    inside = np.prod(0.5 * (1 + np.tanh((size / 2 - np.abs(away)) / edge)), axis=1)
    return np.where(inside > 1e-4, inside, 0.0)


def along_beam(spec: Spec, values: Values, *, soft: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return points of a stretch of a beam, the lengths they stand for [m], and how far they lie inside it, (n,) each.

    The edges of the stretch, ``soft`` of its extent wide [-], are resolved whatever the mesh.
    """
    centre, size = float(values["x"]), float(values["extent"])
    edge = size * soft
    ends = np.array([[-1.0], [1.0]]) * size / 2 + edge * np.linspace(-5.0, 5.0, 11)
    nodes = np.linspace(0.0, spec.length, spec.elements[0] + 1)
    low, high = np.clip(centre + np.array([ends.min(), ends.max()]), 0.0, spec.length)
    cuts = np.unique(np.clip(np.concatenate([centre + ends.ravel(), nodes]), low, high))
    at, own = gauss(EXACT)
    middle, half = (cuts[1:] + cuts[:-1]) / 2, np.diff(cuts) / 2
    points, lengths = (middle[:, None] + at * half[:, None]).ravel(), (own * half[:, None]).ravel()
    return points, lengths, _inside(points[:, None] - centre, np.array([size]), np.array([edge]))


def extents(values: Values) -> tuple[float, float]:
    """Return how far a box reaches along x and along y, as far where that is not stated [m]."""
    along = float(values["extent"])
    return along, float(values.get("extent_y", along))


def outline(predictor: Predictor) -> tuple[Parameter, ...]:
    """Return the coordinates of a place with the structure's outline as their range."""
    spec: Spec = predictor.spec
    if spec.kind != "matrices":
        sides: Sequence[tuple[float, float]] = ((0.0, spec.length), (0.0, spec.width))[: spec.dim]
    else:
        assert spec.imported is not None
        low, high = spec.imported.extents
        sides = [(a, max(b, a + 1e-9)) for a, b in zip(low.tolist(), high.tolist(), strict=True)]
    why = ("anywhere along the structure", "anywhere across the structure", "at any height of the structure")
    return tuple(
        Parameter(n, "m", *side, w, natural=EDGES) for n, side, w in zip(AXES, sides, why, strict=False)
    )


def extent_parameters(
    spec: Spec, low: float, high: float, why: str, *, natural: tuple[str, ...] = ()
) -> list[Parameter]:
    """Return the extents of a box, each between two shares of its side of the structure.

    Parameters
    ----------
    spec : Spec
        Of a beam or a plate.
    low, high : float
        Shares [-].
    why : str
        Why these.
    natural : tuple of {"low", "high"}
        Ends that are no judgement.
    """
    found = [Parameter("extent", "m", low * spec.length, high * spec.length, why, log=True, natural=natural)]
    if spec.kind == "plate":
        across = (low * spec.width, high * spec.width)
        found.append(Parameter("extent_y", "m", *across, why, log=True, natural=natural, like="extent"))
    return found


def spread(spec: Spec, values: Values, *, by_elements: bool = False) -> tuple[FloatArray, FloatArray]:
    """Return Gauss points all over a box with sharp edges, what sticks out cut off, and what each stands for.

    Parameters
    ----------
    spec : Spec
        Of a beam or a plate.
    values : mapping
        As of :func:`shares`.
    by_elements : bool
        Whether what is cubic in every element is integrated exactly, as what is taken away from the model must be.

    Returns
    -------
    points : (n, dim) array
        [m].
    weights : (n,) array
        Lengths of a beam [m], areas of a plate [m^2].
    """
    lines, weights = [], []
    sides = (("x", spec.length), ("y", spec.width))[: spec.dim]
    for (name, size), extent in zip(sides, extents(values), strict=False):
        low, high = (min(max(values[name] + side * extent / 2, 0.0), size) for side in (-1, 1))
        cuts = np.linspace(0.0, size, spec.elements["xy".index(name)] + 1)
        inner = cuts[(cuts > low) & (cuts < high)] if by_elements else cuts[:0]
        edges = np.concatenate([[low], inner, [high]])
        nodes, own = gauss(EXACT if by_elements else DENSE[spec.kind])
        middle, half = (edges[1:] + edges[:-1]) / 2, np.diff(edges) / 2
        lines.append((middle[:, None] + nodes * half[:, None]).ravel())
        weights.append((own * half[:, None]).ravel())
    return np.array(list(product(*lines))), np.prod(list(product(*weights)), axis=1)


gauss = cache(np.polynomial.legendre.leggauss)
"""Gauss's nodes and weights, kept: every box asks for the same."""


def covered(predictor: Predictor, kind: str, inside: FloatArray) -> FloatArray:
    """Return stiffness or mass of the bare structure in a box, on the reduced basis, shape (r, r) [SI].

    On plates from matrices of some hundred cells, kept once for all boxes: a cell that an edge cuts counts with its
    mean share.

    Parameters
    ----------
    predictor : Predictor
        The specimen.
    kind : {"stiffness", "mass"}
        Which matrix.
    inside : (n_points,) array
        Shares at the quadrature points, of :func:`shares` [-].
    """
    reduced, factors = predictor.reduced, predictor.base.factors
    if predictor.spec.kind == "beam" or reduced.whole:
        return reduced.weighted(kind, inside, factors)
    cell, size = _cells(reduced, predictor.spec)
    chosen = np.flatnonzero(inside)
    share = np.bincount(cell[chosen], reduced.fields.weights[chosen] * inside[chosen], len(size)) / size
    key = (f"{kind} of cells", *sorted(factors.items()))
    if key not in reduced.kept:
        reduced.kept[key] = _cell_matrices(predictor, kind, cell)
    chosen = np.flatnonzero(share)
    return np.asarray(np.tensordot(share[chosen], reduced.kept[key][chosen], axes=1))


def _cells(reduced: Reduced, spec: Spec) -> tuple[IntArray, FloatArray]:
    """Return the cell in which each quadrature point lies (n_points,), and the cells' areas (n_cells,) [m^2]."""
    if "cells" not in reduced.kept:
        groups = max(1, math.ceil(math.sqrt(math.prod(spec.elements) / CELLS)))
        counts = [math.ceil(n / groups) for n in spec.elements]
        sides = np.array([spec.length, spec.width]) / np.array(spec.elements) * groups
        index = np.minimum((reduced.fields.points / sides).astype(int), np.array(counts) - 1)
        cell = index[:, 0] * counts[1] + index[:, 1]
        reduced.kept["cells"] = cell, np.bincount(cell, reduced.fields.weights)
    found: tuple[IntArray, FloatArray] = reduced.kept["cells"]
    return found


def _cell_matrices(predictor: Predictor, kind: str, cell: IntArray) -> FloatArray:
    """Return stiffness or mass of every cell, (n_cells, r, r) [SI]."""
    weights = [(cell == index).astype(float) for index in range(int(cell.max()) + 1)]
    return np.stack([predictor.reduced.weighted(kind, inside, predictor.base.factors) for inside in weights])


def place(values: Values) -> Place:
    """Return the middle of the box in model axes [m]."""
    return (float(values["x"]), float(values.get("y", 0.0)), 0.0)


def starting_places(spec: Spec, *, along: int = 8) -> tuple[tuple[float, ...], ...]:
    """Return prior quantiles of the place from which a search starts: a row of beams, a grid of 4 x 2 on plates."""
    if spec.kind == "beam":
        return tuple((float(u),) for u in (np.arange(along) + 0.5) / along)
    return tuple((float(u), v) for u in (np.arange(8)[::2] + 0.5) / 8 for v in (0.2, 0.8))


def mirror_images(spec: Spec, at: Place) -> tuple[Place, ...]:
    """Return a place and its images where the model is its own mirror image, each once [m].

    What sits at one of them shifts all frequencies, and damps all modes, as at any other: only shapes separate them.
    """
    size = (spec.length, spec.width)
    flips = [(False, True) if _symmetric(spec, axis) else (False,) for axis in range(min(spec.dim, 2))]
    found: list[Place] = []
    for flip in product(*flips):
        x, y = (size[i] - at[i] if i < len(flip) and flip[i] else at[i] for i in range(2))
        if all(abs(x - p[0]) + abs(y - p[1]) > LIKE * spec.length for p in found):
            found.append((x, y, at[2]))
    return tuple(found)


def where_alike(predictor: Predictor, at: Place) -> tuple[Place, ...]:
    """Return a place; where no shapes separate it from its mirror images, these too [m]."""
    return (at,) if predictor.measured.has_shapes else mirror_images(predictor.spec, at)


def as_places(points: FloatArray) -> tuple[Place, ...]:
    """Return points (n, dim) with as many of the coordinates as the model has as places; the others are 0 [m]."""
    padded = np.hstack([points, np.zeros((len(points), 3 - points.shape[1]))])
    return tuple((float(x), float(y), float(z)) for x, y, z in padded)


def _symmetric(spec: Spec, axis: int) -> bool:
    """Return whether supports, masses and regions are their own mirror image along an axis."""
    if not spec.outlined:
        return False
    names = ("x0", "x1") if axis == 0 else ("y0", "y1")
    if len({name in spec.clamped for name in names}) > 1:
        return False
    size = spec.length if axis == 0 else spec.width
    bodies = {(_rounded(m.at, spec), m.mass, m.inertia) for m in spec.masses if m.mass > 0}
    turned = {
        (_rounded([size - c if i == axis else c for i, c in enumerate(m.at)], spec), m.mass, m.inertia)
        for m in spec.masses
        if m.mass > 0
    }
    own = ("E", "density", "thickness", "area", "inertia", "alpha", "beta", "loss_factor")
    plain = all(getattr(region, name) is None for region in spec.regions for name in own)
    return plain and bodies == turned


def _rounded(at: list[float] | tuple[float, ...], spec: Spec) -> tuple[int, ...]:
    return tuple(round(c / (LIKE * spec.length)) for c in at)
