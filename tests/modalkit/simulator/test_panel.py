"""Water on the rig's plates against published values, the strip, and measured plates."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from modalkit.simulator.bodies.beam.water import added_mass, layer_damping, slip_factor
from modalkit.simulator.bodies.plate.panel import wetted
from modalkit.simulator.bodies.plate.parts import PlateAttached
from modalkit.simulator.bodies.plate.plate import Plate

PLATE = Plate(0.0, 0.376, 0.2, 0.003175, 210e9, 7850.0)


# DNV-RP-C205, appendix D, rectangular plates moving across their plane: share of rho pi/4 a^2 b
@pytest.mark.parametrize(
    ("aspect", "coefficient"),
    [(1.0, 0.579), (1.5, 0.690), (2.0, 0.757), (3.0, 0.830), (5.0, 0.897), (10.0, 0.947)],
)
def test_rigid_plate(aspect: float, coefficient: float) -> None:
    wet = wetted((0.0, 0.1 * aspect), (0.0, 0.1), 1e-9)
    assert wet.matrix.sum() / (np.pi / 4 * 0.1**3 * aspect) == pytest.approx(coefficient, abs=2e-3)


def test_turning_strip() -> None:
    """A long flat strip that turns about its axis has the added inertia rho pi a^4 / 8 per length."""
    wet = wetted((0.0, 6.0), (-0.1, 0.1), 1e-9, panels=(80, 12))
    turn = np.where(np.abs(wet.places[:, 0] - 3.0) < 10, wet.places[:, 1], 0.0)
    assert turn @ wet.matrix @ turn == pytest.approx(np.pi * 0.1**4 / 8 * 6.0, rel=0.02)


def test_slender_plate_is_the_strip() -> None:
    """One formula for thickness over width against the same one at the plate's edges all round."""
    wet = wetted((0.0, 1.0), (0.0, 0.05), 0.005)
    stations, matrix = added_mass(1.0, 0.05, 0.005, density=1.0)
    for waves in (0, 1, 2, 3):
        ours, strip = np.cos(waves * np.pi * wet.places[:, 0]), np.cos(waves * np.pi * stations)
        assert ours @ wet.matrix @ ours == pytest.approx(strip @ matrix @ strip, rel=8e-3)


def test_matrix_is_symmetric_and_positive() -> None:
    wet = wetted((0.0, 0.3), (0.0, 0.2), 0.003, wall=True)
    np.testing.assert_allclose(wet.matrix, wet.matrix.T)
    assert np.linalg.eigvalsh(wet.matrix)[0] > 0


def test_wall_is_half_of_a_plate_twice_as_long() -> None:
    half = wetted((0.0, 0.2), (0.0, 0.1), 0.001, wall=True, panels=(14, 16))
    whole = wetted((-0.2, 0.2), (0.0, 0.1), 0.001, panels=(28, 16))
    a, b = np.cos(7 * half.places[:, :1]), np.cos(7 * whole.places[:, :1])
    assert 2 * (a.T @ half.matrix @ a).item() == pytest.approx((b.T @ whole.matrix @ b).item(), rel=1e-9)
    assert 2 * half.slip(a).item() == pytest.approx(whole.slip(b).item(), rel=1e-9)


@pytest.mark.parametrize("thickness", [0.002, 0.01, 0.02])
def test_slip_of_a_long_plate_is_that_round_a_rectangle(thickness: float) -> None:
    wet = wetted((0.0, 5.0), (0.0, 0.1), thickness, panels=(70, 16))
    slip = wet.slip(np.ones((len(wet.places), 1))).item()
    assert slip / (5.0 * 0.1) == pytest.approx(slip_factor(thickness / 0.1), rel=0.02)


def test_boundary_layer_damps_a_slender_plate_as_the_strip() -> None:
    """The ends, where the fluid slips along too, are not in the strip: some 2 % of so long a plate."""
    thin = Plate(0.0, 1.5, 0.03, 0.004, 210e9, 7850.0, drag=1.0, fluid_density=998.0, wall=False)
    _, shapes = thin.real_modes(2)
    (loss,) = thin.modal_losses(shapes[:, :2])
    stations, matrix = layer_damping(1.5, 0.03, 0.004, drag=1.0)
    middle = np.column_stack([stations, np.full(len(stations), 0.015)])
    moved = thin.rows(middle, "w") @ shapes
    np.testing.assert_allclose(np.diag(loss.matrix), np.diag(moved.T @ matrix @ moved), rtol=0.05)
    assert (loss.power, loss.inertia) == (0.5, True)


def test_wet_modes_need_no_more_panels_nor_elements() -> None:
    wet = replace(PLATE, fluid_density=998.0)
    coarse, _ = wet.real_modes(12)
    fine, _ = replace(wet, elements=(9, 6)).real_modes(12)
    np.testing.assert_allclose(coarse, fine, rtol=3e-4)


def test_measured_ratios_of_the_plate_of_paper_a() -> None:
    """Measured (f_dry / f_wet)^2 - 1 of its first modes; the tank's walls and the accelerometer are left out."""
    measured = np.array([4.3, 2.2, 3.7, 2.0, 3.1, 1.6, 1.8])
    dry, _ = PLATE.real_modes(7)
    wet, _ = replace(PLATE, fluid_density=998.0).real_modes(7)
    np.testing.assert_allclose((dry / wet) ** 2 - 1, measured, rtol=0.08)


def test_free_plate_in_water_keeps_its_rigid_motions() -> None:
    wet = replace(PLATE, clamped=(), fluid_density=998.0)
    omega, shapes = wet.real_modes(5)
    assert omega[:3].max() < 1e-3 * omega[3]
    hung = replace(wet, attached=(PlateAttached(0.188, 0.1, stiffness=1.0),))
    heave, _ = hung.real_modes(3)
    water = wetted((0.0, 0.376), (0.0, 0.2), 0.003175).matrix.sum() * 998.0
    assert heave[2] == pytest.approx(1 / np.sqrt(PLATE.mass + water), rel=2e-3)
    assert len(shapes) == wet.n_dofs
