"""Bodies that the modeller states: what their masses and places change, of which neither is known to the last digit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.reduced import Reduced
from updating.models.spec import Spec


@dataclass(frozen=True, eq=False)
class BodyChange:
    """What one doubt in a body changes.

    Parameters
    ----------
    mass : (r, r) array
        Change of the mass matrix per unit: of the logarithm of the mass [kg in w], of its place [kg/m in w].
    of_place : bool
        Which of the two.
    """

    mass: FloatArray
    of_place: bool


def body_changes(reduced: Reduced, spec: Spec) -> dict[str, BodyChange]:
    """Return the change of the mass matrix per unit of the logarithm of each stated mass, and of its place.

    Parameters
    ----------
    reduced : Reduced
        The model.
    spec : Spec
        What it was made of, a beam or a plate; of imported matrices the bodies are as certain as the rest.

    Returns
    -------
    dict of str to BodyChange
        ``mass 1``, ``mass 1 x`` and, of plates, ``mass 1 y``; bodies in their order.
    """
    changes: dict[str, BodyChange] = {}
    for rank, body in enumerate(spec.masses if spec.outlined else (), start=1):
        rows = reduced.rows(np.array([body.at[: spec.dim]], dtype=float), None)
        moves, turns = rows["w"][0], {axis: rows[f"w{axis}"][0] for axis in "xy"[: spec.dim]}
        rotary = sum((np.outer(turn, turn) for turn in turns.values()), np.zeros((len(moves),) * 2))
        heavier = body.mass * np.outer(moves, moves) + body.inertia * rotary
        changes[f"mass {rank}"] = BodyChange(heavier, of_place=False)
        for axis, turn in turns.items():
            carried = body.mass * np.outer(moves, turn)
            changes[f"mass {rank} {axis}"] = BodyChange(carried + carried.T, of_place=True)
    return changes
