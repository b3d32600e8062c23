"""Simulated FRFs and motion against closed forms, time integration, and each other."""

from dataclasses import replace

import numpy as np
import pytest
from imported_cases import imported_beam, spec_of
from imported_cases import seen_from as from_nodes
from scipy import linalg
from simulation_cases import (
    CLAMPED,
    EI,
    FREE,
    LENGTH,
    LOSS,
    MIXED,
    MU,
    POINTS,
    STEEL,
    seen_from,
)
from updating_cases import blank

from acquisition import FORMS, Dof
from acquisition.errors import InputError, StudyError
from updating import Case, Damping, Predictor, Region, Spec
from updating.effects import LIBRARY, accepted_state
from updating.models.state import State
from updating.simulation import (
    damped_modes,
    frf_set,
    modal_system,
    natural_modes,
    receptances,
    simulated,
    time_response,
    with_identified_damping,
)

PLATE = Spec(
    "plate",
    length=0.4,
    width=0.3,
    thickness=0.004,
    elements=(16, 12),
    clamped=("x0",),
    theory="kirchhoff",
    material=STEEL,
    damping=Damping(alpha=8.0, beta=1e-6),
)


BAND = np.linspace(3.0, 1500.0, 400)


def wave_number(frequency: np.ndarray) -> np.ndarray:
    """Complex kappa of a beam with structural damping, kappa^4 = mu omega^2 / (EI (1 + i eta))."""
    omega = 2 * np.pi * frequency
    return np.asarray((MU * omega**2 / (EI * (1 + 1j * LOSS))) ** 0.25)


def numeric_receptance(frequency: np.ndarray, x: float, at: float, *, clamped: bool) -> np.ndarray:
    """The beam's differential equation solved by its own waves left and right of the force."""
    found = []
    for k in wave_number(frequency):

        def waves(z, n=0, k=k):
            turn = [(1j * k) ** n, (-1j * k) ** n, k**n, (-k) ** n]
            waves = [np.exp(1j * k * z), np.exp(-1j * k * z), np.exp(k * (z - LENGTH)), np.exp(-k * z)]
            return np.array(turn) * np.array(waves)

        rows, load = np.zeros((8, 8), complex), np.zeros(8, complex)
        for i, n in enumerate((0, 1) if clamped else (2, 3)):
            rows[i, :4] = waves(0.0, n)
        rows[2, 4:], rows[3, 4:] = waves(LENGTH, 2), waves(LENGTH, 3)
        for n in range(4):
            rows[4 + n, :4], rows[4 + n, 4:] = -waves(at, n), waves(at, n)
        load[7] = 1 / (EI * (1 + 1j * LOSS))
        if at == LENGTH:  # the force sits on the end: EI w''' = -F there
            rows, load = rows[:4, :4].copy(), np.array([0, 0, 0, -load[7]])
            rows[2], rows[3] = waves(LENGTH, 2), waves(LENGTH, 3)
        scale = np.abs(rows).max(axis=1)
        a = linalg.solve(rows / scale[:, None], load / scale)
        side = a[:4] if x <= at else a[4:]
        found.append(side @ waves(x))
    return np.array(found)


def tip_receptance(frequency: np.ndarray) -> np.ndarray:
    """Bishop and Johnson (1960), table 7.1(c): the drive point of a cantilever's tip."""
    k = wave_number(frequency)
    a = k * LENGTH
    f5, f3 = np.cos(a) * np.sinh(a) - np.sin(a) * np.cosh(a), np.cos(a) * np.cosh(a) + 1
    return np.asarray(-f5 / (EI * (1 + 1j * LOSS) * k**3 * f3))


def end_receptance_free(frequency: np.ndarray) -> np.ndarray:
    """The same of a free beam's end."""
    k = wave_number(frequency)
    a = k * LENGTH
    f5, f3 = np.cos(a) * np.sinh(a) - np.sin(a) * np.cosh(a), np.cos(a) * np.cosh(a) - 1
    return np.asarray(-f5 / (EI * (1 + 1j * LOSS) * k**3 * f3))


def near(found: np.ndarray, expected: np.ndarray, share: float) -> None:
    """Compare FRFs line by line, resonances included."""
    assert np.abs(found / expected - 1).max() < share


@pytest.mark.parametrize(("spec", "closed"), [(CLAMPED, tip_receptance), (FREE, end_receptance_free)])
def test_the_drive_point_at_an_end_is_the_closed_form(spec: Spec, closed) -> None:
    found = receptances(seen_from(spec), 2j * np.pi * BAND, seen=np.array([1]), hit=np.array([1]))
    exact = closed(BAND)
    assert np.abs(found[0] - exact).max() < 2e-4 * np.abs(exact).max()
    assert np.median(np.abs(found[0] / exact - 1)) < 1e-4


@pytest.mark.parametrize("clamped", [True, False])
def test_a_transfer_frf_is_that_of_the_differential_equation(*, clamped: bool) -> None:
    model = seen_from(CLAMPED if clamped else FREE, [0.17, 0.33])
    found = receptances(model, 2j * np.pi * BAND, seen=np.array([0, 1]), hit=np.array([1, 0]))
    exact = numeric_receptance(BAND, 0.17, 0.33, clamped=clamped)
    assert np.abs(found[0] - exact).max() < 2e-4 * np.abs(exact).max()
    assert found[0] == pytest.approx(found[1])


def test_the_wave_solution_and_the_closed_form_are_one() -> None:
    assert numeric_receptance(BAND, 0.5, 0.5, clamped=True) == pytest.approx(tip_receptance(BAND), rel=1e-8)


@pytest.mark.parametrize("method", ["direct", "modal"])
def test_the_static_value_is_that_of_a_cantilever(method) -> None:
    model = seen_from(replace(CLAMPED, elements=(40,), damping=Damping()))
    found = receptances(
        model, np.zeros(1, complex), seen=np.array([1, 0]), hit=np.array([1, 1]), method=method
    )
    a = POINTS[0]
    assert found[:, 0].real == pytest.approx(
        [LENGTH**3 / (3 * EI), a**2 * (3 * LENGTH - a) / (6 * EI)], rel=1e-9
    )


def test_a_free_body_is_a_mass_at_the_lowest_lines() -> None:
    frfs = frf_set(seen_from(FREE, [0.25]), np.arange(0.0, 3.0), seen=np.array([0]), hit=np.array([0]))
    assert frfs.values[0] == pytest.approx(1 / (MU * LENGTH), rel=2e-3)


@pytest.mark.parametrize(
    "spec", [CLAMPED, FREE, MIXED, PLATE], ids=["cantilever", "free", "by region", "plate"]
)
def test_modes_add_up_to_the_direct_answer(spec: Spec) -> None:
    points = np.array([[0.13, 0.2], [0.4, 0.05], [0.31, 0.17]])
    plate = spec.kind == "plate"
    model = simulated(Predictor(spec, blank(points))) if plate else seen_from(spec, [0.13, 0.31, 0.5])
    s = 2j * np.pi * np.linspace(2.0, 900.0, 300) + 1.5
    pairs = {"seen": np.array([0, 1, 2]), "hit": np.array([1, 1, 0])}
    direct = receptances(model, s, method="direct", **pairs)
    scale = np.abs(direct).max(axis=1, keepdims=True)
    assert np.abs(receptances(model, s, method="modal", **pairs) - direct).max() < 3e-8 * scale.max()
    enough = int(np.sum(natural_modes(model).frequency < 5 * 900.0))
    some = receptances(model, s, count=enough, **pairs)
    assert (np.abs(some - direct) < 1e-6 * scale).all()
    bare = np.abs(receptances(model, s, count=1, **pairs) - direct)[:, 100:]
    assert bare.max() > 1e-3 * np.abs(direct[:, 100:]).max()  # the count is heeded


@pytest.mark.long
def test_points_anywhere_are_as_good_as_points_of_the_test() -> None:
    test = blank(np.array([[0.4, 0.05], [0.31, 0.17]]))
    line = 2j * np.pi * np.linspace(2.0, 600.0, 40)
    pairs = {"seen": np.array([0, 1]), "hit": np.array([1, 1])}
    own = receptances(simulated(Predictor(PLATE, test)), line, **pairs)
    others = replace(blank(np.array([[0.1, 0.3]])))
    found = receptances(simulated(Predictor(PLATE, others), points=test.points), line, **pairs)
    assert found == pytest.approx(own, rel=1e-4, abs=1e-6 * np.abs(own).max())


def test_forms_are_derivatives_and_gain_and_windows_are_in() -> None:
    base = seen_from(CLAMPED)
    pairs = {"seen": np.array([0]), "hit": np.array([1])}
    sets = {form: frf_set(base, BAND, form=form, decay=3.0, **pairs) for form in FORMS}
    for power, form in enumerate(FORMS):
        expected = sets["receptance"].values * (2j * np.pi * BAND + 3.0) ** power
        assert sets[form].values == pytest.approx(expected)
    off = seen_from(CLAMPED)
    off = replace(off, gain=1.3, decay=2.0)
    assert frf_set(off, BAND, decay=1.0, **pairs).values == pytest.approx(1.3 * sets["accelerance"].values)


def test_frequencies_and_shapes_are_the_predictor_s() -> None:
    predictor = Predictor(CLAMPED, blank(np.linspace(0.1, 0.5, 5)))
    found, expected = natural_modes(simulated(predictor), count=5), predictor.predict(count=5)
    assert found.frequency == pytest.approx(expected.frequency)
    assert found.damping == pytest.approx(np.full(5, LOSS / 2))
    products = found.shapes[predictor.measured.seen] * found.shapes[predictor.measured.hit]
    assert products == pytest.approx(expected.constants)


def test_a_slope_is_the_derivative_along_the_structure() -> None:
    step = 1e-4
    model = seen_from(MIXED, [0.2 - step, 0.2, 0.2 + step])
    system = modal_system(
        model,
        seen=np.array([1]),
        hit=np.arange(3),
        responses=[Dof(9, 3)],
        points=[Dof(i, 3) for i in (1, 2, 3)],
    )
    by_steps = (system.residues[0, 2] - system.residues[0, 0]) / (2 * step)
    low = np.abs(system.poles) < 2 * np.pi * 3000
    slope = system.gradients[0, 0, 1]
    assert np.abs(by_steps - slope)[low].max() < 1e-4 * np.abs(slope[low]).max()


def test_effects_act_where_the_test_s_sensor_is_however_one_looks() -> None:
    test = blank(np.linspace(0.1, 0.5, 5), sensor=1)
    case = Case("specimen", CLAMPED, test, accepted=(("sensor_mass", {"mass": 0.02}),))
    expected = Predictor(CLAMPED, test).predict(
        LIBRARY["sensor_mass"].state(Predictor(CLAMPED, test), {"mass": 0.02}), count=4
    )
    assert natural_modes(simulated(case), count=4).frequency == pytest.approx(expected.frequency)
    seen = simulated(case, points=np.array([[0.33]]))
    assert natural_modes(seen, count=4).frequency == pytest.approx(expected.frequency)
    assert seen.rows.shape[0] == 1


def test_effects_follow_to_another_theory() -> None:
    test = blank(np.linspace(0.1, 0.5, 5))
    spring = {"stiffness": 900.0}
    case = Case("specimen", CLAMPED, test)
    found = simulated(
        case, lambda p: accepted_state(p, "clamp_rotation", spring), lambda p: accepted_state(p, "shear", {})
    )
    better = Predictor(replace(CLAMPED, theory="timoshenko"), test)
    expected = better.predict(LIBRARY["clamp_rotation"].state(better, spring), count=4)
    assert natural_modes(found, count=4).frequency == pytest.approx(expected.frequency)


def test_identified_ratios_go_to_their_partners_and_the_median_to_the_rest() -> None:
    test = blank(np.linspace(0.1, 0.5, 5))
    bare = replace(CLAMPED, damping=Damping())
    model = Predictor(bare, test).predict(count=5)
    order = [0, 1, 3]
    measured = replace(
        test,
        frequency=model.frequency[order], frequency_sigma=1e-4 * model.frequency[order],
        damping=np.array([0.02, 0.01, 0.004]), damping_sigma=np.full(3, 1e-4),
        constants=model.constants[:, order], constants_sigma=np.full((5, 3), 1e-3),
    )  # fmt: skip
    damped = with_identified_damping(Predictor(bare, measured))
    found = natural_modes(simulated(damped), count=5)
    assert found.damping == pytest.approx([0.02, 0.01, 0.01, 0.004, 0.01])
    assert found.frequency == pytest.approx(model.frequency)


def test_ratios_take_the_place_of_damping_by_region() -> None:
    test = blank(np.linspace(0.1, 0.5, 5))
    model = Predictor(MIXED, test).predict(count=2)
    measured = replace(
        test, frequency=model.frequency, damping=np.array([0.03, 0.03]), constants=model.constants,
        constants_sigma=1e-3 * np.ones((5, 2)),
    )  # fmt: skip
    found = natural_modes(simulated(with_identified_damping(Predictor(MIXED, measured))), count=6)
    assert found.damping == pytest.approx(np.full(6, 0.03))


def test_what_cannot_be_simulated_is_said() -> None:
    with pytest.raises(StudyError, match="hang it"):
        damped_modes(seen_from(FREE))
    with pytest.raises(StudyError, match="made for other points"):
        simulated(Predictor(CLAMPED, blank(POINTS)), State(mass=(np.eye(3),)))
    with pytest.raises(InputError, match="n_forces, n_samples"):
        time_response(seen_from(CLAMPED), np.ones((2, 9)), 100.0, hit=np.array([0]), seen=np.array([0]))
    with pytest.raises(StudyError, match="takes \\(n, 1\\)"):
        simulated(Predictor(CLAMPED, blank(POINTS)), points=np.ones((3, 2)))
    with pytest.raises(StudyError, match="no damping was measured"):
        with_identified_damping(Predictor(CLAMPED, nothing_measured()))


def nothing_measured():
    """A test of the model's own modes without damping."""
    test = blank(np.linspace(0.1, 0.5, 5))
    model = Predictor(CLAMPED, test).predict(count=2)
    return replace(test, frequency=model.frequency, constants=model.constants, damping=np.full(2, np.nan))


def test_imported_matrices_do_what_the_beam_does_that_they_are_of() -> None:
    places = np.array([[0.25, 0, 0], [0.5, 0, 0]])
    imported = replace(spec_of(imported_beam(20)), damping=Damping(loss_factor=LOSS))
    test = from_nodes(places, np.tile([0.0, 0.0, 1.0], (2, 1)))
    beam = replace(CLAMPED, elements=(20,))
    pairs = {"seen": np.array([0, 1]), "hit": np.array([1, 1])}
    found = receptances(simulated(Predictor(imported, test)), 2j * np.pi * BAND, **pairs)
    assert found == pytest.approx(
        receptances(seen_from(beam, [0.25, 0.5]), 2j * np.pi * BAND, **pairs), rel=1e-5
    )
    elsewhere = simulated(
        Predictor(imported, test), points=np.array([[0.3, 0, 0]]), directions=np.array([[0, 0, -1.0]])
    )
    one = {"seen": np.array([0]), "hit": np.array([0])}
    own = receptances(seen_from(beam, [0.3]), 2j * np.pi * BAND, **one)
    assert receptances(elsewhere, 2j * np.pi * BAND, **one) == pytest.approx(own, rel=1e-5)


def test_loss_factors_by_region_are_solved_line_by_line() -> None:
    """With structural damping that couples modes no sum of conjugate poles is the FRF: it was 1 % off."""
    halves = (Region("stiff", (0.0, 0.2), loss_factor=0.0), Region("lossy", (0.2, 0.376), loss_factor=0.1))
    spec = Spec(
        "beam",
        length=0.376,
        width=0.0305,
        thickness=0.0047625,
        elements=(8,),
        clamped=("x0",),
        theory="euler-bernoulli",
        material=STEEL,
        regions=halves,
    )
    model = simulated(Predictor(spec, blank(np.linspace(0.1, 0.376, 4))))
    s = 2j * np.pi * np.linspace(5.0, 1500.0, 300)
    seen, hit = np.arange(4), np.full(4, 3)
    summed = receptances(model, s, seen=seen, hit=hit, method="modal")
    for i in (0, 120, 299):
        z = s[i] ** 2 * model.matrices.mass + model.matrices.stiffness + 1j * model.matrices.structural
        exact = model.rows @ np.linalg.solve(z, model.rows[3].astype(complex))
        assert summed[:, i] == pytest.approx(exact, rel=1e-9)
