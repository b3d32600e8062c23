"""Thick sections: the closed form against published values, the thick plate against the closed form."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from acquisition.errors import InputError
from updating.fluid import FluidDomain, added_mass, heave_coefficient, quadrature_grid, strip_theory

INF = float("inf")
CHANNEL = FluidDomain(walls=(0.0, 0.3, -INF, INF))


@pytest.mark.parametrize(
    ("ratio", "published"),
    [(0.1, 1.14), (0.2, 1.21), (0.5, 1.36), (1.0, 1.51), (2.0, 1.70), (5.0, 1.98), (10.0, 2.23)],
)
def test_heave_coefficients_of_rectangles_as_published(ratio, published):
    """Values that ship-hydrodynamics handbooks print for rectangular sections (Wendel 1956)."""
    assert heave_coefficient(ratio) == pytest.approx(published, rel=0.006)


@given(ratio=st.floats(1e-8, 50.0), factor=st.floats(1.01, 1.9))
def test_heave_coefficient_rises_with_thickness(ratio, factor):
    assert 1.0 <= heave_coefficient(ratio) < heave_coefficient(ratio * factor)


def test_a_flat_strip_has_coefficient_one():
    assert heave_coefficient(0.0) == 1.0
    assert heave_coefficient(1e-8) == pytest.approx(1.0, abs=1e-6)
    with pytest.raises(InputError, match="thickness over breadth"):
        heave_coefficient(-0.1)


@pytest.mark.parametrize(
    ("ratio", "bound"), [(0.005, 0.002), (0.016, 0.002), (0.05, 0.004), (0.16, 0.01), (0.5, 0.03)]
)
def test_thick_strips_agree_with_the_exact_section(ratio, bound):
    x, y = quadrature_grid(0.3, 1.0, 8)
    ones = np.ones((1, 8, 8))
    value = added_mass(ones, x, y, length=0.3, width=1.0, thickness=ratio, domain=CHANNEL)[0, 0]
    assert value / (0.3 * np.pi / 4.0) == pytest.approx(heave_coefficient(ratio), rel=bound)


def exact_inertia(ratio: float, shape) -> float:
    """Added mass of a section of breadth 2 whose faces move with ``shape(y)``, from its exterior's map."""
    alpha = _corner(ratio)
    u = np.linspace(0.0, 1.0, 20001)
    angle = alpha + (np.pi - 2.0 * alpha) * u * u * (3.0 - 2.0 * u)
    stretch = np.sqrt(np.maximum(2.0 * (np.cos(2.0 * alpha) - np.cos(2.0 * angle)), 0.0))
    stretch *= (np.pi - 2.0 * alpha) * 6.0 * u * (1.0 - u)
    run = np.concatenate([[0.0], np.cumsum(0.5 * (stretch[1:] + stretch[:-1]))])
    y = 1.0 - 2.0 * run / run[-1]
    flux = shape(y) * stretch / run[-1] * 2.0
    sines = [2.0 / np.pi * np.sum(np.sin(n * angle) * flux) for n in range(1, 300)]
    return float(np.pi * np.sum(np.square(sines) / np.arange(1, 300)))


def _corner(ratio: float) -> float:
    """Angle of the corner on the unit circle, by bisection on the lengths of the two sides."""
    low, high = 1e-6, 0.5 * np.pi
    s = (np.arange(4000) + 0.5) / 4000
    for _ in range(60):
        alpha = 0.5 * (low + high)
        side = alpha * np.mean(np.sqrt(np.maximum(np.cos(2.0 * alpha * s) - np.cos(2.0 * alpha), 0.0)))
        rest = alpha + (0.5 * np.pi - alpha) * s
        face = (0.5 * np.pi - alpha) * np.mean(np.sqrt(np.cos(2.0 * alpha) - np.cos(2.0 * rest)))
        low, high = (low, alpha) if side / face > ratio else (alpha, high)
    return 0.5 * (low + high)


@pytest.mark.parametrize("ratio", [0.016, 0.05, 0.16])
@pytest.mark.parametrize(
    "shape",
    [lambda y: 1.0 + 0.0 * y, lambda y: y, lambda y: 1.5 * y**2 - 0.5, lambda y: np.sin(np.pi * y)],
    ids=["heave", "roll", "bending", "wave"],
)
def test_thickness_acts_as_in_the_exact_flow_whatever_the_shape(ratio, shape):
    """A heave coefficient applied to every shape would be wrong by 4 to 20 % for the bending ones."""
    x, y = quadrature_grid(0.3, 2.0, 20)
    field = np.broadcast_to(shape(y - 1.0), (1, 20, 20))
    value = added_mass(field, x, y, length=0.3, width=2.0, thickness=2.0 * ratio, domain=CHANNEL)[0, 0] / 0.3
    assert value == pytest.approx(exact_inertia(ratio, shape), rel=0.004 + 0.06 * ratio)


@pytest.mark.long
@given(thickness=st.floats(1e-4, 0.2), more=st.floats(1.05, 2.0))
@settings(max_examples=6)
def test_thickness_raises_the_added_mass(thickness, more):
    x, y = quadrature_grid(1.5, 1.0, 8)
    thin, thick, thicker = (
        added_mass(np.ones((1, 8, 8)), x, y, length=1.5, width=1.0, thickness=t)[0, 0]
        for t in (0.0, thickness, thickness * more)
    )
    assert thin < thick < thicker


def test_strip_theory_integrates_the_section_along_the_beam():
    x = np.linspace(0.0, 2.0, 2001)
    shapes = np.stack([np.ones_like(x), x])
    mass = np.pi / 4.0 * 0.3**2 * heave_coefficient(0.1)
    expected = mass * np.array([[2.0, 2.0], [2.0, 8.0 / 3.0]])
    np.testing.assert_allclose(strip_theory(shapes, x, width=0.3, thickness=0.03), expected, rtol=1e-6)
