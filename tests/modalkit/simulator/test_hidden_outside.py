"""Effects that no library has, and wider forms of those it has: closed forms, and nothing where there is none of it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from modalkit.blind.trial import draw_trial
from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.beam.water import added_mass
from modalkit.simulator.bodies.complex_modes import complex_modes
from modalkit.simulator.bodies.images import corner, images
from modalkit.simulator.bodies.parts import Stretch
from modalkit.simulator.bodies.plate.parts import Cavity, Patch
from modalkit.simulator.bodies.plate.plate import Plate
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.hidden import HIDDEN_EFFECTS
from modalkit.simulator.scene import Scene, nominal_scene
from modalkit.simulator.setup import Setup

BEAM = Beam(0.0, 0.6, 0.03, 0.003, 210e9, 7850.0)
HELD = replace(BEAM, clamped=("x0", "x1"))
PLATE = Plate(0.0, 0.4, 0.3, 0.002, 70e9, 2700.0, clamped=("x0", "x1", "y0", "y1"), elements=(4, 3))


def setup_of(kind: str, clamped: tuple[str, ...]) -> Setup:
    plan = DrawRanges(kinds=(kind,), effects=("E",))
    drawn = draw_trial(31, 1 if kind == "plate" else 0, plan=plan).scene.setup
    return replace(drawn, clamped=clamped, sensor_mass=0.0, baseline=False, window=0.0, theory="timoshenko")


@pytest.fixture(scope="module")
def setups() -> dict[str, Setup]:
    """A beam and a plate held at both ends, and a free beam."""
    return {
        "beam": setup_of("beam", ("x0", "x1")),
        "free": setup_of("beam", ()),
        "plate": setup_of("plate", ("x0", "x1")),
    }


def put(name: str, setup: Setup, **values: Any) -> tuple[Scene, Scene]:
    scene = nominal_scene(setup)
    if setup.kind == "plate":
        scene = scene.with_body(elements=(3, 2))
    return scene, HIDDEN_EFFECTS[name].act(scene, values)


NONE = {
    "ground_spring": {"x": 0.1, "y": 0.1, "extent": 0.05, "stiffness": 0.0, "damping": 0.0},
    "suspension": {"cords": 3, "inset": 0.1, "stiffness": 0.0, "damping": 0.0},
    "density_gradient": {"slope": 0.0},
    "initial_curvature": {"rise": 0.0},
    "thermal_prestress": {"force": 0.0, "lean": 0.8},
    "channel_gain": {"points": [2], "gain": 1.0},
    "cross_axis": {"arm": 0.0},
    "drift": {"rate": 0.0},
    "uniform_damping": {"alpha": -0.0, "beta": 0.0, "loss_factor": 0.0},
}


@pytest.mark.parametrize("name", sorted(NONE))
def test_none_of_it_does_nothing(name: str, setups: dict[str, Setup]) -> None:
    before, after = put(name, setups["free" if name == "suspension" else "beam"], **NONE[name])
    np.testing.assert_allclose(after.elastic().poles, before.elastic().poles, rtol=1e-9)
    np.testing.assert_allclose(after.elastic().residues, before.elastic().residues, rtol=1e-6, atol=1e-12)


# a free beam that rests on springs all along bounces at sqrt(K / M) and keeps its shapes: omega^2 = omega0^2 + K / M
def test_a_foundation_under_all_of_a_beam_is_winklers(setups: dict[str, Setup]) -> None:
    setup = setups["free"]
    bare, _ = nominal_scene(setup).body.real_modes(5)
    total = 0.3 * setup.mass * bare[2] ** 2
    middle = {"x": setup.length / 2, "extent": setup.length}
    _, after = put("ground_spring", setup, **middle, stiffness=total)
    omega, _ = after.body.real_modes(5)
    np.testing.assert_allclose(omega[2:] ** 2, bare[2:] ** 2 + total / setup.mass, rtol=2e-2)
    assert omega[0] == pytest.approx(np.sqrt(total / setup.mass), rel=2e-2)


def test_cords_carry_the_whole_and_damp_its_bounce(setups: dict[str, Setup]) -> None:
    setup = setups["free"]
    omega = 0.2 * 2 * np.pi * setup.nominal_hz[0]
    stiffness = setup.mass * omega**2 / 3
    values = {"cords": 3, "inset": 0.1, "stiffness": stiffness, "damping": 0.1 * stiffness / omega}
    before, after = put("suspension", setup, **values)
    own = 2 * np.pi * setup.nominal_hz[0] / 15  # of the soft cords that any free beam hangs on
    first = after.modes().poles[0]
    assert abs(first) == pytest.approx(np.hypot(omega, own), rel=0.03)
    assert -first.real / abs(first) > 0.05
    assert np.all(after.elastic().frequency[:3] > before.elastic().frequency[:3])


# rank-one stiffness (E A / L) (integral of w0' phi')^2: first order in the symmetric modes, none in the others
def test_a_shallow_arch_stiffens_symmetric_modes_alone() -> None:
    flat, shapes = HELD.real_modes(4)
    x = np.linspace(0.0, 0.6, 20001)
    slope = np.pi * 3e-4 / 0.6 * np.sin(2 * np.pi * x / 0.6)
    felt = np.trapezoid((HELD.rows(x, "slope") @ shapes) * slope[:, None], x, axis=0)
    arch, _ = replace(HELD, rise=3e-4).real_modes(4)
    expected = HELD.E * HELD.width * HELD.thickness / 0.6 * felt**2
    np.testing.assert_allclose(arch**2 - flat**2, expected, atol=0.02 * expected.max())
    assert expected[0] > 1e-3 * flat[0] ** 2 > 1e3 * expected[1]


def test_an_arched_plate_is_stiffer_in_its_first_mode() -> None:
    flat, arch = (replace(PLATE, rise=rise).real_modes(5)[0] for rise in (0.0, 1e-3))
    assert arch[0] > 1.01 * flat[0]
    assert np.all(arch > flat * (1 - 1e-9))


def test_a_gradient_shifts_as_perturbation_says() -> None:
    before, shapes = BEAM.real_modes(4)
    after, _ = replace(BEAM, density_slope=0.02).real_modes(4)
    x = np.linspace(0.0, 0.6, 4001)
    local = 0.02 * (x / 0.6 - 0.5)[:, None] * BEAM.mass / 0.6
    more = np.trapezoid(local * (BEAM.rows(x, "w") @ shapes) ** 2, x, axis=0)
    np.testing.assert_allclose(after / before - 1, -0.5 * more, rtol=0.05)


def test_a_load_that_leans_acts_by_its_mean_at_first() -> None:
    load = 0.1 * HELD.bending_stiffness * (2 * np.pi / 0.6) ** 2
    even, leaning = (replace(HELD, axial=load, axial_lean=lean).real_modes(3)[0] for lean in (0.0, 0.8))
    bare, _ = HELD.real_modes(3)
    np.testing.assert_allclose(leaning - bare, even - bare, rtol=0.05)
    assert not np.allclose(leaning, even, rtol=1e-6)


def test_a_bow_of_stress_alone_loads_the_middle_of_a_plate() -> None:
    free = replace(PLATE, clamped=("x0", "x1"))
    pull = 4 * free.bending_stiffness * free.width * (np.pi / 0.4) ** 2
    pulls = [replace(free, axial=0.3 * pull, axial_bow=bow).real_modes(2)[0] for bow in (-0.8, 0.0, 0.8)]
    assert pulls[1][0] > free.real_modes(1)[0][0]
    assert pulls[0][1] > pulls[1][1] > pulls[2][1]  # the second mode twists, and moves most at the edges


def test_air_shut_in_stiffens_by_the_volume_displaced() -> None:
    bare, shapes = PLATE.real_modes(3)
    _, _, weight, read = PLATE.grid.gauss
    volume = read.rows({0: read.value}, PLATE.n_dofs).T @ weight @ shapes
    stiffness = 0.05 * bare[0] ** 2 / volume[0] ** 2
    blocked = replace(PLATE, cavity=Cavity(stiffness, inertance=1e6 * stiffness))
    omega, _ = blocked.real_modes(4)
    assert omega[1] ** 2 == pytest.approx(1.05 * bare[0] ** 2, rel=3e-3)
    np.testing.assert_allclose(omega[2], bare[1], rtol=1e-5)  # the second displaces nothing


def test_a_neck_resonates_and_splits_the_mode() -> None:
    bare, shapes = PLATE.real_modes(1)
    _, _, weight, read = PLATE.grid.gauss
    volume = float((read.rows({0: read.value}, PLATE.n_dofs).T @ weight @ shapes)[0])
    stiffness = 0.02 * bare[0] ** 2 / volume**2
    open_ = replace(PLATE, cavity=Cavity(stiffness, stiffness / bare[0] ** 2, resistance=0.0))
    omega, _ = open_.real_modes(2)
    assert omega[0] < bare[0] < omega[1]
    assert omega[0] * omega[1] == pytest.approx(bare[0] ** 2, rel=0.01)


def test_a_channels_gain_and_a_sensors_arm_are_the_measurements(setups: dict[str, Setup]) -> None:
    before, after = put("channel_gain", setups["beam"], points=[2], gain=1.3)
    factor = np.ones((len(before.setup.points), 1))
    factor[1] = 1.3
    np.testing.assert_allclose(after.elastic().residues, factor * before.elastic().residues, rtol=1e-9)
    before, after = put("cross_axis", setups["beam"], arm=0.01)
    plain, seen = before.elastic(), after.elastic()
    sensor = before.setup.sensor
    expected = plain.sensor + 0.01 * plain.slopes[0, sensor]
    np.testing.assert_allclose(seen.sensor, expected, rtol=1e-9)
    np.testing.assert_allclose(seen.poles, plain.poles, rtol=1e-12)


# a harmonic of wavenumber k between surface and bottom: k / (tanh ka + coth kb) per unit jump, k / 2 without either
@pytest.mark.parametrize("tank", [(0.2, np.inf), (np.inf, 0.3), (0.2, 0.3), (1.0, 0.25)])
def test_images_are_those_of_the_tank(tank: tuple[float, float]) -> None:
    k = 2.5
    mirrored = sum(sign * np.exp(-k * abs(height)) for height, sign in images(*tank))
    exact = 1 / (np.tanh(k * tank[0]) + 1 / np.tanh(k * tank[1]))
    assert 0.5 * (1 + mirrored) == pytest.approx(exact, rel=1e-4)


def test_a_corner_is_the_derivative_of_its_solid_angle() -> None:
    def angle(z: float) -> float:
        return float(np.arctan(0.3 * 0.5 / (z * np.sqrt(0.3**2 + 0.5**2 + z**2))))

    slope = (angle(0.2 + 1e-6) - angle(0.2 - 1e-6)) / 2e-6
    assert float(corner(np.array(0.3), np.array(0.5), 0.2)) == pytest.approx(-slope, rel=1e-6)
    assert float(corner(np.array(0.3), np.array(0.5), 1e-7)) == pytest.approx(
        float(corner(np.array(0.3), np.array(0.5))), rel=1e-6
    )


def test_a_surface_lightens_and_a_bottom_weighs() -> None:
    def heave(**tank: Any) -> float:
        return float(added_mass(0.5, 0.05, 0.002, density=1000.0, **tank)[1].sum())

    free = heave()
    assert heave(tank=(0.02, np.inf)) < 0.97 * free
    assert heave(tank=(np.inf, 0.02)) > 1.03 * free
    assert heave(tank=(3.0, 3.0)) == pytest.approx(free, rel=5e-3)


def test_viscous_layers_over_all_are_rayleighs() -> None:
    whole = Stretch(0.3, 0.6 + 1e-9, alpha=3.0, beta=2e-6)
    modes = complex_modes(
        replace(BEAM, thickness=0.001, stretches=(whole,)),
        np.array([[0.6]]),
        np.array([0.6]),
        count=8,
        scatter=np.ones(8),
    )
    omega = np.abs(modes.poles[:4])
    np.testing.assert_allclose(-modes.poles.real[:4], 0.5 * (3.0 + 2e-6 * omega**2), rtol=2e-3)
    laid = Patch(0.2, 0.15, 0.4 + 1e-9, 0.3 + 1e-9, alpha=3.0)
    plate = replace(PLATE, thickness=0.001, patches=(laid,))
    damped = complex_modes(plate, np.array([[0.1, 0.1]]), np.array([0.1, 0.1]), count=6, scatter=np.ones(6))
    np.testing.assert_allclose(-damped.poles.real[:3], 1.5, rtol=2e-3)


def test_less_damping_than_expected_is_a_share_of_it(setups: dict[str, Setup]) -> None:
    setup = setups["beam"]
    before, after = put(
        "uniform_damping", setup, alpha=-0.6 * setup.alpha, beta=-0.6 * setup.beta, loss_factor=0.0
    )
    np.testing.assert_allclose(after.elastic().damping[:4], 0.4 * before.elastic().damping[:4], rtol=1e-3)
    _, gone = put("uniform_damping", setup, alpha=-2 * setup.alpha, beta=-2 * setup.beta, loss_factor=0.0)
    assert np.all(gone.elastic().poles.real <= 1e-6)


@pytest.mark.parametrize("slope", [-0.01, 0.01])
def test_a_joint_softens_or_hardens_by_its_slope(slope: float, setups: dict[str, Setup]) -> None:
    setup = setups["beam"]
    before, after = put("joint_nonlinearity", setup, slope=slope / setup.peak)
    low, high = (after.elastic(f * setup.peak).frequency[: setup.modes] for f in (0.9, 1.1))
    assert np.mean(np.log(high / low)) / 0.2 == pytest.approx(slope, rel=0.15)
    rest = after.elastic(1e-6 * setup.peak).frequency[: setup.modes]
    np.testing.assert_allclose(rest, before.elastic().frequency[: setup.modes], rtol=1e-6)


def test_two_elastic_constants_move_different_modes() -> None:
    free = replace(PLATE, clamped=("x0",))
    bare = free.real_modes(3)[0]
    changes: tuple[dict[str, float], ...] = ({"shear_ratio": 1.2}, {"ratio": 1.2})
    twist, across = (replace(free, **change).real_modes(3)[0] / bare - 1 for change in changes)  # type: ignore
    assert twist[1] > 5 * twist[0] > 0  # the second mode twists
    assert np.abs(twist / across - (twist / across)[0]).max() > 0.1


def test_areas_are_softer_and_stiffer_and_lie_on_the_structure(setups: dict[str, Setup]) -> None:
    rng = np.random.default_rng(1)
    for kind in ("beam", "plate"):
        setup = setups[kind]
        drawn = [HIDDEN_EFFECTS["local_stiffness"].draw(rng, setup, 1.0) for _ in range(200)]
        losses = np.array([v["loss"] for v in drawn])
        assert 0.1 < np.mean(losses < 0) < 0.4
        assert losses.min() >= -9 and losses.max() <= 0.98
        assert all(np.sign(v["compliance"]) == np.sign(v["loss"]) for v in drawn)
        for axis, name, size in zip("xy", ("extent", "extent_y"), setup.size, strict=False):
            reach = np.array([[v[axis] - v[name] / 2, v[axis] + v[name] / 2] for v in drawn])
            assert reach.min() > -1e-9 and reach.max() < size + 1e-9
            assert max(v[name] for v in drawn) > 0.28 * size
    hard, soft = ({"x": 0.1, "extent": 0.1, "loss": loss, "form": "cosine"} for loss in (-2.0, 0.5))
    for values, sign in ((hard, 1), (soft, -1)):
        before, after = put("local_stiffness", setups["beam"], **values)
        assert np.all(sign * (after.elastic().frequency[:4] - before.elastic().frequency[:4]) > 0)


@pytest.mark.parametrize("form", ["sheet", "ice"])
def test_a_load_weighs_what_it_says_and_stays_on_the_structure(setups: dict[str, Setup], form: str) -> None:
    rng = np.random.default_rng(2)
    for kind in ("beam", "plate"):
        setup = setups[kind]
        values = HIDDEN_EFFECTS["local_mass"].draw(rng, setup, 1.0) | {"form": form}
        sides = [
            np.linspace(-0.5, 0.5, 600, endpoint=False) * values[name] + values[axis]
            for axis, name in zip("xy", ("extent", "extent_y"), strict=False)
            if name in values
        ]
        places = np.meshgrid(*[side + (side[1] - side[0]) / 2 for side in sides])
        body = put("local_mass", setup, **values)[1].body
        heavier = np.ones_like(places[0])
        if kind == "beam":
            for part in body.stretches:
                heavier *= 1 + (part.line - 1) * part.inside(places[0])
        else:
            for part in body.patches:
                heavier *= 1 + part.mass * part.covers(*places)
        assert heavier.mean() == pytest.approx(values["factor"], rel=5e-3)
        assert (heavier.max() > values["factor"] + 0.01) == (form == "ice")
        area = np.prod([side[-1] - side[0] for side in sides]) / np.prod(setup.size)
        assert values["mass"] == pytest.approx((values["factor"] - 1) * area * setup.mass, rel=5e-3)
        for side, size in zip(sides, setup.size, strict=True):
            assert side.min() > -1e-9 and side.max() < size + 1e-9


def test_masses_sit_at_ends_and_edges_too(setups: dict[str, Setup]) -> None:
    rng = np.random.default_rng(1)
    for kind, edges in (("free", ("x0", "x1")), ("plate", ("y0", "y1"))):
        setup = setups[kind]
        drawn = [HIDDEN_EFFECTS["lumped_mass"].draw(rng, setup, 1.0) for _ in range(200)]
        for edge in edges:
            far = float(edge[1]) * setup.size["xy".index(edge[0])]
            assert 0.05 < np.mean([v[edge[0]] == far for v in drawn]) < 0.25
