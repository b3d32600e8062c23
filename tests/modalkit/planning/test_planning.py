"""The forecast of a test: distances, covariance, thresholds, changes, and what a study tells of them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conforming import departures
from hypothesis import example, given, settings
from hypothesis import strategies as st

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from modalkit.output.schemas import PlanDocument
from modalkit.planning import forecast
from modalkit.planning.curves import Curve
from modalkit.planning.design import Design
from modalkit.planning.document import to_json
from modalkit.planning.family import Family
from modalkit.planning.forecast import DesignForecast, Forecast
from modalkit.planning.own import OwnBench, bench_of
from modalkit.planning.own.following import followed
from modalkit.planning.separability import EQUAL, SEEN, distances
from modalkit.planning.surface import Surface
from modalkit.simulation.setup import SAMPLING
from modalkit.study.read import read_study

SAMPLES = Path(__file__).resolve().parents[3] / "sample_data"

STUDY = """
[test]
{test}
[model]
type = "beam"
length = 0.4
width = 0.03
thickness = 0.005
clamped = ["x0"]
theory = "timoshenko"
[model.material]
E = 210e9
density = 7850.0
[model.damping]
alpha = 1.0
beta = 1e-6
"""
FEW = ("E", "density", "thickness", "section_scale", "clamp_rotation", "calibration_gain", "sensor_mass")
POINTS = "points = [0.08, 0.16, 0.24, 0.32]\nsensor = 0.4\nband = [5.0, 500.0]"
TOLERANCES = {"E": 0.01, "density": 0.003, "thickness": 0.005, "length": 0.002}


def planned(folder: Path, test: str = POINTS, more: str = "") -> OwnBench:
    path = folder / "study.toml"
    path.write_text(STUDY.format(test=test) + more)
    return bench_of(read_study(path))


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> OwnBench:
    return planned(tmp_path_factory.mktemp("beam"))


@pytest.fixture(scope="module")
def curves(bench: OwnBench) -> tuple[Curve, ...]:
    return tuple(bench.solve(f) for f in bench.families if f.name in FEW)


@pytest.fixture(scope="module")
def sample() -> Forecast:
    return forecast(bench_of(read_study(SAMPLES / "beam_dry" / "study.toml")))


def frequencies_alone(bench: OwnBench) -> Design:
    return replace(bench.design, shapes=False, damping_known=False)


def common_variance() -> float:
    """Of the frequencies of a cantilever, which go with sqrt(E / rho) t / L^2."""
    t = TOLERANCES
    return (0.5 * t["E"]) ** 2 + (0.5 * t["density"]) ** 2 + t["thickness"] ** 2 + (2 * t["length"]) ** 2


def forecast_by_curves(curves: tuple[Curve, ...], design: Design, bench: OwnBench) -> DesignForecast:
    return DesignForecast(design, distances(curves, design, bench))


def away(targets: FloatArray, cloud: FloatArray) -> FloatArray:
    return Surface(cloud, joined=True).distance(targets, np.eye(cloud.shape[-1]))


def test_the_distance_to_a_circle_is_that_to_its_rim() -> None:
    angle = np.linspace(0, np.pi, 400)
    rim = np.stack([np.cos(angle), np.sin(angle)], axis=-1)[None]
    rng = np.random.default_rng(1)
    radius, turn = rng.uniform(0.2, 3, 50), rng.uniform(0.1, np.pi - 0.1, 50)
    points = radius[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    assert away(points, rim) == pytest.approx(np.abs(radius - 1), abs=2e-5)


def test_the_distance_to_a_surface_is_that_to_its_plane_between_the_points_of_its_grid() -> None:
    u, v = np.meshgrid(np.linspace(0, 1, 7), np.linspace(0, 2, 9), indexing="ij")
    plane = np.stack([u, v, 0 * u], axis=-1)
    rng = np.random.default_rng(2)
    points = np.column_stack([rng.uniform(0, 1, 40), rng.uniform(0, 2, 40), rng.uniform(-1, 1, 40)])
    assert away(points, plane) == pytest.approx(np.abs(points[:, 2]), abs=1e-12)


def test_whitened_data_of_specimens_inside_their_tolerances_have_unit_variance(bench: OwnBench) -> None:
    design = frequencies_alone(bench)
    white = bench.whitener(design)
    covariance = np.linalg.inv(white.T @ white)
    own = (2e-4) ** 2 + 5e-4**2
    expected = common_variance() * np.ones((3, 3)) + own * np.eye(3)
    # shear is a thousandth of the frequencies here, and thickness and length have hold of it
    assert covariance == pytest.approx(expected, rel=5e-3)
    assert len(bench.columns(design)) == 3


@pytest.mark.long
def test_a_modulus_is_seen_where_the_common_doubt_of_the_frequencies_says(
    curves: tuple[Curve, ...], bench: OwnBench
) -> None:
    seen = forecast_by_curves(curves, frequencies_alone(bench), bench).limits["E"].seen
    own = ((2e-4) ** 2 + 5e-4**2) / 3
    assert seen == pytest.approx(2 * SEEN * np.sqrt(common_variance() + own), rel=0.02)


def test_frequencies_alone_do_not_tell_a_modulus_from_a_density(
    curves: tuple[Curve, ...], bench: OwnBench
) -> None:
    now = forecast_by_curves(curves, frequencies_alone(bench), bench)
    assert now.pairs["E", "density"] < 0.05
    assert not np.isfinite(now.limits["E"].separated)
    assert any({"E", "density", "thickness"} <= set(group) for group in now.classes)
    assert "section_scale" in now.unseen


def test_what_is_the_same_to_any_hammer_stays_the_same(curves: tuple[Curve, ...], bench: OwnBench) -> None:
    """Width moves no frequency and all constants alike, as a gain does: on a beam without a sensor's mass, exactly."""
    now = forecast_by_curves(curves, bench.design, bench)
    assert now.pairs["section_scale", "calibration_gain"] < 0.02
    assert ("section_scale", "calibration_gain") in EQUAL
    assert np.isfinite(now.limits["section_scale"].separated)


@settings(max_examples=8)
@given(
    calibration=st.floats(0.003, 0.019),
    repeatability=st.floats(0.0, 0.00049),
    noise=st.floats(0.1, 0.99),
    drive=st.booleans(),
)
@example(calibration=0.003, repeatability=0.0, noise=0.1, drive=False)
def test_a_better_test_tells_no_less(
    curves: tuple[Curve, ...],
    bench: OwnBench,
    calibration: float,
    repeatability: float,
    noise: float,
    drive: bool,
) -> None:
    plain = bench.design
    assert bench.layout.drive is not None
    better = replace(
        plain,
        calibration=calibration,
        repeatability=repeatability,
        noise=noise,
        stations=(*plain.stations, bench.layout.drive) if drive else plain.stations,
    )
    before, after = (
        forecast_by_curves(curves, design, bench).matrix.to_numpy(float) for design in (plain, better)
    )
    off = ~np.isnan(before)
    # interpolation between the severities solved leaves a few thousandths
    assert np.all(after[off] >= before[off] * (1 - 5e-3) - 5e-3)


def test_a_distance_is_that_in_the_whole_covariance_of_data_and_doubt(
    curves: tuple[Curve, ...], bench: OwnBench
) -> None:
    """Each point of a surface has a doubt of its own, which no single whitening makes independent."""
    by_name = {curve.family.name: curve for curve in curves}
    clamp, sensor = by_name["clamp_rotation"], by_name["sensor_mass"]
    for design in (bench.design, replace(bench.design, calibration=0.003, repeatability=0.0, noise=0.1)):
        have, white = bench.columns(design), bench.whitener(design)
        known, cloud, targets = (
            np.linalg.inv(white.T @ white),
            sensor.cloud[0][:, have],
            clamp.data[0][:, have],
        )
        each = []
        for point in cloud:
            left = targets - point
            whole = known + np.diag((sensor.fidelity * point) ** 2)
            each.append(np.sqrt(np.sum(left * np.linalg.solve(whole, left.T).T, axis=1)))
        exact = np.min(each, axis=0)
        found = Surface(cloud[None], sensor.fidelity).distance(targets, white)
        assert (exact > 3).sum() > 4
        assert found[exact > 3] == pytest.approx(exact[exact > 3], rel=0.05)


def test_every_severity_lies_on_its_own_curve(curves: tuple[Curve, ...], bench: OwnBench) -> None:
    """A severity that was not solved is met by the interpolation within a small part of a sigma."""
    have, white = bench.columns(bench.design), bench.whitener(bench.design)
    for curve in curves:
        target = bench.change(curve.family, 0.73 * curve.family.clear, 0.0)[have]
        (left,) = Surface(curve.cloud[..., have], curve.fidelity).distance(target[None], white)
        assert left < 0.02, curve.family.name


@pytest.mark.long
def test_the_sample_beam_cannot_tell_a_modulus_from_a_thickness_until_its_chain_is_calibrated(
    sample: Forecast,
) -> None:
    assert sample.now.pairs["E", "thickness"] < SEEN
    best = next(one for one in sample.advice if ("E", "thickness") in one.separates)
    assert best.change.key == "calibration"
    assert best.after.pairs["E", "thickness"] >= SEEN
    assert best.factor > 1


def test_advice_is_ordered_and_names_only_pairs_that_it_turns(sample: Forecast) -> None:
    worths = [one.worth for one in sample.advice]
    assert worths == sorted(worths, reverse=True)
    for one in sample.advice:
        for a, b in one.separates:
            if b != "none":
                assert sample.now.pairs[a, b] < SEEN <= one.after.pairs[a, b]
                assert (a, b) not in EQUAL


@pytest.mark.long
def test_every_change_is_followed(sample: Forecast) -> None:
    bench = sample.bench
    assert isinstance(bench, OwnBench)
    for one in sample.advice:
        design, trial = one.change.design, followed(bench.trial, bench.layout, one.change.design)
        setup, hits = trial.ready.test_setup, bench.trial.ready.test_setup.plan.hits
        assert trial.study.test.calibration == design.calibration
        assert trial.study.test.repeatability == pytest.approx(design.repeatability)
        assert trial.problem.tolerances.factors["thickness"] == trial.study.tolerances.thickness
        assert len(np.unique(setup.measured.hit)) == len(design.stations)
        assert np.sqrt(hits / setup.plan.hits) == pytest.approx(design.noise)
        assert setup.band[1] > bench.problem.measured.frequency[design.modes - 1]
        assert setup.plan.rate / SAMPLING >= setup.band[1] * (1 - 1e-9)


def test_the_document_is_json_and_names_every_effect(sample: Forecast) -> None:
    document = json.loads(json.dumps(to_json(sample), allow_nan=False))
    assert not departures(document, PlanDocument)
    names = [row["name"] for row in document["now"]["effects"]]
    assert names == list(sample.now.names)
    assert {"E", "clamp_rotation", "sensor_mass", "local_stiffness"} <= set(names)
    for row in document["now"]["effects"]:
        assert set(row["sigma"]) == {"none", *names}


def test_a_study_with_data_is_read_as_it_was_measured(sample: Forecast) -> None:
    bench = sample.bench
    assert isinstance(bench, OwnBench)
    assert (bench.design.modes, bench.hits, bench.layout.drive) == (3, 15, None)
    assert len(bench.design.stations) == 5
    assert not bench.design.damping_known
    test = bench.problem.measured
    assert np.all(test.frequency_sigma < 2e-4 * test.frequency)


def test_the_sample_beam_is_seen_from_where_its_tolerances_say(sample: Forecast) -> None:
    """Common to all frequencies, sqrt(E / rho) t / L^2: 3 sigma of what the other three leave in doubt, and more."""
    limits, own = sample.now.limits, 3 * np.sqrt(common_variance())
    assert np.expm1(limits["E"].seen) < 2 * own
    assert np.expm1(limits["density"].seen) < np.expm1(limits["E"].seen)
    assert limits["length"].seen < 0.5 * 0.376 * own


def test_modes_alone_are_taken_as_frequencies_alone() -> None:
    bench = bench_of(read_study(SAMPLES / "beam_dry" / "published.toml"))
    assert not bench.design.shapes
    # the test was made in air: what a liquid would do is not asked
    names = {family.name for family in bench.families}
    assert not names & {"fluid_added_mass", "fluid_damping", "calibration_gain", "position_error"}


@pytest.mark.long
def test_what_a_study_does_not_state_of_a_fluid_is_left_open(tmp_path: Path) -> None:
    """Near and far surface and bottom are forms of the fluid; the stated ones are where they are."""
    for more, forms in (
        ("", 4),
        ("[environment]\nfree_surface = 0.02\n", 2),
        ("[environment]\nfree_surface = 0.02\nbottom = 0.05\n", 1),
    ):
        bench = planned(tmp_path, more=more)
        fluid = next(family for family in bench.families if family.name == "fluid_added_mass")
        assert len(fluid.sites) == forms
        lowest = [bench.change(fluid, 998.0, form)[0] for form in fluid.sites]
        assert len(np.unique(np.round(lowest, 6))) == forms
        assert max(lowest) < 0
    bench = planned(tmp_path, more="[environment]\nfluid_density = 1.2\n")
    assert bench.not_forecast["fluid_added_mass"] == "the study rules it out"


def test_a_test_that_is_only_planned_needs_no_data(tmp_path: Path) -> None:
    bench = planned(tmp_path, "points = [0.1, 0.2, 0.3]\nsensor = 0.4\nhits = 7\nband = [5.0, 300.0]")
    places = bench.problem.measured.points[list(bench.design.stations), 0]
    assert places == pytest.approx([0.1, 0.2, 0.3])
    assert bench.layout.drive is not None
    assert (bench.hits, bench.design.modes, bench.design.damping_known) == (7, 2, True)
    assert len(planned(tmp_path, "").design.stations) == 8
    with pytest.raises(StudyError, match=r"0\.5 m is off the beam"):
        planned(tmp_path, "points = [0.1, 0.5]")


def test_a_family_without_signs_is_asked_once_and_one_with_signs_twice(bench: OwnBench) -> None:
    by_name: dict[str, Family] = {family.name: family for family in bench.families}
    assert len(by_name["E"].asked) == 2
    assert len(by_name["sensor_mass"].asked) == 1
    for family in by_name.values():
        assert 0 in family.grid
        assert np.all(np.diff(family.grid) > 0)
        assert family.low <= min(family.asked) <= max(family.asked) <= family.high
