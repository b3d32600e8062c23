"""Where the regions of a model are."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.spec import Spec
from updating.problem.specimen import SpecimenProblem


def boxes(spec: Spec) -> FloatArray:
    """Return the limits of each region, (n_regions, 3, 2) in model axes; nan where they are not known [m].

    A beam has no extent along y; the regions of imported matrices are the boxes of the nodes they touch.
    """
    found = np.zeros((len(spec.regions), 3, 2))
    for i, region in enumerate(spec.regions):
        if spec.imported is not None:
            box = spec.imported.box(i)
            found[i] = np.nan if box is None else np.stack(box, axis=1)
            continue
        found[i, 0] = region.x
        if spec.kind == "plate":
            found[i, 1] = (0.0, spec.width) if region.y is None else region.y
    return found


def centres(problem: SpecimenProblem) -> FloatArray:
    """Return the centre of each region, (n_regions, 3); that of the whole where its own is not known [m]."""
    limits = boxes(problem.predictor.spec)
    middle = limits.mean(axis=2)
    unknown = ~np.isfinite(middle).all(axis=1)
    if unknown.any():
        imported = problem.predictor.spec.imported
        middle[unknown] = 0.0 if imported is None else np.mean(imported.extents, axis=0)
    return np.asarray(middle)


def regions_at(spec: Spec, places: FloatArray) -> FloatArray:
    """Return how each place is shared among the regions that hold it, or are nearest to it.

    Parameters
    ----------
    spec : Spec
        The model.
    places : (n, 3) array
        Places in model axes [m].

    Returns
    -------
    (n, n_regions) array
        Each row sums to 1 [-].
    """
    limits = boxes(spec)
    limits = np.where(np.isfinite(limits), limits, 1e30)
    below = limits[None, :, :, 0] - places[:, None, :]
    above = places[:, None, :] - limits[None, :, :, 1]
    away = np.maximum(np.maximum(below, above), 0.0)
    away[:, :, spec.dim :] = 0.0
    distance = np.linalg.norm(away, axis=2)
    scale = max(spec.length, spec.width, spec.thickness)
    nearest = distance <= distance.min(axis=1, keepdims=True) + 1e-9 * scale
    return np.asarray(nearest / nearest.sum(axis=1, keepdims=True))
