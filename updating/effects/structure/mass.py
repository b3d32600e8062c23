"""Masses that the model forgot."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import product
from types import MappingProxyType
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri

from acquisition.arrays import FloatArray
from updating.effects.base import EDGES, Effect, Parameter, Values, Variant, total_mass
from updating.effects.box import AXES, LIKE, Place, as_places, outline, starting_places, where_alike
from updating.effects.mechanism import ADDED_MASS, Size
from updating.effects.obstacles import Lack, Obstacle
from updating.effects.regions import centre_of, on_basis, one_of
from updating.effects.structure.attachment import attachment_of, with_body
from updating.effects.structure.frequency_gap import frequency_gap
from updating.effects.structure.nodes import (
    NAMED_SHARE,
    distinct,
    distinct_groups,
    free_nodes,
    group_centres,
    without_places,
)
from updating.effects.structure.screening import TRIED, promising_nodes
from updating.effects.structure.sensors import sensor_places, sensor_roves, sensor_share
from updating.models.absorbers import structural
from updating.models.base import Structure
from updating.models.fields import Sparse
from updating.models.imported.matrices import Imported
from updating.models.imported_structure import ImportedStructure
from updating.models.spec import Spec
from updating.models.state import State
from updating.prediction.predict import Predictor

STEEL = 7850.0
"""Density of the cube by which a mass that is all we know is given its rotary inertia [kg/m^3]."""

ROVING = 0.5
"""How far the mean over a roving sensor's places may be off: loud FRFs, and split peaks, have more weight [-]."""

AXES_AWAY = ("dx", "dy", "dz")

FARTHEST = 3.0
"""No sensor is believed to sit further beside its stated place [standard deviations]."""

SHARES = {"anywhere": 0.5, "ends": 0.25, "points": 0.25}
"""Shares of the prior of a body's place: what is fixed to a structure mostly is so at its ends, on plates at corners,
or where a test has its points, whose places are marked and were thought of; each half of the rest [-]."""

PROMISING = 3
"""At how many of the test's points a body is tried: those at which one comes nearest to the frequencies."""

STILL, CUBE = 0.0, 1.0
"""Rotary inertia of a sensor and of a body where none is stated, as a multiple of a steel cube's [-]."""

SIZES = 9
"""So many masses at a place of imported matrices are starts, three in a decade: the search begins at the best of them,
and from one twice as heavy it ends where modes have changed places. Doubled: twice the time of a first look."""

LARGEST = 6.0
"""Largest rotary inertia of a body, as a multiple of a steel cube's of its mass [-]."""


def cube_inertia(mass: float) -> float:
    """Return the rotary inertia of a steel cube about an axis through its middle, m a^2 / 6 [kg m^2]."""
    return float(mass * (mass / STEEL) ** (2 / 3) / 6)


def unit_inertia(structure: Structure, points: FloatArray) -> Sparse:
    """Return the matrix of 1 kg m^2 at each of some points, about every axis the model can turn about."""
    if isinstance(structure, ImportedStructure):
        turns = structure.imported.places.motions(points.reshape(-1, 3), range(3, 6))
        return Sparse(turns.T @ turns)
    rows = structure.rows(points)
    total = Sparse((structure.n_dofs, structure.n_dofs))
    for slope in ("wx", "wy"):
        if slope in rows:
            total = Sparse(total + rows[slope].T @ rows[slope])
    return total


@dataclass(frozen=True)
class Astray(Parameter):
    """A distance from a stated place: normal about zero, cut off where it is no longer plausible.

    The range is `FARTHEST` standard deviations to either side.
    """

    def value(self, coordinate: float) -> float:
        """Take a prior quantile in [0, 1] to the parameter's value [unit]."""
        kept = ndtr(FARTHEST) - ndtr(-FARTHEST)
        return float(self.high / FARTHEST * ndtri(ndtr(-FARTHEST) + kept * coordinate))

    def coordinate(self, value: float) -> float:
        """Take a value to its prior quantile, clipped to [0, 1]."""
        kept = ndtr(FARTHEST) - ndtr(-FARTHEST)
        return float(np.clip((ndtr(value / self.high * FARTHEST) - ndtr(-FARTHEST)) / kept, 0.0, 1.0))


class SensorMass(Effect):
    """Each mounted sensor loads the structure with its mass; one that roves, with the mean over its places.

    A single one that stays sits ``dx`` and ``dy`` beside its stated place, as far as the places of points are in doubt.

    A sensor that roves shifts each measurement by another amount. The frequency found from all of them is about the
    mean of these shifts; where the structure moves most the FRFs are the loudest and the shift the largest, so that
    the mean may be off by half of itself.
    """

    name = "sensor_mass"
    channel = "mass"
    summary = "The mass of the mounted sensor (of each sensor) is not in the model."
    keeps_clamps = True
    footprint = (
        "Frequencies fall where the sensor moves, least in modes with a node there; shapes shrink there."
        " The parameter bulk is its rotary inertia, relative to a steel cube of the same mass."
    )
    phrase = "the mass of the sensor"
    models = ("beam", "plate", "matrices")
    equivalent_to = ("lumped_mass",)
    separated_by = "weigh the sensor, or add a second known mass beside it"
    fidelity = 0.03

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the mass of one sensor."""
        high = 0.5 * total_mass(predictor.spec)
        why = "from the lightest accelerometer with its wax to an impedance head of half the structure's mass"
        mass = Parameter("mass", "kg", min(2e-4, 1e-3 * high), high, why, log=True)
        return (mass, _bulk(STILL), *self._astray(predictor))

    def _astray(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return how far a single sensor that stays may sit beside its place."""
        sigma = predictor.measured.position_sigma
        single = len(sensor_places(predictor)) == 1 and predictor.spec.outlined
        if not single or not sigma > 0:
            return ()
        far, why = (
            FARTHEST * sigma,
            "within three standard deviations of the stated places of points",
        )
        names = AXES_AWAY[: predictor.spec.dim]
        return tuple(Astray(name, "m", -far, far, why, default=0.0, natural=EDGES) for name in names)

    def _places(self, predictor: Predictor, values: Values) -> FloatArray:
        """Return where sensors sit beside their stated places, (n, dim) [m]."""
        points, spec = sensor_places(predictor), predictor.spec
        away = [values.get(name, 0.0) for name in AXES_AWAY[: points.shape[1]]]
        if not any(away):
            return points
        return np.asarray(np.clip(points + away, 0.0, [spec.length, spec.width][: points.shape[1]]))

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start at the stated place, with a light sensor and a heavy one."""
        more = len(self.parameters(predictor)) - 2
        return tuple((u, 0.2, *[0.5] * more) for u in (0.3, 0.7))

    def fidelity_on(self, predictor: Predictor) -> float:
        """Return the doubt in the mean over the places where the sensor roves [-]."""
        return ROVING if sensor_roves(predictor) else self.fidelity

    def sensor_weight(self, values: Values) -> float:
        """Return the mass of one sensor [kg]."""
        return float(values["mass"])

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return the mass of one sensor."""
        return (Size(ADDED_MASS, self.sensor_weight(values), "kg"),)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Require the places of the sensors."""
        if len(sensor_places(predictor)):
            return None
        return Obstacle(
            Lack.DATA,
            "the data do not state where a sensor is mounted; state its place by a [[model.mass]] of 0 kg",
        )

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the mass at every sensor, or spread over the places of one that roves."""
        reduced, points = predictor.reduced, sensor_places(predictor)
        if any(values.get(name) for name in AXES_AWAY):
            inertia = values.get("bulk", STILL) * cube_inertia(values["mass"])
            return State(mass=(_body(predictor, self._places(predictor, values), values["mass"], inertia),))
        mass = values["mass"] * predictor.once("sensors", lambda: reduced.unit_mass(points))
        turning = predictor.once("sensors turning", lambda: _reduced_inertia(predictor, points))
        mass = mass + values.get("bulk", STILL) * cube_inertia(values["mass"]) * turning
        return State(mass=(sensor_share(predictor) * mass,))

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the sensors."""
        return as_places(self._places(predictor, values))


class LumpedMass(Effect):
    """A compact body at one place: a bracket, a bolt, a magnet, a cable's connector."""

    name = "lumped_mass"
    channel = "mass"
    summary = "A body that is not in the model is fixed to the structure at one place."
    keeps_clamps = True
    footprint = (
        "Frequencies fall in the modes that move there, not in those with a node there; shapes shrink there."
        " The parameter bulk is its rotary inertia, relative to a steel cube of the same mass."
    )
    phrase = "a mass left out of the model"
    models = ("beam", "plate", "matrices")
    equivalent_to = ("sensor_mass", "local_mass")
    screened = MappingProxyType({"bulk": (0.1, 0.6)})
    named = ("at",)
    repeats = True
    separated_by = "find the body and remove it; or measure more points around the place"
    fidelity = 0.03

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the mass and its place."""
        high = 0.5 * total_mass(predictor.spec)
        why = "from the smallest mass that repeated tests detect to half the structure's own mass"
        places = outline(predictor)
        return (Parameter("mass", "kg", 2e-3 * high, high, why, log=True), *places, _bulk(CUBE))

    def weight(self, predictor: Predictor, values: Values) -> float:
        """Return the mass of the body, which stays on when the specimen is weighed [kg]."""
        return float(values["mass"])

    def sizes(self, predictor: Predictor, values: Values) -> tuple[Size, ...]:
        """Return the mass of the body."""
        return (Size(ADDED_MASS, self.weight(predictor, values), "kg"),)

    def obstacle(self, predictor: Predictor) -> Obstacle | None:
        """Need places: on imported matrices, the points of the test."""
        return without_places(predictor, "a body might sit")

    def variants(self, predictor: Predictor) -> tuple[Variant, ...]:
        """Return a body at an end, at a test point and anywhere; of imported matrices at nodes.

        Of the test points those are listed at which a body comes nearest to the frequencies. Where a sensor stayed it
        leaves no room for another body.
        """
        points = np.unique(predictor.measured.points, axis=0)
        if predictor.spec.imported is not None:
            return self._on_nodes(predictor, predictor.spec.imported)
        ends = free_ends(predictor.spec)
        there = SHARES["anywhere"] + SHARES["ends"] * bool(len(ends)) + SHARES["points"] * bool(len(points))
        at_end, at_point = (
            SHARES[name] / there / max(len(places), 1)
            for name, places in (("ends", ends), ("points", points))
        )
        return (
            *(Variant(_named(end), at_end) for end in ends if _vacant(predictor, end)),
            *(Variant(_named(at), at_point) for at in promising_points(predictor) if _vacant(predictor, at)),
            Variant(weight=SHARES["anywhere"] / there),
        )

    def _on_nodes(self, predictor: Predictor, imported: Imported) -> tuple[Variant, ...]:
        """Return a body at test points and node sets of imported matrices, and at the most promising other nodes."""
        groups = distinct_groups(imported)
        points = np.unique(predictor.measured.points, axis=0)
        centres = group_centres(imported)
        known: list[dict[str, Any]] = [_named(points[i]) for i in distinct(imported, points, centres)]
        known += [_named(group.centre) | {"at": group.name} for group in groups]
        sizes = [self.parameters(predictor)[0].value(u) for u in TRIED]
        others = free_nodes(imported, np.vstack([points.reshape(-1, 3), centres]))
        best = promising_nodes(predictor, imported, others, partial(with_body, predictor), sizes)
        share = NAMED_SHARE if len(others) else 1.0
        return (
            *(Variant(at, share / len(known)) for at in known),
            *(Variant(node, (1 - share) / len(others)) for node, _ in best),
        )

    def starts(self, predictor: Predictor) -> tuple[tuple[float, ...], ...]:
        """Start from a row of places and the ends, with a middling mass; on imported matrices from several masses."""
        if predictor.spec.kind == "matrices":
            return tuple((u, 0.5, 0.5, 0.5, 0.12 + 0.1 * u) for u in np.linspace(0.04, 0.96, SIZES))
        ends = (
            ((0.02,), (0.98,)) if predictor.spec.kind == "beam" else ((0.98, 0.02), (0.98, 0.98), (0.98, 0.5))
        )
        places = (*starting_places(predictor.spec), *ends)
        return tuple((0.45, *where, 0.2) for where in places)

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the body."""
        inertia = values.get("bulk", CUBE) * cube_inertia(values["mass"])
        if predictor.spec.imported is not None:
            return _on_matrices(predictor, predictor.spec.imported, values, inertia)
        point = np.array([[values[name] for name in AXES[: predictor.spec.dim]]])
        return State(mass=(_body(predictor, point, values["mass"], inertia),))

    def locations(self, predictor: Predictor, values: Values) -> tuple[Place, ...]:
        """Return the place; where no shapes separate it from its mirror images, these too."""
        if predictor.spec.imported is not None and "at" in values:
            return (centre_of(one_of(predictor.spec.imported.groups, values, "at")),)
        at = (float(values["x"]), float(values.get("y", 0.0)), float(values.get("z", 0.0)))
        return where_alike(predictor, at)


def _on_matrices(predictor: Predictor, imported: Imported, values: Values, inertia: float) -> State:
    """Return imported matrices with a body of some rotary inertia [kg m^2] at a node set or a place."""
    if "at" in values:
        group = one_of(imported.groups, values, "at")

        def unit(axes: range) -> FloatArray:
            rows = group.motions(axes)
            return on_basis(predictor, ("body", group.name, axes.start), lambda: Sparse(rows.T @ rows))

        return State(mass=(values["mass"] * unit(range(3)) + inertia * unit(range(3, 6)),))
    place = np.array([[values[name] for name in AXES]])
    key = tuple(place[0].tolist())
    attachment = attachment_of(predictor, ("body", *key), lambda: imported.places.motions(place))
    turning = on_basis(
        predictor,
        ("turning", *key),
        lambda: unit_inertia(predictor.reduced.structure, place),
    )
    return with_body(predictor, attachment, values["mass"]).plus(State(mass=(inertia * turning,)))


def _body(predictor: Predictor, point: FloatArray, mass: float, inertia: float) -> FloatArray:
    """Return the mass matrix of a body at a place (1, dim) [m], of a mass [kg] and a rotary inertia [kg m^2]."""
    rows = predictor.reduced.rows(point)
    body = mass * (rows["w"].T @ rows["w"])
    for name in ("wx", "wy"):
        if name in rows:
            body = body + inertia * (rows[name].T @ rows[name])
    return body


def free_ends(spec: Spec) -> FloatArray:
    """Return the free ends of a beam, the corners of a plate off its clamped edges, (n, dim) [m]."""
    sides = [
        [place for edge, place in ((f"{axis}0", 0.0), (f"{axis}1", size)) if edge not in spec.clamped]
        for axis, size in zip("xy", (spec.length, spec.width)[: spec.dim], strict=False)
    ]
    return np.array(list(product(*sides))).reshape(-1, spec.dim)


def promising_points(predictor: Predictor) -> FloatArray:
    """Return the few test points at which a body comes nearest to the frequencies, to first order, (n, dim) [m]."""

    def build() -> FloatArray:
        test = predictor.measured
        points, first = np.unique(test.points, axis=0, return_index=True)
        if len(points) <= PROMISING:
            return points
        gap = frequency_gap(predictor)
        rows = structural(predictor.point_rows()[first].T, predictor.base.absorbers).T
        masses, gained = gap.sizes(-0.5 * (rows @ gap.prediction.vectors) ** 2)
        gained = np.where(masses > 0, gained, 0.0)
        return np.asarray(points[np.argsort(-gained, kind="stable")[:PROMISING]])

    return predictor.once("points for a body", build)


def _vacant(predictor: Predictor, place: FloatArray) -> bool:
    """Return whether no sensor stays at a place (dim,)."""
    away = np.linalg.norm(sensor_places(predictor) - place, axis=1)
    return sensor_roves(predictor) or bool((away > LIKE * predictor.spec.length).all())


def _named(point: FloatArray) -> dict[str, float]:
    return dict(zip(AXES, map(float, point), strict=False))


def _bulk(default: float) -> Parameter:
    """Return the rotary inertia about the body's own middle and its height above the surface."""
    why = "rotary inertia, relative to a steel cube of the same mass: from a flat disc to a tall body of light metal"
    return Parameter("bulk", "-", 0.0, LARGEST, why, default=default, natural=EDGES)


def _reduced_inertia(predictor: Predictor, points: FloatArray) -> FloatArray:
    reduced = predictor.reduced
    return reduced.project(unit_inertia(reduced.structure, points))
