"""Tests without a hammer: a balance, a caliper, a known mass on a string, a look at the settings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.next_test.base import Maker, Rival, Site, Trial
from updating.diagnosis.next_test.instrument_reading import InstrumentReading, Parts
from updating.effects.base import total_mass
from updating.effects.structure.sensors import sensor_places
from updating.models.state import State

PER_LENGTH = {"density": 1.0, "thickness": 1.0, "width": 1.0, "section": 1.0, "area": 1.0}
"""Powers of a beam's or plate's mass per length, whatever the section's name in the model."""


class Weigh(InstrumentReading):
    """Weigh the specimen: mass per area, and bodies fixed to it; of one in a clamp, not how long it is."""

    family = "weigh"

    sigma = 0.001
    """What weighing reaches: relative 1 sigma, the specimen's other dimensions known as well [-]."""

    def __init__(self, *, clamped: bool) -> None:
        """Take note of whether the specimen must come out of a clamp."""
        self.cost = 3 if clamped else 2
        out = "take the specimen out of its clamp and weigh it" if clamped else "weigh the specimen"
        self.measure = f"{out}, without the sensor, to {100 * self.sigma:g} %"
        self.clamped = clamped

    def read(self, site: Site, parts: Parts, state: State) -> FloatArray:
        """Return the logarithm of the mass."""
        log_mass = sum(p * np.log(state.factors.get(n, 1.0)) for n, p in self._powers.items())
        predictor = site.problem.predictor
        bodies = sum(effect.weight(predictor, values) for effect, values in parts)
        return np.array([log_mass + np.log1p(bodies / total_mass(predictor.spec))]) / self.sigma

    @property
    def _powers(self) -> dict[str, float]:
        return PER_LENGTH if self.clamped else {**PER_LENGTH, "length": 1.0}

    def tolerances(self, site: Site) -> tuple[Mapping[str, float], ...]:
        """Return that mass goes with each of its factors."""
        return ({n: p / self.sigma for n, p in self._powers.items()},)


class Caliper(InstrumentReading):
    """Measure thickness and width."""

    family = "caliper"
    cost = 1
    sigma = 0.002
    """What a micrometer reaches on thickness and width: relative 1 sigma of the mean of some places [-]."""

    measure = f"measure thickness and width at several places, to {100 * sigma:g} %"

    def read(self, site: Site, parts: Parts, state: State) -> FloatArray:
        """Return the logarithms of thickness and width."""
        factors = state.factors
        width = factors.get("width", 1.0) * factors.get("section", 1.0)
        return np.log([factors.get("thickness", 1.0), width]) / self.sigma

    def tolerances(self, site: Site) -> tuple[Mapping[str, float], ...]:
        """Return that each reads its own factor."""
        return ({"thickness": 1 / self.sigma}, {"width": 1 / self.sigma, "section": 1 / self.sigma})


class WeighSensor(InstrumentReading):
    """Weigh the sensor with what fixes it."""

    family = "sensor"
    cost = 2
    sigma = 1e-4
    """What weighing a sensor with its mount reaches: 1 sigma [kg]."""

    measure = f"weigh the sensor with its mount, to {1000 * sigma:g} g"

    def read(self, site: Site, parts: Parts, state: State) -> FloatArray:
        """Return the mass that the model does not hold."""
        return np.array([sum(effect.sensor_weight(values) for effect, values in parts) / self.sigma])

    def tolerances(self, site: Site) -> tuple[Mapping[str, float], ...]:
        """Return that no tolerance enters."""
        return ({},)


class Chain(InstrumentReading):
    """Calibrate the measurement chain with a known free mass: its gain, and the delay between its channels."""

    family = "chain"
    cost = 3
    sigma = 0.005
    """What a calibration of the chain with a known free mass reaches: relative 1 sigma [-]."""

    delay_sigma = 5e-6
    """What the same test determines of a delay between the channels: 1 sigma [s]."""

    measure = (
        f"hit a known free mass with the same hammer and sensor: calibrates the chain to {100 * sigma:g} %"
    )

    def read(self, site: Site, parts: Parts, state: State) -> FloatArray:
        """Return gain and delay."""
        return np.array([np.log(state.gain) / self.sigma, state.delay / self.delay_sigma])

    def tolerances(self, site: Site) -> tuple[Mapping[str, float], ...]:
        """Return that no tolerance enters."""
        return ({}, {})

    def others(self, site: Site, rival: Rival) -> FloatArray:
        """Return that the gain holds what was in doubt about the calibration, the last of the doubts."""
        columns = super().others(site, rival)
        columns[0, -1] = site.problem.measured.calibration / self.sigma
        return columns


class Settings(InstrumentReading):
    """Look up whether, and how, the analyser windowed the records."""

    family = "settings"
    cost = 1
    measure = "look up the exponential window in the analyser's settings, or repeat one point without it"

    sigma = 0.05
    """What the analyser's settings leave in doubt of a window's decay rate: 1 sigma [1/s]."""

    def read(self, site: Site, parts: Parts, state: State) -> FloatArray:
        """Return the decay that the records got."""
        return np.array([state.decay / self.sigma])

    def tolerances(self, site: Site) -> tuple[Mapping[str, float], ...]:
        """Return that no tolerance enters."""
        return ({},)


class Instruments(Maker):
    """The readings that a specimen admits."""

    def trials(self, site: Site, rivals: tuple[Rival, ...]) -> Iterator[Trial]:
        """Give them."""
        problem = site.problem
        spec, test = problem.predictor.spec, problem.measured
        yield Settings()
        if spec.outlined:
            yield Caliper()
            yield Weigh(clamped=bool(spec.clamped))
        if len(sensor_places(problem.predictor)):
            yield WeighSensor()
        if test.absolute and test.has_shapes:
            yield Chain()
