"""Recovery: do the intervals of an update cover parameters drawn from their tolerance, through simulated hits?

python benchmarks/bench_recovery.py              80 random specimens, some 300 parameters
python benchmarks/bench_recovery.py --seeds 20   fewer
python benchmarks/bench_recovery.py --verbose    one line for each specimen

python benchmarks/bench_recovery.py --frequencies  without the shapes as data
python benchmarks/bench_recovery.py --constants    constants with their level, and the density of the whole unknown
python benchmarks/bench_recovery.py --blind        the frequencies are all that was measured

Each specimen is a beam or a plate, free or clamped, of random size, section and layout of regions; its moduli and
densities are drawn from a tolerance of 30 %. The truth is solved on another, finer mesh; its modes, scattered by
the re-mounting that the update is told of, answer simulated hits, in half of the specimens at points and with a
sensor that are a millimetre out of place, and with a calibration off by 2 %; these are averaged, identified, and the
frequencies and shapes found are updated with the same tolerance. Regions end at lines that both meshes have. Sets of
parameters that frequencies cannot tell apart by construction are counted by whether they are named.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import beta

from acquisition import (
    Dof,
    EstimationError,
    Geometry,
    HammerPlan,
    ModalData,
    ModalSystem,
    estimate_frfs,
    hammer_test,
    modal_system,
)
from identification import identify
from updating import (
    Axes,
    Case,
    Material,
    Region,
    Spec,
    Tolerances,
    build_structure,
    measured_from_identified,
    measured_from_modes,
)
from updating.update import Update, update

TOLERANCE = 0.3
REMOUNTING = 5e-4
MISPLACED = 1e-3
CALIBRATION = 0.02
DATA: tuple[str, ...] = ("frequencies", "shapes")
HITS = 3
SAMPLES = 4096


@dataclass(frozen=True)
class Specimen:
    """A nominal model, what is updated, the truth, and where it is hit.

    Parameters
    ----------
    spec, truth : Spec
        The nominal model, and the true one on its finer mesh.
    names : tuple of str
        What is updated.
    logs : (p,) array
        True logarithms of the factors.
    points : (n, 2) array
        Test points [m].
    modes : int
        Number of modes in the band.
    doubt : float
        Standard deviation of the places of points and sensor [m].
    """

    spec: Spec
    truth: Spec
    names: tuple[str, ...]
    logs: np.ndarray
    points: np.ndarray
    modes: int
    doubt: float


def cuts(rng: np.random.Generator, count: int, length: float, grid: int) -> np.ndarray:
    """Return the ends of parts of a length, at random lines of a grid that both meshes share [m]."""
    inner = np.sort(rng.choice(np.arange(1, grid), count - 1, replace=False))
    return length * np.concatenate([[0], inner, [grid]]) / grid


def draw(rng: np.random.Generator, *, level: bool = False) -> Specimen:
    """Draw a specimen; ``level`` turns the density of the whole as well, which no frequency tells from the moduli."""
    plate = bool(rng.integers(2))
    length, thickness = rng.uniform(0.25, 0.6), rng.uniform(0.003, 0.008)
    width = rng.uniform(0.4, 0.7) * length if plate else rng.uniform(0.02, 0.04)
    material = Material(rng.uniform(65e9, 215e9), rng.uniform(2600.0, 8000.0), 0.3)
    along = int(rng.integers(2, 4 if plate else 7))
    across = int(rng.integers(1, 3)) if plate else 1
    x, y = cuts(rng, along, length, 12), cuts(rng, across, width, 6)
    regions = tuple(
        Region(f"p{i}{j}", (x[i], x[i + 1]), (y[j], y[j + 1]) if plate else None)
        for i in range(along)
        for j in range(across)
    )
    elements = (24, 12) if plate else (36,)
    finer = (36, 18) if plate else (84,)
    spec = Spec(
        "plate" if plate else "beam",
        length=length,
        width=width,
        thickness=thickness,
        elements=elements,
        clamped=("x0",) if rng.integers(2) else (),
        theory="kirchhoff" if plate else "euler-bernoulli",
        material=material,
        regions=regions,
    )
    names = [f"{r.name}.E" for r in regions]
    names += [f"{r.name}.density" for r in regions if rng.random() < 0.25]
    names += ["density"] * level
    logs = TOLERANCE * rng.standard_normal(len(names))
    truth = replace(spec, elements=finer, regions=turned(spec, names, logs))
    truth = heavier(truth, float(np.exp(logs[-1]))) if level else truth
    grid = (5, 4) if plate else (9, 1)
    points = np.stack(np.meshgrid(*(np.linspace(0.03, 0.97, n) for n in grid)), axis=-1).reshape(-1, 2)
    places = points * [length, width if plate else 0.0]
    return Specimen(spec, truth, tuple(names), logs, places, 8, MISPLACED * float(rng.integers(2)))


def heavier(spec: Spec, factor: float) -> Spec:
    """Return the same specimen with all of it heavier by a factor."""
    regions = tuple(r if r.density is None else replace(r, density=factor * r.density) for r in spec.regions)
    return replace(
        spec, material=replace(spec.material, density=factor * spec.material.density), regions=regions
    )


def turned(spec: Spec, names: list[str], logs: np.ndarray) -> tuple[Region, ...]:
    """Return the regions with their true properties."""
    regions = {region.name: region for region in spec.regions}
    for name, log in zip(names, logs, strict=True):
        if "." not in name:
            continue
        place, prop = name.split(".")
        nominal = {"E": spec.material.E, "density": spec.material.density}[prop]
        regions[place] = replace(regions[place], **{prop: nominal * float(np.exp(log))})
    return tuple(regions.values())


def answering(specimen: Specimen, rng: np.random.Generator) -> tuple[ModalSystem, np.ndarray]:
    """Return the true structure as seen from the points, and its frequencies in the band [Hz]."""
    structure = build_structure(specimen.truth)
    first, count = structure.rigid_modes, specimen.modes + 6
    values, vectors = structure.eigen(first + count)
    frequency = np.sqrt(values[first:]) / (2 * np.pi) * (1 + REMOUNTING * rng.standard_normal(count))
    places = np.vstack([specimen.points, specimen.points[-1:]])[:, : len(specimen.spec.elements)]
    places = places + specimen.doubt * rng.standard_normal(places.shape)
    shapes = np.asarray(structure.rows(np.maximum(places, 0.0))["w"] @ vectors[:, first:])
    shapes, sensor = shapes[:-1], shapes[-1:] * (1 + CALIBRATION * rng.standard_normal())
    dofs = tuple(Dof(i + 1, 3) for i in range(len(shapes)))
    damping = rng.uniform(0.003, 0.01, count)
    return modal_system(
        frequency=frequency,
        damping=damping,
        response_shapes=sensor,
        point_shapes=shapes,
        responses=dofs[-1:],
        points=dofs,
    ), frequency


def test_of(specimen: Specimen, rng: np.random.Generator, *, blind: bool = False) -> Case:
    """Hit, average and identify a specimen; ``blind`` leaves nothing of the test but frequencies."""
    system, frequency = answering(specimen, rng)
    top = 0.5 * (frequency[specimen.modes - 1] + frequency[specimen.modes])
    plan = HammerPlan(
        rate=2.56 * 1.3 * top,
        samples=SAMPLES,
        hits=HITS,
        width=1.0 / top,
        force_noise=0.02,
        response_noise=1e-3,
        decay=2.0 * np.pi * 2.56 * 1.3 * top / SAMPLES,
        pre_trigger=0.01 * SAMPLES / (2.56 * 1.3 * top),
    )
    z = np.zeros((len(specimen.points), 1))
    geometry = Geometry(tuple(range(1, len(z) + 1)), np.hstack([specimen.points, z]))
    frfs = estimate_frfs(hammer_test(system, plan, rng=rng, geometry=geometry))
    model = identify(frfs, band=(0.6 * frequency[0], top))
    measured = measured_from_identified(
        model,
        Axes(),
        specimen.spec,
        repeatability=REMOUNTING,
        position_sigma=specimen.doubt,
        calibration=CALIBRATION,
    )
    if blind:
        modes = ModalData(frequency=model.modal.frequency, frequency_sigma=model.modal.frequency_sigma)
        measured = measured_from_modes(modes, Axes(), specimen.spec, repeatability=REMOUNTING)
    return Case(
        "specimen",
        specimen.spec,
        measured,
        baseline=None,
        tolerances=Tolerances({"E": TOLERANCE, "density": TOLERANCE}),
    )


def pulls(specimen: Specimen, result: Update) -> np.ndarray:
    """Return (estimate - truth) / sigma of the logarithms."""
    value = np.array([float(p.factor or np.nan) for p in result.parameters])
    sigma = np.array([p.sigma / p.value for p in result.parameters])
    return np.asarray((np.log(value) - specimen.logs) / sigma)


def inside(specimen: Specimen, result: Update) -> np.ndarray:
    """Tell which parameters lie in their 95 % interval: the one stated, or 1.96 sigma of the logarithm."""
    within = np.abs(pulls(specimen, result)) < 1.96
    for i, (parameter, log) in enumerate(zip(result.parameters, specimen.logs, strict=True)):
        if parameter.interval is not None:
            low, high = np.log(
                np.array(parameter.interval) / parameter.value * float(parameter.factor or np.nan)
            )
            within[i] = low <= log <= high
    return within


def interval(hits: int, trials: int) -> tuple[float, float]:
    """Return the 95 % interval of a probability (Clopper and Pearson 1934)."""
    low = beta.ppf(0.025, hits, trials - hits + 1) if hits else 0.0
    high = beta.ppf(0.975, hits + 1, trials - hits) if hits < trials else 1.0
    return float(low), float(high)


def share_text(within: np.ndarray) -> str:
    """Write a coverage with its interval."""
    low, high = interval(int(within.sum()), len(within))
    return f"{100 * within.mean():.1f} % of {len(within)} ({100 * low:.1f} to {100 * high:.1f} %)"


def recovered(seed: int, data: tuple[str, ...] = DATA, *, blind: bool = False) -> tuple[Specimen, Update]:
    """Draw, test and update one specimen."""
    rng = np.random.default_rng([2026, seed])
    specimen = draw(rng, level="constants" in data)
    return specimen, update(test_of(specimen, rng, blind=blind), parameters=specimen.names, data=data)


def named(seed: int) -> bool:
    """Tell whether modulus and density of a whole specimen are named as a pair of which the ratio is known."""
    rng = np.random.default_rng([2027, seed])
    specimen = draw(rng)
    result = update(test_of(specimen, rng), parameters=["E", "density"])
    stated = result.determinability
    couplings = [] if stated is None else [set(c.parameters) for c in stated.couplings if c.determined]
    return set(result.undetermined) == {"E", "density"} and {"E", "density"} in couplings


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", type=int, default=80)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--verbose", action="store_true")
    parser.add_argument("--frequencies", action="store_true", help="frequencies alone are data")
    parser.add_argument("--constants", action="store_true", help="constants with their level are data")
    parser.add_argument("--blind", action="store_true", help="frequencies are all that was measured")
    chosen = parser.parse_args()
    data = DATA[:1] if chosen.frequencies or chosen.blind else DATA
    data = ("frequencies", "constants") if chosen.constants else data
    every, within, determined, lost, several = [], [], [], 0, 0
    for seed in range(chosen.first, chosen.first + chosen.seeds):
        try:
            specimen, result = recovered(seed, data, blind=chosen.blind)
        except EstimationError as error:
            lost += 1
            print(f"{seed}: {error}")
            continue
        own = pulls(specimen, result)
        known = np.array([name not in result.undetermined for name in result.names])
        every.append(own)
        within.append(inside(specimen, result))
        determined.append(within[-1][known])
        several += any("solutions" in warning for warning in result.warnings)
        if chosen.verbose:
            spec = specimen.spec
            marks = " ".join(f"{p:+.1f}" + "*" * (not w) for p, w in zip(own, within[-1], strict=True))
            print(
                f"{seed}: {spec.kind} {'clamped' if spec.clamped else 'free'}, places {specimen.doubt}, "
                f"{len(result.pairs)} modes, inflation {result.inflation:.2f}, converged {result.converged}, "
                f"known {known.sum()}, chi2 {result.chi2:.1f}/{result.dof}, pulls {marks}"
                + ", several"
                * any("solutions" in warning for warning in result.warnings)
            )
    pooled = np.concatenate(every)
    print(
        f"covered by 95 % intervals, all parameters: {share_text(np.concatenate(within))}; "
        f"r.m.s. pull {np.sqrt(np.mean(pooled**2)):.2f}"
    )
    print(f"  of these, determined by the data: {share_text(np.concatenate(determined))}")
    print(f"  specimens without a result: {lost} of {chosen.seeds}; with several solutions: {several}")
    pairs = np.array([named(seed) for seed in range(max(1, chosen.seeds // 4))])
    print(f"E and density of everything named as a pair: {pairs.sum()} of {len(pairs)}")


if __name__ == "__main__":
    main()
