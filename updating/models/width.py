"""What no theory of beams has: that a beam has a width across which it bends, too.

Poisson's ratio curves the section of a bent beam the other way. Where the wavelength is not long beside the width it
can do so only in part, and a clamp forbids it: both stiffen, the clamp as if the beam were shorter by nu^2 b sqrt((1 -
nu) / 6), some 0.03 of its width b (from the energy of a strip whose anticlastic curvature dies out towards the clamp).
A plate of the same outline includes both, and shows by how much. A real beam has all of it, a model of beams nothing:
so it is a doubt of the frequencies, one amount for all modes together.

On the middle line of the width a bent beam moves by nu b^2/24 w'' more than the mean over its section, on the edges by
twice that less: per cents of it, of a beam half as wide as the waves in it are long.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.models.base import Structure
from updating.models.build import build_structure
from updating.models.fields import Sparse
from updating.models.spec import Spec, Theory


@dataclass(frozen=True, eq=False)
class AcrossWidth:
    """What a plate of the outline of a beam has beyond it.

    Parameters
    ----------
    stiffening : (n_modes,) array
        ln(frequency of the plate / frequency of the beam) [-].
    shape : (n_points, n_modes) array
        The beam's shape [kg^-1/2].
    mean : (n_points, n_modes) array
        Mean shape over the width less the beam's [kg^-1/2].
    line : (n_points, n_modes) array
        Shape on the middle line less that mean [kg^-1/2].
    """

    stiffening: FloatArray
    shape: FloatArray
    mean: FloatArray
    line: FloatArray


def across_width(
    spec: Spec, order: IntArray, points: FloatArray, *, along: int = 40, across: int = 4
) -> AcrossWidth:
    """Return what a plate of a beam's outline has beyond it.

    Parameters
    ----------
    spec : Spec
        The model; its regions are left aside, its masses sit on the middle line.
    order : (n_modes,) int array
        Rank of each mode among the elastic modes.
    points : (n_points,) array
        Places along the beam [m].
    along : int
        Most elements along the plate: a clamp's hold on the section is resolved for beams wider than a thirtieth of
        their length. Doubled: twice the work for a note.
    across : int
        Elements across it: frequencies are good to a thousandth of the shift. Doubled: four times the work.

    Returns
    -------
    AcrossWidth
        All 0 where the model is no beam.
    """
    if spec.kind != "beam" or spec.material.poisson == 0:
        nothing = np.zeros((len(points), len(order)))
        return AcrossWidth(np.zeros(len(order)), nothing, nothing, nothing)
    count = int(order.max()) + 1
    cells = min(spec.elements[0], along)
    beam = replace(spec, elements=(cells,), regions=())
    masses = tuple(replace(one, at=(one.at[0], spec.width / 2)) for one in spec.masses)
    theory: Theory = "mindlin" if spec.theory == "timoshenko" else "kirchhoff"
    plate = replace(beam, kind="plate", elements=(cells, across), theory=theory, masses=masses)
    (own, of_beam), (found, of_plate) = _bending(beam, count, points), _bending(plate, count, points)
    shift, (shape, mean, line) = np.zeros(count), np.zeros((3, len(points), count))
    n = min(found.size, own.size)
    shift[:n] = np.log(found[:n] / own[:n])
    before, bent = of_beam[0, :, :n], of_plate[..., :n]
    bent = bent * np.where(np.sum(bent[-1] * before, axis=0) < 0, -1.0, 1.0)
    whole = np.einsum("l,lpm->pm", WEIGHTS, bent[:-1])
    shape[:, :n], mean[:, :n], line[:, :n] = before, whole - before, bent[-1] - whole
    return AcrossWidth(shift[order], shape[:, order], mean[:, order], line[:, order])


PLACES, WEIGHTS = (0.5 * one for one in np.polynomial.legendre.leggauss(6))
"""Lines across the width, shares of it from the middle, and their weights in the mean [-]."""


def _bending(
    spec: Spec, count: int, points: FloatArray, *, twist: float = 0.1
) -> tuple[FloatArray, FloatArray]:
    """Return the lowest frequencies of modes that move the middle line (count,) [rad/s], and shapes on lines.

    Those that move it by less than a share ``twist`` of what the liveliest does are twist. Doubled: a bending mode
    that the line's ends alone see may be missed. Shapes are (lines, n_points, count), the middle the last [kg^-1/2].
    """
    structure, omega, elastic = _elastic(spec, 3 * count + 4 if spec.kind == "plate" else count)
    ends = np.linspace(0.0, spec.length, 8 * count + 1)
    moved = np.abs(_on_line(structure, spec, ends, 0.0) @ elastic).max(axis=0)
    bending = np.flatnonzero(moved > twist * moved.max())[:count]
    lines = [_on_line(structure, spec, points, y) @ elastic[:, bending] for y in (*PLACES, 0.0)]
    return omega[bending], np.stack(lines)


@lru_cache(maxsize=4)  # frequencies and shapes are asked for one after the other
def _elastic(spec: Spec, count: int) -> tuple[Structure, FloatArray, FloatArray]:
    """Return a model, its lowest frequencies (count,) [rad/s] and their shapes (n_dofs, count)."""
    structure = build_structure(spec)
    first = structure.rigid_modes
    values, vectors = structure.eigen(first + count)
    return structure, np.sqrt(values[first:]), vectors[:, first:]


def _on_line(structure: Structure, spec: Spec, along: FloatArray, y: float) -> Sparse:
    """Return the rows of places on a line that is a share y of the width beside the middle, (n, n_dofs)."""
    points = np.stack([along, np.full_like(along, (0.5 + y) * spec.width)], axis=1)[:, : spec.dim]
    return structure.rows(points)["w"]
