"""Modes that are close turn into each other within tolerances: that is no misfit. The truth is the rig's own plate."""

import numpy as np
import pytest
from updating_cases import STEEL

from modalkit.simulator.bodies.plate.parts import PlateAttached
from modalkit.simulator.bodies.plate.plate import Plate
from updating import Case, Measured, PointMass, Spec, Tolerances
from updating.diagnosis.diagnose import pose
from updating.diagnosis.search.points import evaluate
from updating.problem.candidate import Candidate
from updating.problem.specimen import SpecimenProblem

SIDE, THICKNESS, MODES, NOISE = 0.4, 0.0015, 6, 2e-4
SENSOR, AT = 0.006, (0.1, 0.0)
DOUBT = 0.002
"""Tolerance on length and width [-]: the two close modes are 0.4 % apart."""


def clamped_plate(width: float, *, off: float) -> SpecimenProblem:
    """Return the problem of a clamped plate whose specimen is wider by ``off`` tolerances, and nothing else."""
    size = (0.0, SIDE, width * (1 + off * DOUBT), THICKNESS)
    attached = (PlateAttached(*AT, SENSOR),)
    body = Plate(*size, STEEL.E, STEEL.density, clamped=("x0",), attached=attached)
    omega, shapes = body.real_modes(MODES)
    x, y = np.meshgrid(np.linspace(0.06, SIDE, 5), np.linspace(0.0, width, 5), indexing="ij")
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    phi = body.rows(points * (1.0, 1 + off * DOUBT), "w") @ shapes
    rng, n = np.random.default_rng(1), len(points)
    constants = phi * phi[-1]
    sigma = 0.01 * np.sqrt(np.mean(constants**2, axis=0)) * np.ones_like(constants)
    frequency = omega / (2 * np.pi) * np.exp(NOISE * rng.standard_normal(MODES))
    measured = Measured(
        frequency=frequency,
        frequency_sigma=1e-5 * frequency,
        damping=np.full(MODES, np.nan),
        damping_sigma=np.full(MODES, np.nan),
        points=points,
        nodes=tuple(range(1, n + 1)),
        seen=np.full(n, n - 1),
        hit=np.arange(n),
        constants=constants + sigma * rng.standard_normal(constants.shape),
        constants_sigma=sigma,
        absolute=True,
        repeatability=NOISE,
    )
    spec = Spec(
        "plate",
        length=SIDE,
        width=width,
        thickness=THICKNESS,
        elements=(16, 16),
        clamped=("x0",),
        theory="mindlin",
        material=STEEL,
        masses=(PointMass(AT, SENSOR),),
    )
    doubts = Tolerances({"E": 0.01, "density": 0.003, "length": DOUBT, "width": DOUBT})
    return pose(Case("close", spec, measured, baseline=None, tolerances=doubts))[0]


@pytest.mark.long
@pytest.mark.parametrize("off", [-1.5, 0.0, 1.5])
def test_close_modes_that_a_tolerance_turns_fit(off: float) -> None:
    problem = clamped_plate(0.889 * SIDE, off=off)
    assert problem.wide
    found = evaluate(problem, Candidate(), np.zeros(0)).marginal
    assert found.scale == 1.0
    assert found.chi2 < 1.3 * found.count


@pytest.mark.long
def test_distant_modes_are_linearised_once() -> None:
    problem = clamped_plate(0.92 * SIDE, off=1.0)
    assert not problem.wide
    assert evaluate(problem, Candidate(), np.zeros(0)).marginal.scale == 1.0
