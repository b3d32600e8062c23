"""How far a reduced basis is off where parts of a structure change: residual forces, and what they would move."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.reduced import Reduced
from updating.models.state import State

CHANGED = 0.8
"""Factor on the stiffness of every second region for which a basis is judged [-]: a change that is found every day; of
0.5 the error is some four times larger, for it goes with the square."""


def reduction_error(reduced: Reduced, state: State, count: int) -> FloatArray:
    """Return by how much the lowest elastic frequencies of a reduced model are too high, (count,) [-].

    The residual forces of a mode, r = K phi - lambda M phi, move the structure by K0^-1 r; what that takes off lambda
    is their work, to first order in the change from the nominal K0.

    Parameters
    ----------
    reduced : Reduced
        The model.
    state : State
        Where; must add no matrices of the basis.
    count : int
        Number of modes.
    """
    structure = reduced.structure
    stiffness, mass = structure.matrices(state)
    values, vectors = reduced.eigen(state)
    chosen = slice(structure.rigid_modes, structure.rigid_modes + count)
    shapes = reduced.basis[:, : len(vectors)] @ vectors[:, chosen]
    residual = stiffness @ shapes - (mass @ shapes) * values[chosen]
    work = np.einsum("ij,ij->j", residual, structure.solve(residual, 0.0))
    return np.asarray(np.abs(work) / (2 * values[chosen]))


def every_second(reduced: Reduced) -> State:
    """Return the state in which every second region has :data:`CHANGED` of its stiffness."""
    regions = range(0, len(reduced.structure.spec.regions), 2)
    return State(regional={(i, "E"): CHANGED for i in regions})
