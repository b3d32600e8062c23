"""Faults of the measurement, put into hammer tests from the hits up, are named, and point at the nodes concerned."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from struck_cases import ROD, SHEET, Faults, Roving, struck_case
from updating_cases import blank

from updating import LIBRARY, Case, Diagnosis, Predictor, diagnose
from updating.effects.measurement.points import indices
from updating.test_data.chain_phase import turn

pytestmark = pytest.mark.long

NAMES = (
    "E", "section_scale", "uniform_damping", "exponential_window", "calibration_gain", "channel_gain", "time_delay",
    "polarity", "swapped_points", "position_error",
)  # fmt: skip
OFFERED = [LIBRARY[name] for name in NAMES]
SAMPLE = 1 / ROD.rate

ON_BEAMS: dict[str, tuple[Faults, str]] = {
    "a part of a sample late": (Faults(delay=0.3 * SAMPLE), "time_delay"),
    "three samples late": (Faults(delay=3 * SAMPLE), "time_delay"),
    "one point reversed": (Faults(turned=(2,)), "polarity"),
    "two points reversed": (Faults(turned=(1, 4)), "polarity"),
    "neighbours exchanged": (Faults(exchanged=(2, 3)), "swapped_points"),
    "far points exchanged": (Faults(exchanged=(1, 4)), "swapped_points"),
    "10 mm beside": (Faults(moved={3: (0.010,)}), "position_error"),
}


@cache
def on_beam(
    fault: str, roving: Roving = "hammer", sensors: tuple[int, ...] = (5,), baseline: bool = False
) -> Case:
    faults = ON_BEAMS[fault][0] if fault else Faults()
    return struck_case(ROD, faults, seed=3, roving=roving, sensors=sensors, baseline=baseline)


@cache
def answer(
    fault: str, roving: Roving = "hammer", sensors: tuple[int, ...] = (5,), baseline: bool = False
) -> Diagnosis:
    return diagnose(on_beam(fault, roving, sensors, baseline), library=OFFERED)


def concerned(faults: Faults) -> set[int]:
    return {*faults.turned, *faults.exchanged, *faults.moved, *faults.upside_down}


@pytest.mark.parametrize("fault", list(ON_BEAMS))
def test_a_fault_on_a_beam_is_named(fault: str) -> None:
    faults, name = ON_BEAMS[fault]
    found = answer(fault)
    assert (found.verdict, found.sets) == ("named", ((name,),))
    assert found.included[name] > 0.99
    assert found.where.channel == "measurement"
    assert set(found.where.points) == concerned(faults)
    assert len(found.gap.modes) == 5
    row = found.ranking[0].parameters
    if faults.delay:
        assert row["time_delay.delay"].value == pytest.approx(faults.delay, abs=0.02 * SAMPLE)
    for node, (away,) in faults.moved.items():
        assert row["position_error.dx"].value == pytest.approx(away, abs=0.0015)
        assert found.where.location is not None
        assert found.where.location[0] == pytest.approx(ROD.points[node - 1, 0] + away, abs=0.0015)


@pytest.mark.parametrize(
    ("fault", "roving", "sensors", "baseline"),
    [
        ("two points reversed", "accelerometer", (5,), False),
        ("three samples late", "hammer", (3, 5), False),
        ("far points exchanged", "accelerometer", (3, 5), True),
    ],
)
def test_a_fault_is_named_whatever_roves(
    fault: str, roving: Roving, sensors: tuple[int, ...], baseline: bool
) -> None:
    faults, name = ON_BEAMS[fault]
    found = answer(fault, roving, sensors, baseline)
    assert (found.verdict, found.sets) == ("named", ((name,),))
    assert set(found.where.points) == concerned(faults)


@pytest.mark.parametrize(
    ("roving", "sensors", "baseline"),
    [
        ("hammer", (5,), False),
        ("accelerometer", (3, 5), True),
    ],
)
def test_a_sound_measurement_has_no_fault(roving: Roving, sensors: tuple[int, ...], baseline: bool) -> None:
    assert answer("", roving, sensors, baseline).verdict == "none"


ON_PLATES = {
    "three points reversed": (Faults(turned=(3, 10, 17)), "polarity"),
    "20 mm beside, on an edge": (Faults(moved={13: (-0.020, 0.0)}), "position_error"),
}


@pytest.mark.parametrize("fault", list(ON_PLATES))
def test_a_fault_on_a_plate_is_named(fault: str) -> None:
    faults, name = ON_PLATES[fault]
    found = diagnose(struck_case(SHEET, faults, seed=3), library=OFFERED)
    assert (found.verdict, found.sets) == ("named", ((name,),))
    assert set(found.where.points) == concerned(faults)
    for node, away in faults.moved.items():
        assert found.where.location is not None
        assert found.where.location[:2] == pytest.approx(SHEET.points[node - 1] + np.array(away), abs=0.003)


def test_a_sensor_upside_down_is_named() -> None:
    case = struck_case(ROD, Faults(upside_down=(3,)), seed=3, sensors=(3, 5))
    found = diagnose(case, library=OFFERED)
    assert (found.verdict, found.sets) == ("named", (("polarity",),))
    assert found.where.points == (3,)


def test_the_only_sensor_upside_down_is_named() -> None:
    """Or the hammer's sign: every FRF is reversed, whichever point is hit."""
    found = diagnose(struck_case(ROD, Faults(upside_down=(5,)), seed=3), library=OFFERED)
    assert (found.verdict, found.sets) == ("named", (("polarity",),))
    assert found.where.points == (5,)
    assert found.ranking[0].parameters["polarity.channel"].value.startswith("5")


@pytest.mark.parametrize("roving", ["hammer", "accelerometer"])
def test_a_point_of_wrong_level_is_named(roving: Roving) -> None:
    found = diagnose(struck_case(ROD, Faults(louder={3: 0.8}), seed=3, roving=roving), library=OFFERED)
    assert (found.verdict, found.sets) == ("named", (("channel_gain",),))
    assert found.where.points == (3,)
    gain = found.ranking[0].parameters["channel_gain.gain"]
    assert gain.value == pytest.approx(0.8, rel=0.02)
    assert 0.0005 < gain.high95 - gain.low95 < 0.05


def test_a_sensor_of_wrong_level_among_two_is_named() -> None:
    case = struck_case(ROD, Faults(louder_still={3: 1.3}), seed=3, sensors=(3, 5))
    found = diagnose(case, library=OFFERED)
    assert (found.verdict, found.sets) == ("named", (("channel_gain",),))
    assert found.where.points == (3,)
    row = found.ranking[0].parameters
    assert row["channel_gain.channel"].value.startswith("3")
    assert row["channel_gain.gain"].value == pytest.approx(1.3, rel=0.03)


def test_the_level_alone_is_the_calibration_or_the_section() -> None:
    found = diagnose(struck_case(ROD, Faults(gain=0.74), seed=3), library=OFFERED)
    assert found.verdict == "class"
    assert {*found.sets} == {("calibration_gain",), ("section_scale",)}
    row = next(r for r in found.ranking if r.effects == ("calibration_gain",))
    assert row.parameters["calibration_gain.gain"].value == pytest.approx(0.74, rel=0.04)


def test_a_window_left_in_is_no_damping_for_constants_turn_and_noise_fades() -> None:
    found = diagnose(struck_case(ROD, Faults(decay=4.0), seed=3, baseline=True), library=OFFERED)
    assert found.verdict == "named"
    assert found.sets == (("exponential_window",),)
    row = next(r for r in found.ranking if r.effects == ("exponential_window",))
    assert row.parameters["exponential_window.decay"].value == pytest.approx(4.0, rel=0.1)


def test_no_sign_is_lost_between_chains_however_late_they_are() -> None:
    """Two sensors see real modes through one delay: seen together, their constants are real and of the right signs."""
    rng = np.random.default_rng(5)
    shapes = rng.standard_normal((6, 4))
    seen, hit = np.repeat([0, 4], 6), np.tile(np.arange(6), 2)
    truth = shapes[seen] * shapes[hit]
    noise = 1e-3 * (rng.standard_normal(truth.shape) + 1j * rng.standard_normal(truth.shape))
    for lag in np.linspace(-np.pi, np.pi, 41):
        found = turn(truth * np.exp(1j * lag) + noise, np.full(truth.shape, 1e-3), seen, hit)
        sign = np.sign(np.sum(found.real * truth, axis=0))
        assert found.real * sign == pytest.approx(truth, abs=0.01)


def test_a_point_is_sought_on_the_structure_only() -> None:
    predictor = Predictor(SHEET.nominal, blank(SHEET.points))
    effect = LIBRARY["position_error"]
    for node in (13, 7, 20):
        at = SHEET.points[node - 1]
        for quantile in (0.0, 0.3, 1.0):
            values = effect.settled(predictor, {**effect.values(predictor, [quantile] * 2), "point": node})
            where = at + np.array([values["dx"], values["dy"]])
            assert (where >= -1e-12).all()
            assert (where <= np.array([SHEET.nominal.length, SHEET.nominal.width]) + 1e-12).all()


def test_points_are_named_by_their_nodes() -> None:
    case = on_beam("one point reversed")
    other = dict(zip(case.measured.nodes, (70, 12, 3, 999, 50), strict=True))
    nodes = tuple(other[n] for n in case.measured.nodes)
    renamed = replace(case, measured=replace(case.measured, nodes=nodes))
    assert diagnose(renamed, library=OFFERED).where.points == (other[2],)
    assert indices(renamed.measured, nodes[::-1]) == [4, 3, 2, 1, 0]


def test_an_accepted_fault_is_not_found_again() -> None:
    case = replace(on_beam("one point reversed"), accepted=(("polarity", {"points": (2,)}),))
    assert diagnose(case, library=OFFERED).verdict == "none"
    predictor = Predictor(case.spec, case.measured)
    (reversed_point,) = indices(case.measured, (2,))
    state = LIBRARY["polarity"].state(predictor, {"points": (2,)})
    assert state.point_gains == {("hit", reversed_point): -1.0}
