"""The poles and residues that a synthetic hammer test of a model needs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition import Dof, ModalSystem
from acquisition.arrays import FloatArray, IntArray
from updating.simulation.model import Simulated
from updating.simulation.poles import damped_modes


def modal_system(
    model: Simulated,
    *,
    seen: IntArray,
    hit: IntArray,
    responses: Sequence[Dof],
    points: Sequence[Dof],
    signs: FloatArray | None = None,
) -> ModalSystem:
    """Return all poles of a model with their residues between points, modes far above any band included.

    The model's gain and unknown window belong to the measurement and are not in it.

    Parameters
    ----------
    model : Simulated
        A clamped or hung structure.
    seen : (n_responses,) int array
        Rows of the points that are observed.
    hit : (n_points,) int array
        Rows of the points that are hit.
    responses, points : sequences of Dof
        What these are called in the test.
    signs : (n_responses, n_points) array, optional
        +1 or -1: whether transducer and hammer point along the model's rows or one against the other [-].
    """
    modes = damped_modes(model)
    left, right = model.rows[seen] @ modes.vectors, model.rows[hit] @ modes.vectors
    turned = np.ones((len(seen), len(hit))) if signs is None else np.asarray(signs, dtype=float)
    tilts = np.zeros((2, len(hit), len(modes.poles)), dtype=complex)
    tilts[: len(model.slopes)] = model.slopes[:, hit] @ modes.vectors
    return ModalSystem(
        poles=modes.poles,
        residues=turned[:, :, None] * left[:, None] * right[None],
        responses=tuple(responses),
        points=tuple(points),
        gradients=turned[None, :, :, None] * left[None, :, None] * tilts[:, None],
    )
