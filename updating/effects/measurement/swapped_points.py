"""Points whose labels were exchanged."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.measurement.points import indices, places, points_of
from updating.effects.measurement.shape_screening import PROMISING, screen
from updating.effects.obstacles import Obstacle, shape_obstacle
from updating.models.state import State
from updating.prediction.predict import Predictor


class SwappedPoints(Effect):
    """Two points' labels are exchanged."""

    name = "swapped_points"
    channel = "measurement"
    summary = "The labels of two points are exchanged."
    footprint = (
        "The constants of two points are exchanged in all modes; frequencies and damping do not change."
    )
    models = ("beam", "plate", "matrices")
    equivalent_to = ("polarity", "position_error")
    separated_by = "hit the two points again"
    labels = ("points",)
    exchanges = True
    phrase = "swapped test points"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return nothing to search: the variant states which points it is."""
        return ()

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need shapes at several points."""
        return shape_obstacle(predictor.measured, 3)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the pairs whose exchange brings the shapes nearest to the model's."""
        test = predictor.measured
        role = test.roving
        found = screen(predictor)
        pairs = list(combinations(points_of(test, role), 2))
        misfits = [found.misfit({}, ((role, a, b),)) for a, b in pairs]
        best = np.argsort(misfits)[:PROMISING]
        return tuple(
            Variant({"points": (test.nodes[pairs[i][0]], test.nodes[pairs[i][1]])}, 1.0 / len(pairs))
            for i in best
        )

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the two labels exchanged."""
        a, b = indices(predictor.measured, values["points"])
        return State(exchanged=((predictor.measured.roving, a, b),))

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return the points."""
        return places(predictor.measured, values["points"])
