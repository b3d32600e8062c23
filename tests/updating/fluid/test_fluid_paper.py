"""The submerged plate and beam of the paper on submerged structures: nothing is fitted to the wet data."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq
from scipy.sparse.linalg import eigsh
from skfem import Basis, BilinearForm, ElementQuadBFS, MeshQuad, asm
from skfem.helpers import dd

from updating.fluid import FluidDomain, added_mass, beam_added_mass, quadrature_grid

WATER = 998.0
DRY = np.array([16.76, 70.69, 104.91, 229.96, 296.64, 425.51, 446.90, 574.19, 591.14, 731.06, 843.22, 951.13])
WET = np.array([7.27, 39.61, 48.60, 132.58, 146.44, 262.12, 268.27, 310.61, 367.30, 446.70, 531.26, 539.65])
LENGTH, WIDTH, THICKNESS = 0.376, 0.2, 0.003175
INF = float("inf")
ROOT = FluidDomain(walls=(0.0, INF, -INF, INF))
TANK = FluidDomain(0.18, 0.19, (0.0, 0.55, 0.1 - 0.225, 0.1 + 0.225))


@pytest.fixture(scope="module")
def plate():
    """Thirty dry modes of the cantilever plate (Kirchhoff, conforming): frequencies, shapes, grid."""
    mesh = MeshQuad.init_tensor(np.linspace(0.0, LENGTH, 15), np.linspace(0.0, WIDTH, 9))
    basis = Basis(mesh, ElementQuadBFS(), intorder=7)
    rigidity, nu = 210e9 * THICKNESS**3 / 12.0 / (1.0 - 0.3**2), 0.3

    @BilinearForm
    def bending(u, v, _):
        a, b = dd(u), dd(v)
        direct = (a[0, 0] + nu * a[1, 1]) * b[0, 0] + (a[1, 1] + nu * a[0, 0]) * b[1, 1]
        return rigidity * (direct + 2.0 * (1.0 - nu) * a[0, 1] * b[0, 1])

    @BilinearForm
    def inertia(u, v, _):
        return 7850.0 * THICKNESS * u * v

    stiffness, mass = asm(bending, basis), asm(inertia, basis)
    clamped = basis.get_dofs(lambda point: np.isclose(point[0], 0.0)).all(["u", "u_x", "u_y", "u_xy"])
    free = np.setdiff1d(np.arange(stiffness.shape[0]), clamped)
    squared, vectors = eigsh(stiffness[free][:, free], k=30, M=mass[free][:, free], sigma=0.0)
    whole = np.zeros((stiffness.shape[0], 30))
    whole[free] = vectors
    x, y = quadrature_grid(LENGTH, WIDTH, 24)
    points = np.array([axis.ravel() for axis in np.meshgrid(x, y, indexing="ij")])
    shapes = (basis.probes(points) @ whole).T.reshape(30, 24, 24)
    return np.sqrt(squared) / (2.0 * np.pi), shapes, x, y


def wet_errors(plate, thickness, domain):
    """Relative errors of the wet frequencies from measured dry ones; the model's shapes and higher modes."""
    frequency, shapes, x, y = plate
    stiffness = np.sqrt(0.782) * frequency
    stiffness[: DRY.size] = DRY
    added = added_mass(shapes, x, y, length=LENGTH, width=WIDTH, thickness=thickness, domain=domain)
    squared = eigh(np.diag(stiffness**2), np.eye(30) + WATER * added, eigvals_only=True)
    return np.sqrt(squared[: WET.size]) / WET - 1.0


def rms(errors):
    return float(np.sqrt(np.mean(np.square(errors))))


def test_the_dry_model_is_the_papers(plate):
    printed = [19.26, 78.61, 119.99, 257.71, 336.29, 464.91, 500.95]
    np.testing.assert_allclose(plate[0][:7], printed, rtol=0.002)


def test_thin_plate_at_the_tanks_wall_without_further_walls(plate):
    assert rms(wet_errors(plate, 0.0, ROOT)[:7]) == pytest.approx(0.027, abs=0.002)


def test_thin_plate_in_the_tank(plate):
    errors = wet_errors(plate, 0.0, TANK)
    assert rms(errors[:7]) == pytest.approx(0.023, abs=0.002)
    assert rms(errors) < 0.030


def test_thick_plate_in_the_tank(plate):
    errors = wet_errors(plate, THICKNESS, TANK)
    assert rms(errors[:7]) < 0.015
    assert rms(errors) < 0.023


def test_no_uniform_factor_on_the_mass_does_as_well(plate):
    factors = np.linspace(2.0, 6.0, 400)
    best = min(rms(DRY[:7] / np.sqrt(factor) / WET[:7] - 1.0) for factor in factors)
    assert best > 5.0 * rms(wet_errors(plate, 0.0, TANK)[:7])


def test_added_mass_ratios_of_the_plate_follow_the_measured_pattern(plate):
    """Bending high, torsion low: (f_dry / f_wet)^2 - 1 of the paper's seven modes."""
    _, shapes, x, y = plate
    added = added_mass(shapes[:7], x, y, length=LENGTH, width=WIDTH, domain=TANK)
    measured = (DRY[:7] / WET[:7]) ** 2 - 1.0
    np.testing.assert_allclose(WATER * np.diag(added), measured, rtol=0.13)
    np.testing.assert_allclose(WATER * np.diag(added), [4.1, 2.1, 3.8, 1.9, 3.0, 1.8, 1.7], rtol=0.025)


@pytest.mark.long
def test_wet_beam_lies_between_the_thin_and_the_thick_section():
    """Measured dry frequencies, cantilever shapes; the sensor's mass, left out, would lower the effect."""
    length, width, thickness = 0.376, 0.0305, 0.0047625
    roots = np.array([brentq(lambda s: np.cos(s) + 1.0 / np.cosh(s), *b) for b in ((1, 3), (4, 5), (7, 8))])
    x, _ = quadrature_grid(length, width, 32)
    bx = roots[:, None] * x / length
    sigma = ((np.cosh(roots) + np.cos(roots)) / (np.sinh(roots) + np.sin(roots)))[:, None]
    shapes = np.cosh(bx) - np.cos(bx) - sigma * (np.sinh(bx) - np.sin(bx))
    mass = 7850.0 * width * thickness * length
    domain = FluidDomain(0.18, 0.19, (0.0, 0.55, -0.225, 0.225))
    measured = np.array([19.17, 119.80, 337.86])
    dry = np.array([24.47, 153.96, 429.15])
    errors = []
    for section in (0.0, thickness):
        added = beam_added_mass(shapes, x, length=length, width=width, thickness=section, domain=domain)
        squared = eigh(np.diag(dry**2), np.eye(3) + WATER * added / mass, eigvals_only=True)
        errors.append(np.sqrt(squared) / measured - 1.0)
    thin, thick = errors
    assert np.all(thin > 0.0)
    assert np.all(thick < 0.0)
    assert max(np.abs(thin).max(), np.abs(thick).max()) < 0.025
