"""Thick plates under a thin theory: what shear takes is no gap and hides none. The truth is the rig's Mindlin plate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from updating_cases import PLATE, STEEL

from modalkit.output.summary import answers
from modalkit.simulator.bodies.plate.parts import PlateAttached
from modalkit.simulator.bodies.plate.plate import Plate
from updating import LIBRARY, Case, Measured, Spec, diagnose

pytestmark = pytest.mark.long

SPEC = replace(PLATE, thickness=PLATE.width / 60, elements=(16, 10), clamped=())
MODES, NOISE = 10, 1e-3
SEARCHED = ("E", "thickness", "orthotropy", "local_stiffness", "lumped_mass", "damping_patch", "shear")


def struck(seed: int, *, mass: float = 0.0) -> Measured:
    """Modes of a free Mindlin plate, quintic elements: frequencies good to 0.1 %, constants to 1 %."""
    attached = (PlateAttached(0.3, 0.15, mass),) * (mass > 0)
    size = (0.0, SPEC.length, SPEC.width, SPEC.thickness)
    body = Plate(*size, STEEL.E, STEEL.density, clamped=(), attached=attached)
    omega, shapes = (part[..., 3:] for part in body.real_modes(MODES + 3))
    points = np.array([(x, y) for x in np.linspace(0.0, SPEC.length, 6) for y in (0.0, 0.1, 0.2)])
    phi = body.rows(points, "w") @ shapes
    rng, n = np.random.default_rng(seed), len(points)
    constants = phi * phi[-1]
    sigma = 0.01 * np.sqrt(np.mean(constants**2, axis=0)) * np.ones_like(constants)
    frequency = omega / (2 * np.pi) * np.exp(NOISE * rng.standard_normal(MODES))
    damping = 0.5 * (2.0 / omega + 1e-6 * omega)
    return Measured(
        frequency=frequency,
        frequency_sigma=1e-4 * frequency,
        damping=damping,
        damping_sigma=0.03 * damping,
        points=points,
        nodes=tuple(range(1, n + 1)),
        seen=np.full(n, n - 1),
        hit=np.arange(n),
        constants=constants + sigma * rng.standard_normal(constants.shape),
        constants_sigma=sigma,
        absolute=True,
        repeatability=NOISE,
    )


def diagnosed(spec: Spec, measured: Measured):  # type: ignore[no-untyped-def]
    return diagnose(Case("thick", spec, measured), library=[LIBRARY[name] for name in SEARCHED])


@pytest.mark.parametrize("theory", ["kirchhoff", "mindlin"])
def test_nothing_is_named_where_shear_is_all_that_is_missing(theory: str) -> None:
    found = diagnosed(SPEC.with_theory(theory), struck(1))
    assert (found.verdict, found.significant) == ("none", False)
    said = " ".join(found.warnings)
    thin = theory == "kirchhoff"
    assert ("every set of causes was compared with and without" in said) == thin
    assert ('theory = "mindlin" includes them' in said) == thin
    assert (found.beneath > 100 * NOISE) == thin
    assert ("which the model neglects" in " ".join(answers(found).values())) == thin
    why = str(found.not_examined["shear"])
    assert ("added to every set" in why) == thin
    assert ("has it already" in why) != thin


def test_a_cause_is_found_beside_what_shear_takes() -> None:
    found = diagnosed(SPEC, struck(2, mass=0.03))
    assert found.verdict == "named"
    assert found.sets == (("lumped_mass",),)
    estimates = found.ranking[0].parameters
    assert estimates["lumped_mass.mass"].value == pytest.approx(0.03, rel=0.1)


def test_a_plate_too_thin_for_shear_is_compared_on_its_own_theory_alone() -> None:
    measured = replace(struck(1), repeatability=0.05, constants_sigma=1.0 + 0.0 * struck(1).constants)
    found = diagnosed(SPEC, measured)
    assert "with and without" not in " ".join(found.warnings)
