"""Added mass of plates and beams, against the handbook, doublet panels and exact strips."""

from __future__ import annotations

from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from acquisition.errors import InputError
from updating.fluid import (
    AddedMassOperator,
    FluidDomain,
    added_mass,
    beam_added_mass,
    beam_matrix,
    beam_operator,
    quadrature_grid,
    strip_theory,
)

HANDBOOK = {  # ratio of sides: added mass over that of the circular cylinder on the shorter side
    1.0: 0.579,
    1.25: 0.642,
    1.5: 0.690,
    1.59: 0.704,
    2.0: 0.757,
    2.5: 0.801,
    3.0: 0.830,
    3.17: 0.840,
    4.0: 0.872,
    5.0: 0.897,
    6.25: 0.917,
    8.0: 0.934,
    10.0: 0.947,
}
INF = float("inf")
CHANNEL = FluidDomain(walls=(0.0, 0.3, -INF, INF))


def rigid(length: float, width: float, **options) -> float:
    x, y = quadrature_grid(length, width, 8)
    return float(added_mass(np.ones((1, 8, 8)), x, y, length=length, width=width, **options)[0, 0])


def doublet_panels(length: float, width: float, counts: tuple[int, int], mirror_x: float | None = None):
    """Centres, areas and influence of constant doublet rectangles, the rim set in by a quarter panel."""
    edges = []
    for side, count in zip((length, width), counts, strict=True):
        inset = 0.25 * side / (count + 0.5)
        edges.append(np.linspace(inset, side - inset, count + 1))
    low = [np.repeat(edges[0][:-1], counts[1]), np.tile(edges[1][:-1], counts[0])]
    high = [np.repeat(edges[0][1:], counts[1]), np.tile(edges[1][1:], counts[0])]
    centre = [0.5 * (a + b) for a, b in zip(low, high, strict=True)]

    def influence(x_low, x_high):
        total = np.zeros((centre[0].size, centre[0].size))
        for x_corner, x_sign in ((x_high, 1.0), (x_low, -1.0)):
            for y_corner, y_sign in ((high[1], 1.0), (low[1], -1.0)):
                dx = x_corner - centre[0][:, None]
                dy = y_corner - centre[1][:, None]
                total += x_sign * y_sign * np.hypot(dx, dy) / (dx * dy)
        return -total / (4.0 * np.pi)

    matrix = influence(low[0], high[0])
    if mirror_x is not None:
        matrix = matrix + influence(2.0 * mirror_x - high[0], 2.0 * mirror_x - low[0])
    area = (high[0] - low[0]) * (high[1] - low[1])
    return centre[0], centre[1], area, -matrix


def bending_and_twist(x, y):
    """A cantilever-like bending, a twist and a chordwise bending of the plate 1.88 x 1."""
    u, v = x / 1.88, y
    return np.stack([u**2 * (3.0 - u), u * (2.0 * v - 1.0), u * (6.0 * v**2 - 6.0 * v + 1.0) + 0.3])


@pytest.mark.parametrize(("ratio", "expected"), HANDBOOK.items())
def test_rigid_plates_have_the_handbook_coefficients(ratio, expected):
    assert rigid(ratio, 1.0) / (np.pi / 4.0 * ratio) == pytest.approx(expected, rel=2.5e-3)


def test_bending_and_twist_agree_with_doublet_panels():
    x, y = quadrature_grid(1.88, 1.0, 16)
    galerkin = added_mass(bending_and_twist(*np.meshgrid(x, y, indexing="ij")), x, y, length=1.88, width=1.0)
    px, py, area, normal = doublet_panels(1.88, 1.0, (38, 20))
    shapes = bending_and_twist(px, py)
    panels = (shapes * area) @ np.linalg.solve(normal, shapes.T)
    scale = np.sqrt(np.outer(np.diag(galerkin), np.diag(galerkin)))
    np.testing.assert_allclose(panels / scale, galerkin / scale, atol=0.015)


def test_the_effect_of_a_side_wall_agrees_with_mirrored_doublet_panels():
    """The ratio to open water, in which the panels' own error of 1 % cancels."""
    x, y = quadrature_grid(1.88, 1.0, 16)
    shapes = bending_and_twist(*np.meshgrid(x, y, indexing="ij"))
    px, py, area, free = doublet_panels(1.88, 1.0, (38, 20))
    *_, mirrored = doublet_panels(1.88, 1.0, (38, 20), mirror_x=1.98)
    sampled = bending_and_twist(px, py)
    panels = [np.diag((sampled * area) @ np.linalg.solve(a, sampled.T)) for a in (mirrored, free)]
    domains = (FluidDomain(walls=(-INF, 1.98, -INF, INF)), None)
    galerkin = [np.diag(added_mass(shapes, x, y, length=1.88, width=1.0, domain=d)) for d in domains]
    effect = galerkin[0] / galerkin[1] - 1.0
    assert effect.max() > 0.04
    np.testing.assert_allclose(panels[0] / panels[1] - 1.0, effect, rtol=0.06, atol=5e-4)


def test_a_strip_between_walls_is_the_flat_plate_of_two_dimensions():
    assert rigid(0.3, 1.0, domain=CHANNEL) == pytest.approx(0.3 * np.pi / 4.0, rel=1e-5)


def test_a_strip_in_roll_has_the_exact_rotational_inertia():
    x, y = quadrature_grid(0.3, 1.0, 8)
    roll = np.broadcast_to(y - 0.5, (1, 8, 8))
    value = added_mass(roll, x, y, length=0.3, width=1.0, domain=CHANNEL)[0, 0]
    assert value == pytest.approx(0.3 * np.pi * 0.5**4 / 8.0, rel=1e-5)


@pytest.mark.long
def test_a_long_beam_approaches_strip_theory_from_below():
    ratios = []
    for length in (4.0, 16.0, 64.0):
        x = np.linspace(0.0, length, 9)
        ones = np.ones((1, 9))
        ratios.append(
            beam_added_mass(ones, x, length=length, width=1.0)[0, 0] / strip_theory(ones, x, width=1.0)[0, 0]
        )
    assert ratios == sorted(ratios)
    assert ratios[-1] < 1.0
    assert 1.0 - ratios[-1] == pytest.approx((1.0 - ratios[-2]) / 4.0, rel=0.25)


def test_beam_and_plate_with_a_rigid_section_are_the_same():
    x, y = quadrature_grid(2.0, 0.4, 14)
    shapes = np.stack([x**2, x**3])
    domain = FluidDomain(0.7, 0.9, (-0.2, 2.5, -0.5, 0.6))
    plate = added_mass(
        np.repeat(shapes[:, :, None], y.size, axis=2), x, y, length=2.0, width=0.4, domain=domain.shifted(0.2)
    )
    beam = beam_matrix(beam_operator(length=2.0, width=0.4, domain=domain), shapes, x)
    np.testing.assert_allclose(beam, plate, rtol=1e-9)


@pytest.mark.long
@given(
    scale=st.floats(1e-3, 1e3),
    ratio=st.floats(0.2, 5.0),
    thickness=st.floats(0.0, 0.3),
    seed=st.integers(0, 1000),
)
@settings(max_examples=12)
def test_scaling_symmetry_and_positivity(scale, ratio, thickness, seed):
    shapes = np.random.default_rng(seed).normal(size=(4, 7, 7))
    matrices = []
    for size in (1.0, scale):
        x, y = quadrature_grid(ratio * size, size, 7)
        domain = FluidDomain(1.3 * size, 0.8 * size, (0.0, 1.5 * ratio * size, -0.3 * size, 1.6 * size))
        operator = AddedMassOperator.build(
            length=ratio * size, width=size, thickness=thickness * size, domain=domain, terms=(9, 9)
        )
        matrices.append(operator.matrix(shapes, x, y))
    np.testing.assert_allclose(matrices[1], matrices[0] * scale**3, rtol=1e-6, atol=1e-9 * scale**3)
    np.testing.assert_array_equal(matrices[0], matrices[0].T)
    assert np.linalg.eigvalsh(matrices[0]).min() > 0.0


def test_turning_the_plate_changes_nothing():
    x, y = quadrature_grid(1.7, 1.0, 12)
    shape = (np.cos(1.3 * x)[:, None] * np.exp(0.4 * y))[None]
    domain = FluidDomain(0.8, 1.1, (0.0, 2.0, -0.4, 1.3))
    turned = FluidDomain(0.8, 1.1, (-0.4, 1.3, 0.0, 2.0))
    upright = added_mass(shape, x, y, length=1.7, width=1.0, thickness=0.02, domain=domain)
    across = added_mass(shape.transpose(0, 2, 1), y, x, length=1.0, width=1.7, thickness=0.02, domain=turned)
    np.testing.assert_allclose(across, upright, rtol=1e-8)


def test_uniform_and_gauss_grids_agree():
    gauss = quadrature_grid(1.88, 1.0, 16)
    uniform = np.linspace(0.0, 1.88, 39), np.linspace(0.0, 1.0, 21)
    values = [
        added_mass(bending_and_twist(*np.meshgrid(*grid, indexing="ij")), *grid, length=1.88, width=1.0)
        for grid in (gauss, uniform)
    ]
    np.testing.assert_allclose(values[1], values[0], rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("counts", [(12, 12), (18, 16)])
def test_more_terms_raise_the_value_of_the_thin_plate_to_its_limit(counts):
    x, y = quadrature_grid(1.88, 1.0, 16)
    shapes = bending_and_twist(*np.meshgrid(x, y, indexing="ij"))
    few, many = (
        np.diag(AddedMassOperator.build(length=1.88, width=1.0, terms=terms).matrix(shapes, x, y))
        for terms in (counts, (26, 24))
    )
    assert np.all(few < many * (1.0 + 2e-5))
    np.testing.assert_allclose(few, many, rtol=1e-4)


def test_bad_input_is_refused_with_a_reason():
    x, y = quadrature_grid(1.0, 1.0, 6)
    good = np.ones((1, 6, 6))
    with pytest.raises(InputError, match="sides must be"):
        added_mass(good, x, y, length=-1.0, width=1.0)
    with pytest.raises(InputError, match="n_modes, nx, ny"):
        added_mass(np.ones((1, 5, 6)), x, y, length=1.0, width=1.0)
    with pytest.raises(InputError, match="ascending"):
        added_mass(good, x[::-1], y, length=1.0, width=1.0)
    with pytest.raises(InputError, match="the plate from 0 to"):
        added_mass(good, x - 0.5, y, length=1.0, width=1.0)
    with pytest.raises(InputError, match="not finite"):
        added_mass(good * np.nan, x, y, length=1.0, width=1.0)
    with pytest.raises(InputError, match="n_modes, nx"):
        beam_added_mass(good, x, length=1.0, width=0.1)


def test_the_operator_is_frozen():
    operator = AddedMassOperator.build(length=1.0, width=1.0, terms=(4, 4))
    with pytest.raises(FrozenInstanceError):
        operator.factor = np.zeros((1, 1))  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        operator.factor[0, 0] = 0.0
