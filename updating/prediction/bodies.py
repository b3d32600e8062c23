"""Bodies that the modeller states: what their masses and places change, of which neither is known to the last digit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.models.parts import PointMass
from updating.models.reduced import Reduced
from updating.models.spec import Spec


@dataclass(frozen=True, eq=False)
class BodyChange:
    """What one doubt in a body changes.

    Parameters
    ----------
    mass : (r, r) array
        Change of the mass matrix per unit: of the logarithm of the mass [kg in w], of its place [kg/m in w].
    axis : int, optional
        Along which of the model's axes its place is in doubt; None of the mass.
    at : float
        Where it is stated to be along that axis [m].
    """

    mass: FloatArray
    axis: int | None = None
    at: float = 0.0

    @property
    def of_place(self) -> bool:
        """Whether the doubt is in the place."""
        return self.axis is not None


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
        moves, turns = _motion(reduced, spec, body.at[: spec.dim])
        changes[f"mass {rank}"] = BodyChange(_inertia(body, moves, turns))
        for axis, (name, turn) in enumerate(turns.items()):
            carried = body.mass * np.outer(moves, turn)
            changes[f"mass {rank} {name}"] = BodyChange(carried + carried.T, axis, float(body.at[axis]))
    return changes


def displaced(
    reduced: Reduced, spec: Spec, bodies: Mapping[str, BodyChange], by: Mapping[str, float]
) -> tuple[FloatArray, ...]:
    """Return what the mass matrix gains where bodies are heavier and elsewhere, (r, r) each [kg in w].

    Parameters
    ----------
    reduced, spec
        As in :func:`body_changes`.
    bodies : mapping of str to BodyChange
        What that returns.
    by : mapping of str to float
        Change of the logarithm of each mass [-] and of its place [m], by the names of :func:`body_changes`; a place
        stays on the structure.
    """
    gains = []
    for rank, body in enumerate(spec.masses if spec.outlined else (), start=1):
        axes = "xy"[: spec.dim]
        step = np.array([by.get(f"mass {rank} {axis}", 0.0) for axis in axes])
        factor = float(np.exp(by.get(f"mass {rank}", 0.0)))
        if factor == 1.0 and not step.any():
            continue
        at = np.array(body.at[: spec.dim], dtype=float)
        size = np.array([spec.length, spec.width][: spec.dim])
        there = np.clip(at + step, np.minimum(at, 0.0), np.maximum(at, size))
        before = bodies[f"mass {rank}"].mass
        after = _inertia(body, *_motion(reduced, spec, there)) if step.any() else before
        gains.append(factor * after - before)
    return tuple(gains)


def _motion(
    reduced: Reduced, spec: Spec, at: FloatArray | Sequence[float]
) -> tuple[FloatArray, dict[str, FloatArray]]:
    """Return displacement (r,) and slope along each axis (r,) of the basis at a place."""
    rows = reduced.rows(np.array([at], dtype=float), None)
    return rows["w"][0], {axis: rows[f"w{axis}"][0] for axis in "xy"[: spec.dim]}


def _inertia(body: PointMass, moves: FloatArray, turns: Mapping[str, FloatArray]) -> FloatArray:
    """Return the mass matrix of a body, its rotary inertia included, (r, r) [kg in w]."""
    rows = np.stack([moves, *turns.values()])
    weights = np.array([body.mass, *(body.inertia for _ in turns)])
    return np.asarray((rows.T * weights) @ rows)
