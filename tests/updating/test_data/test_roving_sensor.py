"""A sensor that roves loads another point in every measurement: how far the mean over its places may be off."""

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import BEAM, blank

from acquisition import Dof, FrfSet
from identification import identify
from updating import Predictor
from updating.effects import LIBRARY
from updating.models.state import State
from updating.problem.candidate import Candidate

POINTS = np.linspace(0.0376, 0.376, 10)
STRUCK = 3


def roving() -> Predictor:
    spec = BEAM.with_elements(20)
    test = replace(blank(POINTS, top=1500.0), seen=np.arange(10), hit=np.full(10, STRUCK))
    return Predictor(spec, test)


def test_the_doubt_is_that_of_a_roving_sensor_only_where_it_roves() -> None:
    sensor = LIBRARY["sensor_mass"]
    fixed = Predictor(BEAM, blank(POINTS))
    assert sensor.fidelity_on(fixed) == sensor.fidelity
    assert sensor.fidelity_on(roving()) > 5 * sensor.fidelity
    assert LIBRARY["length"].fidelity_on(roving()) == LIBRARY["length"].fidelity
    assert Candidate((LIBRARY["length"], sensor)).doubt_on(roving()).fidelity == sensor.fidelity_on(roving())


@pytest.mark.long
def test_frequencies_identified_from_roving_measurements_lie_within_it() -> None:
    predictor, rng = roving(), np.random.default_rng(5)
    spec = predictor.spec
    mass = 0.003 * spec.material.density * spec.length * spec.width * spec.thickness
    lines = np.arange(4.0, 900.0, 0.5)
    s = 2j * np.pi * lines
    values = np.stack(
        [
            predictor.receptance(s, State(mass=(mass * predictor.reduced.unit_mass(at[None, None]),)))[i]
            for i, at in enumerate(POINTS)
        ]
    )
    values = values * s**2
    noise = 0.003 * np.sqrt(np.mean(np.abs(values) ** 2) / 2)
    values = values + noise * (rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape))
    seen, hit = tuple(Dof(i + 1, 3) for i in range(10)), (Dof(STRUCK + 1, 3),) * 10
    found = np.abs(identify(FrfSet(lines, values, seen, hit, "accelerance")).poles) / (2 * np.pi)
    sensor = LIBRARY["sensor_mass"]
    bare = predictor.predict(count=4).frequency
    mean = predictor.predict(sensor.state(predictor, {"mass": mass}), count=4).frequency
    nearest = np.array([found[np.argmin(np.abs(found - f))] for f in mean])
    kept = np.abs(nearest / mean - 1) < 0.005
    assert kept.sum() >= 3
    off = np.log(nearest / mean)[kept] / np.log(mean / bare)[kept]
    assert np.abs(off).max() > 2 * sensor.fidelity  # what holds for a fixed sensor does not hold here
    assert np.sqrt(np.mean(off**2)) < 1.5 * sensor.fidelity_on(predictor)
