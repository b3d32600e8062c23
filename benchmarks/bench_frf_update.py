"""Updating by FRFs: do its intervals cover the truth, and what does it cost beside plain re-solution?

python benchmarks/bench_frf_update.py                36 random specimens and the plate
python benchmarks/bench_frf_update.py --seeds 0      the plate alone
python benchmarks/bench_frf_update.py --verbose      one line for each specimen

Each specimen is a beam or a plate of `bench_recovery`, free or clamped, in regions whose moduli, some densities, and
coefficients of damping are drawn (30 %, and a factor of 2 for damping). The truth is solved on another, finer mesh,
beams by Timoshenko's theory where --timoshenko is said; its resonances are scattered by the re-mounting that the
update is told of; it answers simulated hits with noise of 0.1 to 2 %; these are averaged, identified, and the FRFs
updated. Free bodies hang on cords at a hundredth of their first mode.

The peer of the plate (760 elements in 15 regions, 100 lines, all columns at their true damping) takes the steps of
Gauss and Newton and factorises the full Z(s) of every line in every step; its regions' matrices are assembled once.
It starts 3 % off, where it converges. The floor is the solution of the reduced Z on the same lines, once a step.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace
from time import process_time

import numpy as np
from bench_recovery import Specimen, draw, share_text
from scipy.sparse.linalg import splu

from acquisition import Dof, EstimationError, Geometry, HammerPlan, ModalSystem, estimate_frfs, hammer_test
from identification import identify
from updating import (
    Axes,
    Case,
    Damping,
    Material,
    Measured,
    Predictor,
    Region,
    Spec,
    Tolerances,
    build_structure,
    measured_from_identified,
)
from updating.frf_update import FrfUpdate, update_frfs
from updating.models.response import answers
from updating.simulation import modal_system, simulated
from updating.test_data.measured_frfs import MeasuredFrfs, measured_frfs

TOLERANCE = 0.3
REMOUNTING = 5e-4
SAMPLES = 4096
STEEL = Material(210e9, 7850.0, 0.3)


@dataclass(frozen=True)
class Damped:
    """A specimen with damping by region.

    Parameters
    ----------
    case : Specimen
        Sizes, regions, truth.
    names : tuple of str
        Coefficients of damping.
    values : (p,) array
        Their true values [1/s, s].
    """

    case: Specimen
    names: tuple[str, ...]
    values: np.ndarray


def blank(spec: Spec, points: np.ndarray, count: int) -> Measured:
    """Return a test whose points are known and nothing else, all FRFs seen from the last point."""
    n, nothing = len(points), np.full(count, np.nan)
    ends = np.full(n, n - 1), np.arange(n)
    ones = np.ones((n, count))
    return Measured(
        frequency=np.linspace(50, 1000, count),
        frequency_sigma=nothing,
        damping=nothing,
        damping_sigma=nothing,
        points=points[:, : spec.dim],
        nodes=tuple(range(1, n + 1)),
        seen=ends[0],
        hit=ends[1],
        constants=ones,
        constants_sigma=ones,
        absolute=True,
    )


def damped(rng: np.random.Generator, theory: bool) -> Damped:
    """Draw a specimen and the damping of its regions."""
    case = draw(rng)
    count = case.modes
    omega = (
        2
        * np.pi
        * Predictor(case.truth, blank(case.truth, case.points, count)).predict(count=count).frequency
    )
    names, values, regions = [], [], []
    for region in case.truth.regions:
        alpha, beta = np.array([0.005 * omega[0], 0.005 / omega[-1]]) * np.exp(
            np.log(2) * rng.standard_normal(2)
        )
        regions.append(replace(region, alpha=float(alpha), beta=float(beta)))
        names += [f"{region.name}.alpha", f"{region.name}.beta"]
        values += [alpha, beta]
    truth = replace(case.truth, regions=tuple(regions))
    if theory and truth.kind == "beam":
        truth = truth.with_theory("timoshenko")
    spec = replace(case.spec, damping=Damping(0.005 * omega[0], 0.005 / omega[-1]))
    return Damped(replace(case, spec=spec, truth=truth), tuple(names), np.array(values))


def answering(drawn: Damped, rng: np.random.Generator) -> tuple[ModalSystem, np.ndarray]:
    """Return the damped structure in another mounting, and its frequencies in the band [Hz]."""
    case = drawn.case
    there = Predictor(case.truth, blank(case.truth, case.points, case.modes))
    frequency = there.predict(count=case.modes + 1).frequency
    hung = simulated(there).hung(0.01 * frequency[0])
    dofs = tuple(Dof(i + 1, 3) for i in range(len(case.points)))
    system = modal_system(
        hung,
        seen=there.measured.seen[-1:],
        hit=there.measured.hit,
        responses=dofs[-1:],
        points=dofs,
    )
    shift = np.where(
        np.abs(system.poles) > np.pi * frequency[0],
        1 + REMOUNTING * rng.standard_normal(len(system.poles)),
        1.0,
    )
    # the same shapes at another frequency: residues of receptances go as its inverse
    return replace(system, poles=system.poles * shift, residues=system.residues / shift), frequency


def test_of(drawn: Damped, rng: np.random.Generator, noise: float) -> tuple[Case, MeasuredFrfs]:
    """Hit, average and identify a specimen."""
    case = drawn.case
    system, frequency = answering(drawn, rng)
    top = 0.5 * (frequency[case.modes - 1] + frequency[case.modes])
    rate = 2.56 * 1.3 * top
    plan = HammerPlan(
        rate=rate,
        samples=SAMPLES,
        hits=3,
        width=1.0 / top,
        force_noise=0.002,
        response_noise=noise,
        decay=2.0 * np.pi * rate / SAMPLES,
        pre_trigger=0.01 * SAMPLES / rate,
    )
    z = np.zeros((len(case.points), 1))
    geometry = Geometry(tuple(range(1, len(z) + 1)), np.hstack([case.points, z]))
    frfs = estimate_frfs(hammer_test(system, plan, rng=rng, geometry=geometry))
    model = identify(frfs, band=(0.6 * frequency[0], top))
    stated = {"repeatability": REMOUNTING, "position_sigma": 0.0, "calibration": 1e-3}
    measured = measured_from_identified(model, Axes(), case.spec, **stated)
    tolerances = Tolerances({"E": TOLERANCE, "density": TOLERANCE})
    return Case("specimen", case.spec, measured, baseline=None, tolerances=tolerances), measured_frfs(
        model, measured
    )


def recovered(seed: int, *, theory: bool = False) -> tuple[Damped, FrfUpdate, np.ndarray]:
    """Draw, test and update one specimen; return (estimate - truth) / sigma as well."""
    rng = np.random.default_rng([2028, seed])
    drawn = damped(rng, theory)
    case, frfs = test_of(drawn, rng, float(10 ** rng.uniform(-3.0, -1.7)))
    result = update_frfs(case, frfs, stages=[drawn.case.names, drawn.names])
    truth = np.concatenate([np.exp(drawn.case.logs), drawn.values])
    pulls = []
    for p, true in zip(result.parameters, truth, strict=True):
        factor = p.factor is not None
        pulls.append(np.log(p.factor / true) * p.value / p.sigma if factor else (p.value - true) / p.sigma)
    return drawn, result, np.array(pulls)


def coverage(seeds: int, *, theory: bool, verbose: bool) -> None:
    """Print how many intervals cover."""
    kinds: dict[str, list[np.ndarray]] = {"mass and stiffness": [], "damping": []}
    lost, unconverged = 0, 0
    for seed in range(seeds):
        try:
            drawn, result, pulls = recovered(seed, theory=theory)
        except EstimationError as error:
            lost += 1
            print(f"{seed}: {error}")
            continue
        known = np.array([p.name not in result.undetermined for p in result.parameters])
        first = len(drawn.case.names)
        for name, part in (("mass and stiffness", slice(first)), ("damping", slice(first, None))):
            kinds[name].append(pulls[part][known[part]])
        unconverged += not result.converged
        if verbose:
            spec, off = drawn.case.spec, " ".join(f"{d:.3f}" for d in result.discrepancy)
            kind = f"{spec.kind} {'clamped' if spec.clamped else 'free'}"
            print(
                f"{seed}: {kind}, off {off}, converged {result.converged}, "
                f"known {known.sum()} of {len(known)}, pulls {' '.join(f'{p:+.1f}' for p in pulls)}",
                flush=True,
            )
    for name, parts in kinds.items():
        pooled = np.concatenate(parts)
        print(
            f"{name}: covered by 95 % intervals {share_text(np.abs(pooled) < 1.96)}, "
            f"median |pull| {np.median(np.abs(pooled)):.2f}"
        )
    pooled = np.concatenate([np.concatenate(parts) for parts in kinds.values()])
    print(
        f"both: {share_text(np.abs(pooled) < 1.96)}; without a result {lost}, not converged {unconverged} of {seeds}"
    )


def plate(logs: np.ndarray) -> Spec:
    """Return the plate of 760 elements with 15 moduli."""
    x, y = 0.376 * np.arange(6) / 5, 0.2 * np.arange(4) / 3
    places = [(i, j) for i in range(5) for j in range(3)]
    regions = tuple(
        Region(f"p{i}{j}", (x[i], x[i + 1]), (y[j], y[j + 1]), E=210e9 * float(np.exp(log)))
        for (i, j), log in zip(places, logs, strict=True)
    )
    damping = Damping(2.0, 2e-6)
    return Spec(
        "plate",
        length=0.376,
        width=0.2,
        thickness=0.003175,
        elements=(38, 20),
        clamped=("x0",),
        theory="kirchhoff",
        material=STEEL,
        regions=regions,
        damping=damping,
    )


def plate_case() -> tuple[Case, MeasuredFrfs, np.ndarray]:
    """Return the plate's test with exact FRFs and 0.1 % noise, and the true logarithms."""
    rng = np.random.default_rng(5)
    logs = 0.03 * rng.standard_normal(15)
    points = np.array([(x, y) for x in np.linspace(0.07, 0.376, 5) for y in np.linspace(0.0, 0.2, 5)])
    test = blank(plate(logs), points, 12)
    there = Predictor(plate(logs), test)
    modes = there.predict(count=12)
    s = 2j * np.pi * np.arange(10.0, 1000.0, 1.0)
    h = there.receptance(s)
    sigma = 1e-3 * np.sqrt(np.mean(np.abs(h * s**2) ** 2, axis=1, keepdims=True)) / np.abs(s**2)
    noise = rng.standard_normal((2, *h.shape)) / np.sqrt(2)
    measured = replace(
        test,
        frequency=modes.frequency,
        frequency_sigma=1e-5 * modes.frequency,
        damping=modes.damping,
        damping_sigma=1e-3 * modes.damping,
        constants=modes.constants,
        constants_sigma=1e-3 * np.abs(modes.constants) + 1e-6,
        repeatability=0.0,
    )
    frfs = MeasuredFrfs(s, h + sigma * (noise[0] + 1j * noise[1]), sigma**2 + 0 * h.real, test.seen, test.hit)
    case = Case(
        "plate", plate(np.zeros(15)), measured, baseline=None, tolerances=Tolerances({"E": TOLERANCE})
    )
    return case, frfs, logs


def resolved(case: Case, frfs: MeasuredFrfs, *, steps: int = 20) -> tuple[np.ndarray, int]:
    """Take Gauss and Newton's steps with every line of the full model factorised anew; return logarithms and steps."""
    structure = build_structure(case.spec)
    free = structure.free()
    rows = structure.rows(case.measured.points, None)["w"].toarray()[:, free]
    mass = structure.matrix("mass")[free][:, free].tocsc()
    whole = structure.matrix("stiffness")[free][:, free].tocsc()
    parts = [region_stiffness(case.spec, i)[free][:, free].tocsc() for i in range(15)]
    damping = case.spec.damping
    logs, scale = np.zeros(15), 1 / np.sqrt(frfs.variance)
    done = 0
    while done < steps:
        done += 1
        stiffness = whole + sum((np.exp(x) - 1) * part for x, part in zip(logs, parts, strict=True))
        residual, slopes = [], []
        for k, s in enumerate(frfs.laplace):
            z = (s**2 + s * damping.alpha) * mass + (1 + s * damping.beta) * stiffness
            states = splu(z.tocsc()).solve(rows.T.astype(complex))
            hit, seen = states[:, frfs.hit], states[:, frfs.seen[0]]
            residual.append((frfs.values[:, k] - rows[frfs.hit] @ seen) * scale[:, k])
            by = [
                -(1 + s * damping.beta) * np.exp(x) * (hit.T @ (p @ seen))
                for x, p in zip(logs, parts, strict=True)
            ]
            slopes.append(np.stack(by, axis=1) * scale[:, k, None])
        matrix, load = np.concatenate(slopes), np.concatenate(residual)
        both = np.vstack([matrix.real, matrix.imag]), np.concatenate([load.real, load.imag])
        move = np.clip(np.linalg.lstsq(*both, rcond=None)[0], -0.3, 0.3)
        logs = logs + move
        if np.abs(move).max() < 1e-6:
            break
    return logs, done


def region_stiffness(spec: Spec, index: int) -> object:
    """Return the stiffness matrix of one region, by difference of two models."""
    regions = tuple(replace(r, E=2 * r.E) if i == index else r for i, r in enumerate(spec.regions))
    more = build_structure(replace(spec, regions=regions)).matrix("stiffness")
    return more - build_structure(spec).matrix("stiffness")


def race() -> None:
    """Print the plate's times."""
    case, frfs, logs = plate_case()
    names = [f"{r.name}.E" for r in case.spec.regions]
    start = process_time()
    result = update_frfs(case, frfs, parameters=names)
    ours = process_time() - start
    used = np.searchsorted(frfs.frequency, np.array(result.lines[0]) - 1e-6)
    start = process_time()
    theirs_logs, steps = resolved(case, frfs.lines(used))
    theirs = process_time() - start
    found = np.array([np.log(p.factor or np.nan) for p in result.parameters])
    predictor = Predictor(case.spec, case.measured)
    matrices, rows = predictor.matrices(result.state), predictor.point_rows(result.state)
    start = process_time()
    for _ in range(5):
        answers(matrices, rows.T, frfs.laplace[used])
    floor = (process_time() - start) / 5 * result.iterations
    print(
        f"one update of the plate by FRFs: {ours:.2f} s ({result.iterations} iterations, {len(used)} lines), "
        f"re-solution {theirs:.1f} s ({steps} steps), ratio {theirs / ours:.1f}; floor {floor:.2f} s; "
        f"largest error of a modulus {100 * np.abs(found - logs).max():.3f} %, "
        f"re-solution {100 * np.abs(theirs_logs - logs).max():.3f} %"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--seeds", type=int, default=36)
    parser.add_argument("--timoshenko", action="store_true", help="true beams shear; the models do not")
    parser.add_argument("--verbose", action="store_true")
    parser.add_argument("--no-race", action="store_true")
    chosen = parser.parse_args()
    if chosen.seeds:
        coverage(chosen.seeds, theory=chosen.timoshenko, verbose=chosen.verbose)
    if not chosen.no_race:
        race()


if __name__ == "__main__":
    main()
