"""Signs of points the wrong way round."""

from __future__ import annotations

import numpy as np

from updating.effects.base import Effect, Parameter, Values, Variant
from updating.effects.measurement.points import channel_of, concerned, concerned_places, points_of
from updating.effects.measurement.shape_screening import PROMISING, screen
from updating.effects.obstacles import Obstacle, shape_obstacle
from updating.models.state import State
from updating.prediction.predict import Predictor

MANY = 4
"""At most so many points of one test are reversed."""

FEWER = 0.5
"""Prior probability that no more points are reversed than so far [-]."""

OTHER_END = 0.2
"""Prior probability that it is one of the points at the end that stayed [-]."""


class Polarity(Effect):
    """Some points' signs are reversed: hit from the other side, or a sensor upside down."""

    name = "polarity"
    channel = "measurement"
    summary = "Some points are reversed in sign: hit from the other side, or a sensor mounted upside down."
    footprint = (
        "The constants of the points, or of a fixed sensor, change sign in all modes; nothing else changes."
    )
    models = ("beam", "plate", "matrices")
    equivalent_to = ("swapped_points",)
    separated_by = "check the sign of the drive point FRF, and hit the points again"
    labels = ("points",)
    phrase = "a transducer of wrong polarity"
    of_sensor = True

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return nothing to search: the variant states which points it is."""
        return ()

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need shapes at several points."""
        return shape_obstacle(predictor.measured, 3)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the sets of points whose reversal brings the shapes nearest to the model's."""
        role = predictor.measured.roving
        found = screen(predictor)
        points = points_of(predictor.measured, role)
        chosen: list[int] = []
        variants: list[Variant] = []
        share = 1.0
        for count in range(1, min(MANY, max(len(points) // 2, 1)) + 1):
            left = [p for p in points if p not in chosen]
            misfits = [found.misfit({(role, p): -1.0 for p in (*chosen, q)}) for q in left]
            order = np.argsort(misfits)
            share *= FEWER * count / len(left)  # one of the sets of so many points
            near = order[: PROMISING if count == 1 else 1]
            variants += [self._variant(predictor, [*chosen, left[i]], share) for i in near]
            chosen.append(left[order[0]])
        return (*variants, *self._fixed(predictor, "seen" if role == "hit" else "hit"))

    def _fixed(self, predictor: Predictor, role: str) -> list[Variant]:
        """Return each of the points of the end that stayed; of a shape without forces the sign is free."""
        test = predictor.measured
        points = points_of(test, role)
        if test.bare:
            return []
        return [Variant({"channel": channel_of(test, p)}, OTHER_END / len(points)) for p in points]

    def _variant(self, predictor: Predictor, points: list[int], weight: float) -> Variant:
        return Variant({"points": tuple(predictor.measured.nodes[p] for p in points)}, weight)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the points of the end that roved reversed, or the sensor that stayed."""
        return State(point_gains=dict.fromkeys(concerned(predictor.measured, values), -1.0))

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return the points, or where the sensor sits."""
        return concerned_places(predictor.measured, values)

    def sentence(self, values: Values) -> str:
        """State whether it is a fixed sensor or points of the end that roved."""
        if "channel" in values:
            return (
                f"The sensor {values['channel']} is reversed in sign, whichever point is hit: it is mounted upside "
                "down, or its sign is set wrongly (with a single sensor, possibly that of the hammer)."
            )
        return "Some points are reversed in sign: hit from the other side, or a roving sensor mounted upside down."
