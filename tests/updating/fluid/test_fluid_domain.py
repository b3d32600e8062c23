"""Free surface, bottom and walls, against exact flows, image sums and limits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from acquisition.errors import InputError
from updating.fluid import FluidDomain, added_mass, quadrature_grid

INF = float("inf")


def rigid(length: float, width: float, **options) -> float:
    x, y = quadrature_grid(length, width, 8)
    return float(added_mass(np.ones((1, 8, 8)), x, y, length=length, width=width, **options)[0, 0])


@pytest.mark.parametrize("channel", [1.1, 1.2, 1.5, 2.0, 4.0])
def test_a_strip_across_a_channel_has_the_exact_blockage(channel):
    """Flow through a row of plates, by conformal mapping: 2 c^2 / pi ln sec(pi b / 2 c) per length."""
    gap = 0.5 * (channel - 1.0)
    domain = FluidDomain(walls=(0.0, 0.3, -gap, 1.0 + gap))
    exact = 2.0 * channel**2 / np.pi * np.log(1.0 / np.cos(np.pi / (2.0 * channel)))
    assert rigid(0.3, 1.0, domain=domain) / 0.3 == pytest.approx(exact, rel=2e-4)


def test_a_small_gap_over_the_bottom_squeezes_like_lubrication():
    """Below, the potential is a parabola across the strip: b^3 / 12 h per length, as h goes to zero."""
    ratios = []
    for gap in (0.04, 0.02, 0.01):
        domain = FluidDomain(bottom=gap, walls=(0.0, 0.3, -INF, INF))
        ratios.append(rigid(0.3, 1.0, domain=domain) / 0.3 * 12.0 * gap)
    assert ratios == sorted(ratios, reverse=True)
    assert 2.0 * ratios[2] - ratios[1] == pytest.approx(1.0, abs=0.04)


@pytest.mark.parametrize(("surface", "sign"), [(True, 1.0), (False, -1.0)])
def test_distant_surface_and_bottom_act_like_one_image(surface, sign):
    """A far boundary adds a point doublet's field: dM = +-M^2 (-2 / (2 d)^3) / 4 pi for a rigid plate."""
    distance = 3.0
    domain = FluidDomain(free_surface=distance) if surface else FluidDomain(bottom=distance)
    alone = rigid(1.0, 1.0)
    image = sign * alone**2 * (-2.0 / (2.0 * distance) ** 3) / (4.0 * np.pi)
    assert rigid(1.0, 1.0, domain=domain) - alone == pytest.approx(image, rel=0.12)


def test_distant_walls_act_like_their_images():
    """Two walls 2.5 sides away mirror the plate along x: the sum of point doublets, spaced 6 sides apart."""
    domain = FluidDomain(walls=(-2.5, 3.5, -INF, INF))
    alone = rigid(1.0, 1.0)
    images = alone**2 * 2.0 * sum(1.0 / (6.0 * n) ** 3 for n in range(1, 200)) / (4.0 * np.pi)
    assert rigid(1.0, 1.0, domain=domain) - alone == pytest.approx(images, rel=0.05)


def test_a_large_tank_is_unbounded():
    tank = FluidDomain(20.0, 20.0, (-6.0, 7.5, -5.0, 6.0))
    assert rigid(1.5, 1.0, domain=tank) == pytest.approx(rigid(1.5, 1.0), rel=5e-4)
    beyond = FluidDomain(1e3, 1e3, (-1e3, 1e3, -1e3, 1e3))
    assert rigid(1.5, 1.0, domain=beyond) == pytest.approx(rigid(1.5, 1.0), rel=1e-6)


@pytest.mark.long
@given(gap=st.floats(0.05, 3.0), farther=st.floats(1.1, 3.0))
@settings(max_examples=6)
def test_nearer_walls_add_mass_and_a_nearer_surface_takes_it(gap, farther):
    def walls(distance: float) -> float:
        sides = (-distance, 1.0 + distance, -distance, 1.0 + distance)
        return rigid(1.0, 1.0, domain=FluidDomain(walls=sides))

    assert walls(gap) > walls(gap * farther) * (1.0 - 2e-5)
    near, far = (rigid(1.0, 1.0, domain=FluidDomain(free_surface=d)) for d in (gap, gap * farther))
    assert near < far * (1.0 + 2e-5)
    near, far = (rigid(1.0, 1.0, domain=FluidDomain(bottom=d)) for d in (gap, gap * farther))
    assert near > far * (1.0 - 2e-5)


@pytest.mark.long
@pytest.mark.parametrize("walls", [(-INF, INF, 0.0, INF), (-INF, INF, -INF, 1.0)])
def test_a_plate_at_a_wall_is_half_of_its_mirrored_double(walls):
    x, y = quadrature_grid(1.3, 1.0, 16)
    mirror = 0.0 if walls[2] == 0.0 else 1.0
    shape = np.cos(2.0 * (y - mirror)) * (1.0 + 0.5 * x[:, None])
    at_wall = added_mass(shape[None], x, y, length=1.3, width=1.0, domain=FluidDomain(walls=walls))
    x, y = quadrature_grid(1.3, 2.0, 24)
    double = np.cos(2.0 * (y - 1.0)) * (1.0 + 0.5 * x[:, None])
    whole = added_mass(double[None], x, y, length=1.3, width=2.0)
    assert 2.0 * at_wall[0, 0] == pytest.approx(whole[0, 0], rel=2e-4)


@pytest.mark.long
def test_closing_the_last_gap_to_the_wall_raises_the_mass_continuously():
    values = [
        rigid(1.0, 1.0, domain=FluidDomain(walls=(-gap, INF, -INF, INF))) for gap in (0.1, 0.01, 1e-3, 0.0)
    ]
    assert values == sorted(values)
    assert values[-1] == pytest.approx(0.5 * rigid(2.0, 1.0), rel=2e-4)


@pytest.mark.long
def test_a_quarter_plate_in_the_corner_of_two_walls():
    corner = FluidDomain(walls=(0.0, INF, -INF, 1.0))
    assert 4.0 * rigid(1.0, 1.0, domain=corner) == pytest.approx(rigid(2.0, 2.0), rel=2e-4)


def test_what_does_not_fit_is_refused_with_a_reason():
    with pytest.raises(InputError, match="free_surface is -1"):
        FluidDomain(free_surface=-1.0)
    with pytest.raises(InputError, match="bottom is nan"):
        FluidDomain(bottom=float("nan"))
    with pytest.raises(InputError, match="x0 < x1"):
        FluidDomain(walls=(1.0, 0.0, 0.0, 1.0))
    with pytest.raises(InputError, match="four numbers"):
        FluidDomain(walls=(float("nan"), 0.0, 0.0, 1.0))
    with pytest.raises(InputError, match="the plate occupies y"):
        rigid(1.0, 1.0, domain=FluidDomain(walls=(-1.0, 2.0, -1.0, 0.9)))
    with pytest.raises(InputError, match="fills the tank"):
        rigid(1.0, 1.0, domain=FluidDomain(walls=(0.0, 1.0, 0.0, 1.0)))
