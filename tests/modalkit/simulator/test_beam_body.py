"""The rig's beam against closed forms and published values."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize
from hypothesis import given, settings
from hypothesis import strategies as st

from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.mesh import graded_mesh
from modalkit.simulator.bodies.parts import Attached, Notch

SLENDER = Beam(0.0, 1.0, 0.02, 0.001, 210e9, 7850.0)
STOCKY = Beam(0.0, 0.5, 0.04, 0.05, 210e9, 7850.0)


def euler_bernoulli(beam: Beam, wave_numbers: list[float]) -> np.ndarray:
    line = beam.density * beam.width * beam.thickness
    return np.asarray(np.array(wave_numbers) ** 2 / beam.length**2 * np.sqrt(beam.bending_stiffness / line))


def timoshenko_determinant(omega: float, beam: Beam) -> float:
    """Frequency function of a clamped-free Timoshenko beam, from its general solution."""
    kappa = 10 * (1 + beam.poisson) / (12 + 11 * beam.poisson)
    area, inertia = beam.width * beam.thickness, beam.width * beam.thickness**3 / 12
    shear = kappa * beam.E / (2 * (1 + beam.poisson)) * area
    bending, line, rotary = beam.E * inertia, beam.density * area, beam.density * inertia
    # w = exp(l x), theta = r w: (S l^2 + m w^2) - S r l = 0 and S (l - r) + B l^2 r + J w^2 r = 0
    squares = np.roots(
        [
            bending * shear,
            omega**2 * (shear * rotary + bending * line),
            omega**2 * line * (rotary * omega**2 - shear),
        ]
    )
    roots = np.concatenate([np.sqrt(squares.astype(complex)), -np.sqrt(squares.astype(complex))])
    ratio = (shear * roots**2 + line * omega**2) / (shear * roots)
    grow = np.exp(roots * beam.length)
    matrix = np.array([np.ones(4), ratio, ratio * roots * grow, (roots - ratio) * grow])
    scaled = matrix / np.abs(matrix).max(axis=1)[:, None]
    return float(np.imag(np.linalg.det(scaled)))


def test_slender_cantilever_is_euler_bernoulli() -> None:
    omega, shapes = SLENDER.real_modes(5)
    exact = euler_bernoulli(SLENDER, [1.87510407, 4.69409113, 7.85475744, 10.99554073, 14.13716839])
    np.testing.assert_allclose(omega, exact, rtol=6e-5)
    tip = SLENDER.rows(np.array([1.0]), "w") @ shapes
    np.testing.assert_allclose(np.abs(tip), 2 / np.sqrt(SLENDER.mass), rtol=1e-4)


def test_slender_free_beam_is_euler_bernoulli() -> None:
    omega, _ = replace(SLENDER, clamped=()).real_modes(6)
    assert omega[:2].max() < 1e-2 * omega[2]
    exact = euler_bernoulli(SLENDER, [4.73004074, 7.85320462, 10.9956079, 14.1371655])
    np.testing.assert_allclose(omega[2:], exact, rtol=6e-5)


def test_stocky_cantilever_is_the_exact_timoshenko_beam() -> None:
    omega, _ = STOCKY.real_modes(4)
    for value in omega:
        low, high = 0.995 * value, 1.005 * value
        root = scipy.optimize.brentq(timoshenko_determinant, low, high, args=(STOCKY,))
        assert value == pytest.approx(root, rel=2e-5)
    no_shear, _ = replace(STOCKY, shear=False).real_modes(4)
    exact = euler_bernoulli(STOCKY, [1.87510407, 4.69409113, 7.85475744, 10.99554073])
    np.testing.assert_allclose(no_shear, exact, rtol=2e-4)
    assert omega[3] < 0.9 * no_shear[3]


def test_mesh_has_converged() -> None:
    notched = replace(STOCKY, notches=(Notch(0.2, 0.02, 0.7),), fluid_density=998.0)
    coarse, _ = notched.real_modes(5)
    fine, _ = replace(notched, elements=40).real_modes(5)
    np.testing.assert_allclose(coarse, fine, rtol=2e-5)


def test_massless_limit_of_a_tip_mass() -> None:
    heavy = 50 * SLENDER.mass
    omega, _ = replace(SLENDER, attached=(Attached(1.0, mass=heavy),)).real_modes(1)
    stiffness = 3 * SLENDER.bending_stiffness
    assert omega[0] == pytest.approx(np.sqrt(stiffness / (heavy + 33 / 140 * SLENDER.mass)), rel=1e-4)


def test_soft_clamp_is_a_pendulum_on_its_spring() -> None:
    soft = replace(SLENDER, clamp_rotation=1e-3 * SLENDER.bending_stiffness)
    omega, _ = soft.real_modes(1)
    rigid = np.sqrt(soft.clamp_rotation / (SLENDER.mass / 3))
    assert omega[0] == pytest.approx(rigid, rel=2e-3)


def test_notch_softens_as_its_compliance_says() -> None:
    notch = Notch(0.3, 0.01, 0.2)
    x = np.linspace(0.295, 0.305, 20001)
    assert notch.compliance == pytest.approx(np.trapezoid(1 / notch.factor(x) - 1, x), rel=1e-6)
    before, shapes = SLENDER.real_modes(3)
    after, _ = replace(SLENDER, notches=(notch,)).real_modes(3)
    curvature = (SLENDER.rows(np.array([0.3]), "curvature") @ shapes)[0]
    expected = -0.5 * notch.compliance * SLENDER.bending_stiffness * curvature**2 / before**2
    np.testing.assert_allclose(after / before - 1, expected, rtol=0.05)


def test_slope_is_the_derivative_of_the_deflection() -> None:
    _, shapes = STOCKY.real_modes(4)
    x, step = np.array([0.11, 0.26, 0.41]), 1e-6
    difference = (STOCKY.rows(x + step, "w") - STOCKY.rows(x - step, "w")) @ shapes / (2 * step)
    np.testing.assert_allclose(STOCKY.rows(x, "slope") @ shapes, difference, rtol=1e-5)


@settings(max_examples=60)
@given(
    start=st.floats(-0.05, 0.05),
    length=st.floats(0.2, 1.2),
    centre=st.floats(0.0, 1.0),
    extent=st.floats(0.005, 0.2),
)
def test_mesh_is_ordered_uneven_and_keeps_its_ends(
    start: float, length: float, centre: float, extent: float
) -> None:
    end, middle = start + length, start + centre * length
    window = (middle - extent * length / 2, middle + extent * length / 2)
    nodes = graded_mesh(start, end, elements=14, windows=(window,))
    assert (nodes[0], nodes[-1]) == (start, end)
    steps = np.diff(nodes)
    assert steps.min() > 0
    assert steps.max() < 0.15 * length
    assert steps.max() > 1.5 * steps.min()
