"""Beams of CalculiX's bricks with nothing hidden: what no theory of beams has is no cause of anything."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from calculix_bricks import Bricks, isotropic, modes, needs_ccx
from updating_cases import case_of, observed

from updating import Material, Measured, Spec
from updating.diagnosis.diagnose import diagnose, pose
from updating.diagnosis.search.points import evaluate
from updating.effects import LIBRARY
from updating.problem.candidate import Candidate

ALUMINIUM = Material(70e9, 2700.0, 0.33)
LENGTH, WIDTH, THICKNESS, COUNT, NOISE = 0.5, 0.03, 0.006, 6, 0.0005
NAMES = ("length", "local_stiffness", "local_mass", "lumped_mass", "sensor_mass", "E", "density")


def bricks_tested(folder: Path, *, clamped: bool) -> Measured:
    near = THICKNESS * np.array([0.25, 0.5, 1.0, 2.0])
    along = np.unique(np.concatenate([np.linspace(0, LENGTH, 41), near]))
    elastic = isotropic(ALUMINIUM.E, ALUMINIUM.poisson)
    bricks = Bricks(
        tuple(along), tuple(np.linspace(0, WIDTH, 5)), THICKNESS, elastic, ALUMINIUM.density, clamped=clamped
    )
    points = along[8::4]
    middle = np.column_stack([points, np.full(len(points), WIDTH / 2)])
    frequency, shapes = modes(folder, bricks, 24, middle)
    moved = np.abs(shapes).max(axis=0)
    bending = np.flatnonzero((frequency > 1.0) & (moved > 0.2 * moved.max()))[:COUNT]
    rng = np.random.default_rng(4)
    constants = shapes[:, bending] * shapes[-1, bending]
    test = observed(frequency[bending], np.full(COUNT, 0.01), constants, points, rng)
    sigma = NOISE * np.sqrt(np.mean(constants**2, axis=0)) * np.ones_like(constants)
    drawn = constants + sigma * rng.standard_normal(constants.shape)
    return replace(test, constants=drawn, constants_sigma=sigma)


@needs_ccx
@pytest.mark.long
@pytest.mark.parametrize("clamped", [True, False])
def test_a_solid_beam_with_nothing_hidden_is_no_cause(tmp_path: Path, clamped: bool) -> None:
    held = ("x0",) if clamped else ()
    spec = Spec(
        "beam", length=LENGTH, width=WIDTH, thickness=THICKNESS, elements=(40,), clamped=held,
        theory="timoshenko", material=ALUMINIUM,
    )  # fmt: skip
    case = case_of(bricks_tested(tmp_path, clamped=clamped), spec)
    bare = evaluate(pose(case)[0], Candidate(), np.zeros(0)).marginal
    assert bare.scale <= 2.0
    names = (*NAMES, "clamp_translation", "clamp_rotation") if clamped else NAMES
    assert diagnose(case, library=[LIBRARY[name] for name in names]).verdict == "none"
