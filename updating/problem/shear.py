"""What a section whose shear coefficient is not stated leaves in doubt.

A beam shears as k G A, where k follows from the form of the section: five sixths for a rectangle, nine tenths for a
rod, half for a thin tube, less for an I (Cowper, J. Appl. Mech. 33, 1966, 335). Area and second moment do not
determine it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.models.build import build_structure
from updating.models.parts import Region
from updating.models.spec import Spec
from updating.models.terms import shear_coefficient


def slackening(spec: Spec, order: IntArray) -> FloatArray:
    """Return by how much a section softer in shear than a rectangle lowers a beam's frequencies.

    Parameters
    ----------
    spec : Spec
        The model.
    order : (n_modes,) int array
        Rank of each mode among the elastic modes.

    Returns
    -------
    (n_modes,) array
        ln(frequency with softer sections / frequency); 0 where none is in doubt.
    """
    softer = tuple(_softer(region, spec.material.poisson) for region in spec.regions)
    if spec.kind != "beam" or spec.theory != "timoshenko" or softer == spec.regions:
        return np.zeros(len(order))
    count = int(order.max()) + 1
    here, there = (_lowest(one, count) for one in (spec, replace(spec, regions=softer)))
    return np.asarray(np.log(there / here)[order])


def _softer(region: Region, poisson: float, *, share: float = 0.6) -> Region:
    """Return a region softer in shear where it has a section of its own and no shear coefficient.

    Its coefficient is a ``share`` of a rectangle's, one standard deviation below it: a thin tube. Halved, an I: the
    doubt doubles.
    """
    if region.shear_coefficient is not None or (region.area is None and region.inertia is None):
        return region
    return replace(region, shear_coefficient=share * shear_coefficient(poisson))


def _lowest(spec: Spec, count: int) -> FloatArray:
    structure = build_structure(spec)
    first = structure.rigid_modes
    return np.asarray(np.sqrt(structure.eigen(first + count)[0][first:]))
