"""The forecast of a test: distances, covariance, thresholds, changes, and what a study tells of them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conforming import departures
from hypothesis import given, settings
from hypothesis import strategies as st

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from modalkit.output.schemas import PlanDocument
from modalkit.planning import KnownTest, RigBench, by_default, forecast
from modalkit.planning.curves import Curve, solve_curve
from modalkit.planning.design import Design, columns, present, whitener
from modalkit.planning.document import to_json
from modalkit.planning.effects import families
from modalkit.planning.family import Family
from modalkit.planning.forecast import DesignForecast, Forecast
from modalkit.planning.from_study import known_test_of
from modalkit.planning.responses import Stations, hidden
from modalkit.planning.separability import EQUAL, SEEN, distances, nearest_in
from modalkit.simulator.scene import nominal_scene
from modalkit.simulator.setup import Setup, Tolerances
from modalkit.study.read import read_study

SAMPLES = Path(__file__).resolve().parents[3] / "sample_data"

SETUP = Setup(
    kind="beam",
    title="Beam",
    length=0.4,
    width=0.03,
    thickness=0.005,
    E=210e9,
    density=7850.0,
    poisson=0.3,
    clamped=("x0",),
    theory="timoshenko",
    elements=(20,),
    tolerances=Tolerances(),
    alpha=1.0,
    beta=1e-6,
    points=((0.08,), (0.16,), (0.24,), (0.32,), (0.4,)),
    sensor=4,
    drive=False,
    sensor_sign=1,
    sensor_mass=0.0,
    modes=3,
    band=(5.0, 500.0),
    hits=5,
    peak=100.0,
    level_scatter=0.3,
    bad_hits=0.0,
    noise=1e-3,
    noise_slope=0.0,
    bits=24,
    calibration=0.02,
    repeatability=0.0005,
    position_sigma=0.001,
    window=0.0,
    baseline=False,
    environment=None,
)
FEW = ("E", "density", "thickness", "section_scale", "clamp_rotation", "calibration_gain", "sensor_mass")


def known_test(setup: Setup = SETUP, **changes: object) -> KnownTest:
    return replace(KnownTest(setup, *by_default(setup.modes)), **changes)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def stations() -> Stations:
    return Stations(SETUP)


@pytest.fixture(scope="module")
def curves(stations: Stations) -> tuple[Curve, ...]:
    return tuple(solve_curve(f, stations.change) for f in families(known_test()) if f.name in FEW)


@pytest.fixture(scope="module")
def sample() -> Forecast:
    return forecast(RigBench(known_test_of(read_study(SAMPLES / "beam_dry" / "study.toml"))))


def forecast_by_curves(curves: tuple[Curve, ...], design: Design, known: KnownTest) -> DesignForecast:
    return DesignForecast(design, distances(curves, design, RigBench(known)))


def away(targets: FloatArray, cloud: FloatArray) -> FloatArray:
    return np.linalg.norm(nearest_in(targets, cloud)[0], axis=1)


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


def test_whitened_data_of_specimens_inside_their_tolerances_have_unit_variance(stations: Stations) -> None:
    """Frequencies of a cantilever go with sqrt(E / rho) t / L^2, so their doubt is known in closed form."""
    known = known_test(shapes=False, damping_known=False)
    design = present(known)
    white = whitener(design, known, stations)
    covariance = np.linalg.inv(white.T @ white)
    t = SETUP.tolerances
    common = (0.5 * t.E) ** 2 + (0.5 * t.density) ** 2 + t.thickness**2 + (2 * t.length) ** 2
    own = known.frequency[0] ** 2 + SETUP.repeatability**2
    expected = common * np.ones((3, 3)) + own * np.eye(3)
    # shear is a thousandth of the frequencies here, and thickness and length have hold of it
    assert covariance == pytest.approx(expected, rel=5e-3)
    assert len(columns(design, stations)) == 3


def test_a_modulus_is_seen_where_the_common_doubt_of_the_frequencies_says(
    curves: tuple[Curve, ...], stations: Stations
) -> None:
    known = known_test(shapes=False, damping_known=False)
    seen = forecast_by_curves(curves, present(known), known).limits["E"].seen
    t = SETUP.tolerances
    common = (0.5 * t.E) ** 2 + (0.5 * t.density) ** 2 + t.thickness**2 + (2 * t.length) ** 2
    own = (known.frequency[0] ** 2 + SETUP.repeatability**2) / 3
    assert seen == pytest.approx(2 * SEEN * np.sqrt(common + own), rel=0.02)


def test_frequencies_alone_do_not_tell_a_modulus_from_a_density(
    curves: tuple[Curve, ...], stations: Stations
) -> None:
    known = known_test(shapes=False, damping_known=False)
    now = forecast_by_curves(curves, present(known), known)
    assert now.pairs["E", "density"] < 0.05
    assert not np.isfinite(now.limits["E"].separated)
    assert any({"E", "density", "thickness"} <= set(group) for group in now.classes)
    assert "section_scale" in now.unseen


def test_what_is_the_same_to_any_hammer_stays_the_same(curves: tuple[Curve, ...], stations: Stations) -> None:
    """Width moves no frequency and all constants alike, as a gain does: on a beam without a sensor's mass, exactly."""
    now = forecast_by_curves(curves, present(known_test()), known_test())
    assert now.pairs["section_scale", "calibration_gain"] < 0.02
    assert ("section_scale", "calibration_gain") in EQUAL
    assert np.isfinite(now.limits["section_scale"].separated)


@settings(max_examples=8, deadline=None)
@given(
    calibration=st.floats(0.003, 0.019),
    repeatability=st.floats(0.0, 0.00049),
    noise=st.floats(0.1, 0.99),
    drive=st.booleans(),
)
def test_a_better_test_tells_no_less(
    curves: tuple[Curve, ...],
    stations: Stations,
    calibration: float,
    repeatability: float,
    noise: float,
    drive: bool,
) -> None:
    known, plain = known_test(), present(known_test())
    better = replace(
        plain,
        calibration=calibration,
        repeatability=repeatability,
        noise=noise,
        stations=(*plain.stations, SETUP.sensor) if drive else plain.stations,
    )
    before, after = (
        forecast_by_curves(curves, design, known).matrix.to_numpy(float) for design in (plain, better)
    )
    off = ~np.isnan(before)
    # interpolation between the severities solved leaves a few thousandths
    assert np.all(after[off] >= before[off] * (1 - 5e-3) - 5e-3)


def test_every_severity_lies_on_its_own_curve(curves: tuple[Curve, ...], stations: Stations) -> None:
    """A severity that was not solved is met by the interpolation within a small part of a sigma."""
    known = known_test()
    design = present(known)
    white, have = whitener(design, known, stations), columns(design, stations)
    for curve in curves:
        q = 0.73 * curve.family.clear
        change = stations.change(curve.family, q, 0.0)[have] @ white.T
        assert away(change[None], curve.cloud[..., have] @ white.T)[0] < 0.02


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


def test_every_change_says_how_it_is_followed(sample: Forecast) -> None:
    assert isinstance(sample.bench, RigBench)
    setup = sample.bench.known_test.setup
    for one in sample.advice:
        followed, design = one.change.follow(setup), one.change.design
        assert followed.calibration == design.calibration
        assert followed.baseline == design.baseline
        assert followed.modes == design.modes
        assert followed.repeatability == pytest.approx(design.repeatability)
        assert len(followed.points) - (not followed.drive) == len(design.stations)
        assert np.sqrt(setup.hits / followed.hits) == pytest.approx(design.noise)
        assert followed.band[1] > followed.nominal_hz[followed.modes - 1]


def test_the_document_is_json_and_names_every_effect(sample: Forecast) -> None:
    document = json.loads(json.dumps(to_json(sample), allow_nan=False))
    assert not departures(document, PlanDocument)
    names = [row["effect"] for row in document["now"]["effects"]]
    assert names == list(sample.now.names)
    assert {"E", "clamp_rotation", "sensor_mass", "local_stiffness"} <= set(names)
    for row in document["now"]["effects"]:
        assert set(row["sigma"]) == {"none", *names}


def test_a_study_with_data_is_read_as_it_was_measured() -> None:
    known = known_test_of(read_study(SAMPLES / "beam_dry" / "study.toml"))
    assert known.setup.modes == 3
    assert known.setup.hits == 15
    assert known.setup.drive
    assert known.setup.window == 8.0
    assert not known.damping_known
    assert np.all(known.frequency < 2e-4)


def test_modes_alone_are_taken_as_frequencies_alone() -> None:
    known = known_test_of(read_study(SAMPLES / "beam_dry" / "published.toml"))
    assert not known.shapes
    # the test was made in air: what a liquid would do is not asked
    names = {family.name for family in families(known)}
    assert not names & {"fluid_added_mass", "fluid_damping", "calibration_gain", "position_error"}


def test_what_a_study_does_not_state_of_a_fluid_is_left_open(tmp_path: Path) -> None:
    """Near and far surface and bottom are forms of the fluid; the stated ones are where they are."""
    path = tmp_path / "study.toml"
    text, wanted = STUDY.format(test="band = [5.0, 300.0]"), "of a fluid not stated: near or far off"
    for more, forms, words in (
        ("", 4, f"free surface and bottom {wanted}"),
        ("[environment]\nfree_surface = 0.02\n", 2, f"bottom {wanted}"),
        ("[environment]\nfree_surface = 0.02\nbottom = 0.05\n", 1, "bottom at 50 mm"),
    ):
        path.write_text(text + more)
        known = known_test_of(read_study(path))
        fluid = next(family for family in families(known) if family.name == "fluid_added_mass")
        assert (len(fluid.sites), words in known.statement) == (forms, True)
        assert not any("fluid" in word for word in known.left_out)
        base = nominal_scene(known.setup)
        lowest = [hidden(fluid, base, 998.0, form).elastic().frequency[0] for form in fluid.sites]
        assert len(np.unique(np.round(lowest, 6))) == forms
        assert all(omega < base.elastic().frequency[0] for omega in lowest)
    path.write_text(text + "[environment]\nfluid_density = 1.2\n")
    assert not any("fluid" in word for word in known_test_of(read_study(path)).statement)


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


def test_a_test_that_is_only_planned_needs_no_data(tmp_path: Path) -> None:
    path = tmp_path / "study.toml"
    path.write_text(
        STUDY.format(test="points = [0.1, 0.2, 0.3]\nsensor = 0.4\nhits = 7\nband = [5.0, 300.0]")
    )
    known = known_test_of(read_study(path))
    assert known.setup.points == ((0.1,), (0.2,), (0.3,), (0.4,))
    assert (known.setup.sensor, known.setup.drive, known.setup.hits, known.setup.modes) == (3, False, 7, 2)
    assert known.damping_known
    path.write_text(STUDY.format(test=""))
    assert len(known_test_of(read_study(path)).setup.points) == 8
    path.write_text(STUDY.format(test="points = [0.1, 0.5]"))
    with pytest.raises(StudyError, match=r"0\.5 m is off the beam"):
        known_test_of(read_study(path))


def test_a_family_without_signs_is_asked_once_and_one_with_signs_twice() -> None:
    by_name: dict[str, Family] = {family.name: family for family in families(known_test())}
    assert len(by_name["E"].asked) == 2
    assert len(by_name["sensor_mass"].asked) == 1
    for family in by_name.values():
        assert 0 in family.grid
        assert np.all(np.diff(family.grid) > 0)
        assert family.low <= min(family.asked) <= max(family.asked) <= family.high
