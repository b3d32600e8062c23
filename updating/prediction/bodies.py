"""Bodies that the modeller states: what their masses and places change, of which neither is known to the last digit."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.reduced import Reduced
from updating.models.spec import Spec


def body_changes(reduced: Reduced, spec: Spec) -> dict[str, FloatArray]:
    """Return the change of the mass matrix per unit of the logarithm of each stated mass, and of its place.

    Parameters
    ----------
    reduced : Reduced
        The model.
    spec : Spec
        What it was made of, a beam or a plate; of imported matrices the bodies are as certain as the rest.

    Returns
    -------
    dict of str to (r, r) array
        ``mass 1`` [kg in w], ``mass 1 x`` and, of plates, ``mass 1 y`` [kg/m in w]; bodies in their order.
    """
    changes: dict[str, FloatArray] = {}
    for rank, body in enumerate(spec.masses if spec.outlined else (), start=1):
        rows = reduced.rows(np.array([body.at[: spec.dim]], dtype=float), None)
        moves, turns = rows["w"][0], {axis: rows[f"w{axis}"][0] for axis in "xy"[: spec.dim]}
        rotary = sum((np.outer(turn, turn) for turn in turns.values()), np.zeros((len(moves),) * 2))
        changes[f"mass {rank}"] = body.mass * np.outer(moves, moves) + body.inertia * rotary
        for axis, turn in turns.items():
            carried = body.mass * np.outer(moves, turn)
            changes[f"mass {rank} {axis}"] = carried + carried.T
    return changes
