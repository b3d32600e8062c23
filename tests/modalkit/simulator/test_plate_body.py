"""The rig's plate against published values, closed forms, beams and finer meshes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy.optimize
from hypothesis import given, settings
from hypothesis import strategies as st

from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.complex_modes import complex_modes
from modalkit.simulator.bodies.plate.mesh import plate_lines
from modalkit.simulator.bodies.plate.parts import Patch, PlateAbsorber, PlateAttached, Rib, SoftSpot, flat_rib
from modalkit.simulator.bodies.plate.plate import Plate

PLATE = Plate(0.0, 0.376, 0.2, 0.003175, 210e9, 7850.0)
ALL = ("x0", "x1", "y0", "y1")
TALL = Plate(0.0, 0.5, 0.02, 0.004, 210e9, 7850.0, poisson=0.0, elements=(12, 2))


def square(thickness: float, clamped: tuple[str, ...], *, turn: float = np.inf) -> Plate:
    """Return a unit square of unit density and modulus, whose frequencies are easily made dimensionless."""
    return Plate(0.0, 1.0, 1.0, thickness, 1e9, 1000.0, clamped=clamped, clamp_rotation=turn, elements=(5, 5))


def parameters(plate: Plate, count: int) -> np.ndarray:
    """Return omega a^2 sqrt(rho t / D) of the lowest modes."""
    line = plate.density * plate.thickness
    values = plate.real_modes(count)[0] * plate.length**2 * np.sqrt(line / plate.bending_stiffness)
    return np.asarray(values)


# Leissa, J. Sound Vib. 31 (1973) 257, tables for nu = 0.3: Ritz values, upper bounds by up to 0.4 %
@pytest.mark.parametrize(
    ("clamped", "values", "tolerance"),
    [
        (ALL, [35.992, 73.413, 73.413, 108.27, 131.64, 132.24], 8e-4),
        (("x0",), [3.4917, 8.5246, 21.429, 27.331, 31.111, 54.443], 8e-3),
        ((), [13.489, 19.789, 24.432, 35.024, 35.024, 61.526], 1.1e-2),
    ],
)
def test_thin_squares_of_leissa(clamped: tuple[str, ...], values: list[float], tolerance: float) -> None:
    plate = square(0.001, clamped)
    skip = plate.rigid_modes
    found = parameters(plate, len(values) + skip)[skip:]
    np.testing.assert_allclose(found, values, rtol=tolerance)
    assert np.all(found < np.array(values))


# Liew, Xiang and Kitipornchai, Comput. Struct. 49 (1993) 1, kappa 5/6: omega b^2 / pi^2 sqrt(rho t / D)
def test_thick_clamped_square_of_liew() -> None:
    found = parameters(square(0.1, ALL), 4) / np.pi**2
    np.testing.assert_allclose(found, [3.2954, 6.2858, 6.2858, 8.8098], rtol=2e-5)


def exact_mindlin(plate: Plate, wave: float) -> float:
    """Frequency of a hinged plate's mode of squared wave number ``wave``, from Mindlin's plate equation."""
    rigidity, line = plate.bending_stiffness, plate.density * plate.thickness
    shear = plate.shear_factor * plate.E / (2 * (1 + plate.poisson)) * plate.thickness
    rotary = line * plate.thickness**2 / 12
    # (D k^4 + ...) : (line w^2 - S k^2)(rotary w^2 - D k^2 - S) = S^2 k^2
    linear = -(rotary * shear * wave + line * (rigidity * wave + shear))
    return float(np.sqrt(np.roots([line * rotary, linear, shear * wave * rigidity * wave]).min()))


@pytest.mark.parametrize("thickness", [0.002, 0.1, 0.2])
def test_hinged_rectangle_is_exact(thickness: float) -> None:
    plate = replace(square(thickness, ALL, turn=0.0), width=0.7)
    waves = sorted(np.pi**2 * (m**2 + n**2 / 0.49) for m in range(1, 7) for n in range(1, 5))
    exact = [exact_mindlin(plate, wave) for wave in waves[:8]]
    np.testing.assert_allclose(plate.real_modes(8)[0], exact, rtol=1e-4)


def test_slender_plate_is_a_beam() -> None:
    beam = Beam(0.0, 0.5, 0.02, 0.004, 210e9, 7850.0, poisson=0.0)
    flat, _ = beam.real_modes(4)
    found, shapes = TALL.real_modes(4)
    np.testing.assert_allclose(found, flat, rtol=1e-5)
    tip = TALL.rows(np.array([[0.5, 0.01]]), "w") @ shapes
    np.testing.assert_allclose(np.abs(tip[0]), 2 / np.sqrt(TALL.mass), rtol=1e-3)


def test_tip_mass_with_inertia_on_a_slender_plate() -> None:
    """Frequency equation of Euler's cantilever with a tip mass (Blevins, Formulas, 1979, table 8-1)."""
    share = 0.4
    loaded = replace(TALL, attached=(PlateAttached(0.5, 0.01, mass=share * TALL.mass),), thickness=0.004)

    def equation(k: float) -> float:
        c, s, ch, sh = np.cos(k), np.sin(k), np.cosh(k), np.sinh(k)
        return float(1 + c * ch + share * k * (c * sh - s * ch))

    roots = [scipy.optimize.brentq(equation, *ends) for ends in ((0.5, 1.8), (3.5, 4.6))]
    line = TALL.mass / TALL.length
    exact = np.array(roots) ** 2 / 0.25 * np.sqrt(TALL.E * 0.02 * 0.004**3 / 12 / line)
    np.testing.assert_allclose(loaded.real_modes(2)[0], exact, rtol=1e-3)


def test_large_ratio_of_moduli_scales_the_width() -> None:
    """Huber's plate is an isotropic one of width b ratio^(-1/4), times the same on the frequencies."""
    ratio = 2.5
    stiff = parameters(replace(square(0.002, ALL), ratio=ratio), 5)
    scaled = parameters(replace(square(0.002, ALL), width=ratio**-0.25), 5)
    np.testing.assert_allclose(stiff, scaled, rtol=1e-3)


def test_tension_stiffens_a_hinged_square_as_computed() -> None:
    plate = square(0.002, ALL, turn=0.0)
    tension = 3.0 * plate.bending_stiffness
    first, second = plate.real_modes(1)[0][0], replace(plate, axial=tension).real_modes(1)[0][0]
    assert (second / first) ** 2 - 1 == pytest.approx(3.0 * np.pi**2 / (4 * np.pi**4), rel=1e-3)
    buckling = -4 * np.pi**2 * plate.bending_stiffness
    assert replace(plate, axial=0.99 * buckling).real_modes(1)[0][0] == pytest.approx(0.1 * first, rel=0.02)


def test_springs_take_over_from_clamps() -> None:
    rigid, _ = PLATE.real_modes(4)
    stiff, _ = replace(PLATE, clamp_rotation=1e9, clamp_translation=1e15).real_modes(4)
    np.testing.assert_allclose(stiff, rigid, rtol=2e-3)
    soft = replace(PLATE, clamp_rotation=1e-4 * PLATE.bending_stiffness / PLATE.length)
    pendulum = np.sqrt(soft.clamp_rotation * PLATE.width / (PLATE.mass * PLATE.length**2 / 3))
    assert soft.real_modes(1)[0][0] == pytest.approx(pendulum, rel=2e-3)
    lifting = replace(PLATE, clamp_translation=1e2)
    assert lifting.real_modes(1)[0][0] == pytest.approx(np.sqrt(1e2 * PLATE.width / PLATE.mass), rel=2e-3)


def test_skew_of_the_clamp_is_antisymmetric_and_meets_the_slanted_plate() -> None:
    up, down = (replace(PLATE, skew=angle).real_modes(5)[0] for angle in (0.1, -0.1))
    np.testing.assert_allclose(up, down, rtol=2e-4)
    longer = replace(PLATE, start=-1e-3).real_modes(5)[0] / PLATE.real_modes(5)[0] - 1
    held = replace(PLATE, skew=0.1, clamp_rotation=1e9).real_modes(5)[0]
    np.testing.assert_allclose(held, up, rtol=2e-3)
    assert np.all(np.abs(up / PLATE.real_modes(5)[0] - 1) < np.abs(40 * longer))


def test_soft_spot_costs_what_first_order_says() -> None:
    spot = SoftSpot(0.06, 0.1, 0.02, 0.04, 0.02, smooth=False)
    before, shapes = PLATE.real_modes(3)
    after, _ = replace(PLATE, spots=(spot,)).real_modes(3)
    x, y = np.meshgrid(np.linspace(0.0505, 0.0695, 20), np.linspace(0.081, 0.119, 20))
    places, step = np.column_stack([x.ravel(), y.ravel()]), 1e-5

    def slope(axis: int, of: str) -> np.ndarray:
        away = step * np.eye(2)[axis]
        rows = PLATE.rows(places + away, of) - PLATE.rows(places - away, of)
        return rows @ shapes / (2 * step)

    xx, yy, xy = slope(0, "theta_x"), slope(1, "theta_y"), slope(0, "theta_y") + slope(1, "theta_x")
    energy = xx**2 + yy**2 + 0.6 * xx * yy + 0.35 * xy**2
    lost = spot.loss * PLATE.bending_stiffness * energy.mean(axis=0) * spot.extent * spot.across
    np.testing.assert_allclose(after / before - 1, -0.5 * lost / before**2, rtol=0.04)


def test_rib_along_the_whole_plate_adds_its_own_stiffness() -> None:
    rib = Rib((0.0, 0.01), (0.5, 0.01), bending=5.0, line_mass=0.1)
    found, _ = replace(TALL, ribs=(rib,)).real_modes(3)
    plain, _ = TALL.real_modes(3)
    rigidity, line = TALL.E * 0.02 * 0.004**3 / 12, TALL.mass / TALL.length
    np.testing.assert_allclose(found / plain, np.sqrt((1 + 5 / rigidity) / (1 + 0.1 / line)), rtol=3e-3)
    real = flat_rib(
        (0.0, 0.01), (0.5, 0.01), width=0.003, height=0.01, thickness=0.004, E=2e11, density=7850.0
    )
    assert real.bending > 2e11 * 0.003 * 0.01**3 / 12
    assert real.line_mass == pytest.approx(7850 * 3e-5)


@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"clamped": ()},
        {"thickness": 0.012, "taper": 0.2},
        {"spots": (SoftSpot(0.1, 0.06, 0.03, 0.03, 0.6),)},
        {"patches": (Patch(0.2, 0.1, 0.12, 0.09, 0.2, 0.05, 0.1),)},
        {"clamp_rotation": 4000.0},
    ],
)
def test_mesh_has_converged(changes: dict[str, Any]) -> None:
    plate = replace(PLATE, **changes)
    skip, count = plate.rigid_modes, 12 + plate.rigid_modes
    coarse, _ = plate.real_modes(count)
    fine, _ = replace(plate, elements=(9, 6)).real_modes(count)
    np.testing.assert_allclose(coarse[skip:], fine[skip:], rtol=1.5e-4)


def test_shapes_are_orthonormal_and_slopes_are_derivatives() -> None:
    plate = replace(PLATE, skew=0.05, attached=(PlateAttached(0.376, 0.2, mass=0.02),))
    _, shapes = plate.real_modes(6)
    at, step = np.array([[0.11, 0.03], [0.26, 0.1], [0.37, 0.199]]), 1e-6
    for name, away in (("slope_x", [step, 0.0]), ("slope_y", [0.0, step])):
        difference = (plate.rows(at + away, "w") - plate.rows(at - away, "w")) @ shapes / (2 * step)
        np.testing.assert_allclose(plate.rows(at, name) @ shapes, difference, rtol=1e-4, atol=1e-3)
    level = replace(plate, alpha=1.0, added_alpha=2.0)
    material, others = level.modal_damping(shapes)
    np.testing.assert_allclose(others, 2 * np.eye(6))
    corner = (plate.rows(np.array([[0.376, 0.2]]), "w") @ shapes)[0]
    np.testing.assert_allclose(material, np.eye(6) - 0.02 * np.outer(corner, corner), atol=1e-7)


def test_damping_of_layers_and_of_the_whole() -> None:
    places = np.array([[0.1, 0.05], [0.376, 0.2]])
    ones = np.ones(8)
    cover = Patch(0.188, 0.1, 0.5, 0.3, 0.02)
    whole = replace(PLATE, added_loss=0.02)
    modes = complex_modes(whole, places, places[1], count=8, scatter=ones)
    np.testing.assert_allclose(modes.damping, 0.01, rtol=1e-4)
    covered = complex_modes(replace(PLATE, patches=(cover,)), places, places[1], count=8, scatter=ones)
    np.testing.assert_allclose(covered.damping, 0.01, rtol=1e-2)  # layers do not damp the energy in shear
    assert np.all(covered.damping < modes.damping)
    assert modes.slopes.shape == (2, 2, 8)


def test_hanging_mass_splits_a_mode() -> None:
    first = PLATE.real_modes(1)[0][0]
    hung = replace(PLATE, absorbers=(PlateAbsorber(0.376, 0.1, 1e-3, 1e-3 * first**2, 0.0),))
    omega, shapes = hung.real_modes(3)
    free, plain = PLATE.real_modes(1)
    tip = (PLATE.rows(np.array([[0.376, 0.1]]), "w") @ plain)[0, 0]
    split = np.sqrt(1e-3) * abs(
        tip
    )  # of two equal oscillators, coupled by the square root of their mass ratio
    assert (omega[1] - omega[0]) / free[0] == pytest.approx(split, rel=0.02)
    assert hung.rows(np.array([[0.1, 0.1]]), "w").shape == (1, len(shapes))


@settings(max_examples=60)
@given(centre=st.floats(0.0, 1.0), extent=st.floats(0.005, 0.5), elements=st.integers(2, 9))
def test_lines_are_ordered_and_keep_ends_and_windows(centre: float, extent: float, elements: int) -> None:
    window = (centre - extent / 2, centre + extent / 2)
    lines = plate_lines(0.0, 1.0, elements=elements, layer=0.01, windows=(window,))
    assert (lines[0], lines[-1]) == (0.0, 1.0)
    assert np.diff(lines).min() > 0
    assert np.diff(lines).max() < 2.2 / elements
    for border in window:
        if 0.05 < border < 0.95 and extent > 0.02:
            assert np.abs(lines - border).min() < 1e-12


def test_lines_of_a_plate_thicker_than_its_layers_allow() -> None:
    lines = plate_lines(0.0, 0.02, elements=2, layer=0.012)
    assert np.diff(lines).min() > 0


def test_a_body_hung_beside_the_plate_hangs_on_its_edge() -> None:
    """Test points keep their places when a specimen comes out smaller than drawn."""
    plate = Plate(0.0, 0.3, 0.2, 0.002, 210e9, 7850.0)
    at, off = (PlateAttached(0.3 + d, 0.2 + d, mass=0.02, inertia=2e-7) for d in (0.0, 3e-3))
    edge, beyond = (replace(plate, attached=(part,)).real_modes(4)[0] for part in (at, off))
    assert beyond == pytest.approx(edge, rel=1e-9)
