"""Masses that the model forgot."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects.base import Effect, Parameter, Values, total_mass
from updating.models.state import State
from updating.prediction import Predictor


class SensorMass(Effect):
    """Each mounted sensor loads the structure with its mass."""

    name = "sensor_mass"
    channel = "mass"
    summary = "The mounted sensor (each of them) loads the structure and is not in the model."
    footprint = (
        "Frequencies fall where the sensor moves, least in modes with a node there; shapes shrink there."
    )
    models = ("beam", "plate", "matrices")
    equivalent_to = ("lumped_mass",)
    separated_by = "weigh the sensor, or add a second known mass beside it"
    fidelity = 0.01

    def parameters(self, predictor: Predictor) -> tuple[Parameter, ...]:
        """Return the mass of one sensor."""
        high = 0.5 * total_mass(predictor.spec)
        why = (
            "from the lightest accelerometer with its wax to an impedance head as heavy as half the structure"
        )
        return (Parameter("mass", "kg", min(2e-4, 1e-3 * high), high, why, log=True),)

    def obstacle(self, predictor: Predictor) -> str | None:
        """Need to know where the sensors sit."""
        test = predictor.measured
        if len(test.sensors) > 3 and len(set(test.hit.tolist())) == 1:
            return "the sensor seems to rove: it loads another point in every measurement"
        if len(sensor_places(predictor)):
            return None
        return "the data do not say where a sensor sits; a [[model.mass]] of 0 kg would"

    def state(self, predictor: Predictor, values: Values) -> State:
        """Return the structure with the mass at every sensor."""
        unit = predictor.once("sensors", lambda: predictor.reduced.unit_mass(sensor_places(predictor)))
        return State(mass=(values["mass"] * unit,))

    def locations(self, predictor: Predictor, values: Values) -> tuple[tuple[float, float, float], ...]:
        """Return the sensors."""
        points = sensor_places(predictor)
        padded = np.hstack([points, np.zeros((len(points), 3 - points.shape[1]))])
        return tuple((float(x), float(y), float(z)) for x, y, z in padded)


def sensor_places(predictor: Predictor) -> FloatArray:
    """Return where sensors sit, (n, dim) [m]: as the data say, else where the modeller put masses."""
    test, spec = predictor.measured, predictor.spec
    if test.sensors:
        return np.unique(test.points[list(test.sensors)], axis=0)
    return np.array([mass.at[: spec.dim] for mass in spec.masses], dtype=float).reshape(-1, spec.dim)
