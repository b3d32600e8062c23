"""The beam with adhesive tape, bare and taped: what stands behind the two tests of the tape paper.

The structure is a steel beam of 31.5 x 4.6 mm hung on soft cords, in a finer mesh and another theory than the
models that are fitted to it. Damping by air and cords acts everywhere; a tape on 0.5-0.8 m adds mass, stiffness
and hysteresis there alone. The poles and residues are those of the damped eigenproblem, so that the shapes are as
complex as that damping makes them; only the poles are then moved to what was published.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from published import PUBLISHED, PUBLISHED_DAMPING
from scipy import linalg

from acquisition import (
    Dof,
    FrfSet,
    Geometry,
    HammerPlan,
    ModalSystem,
    estimate_frfs,
    hammer_test,
    judge_hits,
)
from acquisition.arrays import ComplexArray, FloatArray
from updating import Material, Spec
from updating.models import FieldStructure, Region, build_structure

WIDTH, THICKNESS = 0.0315, 0.0046
STEEL = Material(E=0.968 * 210e9, density=7860.0, poisson=0.3)
TAPE = (0.5, 0.8)
"""Where the tape sits [m]."""
TAPE_MASS, TAPE_STIFFNESS = 1.035, 1.09
"""What the tape does to mass and bending stiffness of the section: Table 2, updated A_2/A_1 and I_2/I_1 [-]."""
AIR = 1.7
"""Damping by air and cords, on the mass [1/s]."""
TAPE_LOSS, STEEL_LOSS = 0.03, 4e-4
"""Loss factor of the section under the tape, and of bare steel [-]."""
CORDS, CORD_STIFFNESS = (0.22, 0.78), 22.0
"""Where the beam hangs [m], and how stiff each cord is [N/m]."""
GAIN = 0.74
"""Calibration error of the responses [-]."""
HAMMER = 4
"""Node that is hit."""
BEYOND = 6
"""Modes above the published ones that still sound in the FRFs."""
BASIS = 40
"""Undamped modes in which the damped eigenproblem is solved."""


@dataclass(frozen=True)
class TapeRig:
    """One of the two tests.

    Parameters
    ----------
    name : str
        Folder and file.
    taped : bool
        Whether the tape is on.
    decay : float
        Decay rate of the exponential window [1/s].
    seed : int
        Seed of all scatter and noise.
    """

    name: str
    taped: bool
    decay: float
    seed: int


RIGS = (TapeRig("tape_bare", False, 1.0, 201), TapeRig("tape_taped", True, 0.0, 202))
POINTS = np.arange(11) / 10
"""Where the accelerometers sit [m]."""


@dataclass(frozen=True, eq=False)
class Damped:
    """Modes of a damped structure at the points of the test.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Poles of the upper half plane, rising [rad/s].
    shapes : (11, n_modes) complex array
        Shapes at the points, so scaled that a residue is the product of two [(m/(N s))^1/2].
    slope : (n_modes,) complex array
        Slope of the shapes where the hammer hits, scaled alike.
    """

    poles: ComplexArray
    shapes: ComplexArray
    slope: ComplexArray


def structure(*, taped: bool) -> FieldStructure:
    """Return the structure behind a test, undamped."""
    area, inertia = WIDTH * THICKNESS, WIDTH * THICKNESS**3 / 12
    tape = Region("tape", TAPE, area=TAPE_MASS * area, inertia=TAPE_STIFFNESS * inertia)
    regions = (tape,) if taped else ()
    spec = Spec(
        "beam",
        length=1.0,
        width=WIDTH,
        thickness=THICKNESS,
        elements=(70,),
        clamped=(),
        theory="timoshenko",
        material=STEEL,
        regions=regions,
    )
    built = build_structure(spec)
    assert isinstance(built, FieldStructure)
    return built


def damped_modes(*, taped: bool) -> Damped:
    """Solve (s^2 M + s C + K + i D) psi = 0 for the lowest modes, the two of the hanging beam included."""
    built = structure(taped=taped)
    _, basis = built.eigen(BASIS)
    inside = (built.fields.points[:, 0] > TAPE[0]) & (built.fields.points[:, 0] < TAPE[1])
    loss = np.where(inside & taped, TAPE_LOSS, STEEL_LOSS)
    cords = built.fields.at(np.array(CORDS)[:, None])["w"] @ basis
    mass = basis.T @ (built.matrix("mass") @ basis)
    stiffness = basis.T @ (built.matrix("stiffness") @ basis) + CORD_STIFFNESS * cords.T @ cords
    hysteresis = basis.T @ (built.matrix("stiffness", loss) @ basis)
    poles, vectors = _poles(mass, AIR * mass, stiffness + 1j * hysteresis)
    kept = slice(0, 2 + len(PUBLISHED["tape_taped"]) + BEYOND)
    rows = built.fields.at(POINTS[:, None])
    shapes, slopes = (rows[name] @ basis @ vectors[:, kept] for name in ("w", "wx"))
    return Damped(poles[kept], shapes, slopes[HAMMER - 1])


def _poles(
    mass: FloatArray, damping: FloatArray, stiffness: ComplexArray
) -> tuple[ComplexArray, ComplexArray]:
    """Return the poles of the upper half plane and their vectors, psi^T (2 s M + C) psi = 1."""
    n = len(mass)
    inverse = linalg.inv(mass)
    state = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])
    values, vectors = linalg.eig(state)
    upper = np.flatnonzero(values.imag > 0)
    order = upper[np.argsort(values[upper].imag)]
    poles, psi = values[order], vectors[:n, order]
    norm = 2 * poles * np.sum(psi * (mass @ psi), axis=0) + np.sum(psi * (damping @ psi), axis=0)
    return poles, psi / np.sqrt(norm)


def moved_poles(rig: TapeRig, own: ComplexArray) -> ComplexArray:
    """Return the poles of a test: the taped beam's published ones, and the bare beam's beside them.

    What the published frequencies differ by from those of the structure behind is a matter of the specimen, so
    the bare beam differs alike; the modes above follow in the mean.
    """
    taped = damped_modes(taped=True).poles
    published = np.array(PUBLISHED["tape_taped"])
    count = 2 + len(published)
    ratio = np.ones(len(own))
    ratio[2:count] = 2 * np.pi * published / np.abs(taped[2:count])
    ratio[count:] = np.mean(ratio[count - 3 : count])
    zeta = -own.real / np.abs(own)
    if rig.taped:
        zeta[2:count] = PUBLISHED_DAMPING["tape_taped"]
    omega = np.abs(own) * ratio
    return np.asarray(omega * (-zeta + 1j * np.sqrt(1 - zeta**2)))


def tape_system(rig: TapeRig) -> ModalSystem:
    """Return the structure behind a test with its poles moved; the modal constants keep size and phase."""
    modes = damped_modes(taped=rig.taped)
    poles = moved_poles(rig, modes.poles)
    scale = modes.poles.imag / poles.imag
    hit = modes.shapes[HAMMER - 1]
    gradients = np.zeros((2, len(POINTS), 1, len(poles)), dtype=complex)
    gradients[0, :, 0] = modes.shapes * modes.slope * scale
    return ModalSystem(
        poles=poles,
        residues=(modes.shapes * hit * scale)[:, None],
        responses=tuple(Dof(i + 1, 3) for i in range(len(POINTS))),
        points=(Dof(HAMMER, 3),),
        gradients=gradients,
    )


def tape_plan(rig: TapeRig) -> HammerPlan:
    """Return how the beam is hit: 15 times at node 4 for every place of the accelerometer."""
    return HammerPlan(
        rate=1536.0,
        samples=8192,
        hits=15,
        peak=40.0,
        width=1.2 / 600,
        pre_trigger=0.02,
        force_noise=2e-4 * 40.0,
        response_noise=3e-4,
        position_sigma=5e-4,
        decay=rig.decay,
        gain=GAIN,
        adc_bits=20,
    )


def tape_frfs(rig: TapeRig) -> FrfSet:
    """Carry the synthetic test out and average its hits, as the program itself does.

    One accelerometer, whose mass is neglected, goes from point to point: every FRF has hits of its own.
    """
    whole, plan = tape_system(rig), tape_plan(rig)
    places = np.zeros((len(POINTS), 3))
    places[:, 0] = POINTS
    geometry = Geometry(tuple(range(1, len(places) + 1)), places)
    rng = np.random.default_rng(rig.seed)
    parts = []
    for row in range(len(POINTS)):
        test = hammer_test(_seen_at(whole, row), plan, rng=rng, geometry=geometry)
        parts.append(estimate_frfs(test, verdicts=judge_hits(test)).band(0.0, 600.0))
    return _joined(parts)


def _seen_at(system: ModalSystem, row: int) -> ModalSystem:
    """Return the system as one of its responses sees it."""
    assert system.gradients is not None
    return replace(
        system,
        residues=system.residues[row : row + 1],
        responses=(system.responses[row],),
        gradients=system.gradients[:, row : row + 1],
    )


def _joined(parts: list[FrfSet]) -> FrfSet:
    """Put the FRFs of all places of the accelerometer together, with their coherence."""
    return replace(
        parts[0],
        values=np.vstack([p.values for p in parts]),
        responses=tuple(r for p in parts for r in p.responses),
        references=tuple(r for p in parts for r in p.references),
        coherence=np.vstack([np.asarray(p.coherence) for p in parts]),
        averages=np.concatenate([np.asarray(p.averages) for p in parts]),
        variance=None,
        scatter=None,
    )
