"""An update finds what was put into a model, and ends on the full model."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from acquisition import ModalData
from updating import (
    Axes,
    Case,
    Material,
    PointMass,
    Region,
    Spec,
    Tolerances,
    build_structure,
    measured_from_modes,
)
from updating.update import update

STEEL = Material(210e9, 7850.0, 0.3)
BEAM = Spec(
    "beam",
    length=0.4,
    width=0.03,
    thickness=0.005,
    elements=(12,),
    clamped=("x0",),
    theory="euler-bernoulli",
    material=STEEL,
)
PARTS = (Region("root", (0.0, 0.1)), Region("middle", (0.1, 0.25)), Region("tip", (0.25, 0.4)))
PLATE = Spec(
    "plate",
    length=0.4,
    width=0.2,
    thickness=0.004,
    elements=(12, 6),
    clamped=("x0",),
    theory="kirchhoff",
    material=STEEL,
)
DOUBTS = Tolerances({"E": 0.3, "density": 0.3, "thickness": 0.3, "length": 0.1})


def frequencies(spec: Spec, count: int) -> np.ndarray:
    return np.sqrt(build_structure(spec).eigen(count)[0]) / (2 * np.pi)


def case_of(model: Spec, measured: np.ndarray, sigma: float = 1e-5, title: str = "specimen") -> Case:
    data = ModalData(frequency=measured, frequency_sigma=sigma * measured)
    test = measured_from_modes(data, Axes(), model, repeatability=0.0, title=title)
    return Case(title, model, test, baseline=None, tolerances=DOUBTS)


def regional(spec: Spec, names: list[str], factors: list[float]) -> Spec:
    regions = {r.name: r for r in spec.regions}
    for name, factor in zip(names, factors, strict=True):
        region, prop = name.split(".")
        nominal = {"E": spec.material.E, "density": spec.material.density}[prop]
        regions[region] = replace(regions[region], **{prop: factor * nominal})
    return replace(spec, regions=tuple(regions.values()))


factor = st.floats(0.7, 1.4)


@settings(max_examples=12)
@given(factors=st.lists(factor, min_size=3, max_size=3))
def test_region_factors_of_a_beam_are_recovered_exactly(factors: list[float]) -> None:
    names = ["root.E", "middle.E", "tip.density"]
    model = replace(BEAM, regions=PARTS)
    truth = frequencies(regional(model, names, factors), 6)
    result = update(case_of(model, truth), parameters=names, weights="relative")
    assert result.converged
    assert result.exact
    assert [p.factor for p in result.parameters] == pytest.approx(factors, rel=1e-4)
    assert result.undetermined == ()


def test_the_frequencies_at_the_end_are_those_of_a_rebuilt_full_model() -> None:
    rng = np.random.default_rng(5)
    model = replace(PLATE, regions=(Region("root", (0.0, 0.1)), Region("corner", (0.2, 0.4), (0.1, 0.2))))
    disturbed = frequencies(model, 6) * np.exp(0.03 * rng.standard_normal(6))
    names = ["root.E", "corner.density"]
    result = update(case_of(model, np.sort(disturbed)), parameters=names, weights="relative")
    rebuilt = regional(model, names, [float(p.factor or 0) for p in result.parameters])
    assert result.exact
    rounding = 4e-9  # of a solve: half of eps times the largest over the smallest eigenvalue, 3.2e7
    assert result.pairs["after_hz"].to_numpy() == pytest.approx(frequencies(rebuilt, 6), rel=rounding)
    assert result.pairs["before_hz"].to_numpy() == pytest.approx(frequencies(model, 6), rel=1e-7)


def test_length_and_sensor_mass_are_recovered_together() -> None:
    bare = replace(BEAM, masses=(PointMass((0.4,), 0.0),))
    longer = replace(BEAM, length=0.41, regions=(), masses=(PointMass((0.41,), 0.012),))
    result = update(
        case_of(bare, frequencies(longer, 5)), parameters=["length", "sensor_mass"], weights="relative"
    )
    length, mass = result.parameters
    assert length.value == pytest.approx(0.010, abs=2e-5)
    assert length.unit == "m"
    assert mass.value == pytest.approx(0.012, rel=2e-3)
    assert not mass.at_bound


def test_a_clamp_that_turns_is_found_from_any_stiffness() -> None:
    scale = STEEL.E * 0.03 * 0.005**3 / 12 / 0.4
    truth = 12 * scale
    # roots of the beam on a rotational spring: (k L / E I) (1 + cos cosh) = b (sin cosh - cos sinh)
    roots = clamped_on_spring(12.0, 4)
    omega = roots**2 * np.sqrt(STEEL.E * 0.005**2 / (12 * STEEL.density)) / 0.4**2
    result = update(case_of(BEAM, omega / (2 * np.pi)), parameters=["clamp_rotation"], weights="relative")
    assert result.parameters[0].value == pytest.approx(truth, rel=5e-3)
    assert result.exact


def clamped_on_spring(ratio: float, count: int) -> np.ndarray:
    from scipy.optimize import brentq

    def characteristic(b: float) -> float:
        turning = ratio * (1 / np.cosh(b) + np.cos(b))
        return float(turning - b * (np.sin(b) - np.cos(b) * np.tanh(b)))

    grid = np.linspace(0.3, 14, 2000)
    values = np.array([characteristic(b) for b in grid])
    change = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))[:count]
    return np.array([brentq(characteristic, grid[i], grid[i + 1]) for i in change])


def two_beams() -> list[Case]:
    softer = Material(190e9, 7850.0)
    other = replace(BEAM, length=0.3, thickness=0.004, regions=())
    return [
        case_of(BEAM, frequencies(replace(BEAM, material=softer), 4), title="known"),
        case_of(other, frequencies(replace(other, length=0.31, material=softer), 4), title="clamped"),
    ]


def test_a_shared_modulus_tells_the_length_of_the_other_specimen() -> None:
    result = update(two_beams(), parameters=[["E"], ["length", "E"]], shared=["E"])
    found = {(p.name, p.study): p for p in result.parameters}
    assert set(found) == {("E", None), ("length", "clamped")}
    assert found["E", None].value == pytest.approx(190e9, rel=1e-4)
    assert found["length", "clamped"].value == pytest.approx(0.010, abs=1e-5)
    assert result.undetermined == ()
    assert result.rms_percent() < 1e-3 < result.rms_percent("before")


def test_length_and_modulus_of_one_uniform_beam_are_named_as_undetermined() -> None:
    result = update(two_beams(), parameters=["length", "E"], weights="relative")
    assert set(result.undetermined) == {"length (known)", "E (known)", "length (clamped)", "E (clamped)"}


@pytest.mark.long
def test_stated_sigma_covers_the_truth_as_often_as_it_says() -> None:
    rng = np.random.default_rng(11)
    model = replace(BEAM, regions=PARTS)
    names, factors = ["root.E", "tip.E"], [0.9, 1.15]
    truth = frequencies(regional(model, names, factors), 6)
    pulls = []
    for _ in range(60):
        noisy = truth * np.exp(2e-3 * rng.standard_normal(6))
        result = update(case_of(model, noisy, 2e-3), parameters=names)
        pulls += [
            (p.value / 210e9 - f) / (p.sigma / 210e9) for p, f in zip(result.parameters, factors, strict=True)
        ]
    inside = np.mean(np.abs(pulls) < 1.96)
    assert 0.89 <= inside <= 0.99  # 120 draws of 0.95: two standard deviations are 0.04
