"""From which end points and bodies were measured, where no single clamp states it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from updating.models.spec import Spec
from updating.thresholds import END_REACH, REGISTRATION_SHARE


def registration_doubt(spec: Spec, tolerances: Mapping[str, float]) -> FloatArray:
    """Return the doubt in where all places lie along the model's axes, of beams one, of plates two [m].

    It is 0 where one end is clamped and they keep their distance from the other, and of imported models. Else it is not
    stated from which end they were measured: half of the doubt in the size.

    Parameters
    ----------
    spec : Spec
        The model.
    tolerances : mapping
        Relative standard deviations of the factors, by name [-].
    """
    if not spec.outlined:
        return np.zeros(1)
    sizes = {"length": spec.length} | ({"width": spec.width} if spec.kind == "plate" else {})
    doubts = [REGISTRATION_SHARE * tolerances.get(name, 0.0) * size for name, size in sizes.items()]
    ends = [len({edge for edge in spec.clamped if edge[0] == axis}) for axis in "xy"[: len(sizes)]]
    return np.where(np.array(ends) == 1, 0.0, np.array(doubts))


def with_registration(sigma: FloatArray, at: FloatArray, size: float, loose: float) -> FloatArray:
    """Return the doubt in places along one axis, those at an end as wide as the doubt in the size: [m].

    What was put at the end of the model was at the end of the specimen, wherever that is.

    Parameters
    ----------
    sigma, at : (n,) arrays
        Doubt in each place by itself, and where it is stated to be [m].
    size : float
        Size of the model along the axis [m].
    loose : float
        Doubt in where all places lie [m].
    """
    at_end: BoolArray = np.minimum(at, size - at) < END_REACH * size
    return np.where(at_end, np.hypot(sigma, 2 * loose), sigma)
