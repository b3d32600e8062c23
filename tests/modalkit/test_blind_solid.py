"""The rig's solids by CalculiX against its beams and plates, where these are right, and where they are not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition.errors import StudyError
from modalkit.blind.bodies import solid_deck
from modalkit.blind.bodies.beam import Beam
from modalkit.blind.bodies.complex_modes import complex_modes
from modalkit.blind.bodies.parts import Attached, Stretch
from modalkit.blind.bodies.plate import Plate
from modalkit.blind.bodies.plate_parts import PlateAttached
from modalkit.blind.bodies.solid import Cut, Solid, available

needs_ccx = pytest.mark.skipif(not available(), reason="no ccx: apt-get install calculix-ccx")

BAR = Solid("beam", 0.0, 0.5, 0.03, 0.008, 210e9, 7850.0, poisson=0.0)
BEAM = Beam(0.0, 0.5, 0.03, 0.008, 210e9, 7850.0, poisson=0.0)


@needs_ccx
def test_bar_is_the_beam() -> None:
    """Without Poisson's effect the clamp holds nothing that a beam's does not."""
    omega, shapes = BAR.real_modes(6)
    beam, beam_shapes = BEAM.real_modes(6)
    np.testing.assert_allclose(omega, beam, rtol=6e-4)
    x = np.array([[0.1], [0.33], [0.47]])
    for ours, theirs in (("w", "w"), ("slope", "slope")):
        read, known = BAR.rows(x, ours) @ shapes, BEAM.rows(x, theirs) @ beam_shapes
        assert np.abs(np.abs(read) - np.abs(known)).max() < 0.01 * np.abs(known).max()


@needs_ccx
def test_bricks_have_converged_and_give_the_same_twice() -> None:
    fine, _ = replace(BAR, elements=(60, 2, 2)).real_modes(5)
    coarse, _ = BAR.real_modes(5)
    np.testing.assert_allclose(coarse, fine, rtol=5e-4)
    text = solid_deck.deck(
        BAR.bricks, E=BAR.E, density=BAR.density, poisson=0.0, held=BAR._held(), points=[], count=3
    )
    read = BAR.bricks.bottom().ravel()
    first, second = (solid_deck.run(text, read=read) for _ in range(2))
    np.testing.assert_array_equal(first[0], second[0])
    np.testing.assert_array_equal(first[1], second[1])


@needs_ccx
def test_what_hangs_on_a_bar_counts_as_on_a_beam() -> None:
    mass = 0.05
    parts = (Attached(0.43, mass=mass, inertia=mass * 0.004**2, stiffness=3e4),)
    bar = replace(BAR, attached=parts).real_modes(5)[0] / BAR.real_modes(5)[0]
    beam = replace(BEAM, attached=parts).real_modes(5)[0] / BEAM.real_modes(5)[0]
    np.testing.assert_allclose(bar, beam, atol=1e-3)
    soft = replace(BAR, clamp_rotation=2000.0).real_modes(4)[0]
    np.testing.assert_allclose(soft, replace(BEAM, clamp_rotation=2000.0).real_modes(4)[0], rtol=0.015)


@needs_ccx
def test_slot_costs_more_than_the_section_that_is_left() -> None:
    """Stress does not turn at right angles: the slot's neighbourhood is idle too, up to a depth or so away."""
    slot = replace(BAR, cuts=(Cut(0.15, 0.003, 0.004),)).real_modes(3)[0] / BAR.real_modes(3)[0] - 1
    least, most = (
        replace(BEAM, stretches=(Stretch(0.15, width, bending=0.125, line=0.5),)).real_modes(3)[0]
        / BEAM.real_modes(3)[0]
        - 1
        for width in (0.003, 0.003 + 2 * 0.004)
    )
    assert np.all(slot < 1.3 * least)
    assert np.all(slot > most)


@needs_ccx
def test_free_bar_on_springs() -> None:
    springs = tuple(Attached(x, stiffness=500.0) for x in (0.112, 0.388))
    bar, beam = (replace(b, clamped=(), attached=springs).real_modes(5)[0] for b in (BAR, BEAM))
    np.testing.assert_allclose(bar, beam, rtol=1.5e-3)
    with pytest.raises(StudyError, match="attach springs"):
        replace(BAR, clamped=()).real_modes(5)


@needs_ccx
def test_solid_plate_is_the_thick_plate() -> None:
    corner = (PlateAttached(0.376, 0.2, mass=0.02, inertia=0.02 * 0.0016**2),)
    solid = Solid("plate", 0.0, 0.376, 0.2, 0.003175, 210e9, 7850.0, attached=corner)
    plate = Plate(0.0, 0.376, 0.2, 0.003175, 210e9, 7850.0, attached=corner)
    places = np.array([[0.1, 0.02], [0.2, 0.13], [0.376, 0.0]])
    ours, theirs = (
        complex_modes(replace(b, alpha=2.0, beta=1e-6), places, places[2], count=8, scatter=np.ones(8))
        for b in (solid, plate)
    )
    np.testing.assert_allclose(ours.frequency, theirs.frequency, rtol=2e-3)
    np.testing.assert_allclose(ours.damping, theirs.damping, rtol=2e-3)
    size = np.abs(theirs.residues).max()
    assert np.abs(np.abs(ours.residues) - np.abs(theirs.residues)).max() < 0.02 * size
    assert ours.slopes.shape == theirs.slopes.shape


def test_a_solid_without_calculix_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    assert not available()
    with pytest.raises(StudyError, match="install calculix-ccx"):
        solid_deck.run("", read=np.array([1]))
