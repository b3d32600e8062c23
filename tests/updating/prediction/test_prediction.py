"""Predictions against exact beams, their sensitivities against finite differences, their damping by hand."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from updating_cases import BEAM, PLATE, POINTS, STEEL, ExactBeam, blank

from updating import Damping, Predictor, Region, Spec
from updating.models.parts import PointMass
from updating.models.state import NOMINAL, State

FACTORS = ("E", "density", "thickness", "width", "length")
# none at an edge: beyond it there is nothing to hit, and a plate that narrows takes such a point along
GRID = np.array([[x, y] for x in np.linspace(0.09, 0.376, 4) for y in (0.01, 0.11, 0.19)])
LOOK = {
    "beam": Predictor(BEAM, blank(POINTS)),
    "free": Predictor(replace(BEAM, clamped=()), blank(np.linspace(0.03, 0.33, 5))),
    "other end": Predictor(replace(BEAM, clamped=("x1",)), blank(np.linspace(0.0, 0.3, 5))),
    "both": Predictor(replace(BEAM, clamped=("x0", "x1")), blank(POINTS - 0.03)),
    "shapes": Predictor(BEAM, blank(POINTS, shapes_only=True)),
    "plate": Predictor(PLATE, blank(GRID)),
}


MESH = 3e-5
"""Error of 40 elements in a fifth mode: (k L / n)^4 / 1440."""


def exact(spec: Spec, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    thick = spec.theory == "timoshenko"
    size = (spec.length, spec.width, spec.thickness)
    beam = ExactBeam(*size, clamped=bool(spec.clamped), shear=thick, rotary=thick)
    frequency = beam.frequencies(5)
    return frequency, beam.shapes(frequency, points)


@pytest.mark.parametrize("name", ["beam", "free"])
def test_constants_are_products_of_mass_normalised_shapes(name: str) -> None:
    predictor = LOOK[name]
    frequency, shape = exact(predictor.spec, predictor.measured.points[:, 0])
    found = predictor.predict(State(gain=1.3), count=5)
    assert found.frequency == pytest.approx(frequency, rel=MESH)
    constants = 1.3 * shape * shape[-1]
    np.testing.assert_allclose(found.constants, constants, atol=2e-4 * np.abs(constants).max())


def test_without_a_reference_constants_are_the_shapes() -> None:
    _, shape = exact(BEAM, POINTS)
    found = LOOK["shapes"].predict(count=5).constants
    sign = np.sign(np.sum(found * shape, axis=0))
    np.testing.assert_allclose(found * sign, shape, atol=1e-4 * np.abs(shape).max())


def differences(predictor: Predictor, state: State, name: str, count: int) -> tuple[np.ndarray, np.ndarray]:
    step = 1e-4
    up, down = (
        predictor.predict(state.plus(State(factors={name: np.exp(s)})), count=count) for s in (step, -step)
    )
    sign = np.sign(np.sum(up.constants * down.constants, axis=0))
    frequency = np.log(up.frequency / down.frequency) / (2 * step)
    return frequency, (up.constants - sign * down.constants) / (2 * step)


@pytest.mark.parametrize("name", list(LOOK))
@pytest.mark.parametrize("factor", FACTORS)
def test_sensitivities_are_the_limits_of_differences(name: str, factor: str) -> None:
    predictor = LOOK[name]
    state = State(factors={"E": 1.1, "length": 1.03}, gain=1.2)
    found = predictor.predict(state, factors=(factor,), count=5)
    by_frequency, by_constants = differences(predictor, state, factor, 5)
    assert found.log_frequency_by[:, 0] == pytest.approx(by_frequency, abs=2e-5)
    if name == "shapes":  # whose sign is anybody's
        plain = predictor.predict(state, count=5).constants
        lean = np.sign(np.sum(found.constants * plain, axis=0))
        by_constants = (
            by_constants * np.sign(np.sum(by_constants * found.constants_by[..., 0], axis=0)) * lean
        )
    scale = np.abs(found.constants).max()
    np.testing.assert_allclose(found.constants_by[..., 0], by_constants, atol=5e-4 * scale)


@pytest.mark.parametrize("name", ["beam", "free", "plate"])
def test_slopes_are_what_moving_the_hit_changes(name: str) -> None:
    predictor = LOOK[name]
    test = predictor.measured
    keep = test.hit != test.seen[0]
    found = predictor.predict(State(factors={"length": 1.02}), count=5)
    for axis in range(test.points.shape[1]):
        step = np.zeros(test.points.shape[1])
        step[axis] = 1e-5
        # the sensor stays: it is a point of its own
        points = [np.vstack([test.points + s * step, test.points[test.seen[:1]]]) for s in (1, -1)]
        ends = []
        for moved in points:
            beside = replace(test, points=moved, seen=np.full(len(test.seen), len(test.points)))
            ends.append(
                predictor.for_test(beside).predict(State(factors={"length": 1.02}), count=5).constants
            )
        difference = (ends[0] - ends[1]) / 2e-5
        scale = np.abs(difference).max()
        inner = (
            keep & (test.points[:, axis] > 0.001) & (test.points[:, axis] < 0.99 * test.points[:, axis].max())
        )
        assert inner.any()
        np.testing.assert_allclose(found.along[axis][inner], difference[inner], atol=2e-4 * scale)


@pytest.mark.parametrize(("name", "grows"), [("beam", 1.0), ("other end", 0.0), ("both", 0.5), ("free", 0.5)])
@settings(max_examples=8)
@given(stretch=st.floats(0.95, 1.1))
def test_points_keep_their_distance_from_the_free_end(name: str, grows: float, stretch: float) -> None:
    predictor = LOOK[name]
    spec = predictor.spec
    longer = replace(spec, length=stretch * spec.length, regions=())
    moved = predictor.measured.points + grows * (longer.length - spec.length)
    fresh = Predictor(longer, replace(predictor.measured, points=moved)).predict(count=5)
    found = predictor.predict(State(factors={"length": stretch}), count=5)
    assert found.frequency == pytest.approx(fresh.frequency, rel=1e-4)
    np.testing.assert_allclose(found.constants, fresh.constants, atol=1e-3 * np.abs(fresh.constants).max())


@pytest.mark.parametrize(("clamped", "grows"), [(("x0",), 0.5), (("y0",), 1.0), (("y1",), 0.0)])
def test_points_of_a_wider_plate_stay_where_they_are(clamped: tuple[str, ...], grows: float) -> None:
    stretch, spec = 1.02, replace(PLATE, clamped=clamped)
    wider = replace(spec, width=stretch * spec.width)
    moved = GRID + np.array([0.0, grows * (wider.width - spec.width)])
    fresh = Predictor(wider, blank(moved)).predict(count=5)
    found = Predictor(spec, blank(GRID)).predict(State(factors={"width": stretch}), count=5)
    assert found.frequency == pytest.approx(fresh.frequency, rel=1e-4)
    np.testing.assert_allclose(found.constants, fresh.constants, atol=1e-3 * np.abs(fresh.constants).max())


@pytest.mark.parametrize("mass", [0.0, 1e-7, 1e-6])
def test_modes_that_are_all_but_double_turn_no_faster_than_anything_bears(mass: float) -> None:
    """A speck in a corner makes of two double modes two that a change of width mixes at once."""
    speck = (PointMass((0.3, 0.3), mass),) if mass else ()
    square = Spec(
        "plate",
        length=0.3,
        width=0.3,
        thickness=0.003,
        elements=(8, 8),
        clamped=(),
        theory="kirchhoff",
        material=PLATE.material,
        masses=speck,
    )
    points = np.stack(np.meshgrid([0.02, 0.11, 0.28], [0.01, 0.2, 0.29], indexing="ij"), axis=-1).reshape(
        -1, 2
    )
    found = Predictor(square, blank(points)).predict(factors=("E", "length", "width"), count=9)
    assert np.diff(np.log(found.frequency)).min() < 1e-5
    size = np.abs(found.constants).max()
    assert np.abs(found.constants_by).max() < 1e4 * size  # all of another shape at a ten thousandth


def damping(spec: Spec, state: State = NOMINAL) -> tuple[np.ndarray, np.ndarray]:
    found = Predictor(spec, blank(POINTS)).predict(state, count=5)
    return found.damping, 2 * np.pi * found.frequency


def test_damping_that_nobody_expects_is_unknown() -> None:
    spec = replace(BEAM, damping=Damping())
    assert np.isnan(damping(spec)[0]).all()
    assert not Predictor(spec, blank(POINTS)).expects_damping
    assert LOOK["beam"].expects_damping


def test_damping_of_every_form() -> None:
    found, omega = damping(replace(BEAM, damping=Damping(alpha=3.0, beta=2e-6)))
    assert found == pytest.approx(1.5 / omega + 1e-6 * omega, rel=1e-6)
    found, omega = damping(replace(BEAM, damping=Damping(loss_factor=0.02)))
    assert found == pytest.approx(np.full(5, 0.01), rel=1e-6)
    given_ratios = (0.01, 0.02, 0.03)
    found, omega = damping(replace(BEAM, damping=Damping(ratios=given_ratios)))
    assert found == pytest.approx([0.01, 0.02, 0.03, 0.03, 0.03])


def test_a_window_and_a_dashpot_add_to_the_damping() -> None:
    plain, omega = damping(BEAM)
    found, _ = damping(BEAM, State(decay=5.0))
    # the pole keeps its ringing frequency, so that its modulus grows as well
    real, ringing = plain * omega + 5.0, omega * np.sqrt(1 - plain**2)
    assert found == pytest.approx(real / np.hypot(real, ringing), rel=1e-9)
    predictor = LOOK["beam"]
    row = predictor.nominal_rows["w"][[4]]
    found = predictor.predict(State(damping=(0.7 * row.T @ row,)), count=5).damping
    _, shape = exact(BEAM, POINTS)
    assert found == pytest.approx(0.7 * shape[4] ** 2 / (2 * omega), rel=1e-3)


def test_a_stiffer_specimen_is_damped_as_its_own_matrices_say() -> None:
    found, omega = damping(replace(BEAM, damping=Damping(alpha=3.0, beta=2e-6)), State(factors={"E": 1.44}))
    assert found == pytest.approx(1.5 / omega + 1e-6 * omega, rel=1e-6)


@pytest.mark.parametrize("whole", [Damping(), Damping(alpha=1.0)])
def test_a_region_s_own_damping_takes_the_place_of_the_model_s(whole: Damping) -> None:
    """Two halves with the same coefficients are the whole; a half alone is damped where it bends and moves."""
    own = {"alpha": 3.0, "beta": 2e-6, "loss_factor": 0.01}
    halves = (Region("a", (0.0, 0.188), **own), Region("b", (0.188, 0.376), **own))
    found, omega = damping(replace(BEAM, damping=whole, regions=halves))
    expected = 3.0 / (2 * omega) + 1e-6 * omega + 0.005
    assert found == pytest.approx(expected, rel=1e-6)
    thin = replace(BEAM, theory="euler-bernoulli", damping=Damping())
    tip = replace(thin, regions=(Region("b", (0.188, 0.376), alpha=3.0),))
    x = np.linspace(0.188, 0.376, 2001)
    frequency, shape = exact(thin, x)
    line = STEEL.density * BEAM.width * BEAM.thickness
    expected = 3.0 * np.trapezoid(line * shape**2, x, axis=0) / (4 * np.pi * frequency)
    assert damping(tip)[0] == pytest.approx(expected, rel=1e-4)


def test_another_theory_takes_the_place_of_the_nominal_one() -> None:
    thin = Predictor(replace(BEAM, theory="euler-bernoulli"), blank(POINTS))
    found = thin.predict(State(theory="timoshenko", factors={"E": 1.1}), count=5)
    assert found.frequency == pytest.approx(np.sqrt(1.1) * exact(BEAM, POINTS)[0], rel=1e-4)
    assert thin.under("timoshenko") is thin.under("timoshenko")


def test_additions_stand_before_the_state_and_can_be_taken_out() -> None:
    predictor = replace(LOOK["beam"], additions=(lambda _: State(factors={"E": 1.21}),))
    ratio = predictor.predict(count=3).frequency / LOOK["beam"].predict(count=3).frequency
    assert ratio == pytest.approx(np.full(3, 1.1))
    assert predictor.bare.predict(count=3).frequency == pytest.approx(LOOK["beam"].predict(count=3).frequency)


def test_a_state_without_stiffness_is_said_and_not_a_number() -> None:
    basis = LOOK["beam"].reduced
    gone = State(stiffness=(-1.5 * basis.weighted("stiffness", np.ones(len(basis.structure.region_of))),))
    assert np.isnan(LOOK["beam"].predict(gone, count=3).frequency).all()


def test_modes_reach_above_the_measured_ones() -> None:
    predictor = LOOK["free"]
    found = predictor.predict().frequency
    assert found[0] > 100  # no rigid-body mode
    assert len(found) == len(predictor.measured.frequency) + 3 or found[-1] < 1.6 * 1600
    assert len(predictor.predict(at_least=9).frequency) == 9


def test_a_basis_is_handed_on_and_never_written_into_a_predictor() -> None:
    """Another test looks from the same basis, another model from its own, and none of them is changed by it."""
    first = LOOK["beam"]
    fields = dict(vars(first))
    other = first.for_test(replace(first.measured, title="again"))
    assert other.basis is other.reduced is first.reduced
    assert first.on(first.reduced).reduced is first.reduced
    assert first.of(first.spec.with_elements(12)).reduced is not first.reduced
    assert {name: vars(first)[name] for name in fields} == fields


def test_each_addition_sees_those_before_it() -> None:
    seen: list[float] = []

    def stiffer(predictor: Predictor) -> State:
        seen.append(predictor.base.factors.get("E", 1.0))
        return State(factors={"E": 2.0})

    predictor = replace(LOOK["beam"], additions=(stiffer, stiffer, stiffer))
    assert predictor.base.factors["E"] == pytest.approx(8.0)
    assert seen == [1.0, 2.0, 4.0]
