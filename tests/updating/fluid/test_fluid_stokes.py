"""Slip along the faces and Stokes' layer, against panels round the section and the viscous strip."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import kv

from acquisition.errors import InputError
from updating.fluid import (
    AddedMassOperator,
    FluidDomain,
    edge_reach,
    layer_depth,
    quadrature_grid,
    slip_coefficient,
    slip_matrix,
)

INF = float("inf")
CHANNEL = FluidDomain(walls=(0.0, 0.3, -INF, INF))


def sader(reynolds: float) -> complex:
    """Hydrodynamic function of a strip without thickness, J. Appl. Phys. 84 (1998) 64, Eqs. 20 and 21.

    Re = rho omega b^2 / 4 eta; the fit holds to 0.1 % up to 1e4.
    """
    root, tau = np.sqrt(1j * reynolds), np.log10(reynolds)
    circle = 1.0 + 4j * kv(1, -1j * root) / (root * kv(0, -1j * root))
    above = np.polyval([0.00069085, -0.0035117, 0.044055, -0.12886, 0.46842, -0.48274, 0.91324], tau)
    below = np.polyval([0.00069085, -0.0035862, 0.045155, -0.13444, 0.48690, -0.56964, 1.0], tau)
    up = np.polyval([-0.000044510, 0.000064577, -0.00010961, 0.016294, -0.029256, -0.024134], tau)
    down = np.polyval([0.0028361, -0.014369, 0.079156, -0.18357, 0.55182, -0.59702, 1.0], tau)
    return complex((above / below + 1j * up / down) * circle)


def panels_round_a_rectangle(thickness: float, count: int = 160) -> float:
    """Slip of a section of unit breadth in heave, by source panels that crowd towards the corners."""
    crowd = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, count + 1))
    crowd = crowd**2 * (3.0 - 2.0 * crowd)
    across, up = crowd - 0.5, thickness * (crowd - 0.5)
    half = 0.5 * thickness
    corners = [across - half * 1j, 0.5 + up * 1j, -across + half * 1j, -0.5 - up * 1j]
    start, end = (np.concatenate([c[s] for c in corners]) for s in (slice(None, -1), slice(1, None)))
    middle, along = 0.5 * (start + end), (end - start) / np.abs(end - start)
    with np.errstate(divide="ignore"):
        turned = (middle[:, None] - start) / (middle[:, None] - end)
    field = np.log(turned) / along / (2.0 * np.pi)  # u - i v of unit sources per length
    np.fill_diagonal(field, 0.5 * (1j / along))  # outside: half a source leaves, along the outer normal
    normal = -1j * along
    outward = np.real(field * normal[:, None])
    strength = np.linalg.solve(outward, np.imag(normal))
    sliding = np.real(field * along[:, None]) @ strength - np.imag(along)
    return float(np.sum(np.square(sliding) * np.abs(end - start)))


@pytest.mark.parametrize("ratio", [0.05, 0.156, 0.5, 1.0])
def test_slip_round_a_section_agrees_with_source_panels(ratio):
    assert slip_coefficient(ratio) == pytest.approx(panels_round_a_rectangle(ratio), rel=0.02)


@pytest.mark.parametrize(
    ("reynolds", "low", "high"), [(1e3, -0.08, 0.0), (3e3, -0.055, 0.0), (1e4, -0.03, 0.0)]
)
def test_a_sharp_strip_loses_what_the_viscous_one_does_where_the_layer_is_thin(reynolds, low, high):
    """Breadth 1; the imaginary part times pi / 4 is sqrt(eta / 2 rho omega) times the slip."""
    depth = 0.5 * np.sqrt(2.0 / reynolds)
    x, y = quadrature_grid(0.3, 1.0, 8)
    operator = AddedMassOperator.build(length=0.3, width=1.0, domain=CHANNEL)
    slip = slip_matrix(operator, np.ones((1, 8, 8)), x, y, reach=edge_reach(1.0, 0.0, depth))[0, 0] / 0.3
    ours = 4.0 / np.pi * 0.5 * depth * slip
    deviation = ours / sader(reynolds).imag - 1.0
    assert low < deviation < high


@pytest.mark.parametrize("ratio", [1e-4, 0.01, 0.156])
def test_a_blunt_strip_slips_like_its_exact_section(ratio):
    x, y = quadrature_grid(0.3, 1.0, 8)
    operator = AddedMassOperator.build(length=0.3, width=1.0, domain=CHANNEL)
    reach = edge_reach(1.0, ratio, 0.0)
    slip = slip_matrix(operator, np.ones((1, 8, 8)), x, y, reach=reach)[0, 0] / 0.3
    assert slip == pytest.approx(slip_coefficient(ratio), rel=0.01)


def test_slip_of_a_thin_section_rises_with_the_logarithm():
    """Two edges, each with the strength of the sharp one: 2 ln 10 per decade of thickness."""
    thin, thinner = slip_coefficient(1e-6), slip_coefficient(1e-7)
    assert thinner - thin == pytest.approx(np.log(10.0), rel=1e-3)


def test_the_depth_of_the_layer_in_water():
    """0.56 mm at 1 Hz, a textbook value for water, and with the inverse root of frequency."""
    assert layer_depth(1e-3, 1000.0, 1.0) == pytest.approx(0.564e-3, rel=1e-3)
    assert layer_depth(1e-3, 1000.0, 100.0) == pytest.approx(0.0564e-3, rel=1e-3)


@pytest.mark.long
@given(scale=st.floats(1e-2, 1e2), ratio=st.floats(0.3, 3.0), seed=st.integers(0, 99))
@settings(max_examples=10)
def test_slip_scales_is_symmetric_and_positive(scale, ratio, seed):
    shapes = np.random.default_rng(seed).normal(size=(3, 6, 6))
    found = []
    for size in (1.0, scale):
        x, y = quadrature_grid(ratio * size, size, 6)
        operator = AddedMassOperator.build(length=ratio * size, width=size, terms=(8, 8))
        found.append(slip_matrix(operator, shapes, x, y, reach=1e-4 * size))
    np.testing.assert_allclose(found[1], found[0] * scale**2, rtol=1e-6, atol=1e-9 * scale**2)
    np.testing.assert_array_equal(found[0], found[0].T)
    assert np.linalg.eigvalsh(found[0]).min() > 0.0


@pytest.mark.long
def test_turning_the_plate_leaves_its_slip():
    x, y = quadrature_grid(1.7, 1.0, 12)
    shape = (np.cos(1.3 * x)[:, None] * np.exp(0.4 * y))[None]
    upright = AddedMassOperator.build(length=1.7, width=1.0, domain=FluidDomain(walls=(0.0, INF, -INF, INF)))
    turned = AddedMassOperator.build(length=1.0, width=1.7, domain=FluidDomain(walls=(-INF, INF, 0.0, INF)))
    one = slip_matrix(upright, shape, x, y, reach=1e-4)
    other = slip_matrix(turned, shape.transpose(0, 2, 1), y, x, reach=1e-4)
    np.testing.assert_allclose(other, one, rtol=1e-8)


@pytest.mark.long
def test_a_plate_at_a_wall_slips_like_half_of_its_mirrored_double():
    x, y = quadrature_grid(1.3, 1.0, 16)
    operator = AddedMassOperator.build(length=1.3, width=1.0, domain=FluidDomain(walls=(-INF, INF, 0.0, INF)))
    shape = np.cos(2.0 * y) * (1.0 + 0.5 * x[:, None])
    half = slip_matrix(operator, shape[None], x, y, reach=1e-3)
    x, y = quadrature_grid(1.3, 2.0, 24)
    whole = AddedMassOperator.build(length=1.3, width=2.0)
    shape = np.cos(2.0 * (y - 1.0)) * (1.0 + 0.5 * x[:, None])
    assert 2.0 * half[0, 0] == pytest.approx(
        slip_matrix(whole, shape[None], x, y, reach=1e-3)[0, 0], rel=5e-3
    )


@pytest.mark.parametrize(("thickness", "layer"), [(0.0, 0.0), (-1e-3, 1e-4), (1e-3, -1e-4)])
def test_an_edge_that_nothing_blunts_is_refused(thickness, layer):
    with pytest.raises(InputError, match="boundary layer"):
        edge_reach(0.1, thickness, layer)
