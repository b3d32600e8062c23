"""A point that lies elsewhere than stated."""

from __future__ import annotations

import numpy as np

from updating.effects.base import EDGES, Effect, Parameter, Values, Variant
from updating.effects.measurement.points import indices, places, points_of
from updating.effects.measurement.shape_screening import PROMISING, screen
from updating.effects.mechanism import Size
from updating.effects.obstacles import Obstacle, shape_obstacle
from updating.models.state import State
from updating.prediction.predict import Predictor

FARTHEST = 0.15
"""How far from its stated place a point is sought, of the length [-]."""


class PositionError(Effect):
    """One point lies elsewhere than stated."""

    name = "position_error"
    channel = "measurement"
    summary = "One point was hit (or its sensor mounted) elsewhere than stated."
    footprint = (
        "The constants of one point change in proportion to the slope of the shapes there; frequencies and damping do "
        "not change."
    )
    models = ("beam", "plate")
    equivalent_to = ("swapped_points", "channel_gain")
    repeats = True
    separated_by = "measure the point's place and hit it again"
    labels = ("point",)
    phrase = "a misplaced test point"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return how far it lies from where it was stated."""
        far = FARTHEST * predictor.spec.length
        why = "from the error of a tape measure to the spacing of a coarse grid"
        axes = ("dx", "dy")[: predictor.spec.dim]
        return tuple(Parameter(name, "m", -far, far, why, natural=EDGES) for name in axes)

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start on either side of where it was stated."""
        if predictor.spec.dim == 1:
            return ((0.4,), (0.6,))
        return ((0.4, 0.5), (0.6, 0.5), (0.5, 0.4), (0.5, 0.6))

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need shapes at several points."""
        return shape_obstacle(predictor.measured, 4)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the points that spoil the agreement of the shapes most."""
        test = predictor.measured
        role = test.roving
        found = screen(predictor)
        points = points_of(test, role)
        worst = np.argsort([found.without(role, p) for p in points])[:PROMISING]
        return tuple(Variant({"point": test.nodes[points[i]]}, 1.0 / len(points)) for i in worst)

    def settled(self, predictor: Predictor, values: Values) -> Values:
        """Return how far the point lies away, its range cut off where the structure ends."""
        (at,), spec = places(predictor.measured, (values["point"],)), predictor.spec
        settled, sizes = dict(values), (spec.length, spec.width)[: spec.dim]
        for name, stated, size in zip(("dx", "dy"), at, sizes, strict=False):
            far = FARTHEST * spec.length
            low, high = max(-far, -stated), min(far, size - stated)
            settled[name] = low + (high - low) * (values[name] + far) / (2 * far)
        return settled

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return how far the point lies away."""
        return (Size("distance", float(np.hypot(values["dx"], values.get("dy", 0.0))), "m"),)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the point moved."""
        test = predictor.measured
        (point,) = indices(test, (values["point"],))
        away = tuple(values.get(name, 0.0) for name in ("dx", "dy")[: predictor.spec.dim])
        return State(moved={(test.roving, point): away})

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return where the point really was."""
        ((x, y, z),) = places(predictor.measured, (values["point"],))
        return ((x + values["dx"], y + values.get("dy", 0.0), z),)
