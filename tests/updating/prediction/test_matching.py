"""Which mode belongs to which."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from updating_cases import BEAM, POINTS, blank

from acquisition.errors import EstimationError
from acquisition.quantities import hertz
from updating import Measured, Predictor
from updating.models.state import State
from updating.prediction.assignment import mac_of_constants, match
from updating.prediction.matching import pair_modes
from updating.prediction.prediction import Prediction

LOOK = Predictor(BEAM, blank(POINTS))
MODEL = LOOK.predict(count=6)


def seen_as(prediction: Prediction, *, shapes: bool = True) -> Measured:
    """A test without noise of what a model predicts."""
    n = len(prediction.frequency)
    keep = slice(None) if shapes else slice(0, 0)
    test = LOOK.measured
    return replace(
        test,
        frequency=prediction.frequency,
        frequency_sigma=1e-4 * prediction.frequency,
        damping=np.full(n, 0.01),
        damping_sigma=np.full(n, 1e-3),
        seen=test.seen[keep],
        hit=test.hit[keep],
        constants=prediction.constants[keep],
        constants_sigma=0.01 * np.abs(prediction.constants[keep]) + 1e-6,
    )


def test_mac_is_what_its_definition_says() -> None:
    test = seen_as(MODEL)
    found = mac_of_constants(test, MODEL)
    a, b = test.constants, MODEL.constants
    for i in range(6):
        for j in range(6):
            expected = (a[:, i] @ b[:, j]) ** 2 / ((a[:, i] @ a[:, i]) * (b[:, j] @ b[:, j]))
            assert found[i, j] == pytest.approx(expected)
    assert np.diag(found) == pytest.approx(np.ones(6))


@settings(max_examples=30)
@given(order=st.permutations(range(5)), level=st.floats(0.1, 10), stretch=st.floats(0.8, 1.25))
def test_shapes_find_their_partner_in_any_order_and_level(
    order: list[int], level: float, stretch: float
) -> None:
    test = seen_as(MODEL.select(np.array(order)))
    test = replace(test, frequency=stretch * test.frequency, constants=-level * test.constants)
    assert match(test, MODEL, np.arange(5)).tolist() == order


def test_modes_that_a_band_left_out_count_in_the_rank() -> None:
    """Modes 12 to 14 of a series as dense as a plate's: their ratios to 11 to 13 are as even as to their own."""
    hertz = 100.0 + 5.0 * np.arange(20)
    model = replace(MODEL.select(np.zeros(20, dtype=int)), frequency=hertz)
    test = replace(seen_as(MODEL.select(np.arange(3)), shapes=False), frequency=1.01 * hertz[11:14])
    assert pair_modes(test, model).order.tolist() != [11, 12, 13]
    assert pair_modes(replace(test, below=11), model).order.tolist() == [11, 12, 13]


def test_without_shapes_the_rank_decides() -> None:
    test = seen_as(MODEL, shapes=False)
    assert match(test, MODEL, np.array([0, 1, 2, 4, 5, 3])).tolist() == [0, 1, 2, 4, 5, 3]


def test_modes_that_cross_are_followed() -> None:
    """Two of the model's modes in swapped order: shapes say so, whatever their frequencies."""
    near = replace(MODEL, frequency=MODEL.frequency.copy())
    near.frequency[2] = 1.02 * near.frequency[1]
    crossed = replace(near, frequency=near.frequency[[0, 2, 1, 3, 4, 5]])
    assert match(seen_as(near), crossed, np.arange(6)).tolist() == list(range(6))


def test_a_mode_missing_from_the_test_shifts_nothing() -> None:
    paired = pair_modes(seen_as(MODEL.select(np.array([0, 2, 3]))), MODEL)
    assert paired.order.tolist() == [0, 2, 3]
    assert paired.warnings == ()
    alone = pair_modes(seen_as(MODEL.select(np.array([0, 2, 3])), shapes=False), MODEL)
    assert alone.order.tolist() == [0, 2, 3]


def test_a_mode_that_the_model_lacks_is_left_out_and_said() -> None:
    test = seen_as(MODEL.select(np.arange(4)))
    strange = test.constants.copy()
    basis = np.linalg.svd(MODEL.constants[:, :4])[0][:, 4]
    strange[:, 2] = basis * np.linalg.norm(strange[:, 2])
    paired = pair_modes(replace(test, constants=strange), MODEL.select(np.arange(4)))
    assert paired.order.tolist() == [0, 1, 3]
    assert f"{hertz(test.frequency[2])} has no partner" in paired.warnings[0]


def test_a_mode_that_drowns_in_noise_is_left_out_and_said() -> None:
    test = seen_as(MODEL)
    sigma = test.constants_sigma.copy()
    sigma[:, 3] = np.abs(test.constants[:, 3]).max()
    paired = pair_modes(replace(test, constants_sigma=sigma), MODEL)
    assert paired.order.tolist() == [0, 1, 2, 4, 5]
    assert "too faint" in paired.warnings[0]
    with pytest.raises(EstimationError, match="is dominated by noise"):
        pair_modes(replace(test, constants_sigma=np.full_like(sigma, 1e9)), MODEL)


def test_more_modes_than_the_model_has_are_refused() -> None:
    with pytest.raises(EstimationError, match="6 modes and the model 3"):
        pair_modes(seen_as(MODEL), MODEL.select(np.arange(3)))


def test_another_structure_altogether_is_refused() -> None:
    test = seen_as(MODEL.select(np.arange(1)))
    other = np.linalg.svd(MODEL.constants[:, :2])[0][:, [2]]
    with pytest.raises(EstimationError, match="check axes, points, boundary conditions"):
        pair_modes(
            replace(test, constants=other, constants_sigma=0.01 * np.ones((5, 1))), MODEL.select(np.arange(2))
        )


def test_a_state_that_has_lost_its_mass_predicts_nothing_and_ends_no_search() -> None:
    """Effects that each can be there may leave nothing together."""
    lost = LOOK.predict(State(mass=(-1.5 * LOOK.reduced.matrices(State())[1],)), count=6)
    assert np.isnan(lost.frequency).all()
    assert sorted(match(seen_as(MODEL), lost, np.arange(6)).tolist()) == list(range(6))


def test_a_uniform_change_keeps_all_pairs() -> None:
    soft = LOOK.predict(State(factors={"E": 0.6}), count=6)
    for shapes in (True, False):
        paired = pair_modes(seen_as(soft.select(np.arange(5)), shapes=shapes), MODEL)
        assert paired.order.tolist() == list(range(5))


@pytest.mark.parametrize("seed", range(6))
def test_a_false_mode_between_true_ones_gets_no_partner_and_costs_no_point(seed: int) -> None:
    """As an identification invents where hits of different levels show a mode at different places."""
    rng = np.random.default_rng(seed)
    true = MODEL.select(np.arange(3))
    test = seen_as(true)
    mixed = true.constants @ rng.normal(size=3) / 3 + 0.3 * np.std(true.constants) * rng.normal(
        size=len(test.seen)
    )
    false = 0.54 * true.frequency[2]
    at = int(np.searchsorted(true.frequency, false))

    def between(values, extra):
        return np.insert(values, at, extra, axis=-1)

    seen = replace(
        test,
        frequency=between(test.frequency, false),
        frequency_sigma=between(test.frequency_sigma, 0.01),
        damping=between(test.damping, 0.02),
        damping_sigma=between(test.damping_sigma, 1e-3),
        constants=between(test.constants, mixed),
        constants_sigma=between(test.constants_sigma, 0.01 * np.abs(mixed).max()),
    )
    paired = pair_modes(seen, MODEL)
    assert paired.trusted is None
    assert false not in paired.measured.frequency and paired.order.tolist() == [0, 1, 2]
    assert any(f"{hertz(false)} has no partner" in w for w in paired.warnings)


def two_sensors() -> Predictor:
    """Seven points hit, sensors at the first and at one in the middle."""
    places = np.linspace(0.05, 0.376, 7)
    base = blank(places)
    hit, seen = np.tile(np.arange(7), 2), np.repeat([0, 4], 7)
    zero = np.zeros((14, len(base.frequency)))
    test = replace(base, seen=seen, hit=hit, constants=zero, constants_sigma=zero + 1)
    return Predictor(replace(BEAM, clamped=()), test)


def reversed_at(
    evaluation: Predictor, rows: np.ndarray, *, noise: float = 0.02
) -> tuple[Measured, Prediction]:
    """A test whose rows are of opposite sign, and the model's modes."""
    model = evaluation.predict(count=8)
    modes = model.select(np.arange(5))
    rng = np.random.default_rng(2)
    scatter = 1 + noise * rng.normal(size=modes.constants.shape)
    constants = np.where(rows[:, None], -1.0, 1.0) * modes.constants * scatter
    test = replace(
        evaluation.measured,
        frequency=0.99 * modes.frequency,
        frequency_sigma=1e-4 * modes.frequency,
        damping=np.full(5, 0.01),
        damping_sigma=np.full(5, 1e-3),
        constants=constants,
        constants_sigma=0.02 * np.abs(constants) + 1e-6,
    )
    return test, model


@pytest.mark.parametrize("sensor", [0, 4])
def test_a_fixed_sensor_upside_down_costs_no_pair(sensor: int) -> None:
    evaluation = two_sensors()
    upside_down = evaluation.measured.seen == sensor
    test, model = reversed_at(evaluation, upside_down)
    paired = pair_modes(test, model)
    assert paired.order.tolist() == [0, 1, 2, 3, 4]
    assert not paired.mostly_alone
    assert paired.trusted is not None and (paired.trusted == ~upside_down).all()
    assert any(f"without sensor at point {test.nodes[sensor]}" in w for w in paired.warnings)
    assert match(paired.measured, model, paired.order).tolist() == [0, 1, 2, 3, 4]


def test_a_point_hit_from_behind_and_a_sensor_upside_down_cost_no_pair() -> None:
    evaluation = two_sensors()
    wrong = (evaluation.measured.seen == 4) ^ (evaluation.measured.hit == 6)
    paired = pair_modes(*reversed_at(evaluation, wrong))
    assert paired.order.tolist() == [0, 1, 2, 3, 4]
    assert paired.trusted is not None
    assert not paired.trusted[evaluation.measured.seen == 4].any()
    assert not paired.trusted[evaluation.measured.hit == 6].any()


def test_sensors_that_agree_are_all_kept() -> None:
    evaluation = two_sensors()
    paired = pair_modes(*reversed_at(evaluation, np.zeros(14, dtype=bool)))
    assert paired.trusted is None and paired.warnings == ()


def test_a_structure_that_bounces_on_its_supports_is_no_mode_far_above_the_band() -> None:
    """On few points a straight line looks like a high mode: the same shape at an eightieth of its frequency."""
    model = LOOK.predict(count=10)
    test = seen_as(model.select(np.array([9, 0, 1, 2, 3])))
    test = replace(test, frequency=np.r_[0.9 * model.frequency[0] / 3, test.frequency[1:]])
    paired = pair_modes(test, model)
    assert paired.order.tolist() == [0, 1, 2, 3]
    assert len(paired.warnings) == 1
    assert "no partner" in paired.warnings[0]


@pytest.mark.parametrize("seed", range(5))
def test_what_rounding_leaves_of_a_mode_across_the_points_is_like_nothing(seed: int) -> None:
    """A mode that no point can see lies nearer in frequency, and rounding gave it the shape of the measured one."""
    rng = np.random.default_rng(seed)
    test = seen_as(MODEL.select(np.array([0, 2, 3])))
    constants, end = MODEL.constants.copy(), getattr(MODEL, test.roving).copy()
    noise = 1 + 0.1 * rng.standard_normal(len(constants))
    constants[:, 1], end[:, 1] = (1e-13 * part[:, 2] * noise for part in (MODEL.constants, end))
    model = replace(MODEL, constants=constants, frequency=MODEL.frequency.copy(), **{test.roving: end})
    model.frequency[1] = test.frequency[1]
    model.frequency[2] = 1.2 * test.frequency[1]
    paired = pair_modes(test, model)
    assert paired.order.tolist() == [0, 2, 3]
    assert (mac_of_constants(test, model)[:, 1] == 0).all()
    assert MODEL.constants[0, 1] != 0 and mac_of_constants(test, MODEL)[:, 1].max() > 0
