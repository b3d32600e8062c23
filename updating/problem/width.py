"""What no theory of beams has: that a beam has a width across which it bends, too.

Poisson's ratio curves the section of a bent beam the other way. Where the wavelength is not long beside the width it
can do so only in part, and a clamp forbids it: both stiffen, the clamp as if the beam were shorter by nu^2 b sqrt((1 -
nu) / 6), some 0.03 of its width b (from the energy of a strip whose anticlastic curvature dies out towards the clamp).
A plate of the same outline includes both, and shows by how much. A real beam has all of it, a model of beams nothing:
so it is a doubt of the frequencies, one amount for all modes together.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.models.build import build_structure
from updating.models.spec import Spec, Theory


def stiffening(spec: Spec, order: IntArray, *, along: int = 40, across: int = 4) -> FloatArray:
    """Return by how much bending across the width raises a beam's frequencies.

    Parameters
    ----------
    spec : Spec
        The model; its regions and masses are left aside.
    order : (n_modes,) int array
        Rank of each mode among the elastic modes.
    along : int
        Most elements along the plate: a clamp's hold on the section is resolved for beams wider than a thirtieth of
        their length. Doubled: twice the work for a note.
    across : int
        Elements across it: frequencies are good to a thousandth of the shift. Doubled: four times the work.

    Returns
    -------
    (n_modes,) array
        ln(frequency of the plate / frequency of the beam); 0 where the model is no beam.
    """
    if spec.kind != "beam" or spec.material.poisson == 0:
        return np.zeros(len(order))
    count = int(order.max()) + 1
    cells = min(spec.elements[0], along)
    beam = replace(spec, elements=(cells,), regions=(), masses=())
    theory: Theory = "mindlin" if spec.theory == "timoshenko" else "kirchhoff"
    plate = replace(beam, kind="plate", elements=(cells, across), theory=theory, regions=())
    found, own = _bending(plate, count), _bending(beam, count)
    shift = np.zeros(count)
    shift[: len(found)] = np.log(found / own[: len(found)])
    return np.asarray(shift[order])


def _bending(spec: Spec, count: int, *, twist: float = 0.1) -> FloatArray:
    """Return the lowest frequencies of modes that move the middle line (count,) [rad/s].

    Those that move it by less than a share ``twist`` of what the liveliest does are twist. Doubled: a bending mode
    that the line's ends alone see may be missed.
    """
    structure = build_structure(spec)
    first = structure.rigid_modes
    values, vectors = structure.eigen(first + (3 * count + 4 if spec.kind == "plate" else count))
    line = np.linspace(0.0, spec.length, 8 * count + 1)
    points = np.stack([line, np.full_like(line, spec.width / 2)], axis=1)[:, : spec.dim]
    moved = np.abs(structure.rows(points)["w"] @ vectors[:, first:]).max(axis=0)
    return np.asarray(np.sqrt(values[first:][moved > twist * moved.max()][:count]))
