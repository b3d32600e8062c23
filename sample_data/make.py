"""Make all sample data anew: ``python sample_data/make.py [FOLDER]``.

Every test here is synthetic. The structure behind it is not the model that the study files fit to it: it has
another mesh, for the beams another theory, and the causes that the published frequencies speak for (the
structure bends 16 mm inside its clamp; an accelerometer of 8.6 g; a modulus of 0.96 of the nominal one for the
beam and 0.91 for the plate; potential flow of the water in its tank). Its poles are then moved to the published
frequencies, so that what is identified *is* what was published. Damping and noise are invented. The beam with
tape of the other paper, whose damping is published too, is in ``tape.py``.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from joint import joint_test
from published import PAPER, PUBLISHED, PUBLISHED_DAMPING, TABLES, TAPE_PAPER
from tape import RIGS, TapeRig, tape_frfs

from acquisition import (
    Dof,
    FrfSet,
    Geometry,
    HammerPlan,
    HammerTest,
    ModalSystem,
    estimate_frfs,
    hammer_test,
    judge_hits,
    write_uff,
)
from acquisition.arrays import FloatArray
from updating import Environment, Material, Measured, Prediction, Predictor, Spec
from updating.effects import LIBRARY
from updating.models.state import State, combine

LENGTH, PLATE_WIDTH = 0.376, 0.200
BEAM_STEEL = Material(E=0.96 * 210e9, density=7850.0, poisson=0.3)
PLATE_STEEL = Material(E=0.91 * 210e9, density=7850.0, poisson=0.3)
PENETRATION = 0.016
"""How far the structure goes on bending inside its clamp [m]."""
SENSOR = 0.0086
"""Mass of the accelerometer [kg]."""
WATER = 998.0
"""Density of the water [kg/m^3]."""
BOUNDARY_LAYER = 3e-3
"""Damping ratio that the water's boundary layer adds at 1 Hz; it falls with the root of the frequency [-]."""
BEYOND = 6
"""Modes above the published ones that still sound in the FRFs."""
EXCHANGED = {"plate_wet": (5, 6)}
"""Neighbours, from 0, that Table 4 pairs with the finite elements the other way round than the order of the
frequencies of the structure behind, which are 3 % apart."""


@dataclass(frozen=True)
class Rig:
    """One synthetic test.

    Parameters
    ----------
    name : str
        Folder and file.
    spec : Spec
        Mesh and theory of the structure behind it.
    points : (n, dim) array
        Where the hammer hits, in model axes [m]; the last point carries the accelerometer.
    environment : Environment
        The tank.
    wet : bool
        Whether there is water in it.
    band : float
        Upper end of the band [Hz].
    samples : int
        Samples per record.
    decay : float
        Decay rate of the exponential window applied by the analyser [1/s].
    peak : float
        Median peak force [N].
    raw : bool
        Whether the file carries the raw hits; else averaged FRFs with their coherence.
    seed : int
        Seed of all scatter and noise.
    """

    name: str
    spec: Spec
    points: FloatArray
    environment: Environment
    wet: bool
    band: float
    samples: int
    decay: float
    peak: float
    raw: bool
    seed: int


def rigs() -> tuple[Rig, ...]:
    """Return the four tests of the submerged-structures paper."""
    along = LENGTH * np.arange(1, 6) / 5
    grid = np.array([(x, y) for x in along for y in PLATE_WIDTH * np.arange(5) / 4])
    beam = Spec(
        "beam",
        length=LENGTH,
        width=0.0305,
        thickness=0.0047625,
        elements=(53,),
        clamped=("x0",),
        theory="timoshenko",
        material=BEAM_STEEL,
    )
    plate = Spec(
        "plate",
        length=LENGTH,
        width=PLATE_WIDTH,
        thickness=0.003175,
        elements=(26, 14),
        clamped=("x0",),
        theory="kirchhoff",
        material=PLATE_STEEL,
    )
    tank = {"free_surface": 0.18, "bottom": 0.19}
    around_beam = Environment(WATER, **tank, walls=(0.0, 0.55, 0.01525 - 0.225, 0.01525 + 0.225))
    around_plate = Environment(WATER, **tank, walls=(0.0, 0.55, 0.1 - 0.225, 0.1 + 0.225))
    common = {"samples": 1024, "decay": 8.0, "peak": 60.0, "raw": True, "band": 500.0}
    broad = {"samples": 4096, "decay": 4.0, "peak": 60.0, "raw": False, "band": 1000.0}
    return (
        Rig("beam_dry", beam, along[:, None], around_beam, wet=False, seed=101, **common),
        Rig("beam_wet", beam, along[:, None], around_beam, wet=True, seed=102, **common),
        Rig("plate_dry", plate, grid, around_plate, wet=False, seed=103, **broad),
        Rig("plate_wet", plate, grid, around_plate, wet=True, seed=104, **broad),
    )


def structure_behind(rig: Rig) -> Prediction:
    """Solve for the modes of the structure behind a test, at the points of the test."""
    published = np.array(PUBLISHED[rig.name])
    predictor = Predictor(rig.spec, _seen_from(rig, published), rig.environment)
    added = {"length": {"extension": PENETRATION}, "sensor_mass": {"mass": SENSOR}}
    if rig.wet:
        added["fluid_added_mass"] = {"fluid_density": WATER}
    state: State = combine(LIBRARY[name].state(predictor, values) for name, values in added.items())
    return predictor.predict(state, count=len(published) + BEYOND)


def _seen_from(rig: Rig, frequency: FloatArray) -> Measured:
    """Return a test without data, which only says where it is hit and where it is measured."""
    n, m = len(rig.points), len(frequency)
    nothing = np.full(m, np.nan)
    return Measured(
        frequency=frequency, frequency_sigma=nothing, damping=nothing, damping_sigma=nothing,
        points=rig.points, nodes=tuple(range(1, n + 1)), seen=np.full(n, n - 1), hit=np.arange(n),
        constants=np.ones((n, m)), constants_sigma=np.ones((n, m)), absolute=True,
    )  # fmt: skip


def damping_ratios(rig: Rig, frequency: FloatArray) -> FloatArray:
    """Return damping ratios, invented: some per mille of steel and clamp, more at low frequency [-].

    In water the same damper acts on more inertia, so that its ratio falls with the frequency, and the boundary
    layer adds a little.
    """
    dry = np.array(PUBLISHED[rig.name.replace("wet", "dry")])
    rng = np.random.default_rng(len(dry))
    ratio = np.resize(frequency, len(dry)) / dry if rig.wet else np.ones(len(dry))
    reached = np.concatenate([ratio, np.full(len(frequency) - len(dry), ratio[-1])])
    own = (0.002 + 0.04 * reached / frequency) * np.exp(0.25 * rng.standard_normal(len(frequency)))
    layer = BOUNDARY_LAYER / np.sqrt(frequency) if rig.wet else np.zeros(len(frequency))
    return np.asarray(own * reached + layer)


def system(rig: Rig) -> ModalSystem:
    """Return the structure behind a test with its poles at the published frequencies."""
    truth = _numbered(structure_behind(rig), rig.name)
    published = np.array(PUBLISHED[rig.name])
    known = len(published)
    ratio = np.mean(published[-3:] / truth.frequency[known - 3 : known])
    beyond = truth.frequency[known:] * ratio
    frequency = np.concatenate([published, beyond])
    zeta = damping_ratios(rig, frequency)
    omega = 2 * np.pi * frequency
    damped = omega * np.sqrt(1 - zeta**2)
    along = np.zeros((2, 1, *truth.constants.shape))
    along[: len(truth.along), 0] = truth.along
    nodes = [Dof(i + 1, 3) for i in range(len(rig.points))]
    return ModalSystem(
        poles=-zeta * omega + 1j * damped,
        residues=truth.constants[None] / (2j * damped),
        responses=(nodes[-1],),
        points=tuple(nodes),
        gradients=along / (2j * damped),
    )


def _numbered(truth: Prediction, name: str) -> Prediction:
    """Put the modes into the order in which the paper numbers them."""
    order = np.arange(len(truth.frequency))
    if name in EXCHANGED:
        first, second = EXCHANGED[name]
        order[[first, second]] = order[[second, first]]
    return truth.select(order)


def plan(rig: Rig) -> HammerPlan:
    """Return how the structure is hit: 15 times at every point."""
    return HammerPlan(
        rate=2.56 * rig.band,
        samples=rig.samples,
        hits=15,
        peak=rig.peak,
        width=1.2 / rig.band,
        pre_trigger=0.02 * rig.samples / (2.56 * rig.band),
        force_noise=2e-4 * rig.peak,
        response_noise=3e-4,
        position_sigma=5e-4,
        decay=rig.decay,
        adc_bits=20,
    )


def geometry(rig: Rig) -> Geometry:
    """Return the points of a test in its own axes, which are the model's."""
    flat = np.zeros((len(rig.points), 3))
    flat[:, : rig.points.shape[1]] = rig.points
    return Geometry(tuple(range(1, len(flat) + 1)), flat)


def record(rig: Rig) -> HammerTest:
    """Carry the synthetic test out."""
    return hammer_test(system(rig), plan(rig), rng=np.random.default_rng(rig.seed), geometry=geometry(rig))


def averaged(rig: Rig, test: HammerTest) -> FrfSet:
    """Average the hits to FRFs, as the program itself does, and keep the band."""
    frfs = estimate_frfs(test, verdicts=judge_hits(test)).band(0.0, rig.band)
    return replace(frfs, variance=None)


def make(rig: Rig, folder: Path) -> Path:
    """Write the universal file of one test, and return where it is."""
    target = folder / rig.name / f"{rig.name}.uff"
    target.parent.mkdir(parents=True, exist_ok=True)
    test = record(rig)
    title = f"synthetic hammer test, {rig.name}: published frequencies, invented damping"
    if rig.raw:
        write_uff(target, tests=test, title=title, precision="single")
    else:
        write_uff(target, frfs=averaged(rig, test), title=title, precision="single")
    return target


def make_tape(rig: TapeRig, folder: Path) -> Path:
    """Write the universal file of the beam with or without tape, and return where it is."""
    target = folder / rig.name / f"{rig.name}.uff"
    target.parent.mkdir(parents=True, exist_ok=True)
    what = "published frequencies and damping, gain 0.74" if rig.taped else "invented, gain 0.74"
    write_uff(
        target, frfs=tape_frfs(rig), title=f"synthetic hammer test, {rig.name}: {what}", precision="single"
    )
    return target


def make_joint(folder: Path) -> Path:
    """Write the universal file of the beam whose clamp gives, and return where it is."""
    target = folder / "beam_joint" / "beam_joint.uff"
    target.parent.mkdir(parents=True, exist_ok=True)
    write_uff(
        target,
        tests=joint_test(),
        title="synthetic hammer test, beam_joint: all invented",
        precision="single",
    )
    return target


def write_modes(name: str, folder: Path) -> None:
    """Write the published frequencies beside a test, and the damping ratios where there are any."""
    (folder / name / "modes.csv").write_text("\n".join(_lines(name)) + "\n", encoding="utf-8")


def _lines(name: str) -> list[str]:
    if name in PUBLISHED_DAMPING:
        both = zip(PUBLISHED[name], PUBLISHED_DAMPING[name], strict=True)
        return [
            f"# Published natural frequencies and damping ratios, {TAPE_PAPER}, {TABLES[name]}.",
            "# sigmas are ours: half of the last printed digit, and 0.05 % of the frequency and 3 % of the damping",
            "# for an identification nobody documented. No shapes were published.",
            "frequency,sigma,damping,damping_sigma",
            *(f"{f:.1f},{0.05 + 5e-4 * f:.4f},{z:.4f},{5e-5 + 0.03 * z:.6f}" for f, z in both),
        ]
    unit = "half of the last printed digit and 0.05 % for an identification nobody documented"
    return [
        f"# Published natural frequencies, {PAPER}, {TABLES[name]}, column 'Experim.' (two decimals printed).",
        f"# sigma is ours: {unit}. No shapes and no damping were published.",
        "frequency,sigma",
        *(f"{f:.2f},{0.005 + 5e-4 * f:.4f}" for f in PUBLISHED[name]),
    ]


def main(arguments: Sequence[str]) -> None:
    """Make all files below a folder; left out, the one this script lies in."""
    folder = Path(arguments[0]) if arguments else Path(__file__).resolve().parent
    made = [(rig.name, make(rig, folder)) for rig in rigs()]
    made += [(rig.name, make_tape(rig, folder)) for rig in RIGS]
    made.append(("beam_joint", make_joint(folder)))
    for name, path in made:
        print(f"{path}: {path.stat().st_size / 1e6:.2f} MB")
        if name in PUBLISHED:
            write_modes(name, folder)


if __name__ == "__main__":
    main(sys.argv[1:])
