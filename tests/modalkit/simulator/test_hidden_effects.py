"""Every hidden effect against closed forms, independent numbers, or at least the direction that physics sets."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.integrate

from modalkit.blind.trial import Trial, draw_trial
from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.beam.water import (
    _side,
    added_mass,
    layer_damping,
    slip_factor,
    thickness_factor,
)
from modalkit.simulator.bodies.complex_modes import ComplexModes, complex_modes
from modalkit.simulator.bodies.parts import Absorber, Attached, Stretch
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.hidden import HIDDEN_EFFECTS
from modalkit.simulator.hidden.known import KNOWN_SINCE
from modalkit.simulator.hidden.outside import gap_share
from modalkit.simulator.scene import Scene, nominal_scene
from modalkit.simulator.setup import Setup
from updating import LIBRARY

BEAM = Beam(0.0, 0.6, 0.03, 0.003, 210e9, 7850.0, alpha=2.0, beta=1e-6)
INSIDE = [
    name
    for name, hidden_effect in HIDDEN_EFFECTS.items()
    if not hidden_effect.outside and name != "orthotropy"  # of plates alone
]
OUTSIDE = [
    name
    for name, hidden_effect in HIDDEN_EFFECTS.items()
    if hidden_effect.outside and name not in ("skew_clamp", "cavity")  # of plates alone
]
LAMBDA = np.array([1.87510407, 4.69409113, 7.85475744, 10.99554073])
CLEAR = DrawRanges(kinds=("beam",), mild=0.0, strong=0.0, pairs=0.0)


def hide(name: str, index: int = 0) -> Trial:
    return draw_trial(8, index, plan=replace(CLEAR, effects=(name,)))


def cantilever() -> Setup:
    for index in range(40):
        setup = draw_trial(31, index, plan=replace(CLEAR, effects=("E",))).scene.setup
        if setup.clamped == ("x0",) and setup.theory == "timoshenko":
            return replace(setup, environment=None, baseline=False, window=0.0)
    raise AssertionError("no cantilever in 40 draws")


def put(name: str, setup: Setup, **values: Any) -> tuple[Scene, Scene]:
    """Return the rig as stated, and with an effect."""
    scene = nominal_scene(setup)
    return scene, HIDDEN_EFFECTS[name].act(scene, values)


def shifts(after: Scene, before: Scene, level: float | None = None) -> np.ndarray:
    count = before.setup.modes
    return after.elastic(level).frequency[:count] / before.elastic().frequency[:count] - 1


def of(beam: Beam, x: float = 0.6) -> ComplexModes:
    return complex_modes(beam, np.array([[x]]), np.array([x]), count=12, scatter=np.ones(12))


def test_the_rig_has_the_library_and_eighteen_more() -> None:
    assert len(INSIDE) >= 23
    assert len(OUTSIDE) >= 17
    assert all(HIDDEN_EFFECTS[name].exclusive != "" for name in ("section_scale", "calibration_gain"))


def test_what_the_rig_takes_for_known_is_in_the_library() -> None:
    assert {effect.known_as for effect in HIDDEN_EFFECTS.values()} - {None} <= set(LIBRARY)
    assert set(KNOWN_SINCE) <= {name for name, effect in HIDDEN_EFFECTS.items() if effect.outside}


@pytest.mark.parametrize("name", INSIDE + OUTSIDE)
def test_every_clear_effect_stands_in_the_data(name: str) -> None:
    seen = [hide(name, index).truth for index in range(4)]
    assert all(t.effects == (name,) and t.level == "clear" for t in seen)
    assert np.median([t.visibility for t in seen]) > 3
    known = name if name in INSIDE else KNOWN_SINCE.get(name)
    assert all(t.in_library == (known is not None) for t in seen)
    assert all((known,) in t.accepted if known else not t.accepted for t in seen)
    assert all(len(place) == 1 and -1e-9 <= place[0] <= t.size[0] + 1e-9 for t in seen for place in t.places)


UNSHIFTED = {
    *("calibration_gain", "exponential_window", "time_delay", "polarity", "swapped_points", "position_error"),
    *("drift", "oblique_hits", "section_scale", "shear", "channel_gain", "cross_axis"),
}
LOWER = {
    *("clamp_rotation", "clamp_translation", "sensor_mass", "lumped_mass"),
    *("fluid_added_mass", "breathing_crack"),
}
HIGHER = {"ground_spring", "tip_spring", "loose_end", "suspension", "initial_curvature"}


@pytest.mark.parametrize("name", sorted(UNSHIFTED | LOWER | HIGHER))
def test_frequencies_move_the_way_they_must(name: str) -> None:
    for index in range(3):
        trial = hide(name, index)
        moved = shifts(trial.scene, trial.before)
        if name in UNSHIFTED:
            assert np.abs(moved).max() < (1e-2 if name == "section_scale" else 1e-12)
        elif name in LOWER:
            assert moved.max() < 1e-6 and moved.min() < -1e-3
        else:
            assert moved.min() > -1e-6 and moved.max() > 1e-4


@pytest.mark.parametrize(
    ("name", "value", "power"), [("E", 1.2, 0.5), ("density", 1.3, -0.5), ("thickness", 1.05, 1.0)]
)
def test_factors_scale_all_frequencies_alike(name: str, value: float, power: float) -> None:
    before, after = put(name, replace(cantilever(), sensor_mass=0.0), factor=value)
    moved = shifts(after, before)
    np.testing.assert_allclose(moved, value**power - 1, atol=0.012 if name == "thickness" else 1e-6)


def test_length_lowers_by_its_square() -> None:
    setup = replace(cantilever(), sensor_mass=0.0)
    before, after = put("length", setup, extension=0.02 * setup.length)
    np.testing.assert_allclose(shifts(after, before), 1.02**-2 - 1, rtol=0.06)
    assert isinstance(after.body, Beam) and isinstance(before.body, Beam)
    assert after.body.end == before.body.end
    assert after.body.start == pytest.approx(-0.02 * setup.length)


def test_section_scale_is_a_gain_unless_the_sensor_tells() -> None:
    setup = replace(cantilever(), sensor_mass=0.0, repeatability=2e-4)
    for name, values in (("section_scale", {"factor": 1.4}), ("calibration_gain", {"gain": 0.7})):
        equals = HIDDEN_EFFECTS[name].equals
        assert len(equals(setup, values)) == 1
        assert equals(replace(setup, sensor_mass=0.01 * setup.mass), values) == ()
    _, after = put("section_scale", setup, factor=1.25)
    _, gained = put("calibration_gain", setup, gain=0.8)
    a, b = after.elastic(), gained.elastic()
    np.testing.assert_allclose(a.poles, b.poles, rtol=1e-9)
    np.testing.assert_allclose(after.chain.gain * a.residues, gained.chain.gain * b.residues, rtol=1e-6)


# a mass m at the tip of a uniform cantilever: 1 + cos cosh - (m/M) l (sin cosh - cos sinh) = 0
def test_mass_at_the_tip_is_the_textbooks() -> None:
    mass = 0.1 * BEAM.mass
    omega, _ = replace(BEAM, attached=(Attached(0.6, mass=mass),)).real_modes(3)
    for value in omega:
        wave = np.sqrt(value) * (BEAM.mass / BEAM.length / BEAM.bending_stiffness) ** 0.25 * BEAM.length
        sides = [wave * d for d in (0.999, 1.001)]
        ends = [
            1 + np.cos(k) * np.cosh(k) - 0.1 * k * (np.sin(k) * np.cosh(k) - np.cos(k) * np.sinh(k))
            for k in sides
        ]
        assert ends[0] * ends[1] < 0


# a spring k at the tip: l^3 (1 + cos cosh) + (k L^3 / E I) (cosh sin - sinh cos) = 0
def test_spring_at_the_tip_is_the_textbooks() -> None:
    unit = BEAM.bending_stiffness / BEAM.length**3
    omega, _ = replace(BEAM, attached=(Attached(0.6, stiffness=7.0 * unit),)).real_modes(3)
    for value in omega:
        wave = np.sqrt(value) * (BEAM.mass / BEAM.length / BEAM.bending_stiffness) ** 0.25 * BEAM.length
        ends = [
            k**3 * (1 + np.cos(k) * np.cosh(k)) + 7.0 * (np.cosh(k) * np.sin(k) - np.sinh(k) * np.cos(k))
            for k in (0.999 * wave, 1.001 * wave)
        ]
        assert ends[0] * ends[1] < 0


# pinned-pinned under N: omega_n^2 = (n pi / L)^4 E I / m + (n pi / L)^2 N / m; held here by clamps that only turn
@pytest.mark.parametrize("share", [-0.6, 0.5, 3.0])
def test_axial_load_is_eulers(share: float) -> None:
    pinned = replace(BEAM, thickness=0.002, clamped=("x0", "x1"), clamp_rotation=1e-6)
    buckling = pinned.bending_stiffness * (np.pi / pinned.length) ** 2
    omega, shapes = replace(pinned, axial=share * buckling).real_modes(4)
    n = np.arange(1, 5)
    line = pinned.mass / pinned.length
    exact = np.sqrt(
        ((n * np.pi / 0.6) ** 4 * pinned.bending_stiffness + (n * np.pi / 0.6) ** 2 * share * buckling) / line
    )
    np.testing.assert_allclose(omega, exact, rtol=4e-4)
    assert shapes.shape[1] == 4


def test_load_near_buckling_lowers_the_first_mode_to_nothing() -> None:
    pinned = replace(BEAM, clamped=("x0", "x1"), clamp_rotation=1e-6)
    buckling = pinned.bending_stiffness * (np.pi / pinned.length) ** 2
    omega, _ = replace(pinned, axial=-0.9999 * buckling).real_modes(2)
    assert omega[0] < 0.03 * omega[1]


def test_both_ends_clamped() -> None:
    held = replace(BEAM, thickness=0.0015, clamped=("x0", "x1"))
    omega, _ = held.real_modes(3)
    exact = np.array([4.73004074, 7.85320462, 10.9956079]) ** 2 / 0.36
    exact = exact * np.sqrt(held.bending_stiffness / (held.mass / held.length))
    np.testing.assert_allclose(omega, exact, rtol=3e-4)


# linearly tapered cantilever, depth at the tip 0.8 of that at the root, constant width: Mabie and Rogers,
# J. Acoust. Soc. Am. 36 (1964) 463; first-order perturbation with the mode shape of the uniform one here
def test_taper_shifts_as_perturbation_says() -> None:
    taper = 0.02
    thin = replace(BEAM, thickness=0.001)
    before, shapes = thin.real_modes(4)
    after, _ = replace(thin, taper=taper).real_modes(4)
    x = np.linspace(0.0, 0.6, 4001)
    curvature, move = (thin.rows(x, q) @ shapes for q in ("curvature", "w"))
    local = taper * (x / 0.6 - 0.5)[:, None]
    stiff = np.trapezoid(3 * local * thin.bending_stiffness * curvature**2, x, axis=0)
    mass = np.trapezoid(local * thin.mass / 0.6 * move**2, x, axis=0)
    np.testing.assert_allclose(after / before - 1, 0.5 * (stiff / before**2 - mass), rtol=0.05)


def test_a_stretch_over_all_is_another_section() -> None:
    ribbed = replace(BEAM, stretches=(Stretch(0.3, 0.6 + 1e-9, bending=1.3**3, line=1.3),))
    omega, _ = ribbed.real_modes(4)
    np.testing.assert_allclose(omega, 1.3 * BEAM.real_modes(4)[0], rtol=2e-3)


def test_crack_softens_as_its_compliance_says() -> None:
    crack = Stretch(0.2, 0.003, bending=0.3)
    before, shapes = BEAM.real_modes(3)
    after, _ = replace(BEAM, stretches=(crack,)).real_modes(3)
    curvature = (BEAM.rows(np.array([0.2]), "curvature") @ shapes)[0]
    expected = -0.5 * crack.compliance * BEAM.bending_stiffness * curvature**2 / before**2
    np.testing.assert_allclose(after / before - 1, expected, rtol=0.05)


# Den Hartog, Mechanical Vibrations, section 3.2: an undamped absorber tuned to the mode splits it
def test_absorber_splits_its_mode() -> None:
    omega, shapes = BEAM.real_modes(1)
    tip = (BEAM.rows(np.array([0.6]), "w") @ shapes)[0, 0]
    mass = 0.01 * BEAM.mass
    ratio = mass * tip**2
    split, _ = replace(BEAM, absorbers=(Absorber(0.6, mass, mass * omega[0] ** 2, 0.0),)).real_modes(3)
    squares = 1 + ratio / 2 + np.array([-1, 1]) * np.sqrt(ratio + ratio**2 / 4)
    np.testing.assert_allclose((split[:2] / omega[0]) ** 2, squares, rtol=2e-3)
    assert split[2] == pytest.approx(BEAM.real_modes(2)[0][1], rel=5e-3)


def test_hanging_mass_without_spring_is_not_felt() -> None:
    mass = 0.3 * BEAM.mass
    loose, _ = replace(BEAM, absorbers=(Absorber(0.6, mass, 1e-6, 0.0),)).real_modes(4)
    np.testing.assert_allclose(loose[1:], BEAM.real_modes(3)[0], rtol=1e-8)
    rigid, _ = replace(BEAM, absorbers=(Absorber(0.6, mass, 1e10, 0.0),)).real_modes(3)
    held, _ = replace(BEAM, attached=(Attached(0.6, mass=mass),)).real_modes(3)
    np.testing.assert_allclose(rigid, held, rtol=1e-4)


def test_dashpot_adds_what_its_mode_feels() -> None:
    damped = of(replace(BEAM, attached=(Attached(0.6, damping=0.05),)))
    plain = of(BEAM)
    _, shapes = BEAM.real_modes(12)
    tip = (BEAM.rows(np.array([0.6]), "w") @ shapes)[0]
    np.testing.assert_allclose((plain.poles - damped.poles).real[:4], 0.5 * 0.05 * tip[:4] ** 2, rtol=1e-3)


def test_layer_of_loss_over_all_is_half_a_ratio() -> None:
    plain = replace(BEAM, alpha=0.0, beta=0.0, thickness=0.001)
    lossy = of(replace(plain, stretches=(Stretch(0.3, 0.6 + 1e-9, loss=0.04),)))
    np.testing.assert_allclose(lossy.damping[:4], 0.02, rtol=5e-3)


def test_layer_damps_by_its_share_of_strain_energy() -> None:
    plain = replace(BEAM, alpha=0.0, beta=0.0, thickness=0.001)
    omega, shapes = plain.real_modes(12)
    lossy = of(replace(plain, stretches=(Stretch(0.15, 0.2, loss=0.04),)))
    x = np.linspace(0.05, 0.25, 2001)
    energy = plain.bending_stiffness * np.trapezoid((plain.rows(x, "curvature") @ shapes) ** 2, x, axis=0)
    np.testing.assert_allclose(lossy.damping[:4], 0.5 * 0.04 * (energy / omega**2)[:4], rtol=0.01)


# the flow around the rectangle by direct quadrature of the mapped circle, away from the substitutions
@pytest.mark.parametrize("angle", [0.2, 0.5, np.pi / 4])
def test_slip_is_the_quadrature_of_the_mapped_flow(angle: float) -> None:
    def speed(theta: float) -> float:
        return float(4 * np.cos(theta) ** 2 / (2 * np.sqrt(abs(np.sin(angle) ** 2 - np.sin(theta) ** 2))))

    around = 4 * sum(
        scipy.integrate.quad(speed, low, high, limit=400)[0]
        for low, high in ((0.0, angle), (angle, np.pi / 2))
    )
    thickness, width = _side(angle), _side(np.pi / 2 - angle)
    assert slip_factor(thickness / width) == pytest.approx(around / width, rel=2e-3)


def test_boundary_layer_of_a_long_strip_is_stokes() -> None:
    drag = 998.0 * 1e-3
    stations, matrix = layer_damping(4.0, 0.03, 0.003, drag=drag, along=60)
    wave = np.sin(np.pi * stations / 4.0)
    line = np.sqrt(drag / 2) * slip_factor(0.1) * 0.03
    assert wave @ matrix @ wave == pytest.approx(line * 2.0, rel=0.02)
    x, inertia = added_mass(4.0, 0.03, 0.003, density=1.0, along=60)
    np.testing.assert_allclose(x, stations)
    strip = np.pi / 4 * 0.03**2 * thickness_factor(0.1)
    assert wave @ inertia @ wave == pytest.approx(strip * 2.0, rel=0.02)


def test_boundary_layer_damps_with_the_root_of_frequency_and_drags_along() -> None:
    plain = replace(BEAM, alpha=0.0, beta=0.0)
    wet = of(replace(plain, drag=2.0))
    dry = of(plain)
    ratio = wet.damping[:4] * np.sqrt(wet.frequency[:4])
    np.testing.assert_allclose(ratio / ratio[0], 1.0, atol=0.08)
    fall = 1 - wet.frequency[:4] / dry.frequency[:4]
    np.testing.assert_allclose(fall, wet.damping[:4], rtol=0.05)


def test_four_times_the_viscosity_damps_twice_as_much() -> None:
    setup = replace(cantilever(), alpha=0.0, beta=0.0)
    modes = [put("fluid_damping", setup, viscosity=v)[1].elastic().damping[:4] for v in (2e-5, 8e-5)]
    np.testing.assert_allclose(modes[1] / modes[0], 2.0, rtol=0.01)


def test_joint_slope_is_the_mean_over_modes() -> None:
    setup = cantilever()
    before, after = put("joint_nonlinearity", setup, slope=-0.01 / setup.peak)
    low, high = (after.elastic(f * setup.peak).frequency[: setup.modes] for f in (0.9, 1.1))
    slope = np.mean(np.log(high / low)) / (0.2 * setup.peak)
    assert slope == pytest.approx(-0.01 / setup.peak, rel=0.15)
    assert np.all(shifts(after, before, 1e-6 * setup.peak) > -1e-6)


@pytest.mark.long
def test_levels_move_what_depends_on_them() -> None:
    for name in ("joint_nonlinearity", "breathing_crack"):
        scene = hide(name).scene
        soft, hard = (scene.elastic(f * scene.setup.peak).frequency[0] for f in (0.5, 2.0))
        assert hard < soft * (1 - 1e-4)
    scene = hide("loose_end").scene
    soft, hard = (scene.elastic(f * scene.setup.peak).frequency[0] for f in (0.1, 3.0))
    assert hard > soft * (1 + 1e-4)


# describing function of a dead zone, by its own Fourier integral
@pytest.mark.parametrize("amplitude", [0.7, 1.3, 5.0])
def test_gap_share_is_the_fourier_integral(amplitude: float) -> None:
    t = np.linspace(0, 2 * np.pi, 200001)
    x = amplitude * np.sin(t)
    force = np.sign(x) * np.maximum(np.abs(x) - 1.0, 0.0)
    share = np.trapezoid(force * np.sin(t), t) / np.pi / amplitude
    assert gap_share(amplitude) == pytest.approx(share, abs=1e-6)


def test_points_reversed_exchanged_and_moved() -> None:
    setup = cantilever()
    plain = nominal_scene(setup).elastic()
    _, scene = put("polarity", setup, points=[2])
    np.testing.assert_allclose(scene.elastic().points[1], -plain.points[1])
    np.testing.assert_allclose(scene.elastic().points[2], plain.points[2])
    _, scene = put("swapped_points", setup, points=[2, 4])
    np.testing.assert_allclose(scene.elastic().points[[1, 3]], plain.points[[3, 1]])
    _, scene = put("position_error", setup, point=3, dx=0.01)
    here = scene.elastic().points[2]
    assert not np.allclose(here, plain.points[2], rtol=1e-3)
    np.testing.assert_allclose(here, plain.points[2] + 0.01 * plain.slopes[0, 2], rtol=0.3, atol=2e-2)


def test_sensor_beside_a_mass_answers_to_both_names() -> None:
    setup = cantilever()
    (x,) = setup.points[setup.sensor]
    equals = HIDDEN_EFFECTS["lumped_mass"].equals
    assert equals(setup, {"x": x + 0.002 * setup.length}) == ("sensor_mass",)
    assert equals(setup, {"x": x - 0.2 * setup.length}) == ()
    assert HIDDEN_EFFECTS["sensor_mass"].equals(setup, {}) == ("lumped_mass",)
    alpha = {"alpha": 2.0, "beta": 0.0, "loss_factor": 0.0}
    assert HIDDEN_EFFECTS["uniform_damping"].equals(setup, alpha) == ("exponential_window",)
    assert HIDDEN_EFFECTS["uniform_damping"].equals(setup, alpha | {"beta": 1e-6}) == ()
