"""The published dry beam and plate updated together: three variants whose spread is the result."""

from dataclasses import replace

import numpy as np
import pytest

from acquisition import ModalData
from updating import Axes, Case, Material, PointMass, Spec, Tolerances, measured_from_modes
from updating.update import Update, update

STEEL = Material(210e9, 7850.0, 0.3)
BEAM = Spec(
    "beam", length=0.376, width=0.0305, thickness=0.0047625, elements=(10,), clamped=("x0",),
    theory="euler-bernoulli", material=STEEL, masses=(PointMass((0.376,), 0.0),),
)  # fmt: skip
PLATE = Spec(
    "plate",
    length=0.376,
    width=0.2,
    thickness=0.003175,
    elements=(19, 10),
    clamped=("x0",),
    theory="kirchhoff",
    material=STEEL,
    masses=(PointMass((0.376, 0.2), 0.0),),
)
MEASURED = {
    "beam": [24.47, 153.96, 429.15],
    "plate": [16.76, 70.69, 104.91, 229.96, 296.64, 425.51, 446.90, 574.19, 591.14, 731.06, 843.22, 951.13],
}


def case_of(spec: Spec) -> Case:
    frequency = np.array(MEASURED[spec.kind])
    data = ModalData(frequency=frequency, frequency_sigma=0.0005 * frequency)
    doubts = Tolerances({"E": 0.01, "length": 0.002})
    return Case(spec.kind, spec, measured_from_modes(data, Axes(), spec), baseline=None, tolerances=doubts)


def joint(*, beam: tuple[str, ...], plate: tuple[str, ...], shared: tuple[str, ...]) -> Update:
    return update(
        [case_of(BEAM), case_of(PLATE)], parameters=[beam, plate], shared=shared, weights="relative"
    )


def values(result: Update) -> dict[str, float]:
    return {
        p.name if p.study is None else f"{p.name} {p.study}": p.factor
        if p.name == "E" and p.factor
        else p.value
        for p in result.parameters
    }


@pytest.mark.long
def test_length_and_sensor_shared_and_a_modulus_for_the_plate() -> None:
    common = ("length", "sensor_mass")
    result = joint(beam=common, plate=(*common, "E"), shared=common)
    found = values(result)
    assert found["length"] == pytest.approx(0.0182, abs=0.0007)
    assert found["sensor_mass"] == pytest.approx(0.0109, abs=0.001)
    assert found["E plate"] == pytest.approx(0.93, abs=0.01)
    assert result.rms_percent() == pytest.approx(0.52, abs=0.01)
    sigma = {p.name: p.sigma for p in result.parameters}
    assert sigma["length"] == pytest.approx(0.0007, rel=0.2)
    assert sigma["sensor_mass"] == pytest.approx(0.001, rel=0.2)
    assert result.undetermined == ()
    assert result.exact


@pytest.mark.long
def test_the_modulus_shared_by_both() -> None:
    every = ("length", "sensor_mass", "E")
    result = joint(beam=every, plate=every, shared=every)
    found = values(result)
    assert found["length"] == pytest.approx(0.011, abs=0.001)
    assert found["sensor_mass"] == pytest.approx(0.002, abs=0.001)
    assert found["E"] == pytest.approx(0.86, abs=0.005)
    assert result.rms_percent() == pytest.approx(0.65, abs=0.01)


@pytest.mark.long
def test_a_modulus_for_each() -> None:
    every = ("length", "sensor_mass", "E")
    result = joint(beam=every, plate=every, shared=every[:2])
    found = values(result)
    assert found["length"] == pytest.approx(0.016, abs=0.001)
    assert found["sensor_mass"] == pytest.approx(0.0085, abs=0.001)
    assert found["E beam"] == pytest.approx(0.955, abs=0.01)
    assert found["E plate"] == pytest.approx(0.91, abs=0.01)
    assert result.rms_percent() == pytest.approx(0.48, abs=0.01)
    assert (
        result.undetermined == ()
    )  # the length ends many of its own sigmas, and of its tolerances, from its start
    assert {p.name: p.sigma for p in result.parameters}["length"] == pytest.approx(0.0018, rel=0.2)


@pytest.mark.long
def test_one_cause_alone_fits_the_plate_worse() -> None:
    plate = case_of(replace(PLATE, regions=()))
    modulus = update(plate, parameters=["E"], weights="relative").rms_percent()
    with_length = update(plate, parameters=["E", "length"], weights="relative").rms_percent()
    with_both = update(plate, parameters=["E", "length", "sensor_mass"], weights="relative").rms_percent()
    assert modulus == pytest.approx(1.76, abs=0.02)
    assert 0.9 > with_length > with_both
