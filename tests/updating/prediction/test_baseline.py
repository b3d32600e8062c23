"""A model corrected by a baseline has the baseline's modes, and everything else acts on top."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from updating_cases import BEAM, POINTS, blank, case_of, specimen, struck

from acquisition.errors import EstimationError
from updating import LIBRARY, Damping, Measured, Predictor
from updating.diagnosis.diagnose import pose
from updating.likelihood.gaussian import marginal
from updating.models.state import State
from updating.prediction.baseline import correct, in_one_chain, modal_mass
from updating.test_data.chain import measurement_chain

LOOK = Predictor(BEAM, blank(POINTS))
SOUND = LOOK.predict(count=5)


def baseline(ratios: list[float], *, damping: float | None = 0.01, shapes: bool = True) -> Measured:
    """The model's own modes with frequencies off by given ratios."""
    n = len(ratios)
    keep = slice(None) if shapes else slice(0, 0)
    frequency = SOUND.frequency[:n] * np.array(ratios)
    test = LOOK.measured
    return replace(
        test,
        frequency=frequency,
        frequency_sigma=1e-4 * frequency,
        damping=np.full(n, np.nan if damping is None else damping) * (1 + 0.1 * np.arange(n)),
        damping_sigma=np.full(n, 1e-4),
        seen=test.seen[keep],
        hit=test.hit[keep],
        constants=SOUND.constants[keep, :n],
        constants_sigma=0.01 * np.abs(SOUND.constants[keep, :n]) + 1e-6,
        absolute=shapes,
    )


def corrected(test: Measured) -> Predictor:
    own_predictor = LOOK.for_test(test)
    state = correct(own_predictor, test, np.arange(len(test.frequency)))
    return own_predictor.for_test(test, (lambda _: state,))


@settings(max_examples=10)
@given(ratios=st.lists(st.floats(0.85, 1.2), min_size=2, max_size=5), shapes=st.booleans())
def test_the_model_takes_the_baselines_frequencies_and_damping(ratios: list[float], shapes: bool) -> None:
    test = baseline(ratios, shapes=shapes)
    order = np.argsort(test.frequency)
    if not shapes:  # ranks are all there is
        test = test.modes(order)
    found = corrected(test).predict(count=len(ratios))
    rank = np.argsort(np.argsort(test.frequency))
    assert found.frequency[rank] == pytest.approx(test.frequency, rel=1e-6)
    assert found.damping[rank] == pytest.approx(test.damping, rel=1e-6)


def test_a_real_baseline_is_reproduced() -> None:
    """A specimen from an exact beam with its tolerances, noise and all."""
    rng = np.random.default_rng(2)
    test = struck(specimen(rng), rng)
    found = corrected(test).predict(count=5)
    assert found.frequency == pytest.approx(test.frequency, rel=1e-6)
    assert found.damping == pytest.approx(test.damping, rel=1e-6)


def test_shapes_stay_the_models() -> None:
    found = corrected(baseline([0.9, 0.95, 1.1, 1.0, 1.05])).predict(count=5)
    np.testing.assert_allclose(found.constants, SOUND.constants, rtol=1e-5, atol=1e-6)


def test_modes_that_were_not_measured_follow_the_measured_ones() -> None:
    found = corrected(baseline([0.9, 0.9, 0.9])).predict(count=5).frequency
    assert found[3:] == pytest.approx(0.9 * SOUND.frequency[3:], rel=1e-6)


def test_an_effect_acts_on_the_corrected_model() -> None:
    """A uniform beam 10 % slow, then a mass at the tip: as if the beam had been made of softer stuff."""
    soft = replace(BEAM, material=replace(BEAM.material, E=0.81 * BEAM.material.E))
    truth = Predictor(soft, LOOK.measured)
    predictor = corrected(baseline([0.9] * 5))
    for name, values in (("sensor_mass", {"mass": 0.02}), ("clamp_rotation", {"stiffness": 300.0})):
        expected = truth.predict(LIBRARY[name].state(truth, values), count=5).frequency
        found = predictor.predict(LIBRARY[name].state(predictor, values), count=5).frequency
        assert found == pytest.approx(expected, rel=1e-4)


def test_a_baseline_without_damping_expects_none() -> None:
    bare = Predictor(replace(BEAM, damping=Damping()), LOOK.measured)
    test = baseline([0.9, 1.0], damping=None)
    assert correct(bare.for_test(test), test, np.arange(2)).damping == ()
    known = correct(bare.for_test(test), baseline([0.9, 1.0]), np.arange(2))
    assert len(known.damping) == 1
    stated = bare.for_test(test, (lambda _: known,))
    assert stated.expects_damping
    assert not bare.expects_damping


def test_two_modes_for_one_of_the_models_are_refused() -> None:
    test = baseline([1.0, 1.0], shapes=False)
    with pytest.raises(EstimationError, match="two measured modes"):
        correct(LOOK.for_test(test), test, np.array([0, 0]))
    assert isinstance(correct(LOOK.for_test(test), test, np.array([0, 1])), State)


FREE = replace(BEAM, length=0.5, clamped=())


def test_modes_with_the_sensor_on_a_node_say_nothing_of_the_mass() -> None:
    """A free beam seen from its middle: half of its modes have a node there, and are seen because it sits beside it."""
    places = np.linspace(0.0, 0.5, 9)
    middle = Predictor(FREE, blank(places, sensor=4))
    beside = Predictor(FREE, blank(places + np.where(np.arange(9) == 4, 0.001, 0.0), sensor=4))
    true, model = beside.predict(count=6), middle.predict(count=6)
    assert (
        np.linalg.norm(model.constants, axis=0) < 1e-6 * np.linalg.norm(true.constants, axis=0)
    ).sum() == 3
    test = replace(
        middle.measured,
        frequency=true.frequency,
        frequency_sigma=1e-4 * true.frequency,
        damping=np.full(6, 0.01),
        damping_sigma=np.full(6, 1e-4),
        constants=true.constants,
        constants_sigma=0.01 * np.abs(true.constants) + 1e-6,
    )
    heavier, doubt = modal_mass(test, model.constants)
    assert heavier == pytest.approx(1.0, abs=0.01)
    assert doubt < 0.1
    state = correct(middle.for_test(test), test, np.arange(6))
    found = middle.for_test(test, (lambda _: state,)).predict(count=8)
    assert found.frequency == pytest.approx(middle.predict(count=8).frequency, rel=0.002)


@pytest.mark.parametrize(
    "state",
    [
        State(exchanged=(("hit", 1, 3),)),
        State(point_gains={("hit", 3): -1.0}),
        State(point_gains={("hit", 3): 0.8}),
    ],
    ids=["two labels exchanged", "a sign reversed", "a level off"],
)
def test_what_the_model_misses_is_read_as_the_measurement_reads_the_rest(state: State) -> None:
    """A chain off by 30 % in both tests; what the second got wrong besides, undone, fits as if it had not."""
    rng = np.random.default_rng(5)
    beam = specimen(rng)
    before, after = (
        replace(quiet, constants=0.7 * quiet.constants) for quiet in (struck(beam, rng), struck(beam, rng))
    )
    chain = measurement_chain(after, state)
    row = np.array([int(np.flatnonzero(after.hit == point)[0]) for point in chain.hit])
    wrong = replace(
        after,
        constants=chain.gain[:, None] * after.constants[row],
        constants_sigma=np.abs(chain.gain[:, None]) * after.constants_sigma[row],
    )
    fits = [
        marginal(pose(replace(case_of(test, BEAM), baseline=before))[0].compare(undone)).chi2
        for test, undone in ((after, State()), (wrong, state))
    ]
    assert fits[1] == pytest.approx(fits[0], rel=0.02)


@pytest.mark.parametrize("gain", [0.4, 2.5])
def test_a_chain_without_calibration_is_calibrated_by_the_baseline(gain: float) -> None:
    """The level of both tests is that of the chain; one that has changed in between is seen."""
    rng = np.random.default_rng(7)
    beam = specimen(rng)
    tests = [replace(struck(beam, rng), calibration=0.5) for _ in range(2)]
    for after in (1.0, 1.3):
        found = []
        for chain in (1.0, gain):
            before, now = (
                replace(test, constants=level * test.constants, constants_sigma=level * test.constants_sigma)
                for test, level in zip(tests, (chain, chain * after), strict=True)
            )
            problem, warnings = pose(replace(case_of(now, BEAM), baseline=before))
            assert any("one measurement chain" in warning for warning in warnings)
            as_before, changed = (
                marginal(problem.compare(State(gain=one))).log_likelihood for one in (1.0, 1.3)
            )
            found.append(changed - as_before)
        assert found[1] == pytest.approx(found[0], rel=1e-6)
        assert found[0] > 10 if after > 1 else found[0] < -10


def test_another_calibration_is_another_chain() -> None:
    rng = np.random.default_rng(7)
    test = replace(struck(specimen(rng), rng), calibration=0.5)
    assert in_one_chain(test, test).calibration == Measured.calibration
    assert in_one_chain(test, replace(test, calibration=0.4)) is test
    good = replace(test, calibration=0.01)
    assert in_one_chain(good, good).calibration == 0.01
