"""Added mass beside the vortex rings of the benchmarks: in a tank, and of rigid bodies that are published."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from updating.fluid import FluidDomain, added_mass, quadrature_grid

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "benchmarks"))

from water.rings import FAR, Water, disc, limit, rectangle
from water.ritz import Plate

SIDE, MODES = 0.2, 3


def heave(points: np.ndarray) -> np.ndarray:
    return np.ones((len(points), 1))


def test_a_disc_has_eight_thirds_of_the_cube_of_its_radius() -> None:
    found = limit(*(disc(1.0, rings, 3 * rings).added_mass(heave) for rings in (4, 8, 16)))
    assert found[0, 0] == pytest.approx(8 / 3, rel=2e-3)


@pytest.mark.parametrize(("ratio", "coefficient"), [(1.0, 0.579), (2.0, 0.757), (4.0, 0.872)])
def test_a_rigid_rectangle_is_as_heavy_as_published(ratio: float, coefficient: float) -> None:
    """DNV-RP-C205 (2010), table D-2, over rho pi/4 b^2 l; the lattice and the library."""
    whole = coefficient * np.pi / 4 * ratio
    assert rectangle(ratio, 1.0, 16, 10).added_mass(heave)[0, 0] == pytest.approx(whole, rel=2e-3)
    x, y = quadrature_grid(ratio, 1.0)
    found = added_mass(np.ones((1, len(x), len(y))), x, y, length=ratio, width=1.0)
    assert found[0, 0] == pytest.approx(whole, rel=2e-3)


@pytest.mark.parametrize("far", [0.5, 1.5])
def test_side_walls_do_what_mirrored_plates_do(far: float) -> None:
    plate = Plate(SIDE, SIDE, 0.002)
    walls = (0.0, (1 + far) * SIDE, -far * SIDE, (1 + far) * SIDE)
    dry = plate.all_modes(MODES)
    coarse, fine = (
        rectangle(SIDE, SIDE, 6 * k, 5 * k, wall=True).added_mass(
            lambda points: plate.basis(points) @ dry, Water(walls=walls)
        )
        for k in (1, 2)
    )
    x, y = quadrature_grid(SIDE, SIDE)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    shapes = (plate.basis(points) @ dry).T.reshape(MODES, len(x), len(y))
    ours = added_mass(shapes, x, y, length=SIDE, width=SIDE, domain=FluidDomain(walls=walls))
    np.testing.assert_allclose(np.diag(ours), np.diag(4 * fine - coarse) / 3, rtol=2e-3)
    beside = added_mass(
        shapes, x, y, length=SIDE, width=SIDE, domain=FluidDomain(walls=(0.0, FAR, -FAR, FAR))
    )
    assert ours[0, 0] / beside[0, 0] > (1.04 if far == 0.5 else 1.003)
