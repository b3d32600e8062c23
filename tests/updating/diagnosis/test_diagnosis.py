"""Causes put into exact beams are named, left out they are unknown, and no bookkeeping changes the answer."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.stats import binomtest
from updating_cases import BEAM as FINE
from updating_cases import DOUBTS, POINTS, blank, case_of, observed, specimen, struck

from acquisition import ModalData
from updating import (
    LIBRARY,
    Axes,
    Case,
    Diagnosis,
    Environment,
    Measured,
    Predictor,
    Tolerances,
    diagnose,
    measured_from_modes,
)
from updating.models.state import State

pytestmark = pytest.mark.long

BEAM = FINE.with_elements(20)
UNIT = BEAM.material.E * BEAM.width * BEAM.thickness**3 / 12 / BEAM.length
THICK = replace(BEAM, thickness=0.012, theory="euler-bernoulli", regions=())


def beam_with(*, seed: int = 11, **changes: object) -> Case:
    """A hammer test of a beam with something the model lacks."""
    rng = np.random.default_rng(seed)
    channel_group = {n: changes.pop(n) for n in ("gain", "decay") if n in changes}
    beam = specimen(rng)
    if "tip" in changes:
        changes["masses"] = ((beam.length, changes.pop("tip")),)
    made = {n: getattr(beam, n) * v if n == "E" else v for n, v in changes.items()}
    return case_of(struck(replace(beam, **made), rng, **channel_group), BEAM)  # type: ignore[arg-type]


def fluid_test(seed: int, *, density: float = 998.0, scatter: float = 0.2) -> Measured:
    """The one specimen in a fluid, from a finer mesh; the fluid is the library's own."""
    rng = np.random.default_rng(11)
    predictor = Predictor(FINE.with_elements(60), blank(POINTS))
    off = State(factors={n: float(np.exp(s * rng.standard_normal())) for n, s in DOUBTS.items()})
    fluid = LIBRARY["fluid_added_mass"].state(predictor, {"fluid_density": density})
    found = predictor.predict(off.plus(fluid), count=5)
    damping = found.damping * np.exp(scatter * rng.standard_normal(5))
    return observed(found.frequency, damping, found.constants, POINTS, np.random.default_rng(seed))


def thick_beam() -> Case:
    rng = np.random.default_rng(11)
    beam = replace(specimen(rng), thickness=THICK.thickness)
    return case_of(struck(beam, rng), THICK)


TRUTHS: dict[str, Callable[[], Case]] = {
    "none": beam_with,
    "E": lambda: beam_with(E=0.88),
    "clamp_rotation": lambda: beam_with(rotation=60 * UNIT),
    "sensor_mass": lambda: beam_with(tip=0.012),
    "local_stiffness": lambda: beam_with(soft=(0.12, 0.14, 0.6)),
    "local_mass": lambda: beam_with(heavy=(0.1, 0.19, 1.5)),
    "shear": thick_beam,
    "fluid_added_mass": lambda: case_of(fluid_test(11), BEAM),
    "exponential_window": lambda: beam_with(decay=8.0),
    "calibration_gain": lambda: beam_with(gain=1.4),
}
SIZE = {
    "E": ("E.factor", 0.88),
    "clamp_rotation": ("clamp_rotation.stiffness", 60 * UNIT),
    "sensor_mass": ("sensor_mass.mass", 0.012),
    "local_stiffness": ("local_stiffness.compliance", 0.02 * 0.6 / 0.4),
    "local_mass": ("local_mass.mass", 0.5 * 7850.0 * 0.09 * BEAM.width * BEAM.thickness),
    "fluid_added_mass": ("fluid_added_mass.fluid_density", 998.0),
    "exponential_window": ("exponential_window.decay", 8.0),
    "calibration_gain": ("calibration_gain.gain", 1.4),
}

ALIKE = {
    "E": ("thickness",),
    "exponential_window": ("uniform_damping",),
    "calibration_gain": ("section_scale",),
}
"""What these five modes cannot tell from a truth; everything else is named."""


@cache
def answer(truth: str) -> Diagnosis:
    return diagnose(TRUTHS[truth]())


@pytest.mark.parametrize("truth", [t for t in TRUTHS if t != "none"])
def test_what_was_put_in_is_named(truth: str) -> None:
    found = answer(truth)
    assert found.significant
    assert found.verdict == ("class" if truth in ALIKE else "named")
    assert set(found.sets) == {(truth,), *((other,) for other in ALIKE.get(truth, ()))}
    assert found.where.channel == LIBRARY[truth].channel
    row = next(r for r in found.ranking if truth in r.effects)
    assert row.p_value > 0.01
    if truth in SIZE:
        name, value = SIZE[truth]
        estimate = row.parameters[name]
        assert estimate.low95 < value < estimate.high95
        assert not estimate.at_bound


@pytest.mark.slow
@pytest.mark.parametrize(("name", "made"), [("E", {"E": 0.88}), ("sensor_mass", {"tip": 0.012})])
def test_intervals_cover_the_truth_as_often_as_they_say(name: str, made: dict[str, float]) -> None:
    """Forty beams, each off by its own tolerances; how many of 0.95 lie inside is binomial."""
    key, value = SIZE[name]
    inside = 0
    for seed in range(40):
        found = diagnose(beam_with(seed=seed, **made), library=some(name))
        estimate = next(r for r in found.ranking if r.effects == (name,)).parameters[key]
        inside += estimate.low95 < value < estimate.high95
    assert binomtest(inside, 40, 0.95).pvalue > 0.01, inside


def test_a_specimen_within_its_tolerances_has_no_gap() -> None:
    found = answer("none")
    assert (found.verdict, found.sets, found.significant) == ("none", (), False)
    assert found.where.channel == "none"
    assert found.p_value > 0.005


def test_the_place_of_a_soft_spot_is_found() -> None:
    where = answer("local_stiffness").where
    assert where.location is not None
    assert where.location[0] == pytest.approx(0.13, abs=0.02)
    top = max(where.zones, key=lambda z: z.probability)
    assert top.center[0] == pytest.approx(0.13, abs=0.03)
    assert sum(z.probability for z in where.zones) == pytest.approx(1.0)
    assert answer("sensor_mass").where.points == (5,)


@pytest.mark.parametrize("truth", ["E", "clamp_rotation", "sensor_mass"])
def test_the_gap_closes_on_modes_held_out(truth: str) -> None:
    shrink = answer(truth).shrink
    assert shrink.before > 3 * shrink.floor
    assert shrink.held_after < 0.5 * shrink.held_before
    assert shrink.closed is not None
    assert 50 < shrink.closed.value <= 100
    assert shrink.closed.low95 <= shrink.closed.value <= shrink.closed.high95


@pytest.mark.parametrize("truth", list(TRUTHS))
def test_probabilities_are_probabilities(truth: str) -> None:
    found = answer(truth)
    assert sum(r.probability for r in found.ranking) <= 1 + 1e-9
    probabilities = [r.probability for r in found.ranking]
    assert probabilities == sorted(probabilities, reverse=True)
    named = {n: p for n, p in found.where.channels.items() if n != "none"}
    assert sum(named.values()) == pytest.approx(1.0)
    held = sum(r.probability for r in found.ranking if r.effects in found.sets)
    fitting = sum(r.probability for r in found.ranking if r.p_value >= 0.01)
    assert not found.sets or held >= 0.95 * fitting - 1e-9
    examined = {n for r in found.ranking for n in r.effects}
    assert examined | set(found.not_examined) == set(LIBRARY)
    assert [(one.causes, one.sets, one.possible) for one in found.searched][:1] == [
        (1, len(LIBRARY) - len(found.not_examined), len(LIBRARY) - len(found.not_examined))
    ]
    assert all(one.sets <= one.possible for one in found.searched)


def some(*names: str) -> list:
    return [LIBRARY[n] for n in names]


@pytest.mark.parametrize(
    ("truth", "offered"),
    [
        ("sensor_mass", ("E", "density")),
        ("exponential_window", ("E", "sensor_mass")),
        ("E", ("calibration_gain",)),
    ],
)
def test_a_cause_that_the_library_lacks_is_unknown(truth: str, offered: tuple[str, ...]) -> None:
    found = diagnose(TRUTHS[truth](), library=some(*offered))
    assert (found.verdict, found.sets) == ("unknown", ())
    assert found.significant


def test_two_causes_at_once_are_found_as_a_pair() -> None:
    library = some("E", "clamp_rotation", "sensor_mass", "exponential_window", "calibration_gain")
    found = diagnose(beam_with(decay=8.0, tip=0.012), library=library)
    assert (found.verdict, found.sets) == ("named", (("exponential_window", "sensor_mass"),))


def test_frequencies_alone_cannot_tell_factors_apart() -> None:
    beam = specimen(np.random.default_rng(4), E=0.85)
    frequency = beam.frequencies(5)
    data = ModalData(frequency=frequency, frequency_sigma=1e-4 * frequency)
    test = measured_from_modes(data, Axes(), BEAM)
    found = diagnose(case_of(test, BEAM))
    assert found.verdict == "class"
    assert {"E", "density", "thickness"} <= set(found.effects)
    assert "calibration_gain" in found.not_examined
    row = next(r for r in found.ranking if r.effects == ("E",))
    assert {("density",), ("thickness",)} <= set(row.equivalents)


def shapes_alone(gain: float) -> Case:
    """The beam within its tolerances by mass-normalised shapes; a gain of the FRFs is its root in them."""
    stated = beam_with()
    test = stated.measured
    drive = np.flatnonzero(test.seen == test.hit)[0]
    signs = np.sign(np.arange(test.constants.shape[1]) % 2 - 0.5)  # free mode by mode
    scale = signs * np.sqrt(gain / np.abs(test.constants[drive]))
    shapes = replace(
        test,
        constants=test.constants * scale,
        constants_sigma=test.constants_sigma * np.abs(scale),
        seen=test.hit,
        hit=np.full(len(test.hit), -1),
    )
    return replace(stated, measured=shapes)


def test_mass_normalised_shapes_of_the_right_level_have_no_gap() -> None:
    assert diagnose(shapes_alone(1.0), library=some("E", "sensor_mass", "calibration_gain")).verdict == "none"


def test_the_level_of_mass_normalised_shapes_is_compared() -> None:
    found = diagnose(shapes_alone(1.6), library=some("E", "sensor_mass", "calibration_gain"))
    assert (found.verdict, found.sets) == ("named", (("calibration_gain",),))
    estimate = found.ranking[0].parameters["calibration_gain.gain"]
    assert estimate.low95 < 1.6 < estimate.high95
    assert estimate.high95 / estimate.low95 < 1.3


def test_an_effect_put_into_the_model_is_not_found_again() -> None:
    stated = replace(TRUTHS["sensor_mass"](), accepted=(("sensor_mass", {"mass": 0.012}),))
    found = diagnose(stated, library=some("E", "sensor_mass", "clamp_rotation"))
    assert found.verdict == "none"
    assert all("sensor_mass" not in r.effects for r in found.ranking)


def test_a_dry_test_before_makes_the_wet_one_certain() -> None:
    """The drawing may be wrong by a tenth: what the dry test has seen is no gap of the wet one."""
    wet, dry = fluid_test(1, scatter=0.0), fluid_test(2, density=1e-6, scatter=0.0)
    wrong = replace(BEAM, material=replace(BEAM.material, E=1.2 * BEAM.material.E))
    case = case_of(wet, wrong, baseline=dry, environment=Environment(fluid_density=998.0))
    found = diagnose(case, library=some("E", "density", "fluid_added_mass", "sensor_mass"))
    assert (found.verdict, found.sets) == ("named", (("fluid_added_mass",),))
    again = diagnose(replace(case, measured=fluid_test(3, density=1e-6, scatter=0.0)), library=SHORT)
    assert again.verdict == "none"


SHORT = some("E", "clamp_rotation", "sensor_mass", "exponential_window")


def permuted_frfs(case: Case) -> Case:
    test, order = case.measured, np.array([3, 0, 4, 2, 1])
    rows = {n: getattr(test, n)[order] for n in ("seen", "hit", "constants", "constants_sigma")}
    return replace(case, measured=replace(test, **rows))


def permuted_points(case: Case) -> Case:
    test, order = case.measured, np.array([3, 0, 4, 2, 1])
    where = np.argsort(order)
    moved = replace(test, points=test.points[order], seen=where[test.seen], hit=where[test.hit])
    return replace(case, measured=replace(moved, nodes=tuple(test.nodes[i] for i in order)))


def renamed(case: Case) -> Case:
    return replace(case, measured=replace(case.measured, nodes=(70, 12, 3, 999, 5)))


def mirrored(case: Case) -> Case:
    """The x axis points the other way, the clamp and the points with it."""
    test, spec = case.measured, replace(case.spec, clamped=("x1",), regions=())
    return replace(case, spec=spec, measured=replace(test, points=spec.length - test.points))


def permuted_modes(case: Case) -> Case:
    return replace(case, measured=case.measured.modes(np.array([2, 0, 4, 1, 3])))


@cache
def short_answer(truth: str) -> Diagnosis:
    return diagnose(TRUTHS[truth](), library=SHORT)


@pytest.mark.parametrize(
    ("truth", "change"),
    [
        ("sensor_mass", permuted_frfs),
        ("sensor_mass", permuted_points),
        ("sensor_mass", renamed),
        ("sensor_mass", mirrored),
        ("sensor_mass", permuted_modes),
        ("none", permuted_points),
        ("none", mirrored),
    ],
)
def test_bookkeeping_does_not_change_the_answer(truth: str, change: Callable[[Case], Case]) -> None:
    plain = short_answer(truth)
    other = diagnose(change(TRUTHS[truth]()), library=SHORT)
    assert (other.verdict, other.sets) == (plain.verdict, plain.sets)
    assert other.p_value == pytest.approx(plain.p_value, rel=1e-3)
    assert other.gap.rms_percent == pytest.approx(plain.gap.rms_percent, rel=1e-6)
    assert other.ranking[0].probability == pytest.approx(plain.ranking[0].probability, abs=0.02)


def test_the_answer_repeats() -> None:
    one, two = short_answer("sensor_mass"), diagnose(TRUTHS["sensor_mass"](), library=SHORT)
    assert one.p_value == two.p_value
    assert [r.probability for r in one.ranking] == [r.probability for r in two.ranking]
    assert one.shrink == two.shrink


def test_wide_doubts_leave_nothing_to_explain() -> None:
    """A modeller who doubts E by a third cannot be surprised by 12 %."""
    case = replace(TRUTHS["E"](), tolerances=Tolerances(DOUBTS | {"E": 0.3}))
    assert diagnose(case, library=some("E", "density")).verdict == "none"


def test_a_case_is_not_changed_by_looking_at_it() -> None:
    case = TRUTHS["sensor_mass"]()
    before = {n: np.array(getattr(case.measured, n)) for n in ("frequency", "constants", "points", "damping")}
    diagnose(case, library=SHORT)
    for name, values in before.items():
        np.testing.assert_array_equal(getattr(case.measured, name), values)
