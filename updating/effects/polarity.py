"""Signs of points the wrong way round."""

from __future__ import annotations

import numpy as np

from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.obstacles import shape_obstacle
from updating.effects.points import indices, places
from updating.effects.shape_look import PROMISING, ShapeLook
from updating.models.state import Role, State
from updating.prediction import Predictor
from updating.reading import roving

MANY = 4
"""At most so many points of one test are reversed."""


class Polarity(Effect):
    """Some points' signs are reversed: hit from the other side, or a sensor upside down."""

    name = "polarity"
    channel = "measurement"
    summary = "Some points are reversed in sign: hit from the other side, or a sensor mounted upside down."
    footprint = "The points' constants change sign in all modes; frequencies and damping unchanged."
    models = ("beam", "plate", "matrices")
    equivalent_to = ("swapped_points",)
    separated_by = "look at the sign of the drive point FRF and of the points' hits again"
    labels = ("points",)

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return nothing to search: which points it is, the variant says."""
        return ()

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need shapes at several points."""
        return shape_obstacle(predictor.measured, 3)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the sets of points whose reversal brings the shapes nearest to the model's."""
        role = roving(predictor.measured)
        found = ShapeLook(predictor)
        points = found.points(role)
        chosen: list[int] = []
        variants = []
        share = 1.0
        for _ in range(min(MANY, max(len(points) // 2, 1))):
            left = [p for p in points if p not in chosen]
            misfits = [found.misfit({(role, p): -1.0 for p in (*chosen, q)}) for q in left]
            best = int(np.argmin(misfits))
            chosen.append(left[best])
            share *= (
                0.5 / len(left) * len(chosen)
            )  # one of the sets of this many points, and fewer are likelier
            variants.append(self._variant(predictor, role, chosen, share))
            if len(chosen) == 1:
                others = np.argsort(misfits)[1:PROMISING]
                variants += [self._variant(predictor, role, [left[i]], share) for i in others]
        other = "seen" if role == "hit" else "hit"
        if len(found.points(other)) > 1:
            variants += [self._variant(predictor, other, [p], 0.1) for p in found.points(other)[:PROMISING]]
        return tuple(variants)

    def _variant(self, predictor: Predictor, role: str, points: list[int], weight: float) -> Variant:
        return Variant({"points": tuple(predictor.measured.nodes[p] for p in points), "role": role}, weight)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the points reversed."""
        role = values.get("role") or roving(predictor.measured)
        roles: list[Role] = [(role, p) for p in indices(predictor.measured, values["points"])]
        return State(point_gains=dict.fromkeys(roles, -1.0))

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return the points."""
        return places(predictor.measured, values["points"])
