"""Effects of the measurement itself: the structure is as modelled, the data are not as believed."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.effects.base import Effect, Parameter, Values, Variant
from updating.matching import match
from updating.measured import Measured
from updating.models.state import Role, State
from updating.prediction import Predictor
from updating.reading import reading

EVERYTHING = ("beam", "plate", "matrices")

PROMISING = 3
"""How many points, or pairs of points, a look at the shapes passes on to be weighed."""

MANY = 4
"""At most so many points of one test are reversed."""


class ExponentialWindow(Effect):
    """An exponential window was applied and not taken out of the damping."""

    name = "exponential_window"
    channel = "measurement"
    summary = "An exponential window is still in the damping: it adds one decay rate to every mode."
    footprint = "Damping ratios rise in inverse proportion to frequency; nothing else changes."
    models = EVERYTHING
    equivalent_to = ("uniform_damping",)
    separated_by = "the analyser's settings, or a repeat with another window or a longer record"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the decay rate."""
        why = "windows end at 0.1 to 10 % of their start over records of 0.1 to 20 s"
        return (Parameter("decay", "1/s", 0.1, 70.0, why, log=True),)

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need an expectation of the damping."""
        return damping_obstacle(predictor)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the decay added to every mode."""
        return State(decay=values["decay"])


def damping_obstacle(predictor: Predictor) -> str | None:
    """Return why nothing can be said of what changes the damping, or None."""
    if not np.isfinite(predictor.measured.damping).any():
        return "no damping was measured"
    return None if predictor.expects_damping else "neither model nor baseline says what damping to expect"


class CalibrationGain(Effect):
    """The absolute level of all FRFs, or of those of one of several sensors, is off by one factor."""

    name = "calibration_gain"
    channel = "measurement"
    summary = (
        "The calibration of the measurement chain is off: every FRF is too large or too small by one factor."
    )
    footprint = "Modal constants by one factor; frequencies, damping and shapes unchanged."
    models = EVERYTHING
    equivalent_to = ("section_scale",)
    separated_by = "a calibration with a known free mass"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the gain."""
        why = "wrong sensitivity, charge range, or hammer tip factor"
        return (Parameter("gain", "-", 0.4, 2.5, why, log=True),)

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need absolute level."""
        return None if predictor.measured.absolute else "the data carry no absolute level"

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the whole chain, and each sensor where there are several."""
        sensors = _fixed_sensors(predictor.measured)
        if len(sensors) < 2:
            return (Variant(),)
        each = tuple(
            Variant({"points": (predictor.measured.nodes[s],)}, 0.5 / len(sensors)) for s in sensors
        )
        return (Variant(weight=0.5), *each)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the gain."""
        if "points" not in values:
            return State(gain=values["gain"])
        return State(point_gains={("seen", p): values["gain"] for p in _indices(predictor.measured, values["points"])})


class TimeDelay(Effect):
    """The responses lag the force: filters that differ, multiplexed channels, a network of recorders."""

    name = "time_delay"
    channel = "measurement"
    summary = "The response channels lag the force channel: every FRF turns in proportion to frequency."
    footprint = "Modal constants turn by minus omega times the delay; their size, frequencies, damping unchanged."
    models = EVERYTHING
    separated_by = "swap the channels' inputs, or measure the same signal with both"

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the delay."""
        longest = 0.5 / predictor.measured.frequency.max()
        why = "to half a period of the highest mode, either way"
        return (Parameter("delay", "s", -longest, longest, why),)

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a row of delays: a turn by half a circle looks like a reversed sign."""
        return tuple((u,) for u in (0.1, 0.3, 0.42, 0.58, 0.7, 0.9))

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need complex constants."""
        return None if predictor.measured.phase is not None else "the data carry no phase of the residues"

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the delay."""
        return State(delay=values["delay"])


class Polarity(Effect):
    """Some points' signs are reversed: hit from the other side, or a sensor upside down."""

    name = "polarity"
    channel = "measurement"
    summary = "Some points are reversed in sign: hit from the other side, or a sensor mounted upside down."
    footprint = "The points' constants change sign in all modes; frequencies and damping unchanged."
    models = EVERYTHING
    equivalent_to = ("swapped_points",)
    separated_by = "look at the sign of the drive point FRF and of the points' hits again"
    labels = ("points",)

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return nothing to search: which points it is, the variant says."""
        return ()

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need shapes at several points."""
        return _shape_obstacle(predictor.measured, 3)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the sets of points whose reversal brings the shapes nearest to the model's."""
        role = roving(predictor.measured)
        found = _Shapes(predictor)
        points = found.points(role)
        chosen: list[int] = []
        variants = []
        share = 1.0
        for _ in range(min(MANY, max(len(points) // 2, 1))):
            left = [p for p in points if p not in chosen]
            misfits = [found.misfit({(role, p): -1.0 for p in (*chosen, q)}) for q in left]
            best = int(np.argmin(misfits))
            chosen.append(left[best])
            share *= 0.5 / len(left) * len(chosen)  # one of the sets of this many points, and fewer are likelier
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
        roles: list[Role] = [(role, p) for p in _indices(predictor.measured, values["points"])]
        return State(point_gains=dict.fromkeys(roles, -1.0))

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return the points."""
        return _places(predictor.measured, values["points"])


class SwappedPoints(Effect):
    """Two points' labels are exchanged."""

    name = "swapped_points"
    channel = "measurement"
    summary = "The labels of two points are exchanged."
    footprint = "Two points' constants are exchanged in all modes; frequencies and damping unchanged."
    models = EVERYTHING
    equivalent_to = ("polarity", "position_error")
    separated_by = "hit the two points again"
    labels = ("points",)

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return nothing to search: which points it is, the variant says."""
        return ()

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need shapes at several points."""
        return _shape_obstacle(predictor.measured, 3)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the pairs whose exchange brings the shapes nearest to the model's."""
        test = predictor.measured
        role = roving(test)
        found = _Shapes(predictor)
        pairs = list(combinations(found.points(role), 2))
        misfits = [found.misfit({}, ((role, a, b),)) for a, b in pairs]
        best = np.argsort(misfits)[:PROMISING]
        return tuple(
            Variant({"points": (test.nodes[pairs[i][0]], test.nodes[pairs[i][1]])}, 1.0 / len(pairs))
            for i in best
        )

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the two labels exchanged."""
        a, b = _indices(predictor.measured, values["points"])
        return State(exchanged=((roving(predictor.measured), a, b),))

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return the points."""
        return _places(predictor.measured, values["points"])


class PositionError(Effect):
    """One point lies elsewhere than stated."""

    name = "position_error"
    channel = "measurement"
    summary = "One point was hit (or its sensor mounted) elsewhere than stated."
    footprint = "One point's constants change as the shapes slope there; frequencies and damping unchanged."
    models = ("beam", "plate")
    equivalent_to = ("swapped_points",)
    separated_by = "measure the point's place and hit it again"
    labels = ("point",)

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return how far it lies from where it was stated."""
        far = 0.15 * predictor.spec.length
        why = "from what a tape measure gets wrong to the next point of a coarse grid"
        return tuple(Parameter(name, "m", -far, far, why) for name in ("dx", "dy")[: predictor.spec.dim])

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start on either side of where it was stated."""
        if predictor.spec.dim == 1:
            return ((0.4,), (0.6,))
        return ((0.4, 0.5), (0.6, 0.5), (0.5, 0.4), (0.5, 0.6))

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need shapes at several points."""
        return _shape_obstacle(predictor.measured, 4)

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return the points that spoil the agreement of the shapes most."""
        test = predictor.measured
        role = roving(test)
        found = _Shapes(predictor)
        points = found.points(role)
        worst = np.argsort([found.without(role, p) for p in points])[:PROMISING]
        return tuple(Variant({"point": test.nodes[points[i]]}, 1.0 / len(points)) for i in worst)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the point moved."""
        test = predictor.measured
        (point,) = _indices(test, (values["point"],))
        away = tuple(values.get(name, 0.0) for name in ("dx", "dy")[: predictor.spec.dim])
        return State(moved={(roving(test), point): away})

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return where the point really was."""
        ((x, y, z),) = _places(predictor.measured, (values["point"],))
        return ((x + values["dx"], y + values.get("dy", 0.0), z),)


class _Shapes:
    """How near the shapes come to the nominal model's under a reading of the points; a quick look for a shortlist."""

    def __init__(self, predictor: Predictor) -> None:
        test = predictor.measured
        self.predictor, self.test = predictor, test
        prediction = predictor.predict(at_least=len(test.frequency) + 3)
        order = match(test, prediction, np.arange(len(test.frequency)))
        self.vectors = prediction.vectors[:, order]
        rows = predictor.nominal_rows["w"][:, : len(self.vectors)]
        self.shapes = rows @ self.vectors
        self.weight = 1.0 / (test.constants_sigma**2 + 0.02 * np.mean(test.constants**2, axis=0))

    def points(self, role: str) -> list[int]:
        """Return the points that appear in a role."""
        return sorted({int(p) for p in (self.test.hit if role == "hit" else self.test.seen) if p >= 0})

    def misfit(
        self, gains: dict[Role, float], exchanged: tuple[tuple[str, int, int], ...] = ()
    ) -> float:
        """Return the weighted misfit of the shapes, each mode scaled to fit [-]."""
        read = reading(self.test, State(point_gains=gains, exchanged=exchanged))
        return self._left(read.gain[:, None] * read.product(self.shapes, self.shapes), self.weight)

    def without(self, role: str, point: int) -> float:
        """Return the misfit of the shapes without one point [-]."""
        read = reading(self.test, State())
        stated = self.test.hit if role == "hit" else self.test.seen
        weight = np.where((stated == point)[:, None], 0.0, self.weight)
        return self._left(read.product(self.shapes, self.shapes), weight)

    def _left(self, predicted: FloatArray, weight: FloatArray) -> float:
        data = self.test.constants
        overlap = np.sum(weight * data * predicted, axis=0)
        power = np.maximum(np.sum(weight * predicted**2, axis=0), 1e-300)
        return float(np.sum(weight * data**2) - np.sum(overlap**2 / power))


def roving(measured: Measured) -> str:
    """Return the end that was moved from point to point: the hammer, or the sensor."""
    seen, hit = np.unique(measured.seen), np.unique(measured.hit[measured.hit >= 0])
    return "seen" if len(seen) > len(hit) else "hit"


def _fixed_sensors(measured: Measured) -> IntArray:
    return np.unique(measured.seen) if roving(measured) == "hit" else np.zeros(0, dtype=np.int64)


def _shape_obstacle(measured: Measured, least: int) -> str | None:
    moved = measured.hit if roving(measured) == "hit" else measured.seen
    count = len(np.unique(moved[moved >= 0]))
    return None if count >= least else f"it takes shapes at {least} points or more to tell, found {count}"


def _indices(measured: Measured, nodes: tuple[int, ...]) -> list[int]:
    return [measured.nodes.index(int(node)) for node in nodes]


def _places(measured: Measured, nodes: tuple[int, ...]) -> tuple[tuple[float, float, float], ...]:
    points = measured.points[_indices(measured, nodes)]
    padded = np.hstack([points, np.zeros((len(points), 3 - points.shape[1]))])
    return tuple((float(x), float(y), float(z)) for x, y, z in padded)
