"""Speed of one diagnosis of a plate: modalkit beside plain eigen-solutions of the full model, and the floor.

python benchmarks/bench_diagnosis_speed.py              a simulated test of the plate whose root is soft
python benchmarks/bench_diagnosis_speed.py --single     one effect is enough: no pairs are needed

The plate has 760 elements and 15 regions; 12 modes at 20 points are measured, with absolute level. The whole library
is weighed, pairs as well where no single effect explains the data, and the bootstrap is taken. The peer would take the
same number of evaluations, each by ``eigsh`` with shift and invert of the full model, matrices ready; some are timed
and the rest is extrapolated. It would still have to assemble what each effect adds, which is not charged to it. The
floor is the dense eigenproblems of the reduced basis that were solved, and nothing else.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from typing import Any
from unittest import mock

import numpy as np
from diagnosis.body import Body
from diagnosis.hidden import CAUSES, Scene
from diagnosis.observe import draw_marks, measure
from diagnosis.solve import solve
from diagnosis.specimen import Rig, Specimen
from scipy import linalg
from scipy.sparse import linalg as sparse_linalg

from updating import Case, Environment, Material, Spec, Tolerances, build_structure
from updating.diagnosis.diagnose import diagnose
from updating.models.reduced import Reduced
from updating.models.spec import Damping

TIMED = 12


def plate_case(*, single: bool) -> Case:
    """Return a test of the plate with a soft place at its root, and a calibration that is off as well."""
    rng = np.random.default_rng(4)
    spec = Spec(
        "plate", length=0.376, width=0.2, thickness=0.002, elements=(38, 20), clamped=("x0",),
        theory="kirchhoff", material=Material(210e9, 7850.0, 0.3), damping=Damping(1.0, 5e-7),
    )  # fmt: skip
    body = Body("plate", 0.376, 0.2, 0.002, 211e9, 7850.0, 0.3, ("x0",))
    x, y = np.meshgrid([0.08, 0.15, 0.22, 0.3, 0.37], [0.005, 0.07, 0.13, 0.195], indexing="ij")
    rig = Rig(
        np.stack([x.ravel(), y.ravel()], axis=1), 19, 12, absolute=True, baseline=False, noise=0.01,
        frequency_noise=2e-4, damping_noise=0.05, calibration=0.02, repeatability=0.001, position_sigma=0.001,
        remounted_damping=0.05, level=50.0, span=1.3,
    )  # fmt: skip
    doubts = Tolerances({"E": 0.01, "density": 0.003, "thickness": 0.005, "length": 0.002, "width": 0.002})
    specimen = Specimen(spec, doubts, Environment(), body, np.ones(60), rig)
    soft = {"x": 0.06, "y": 0.05, "extent": 0.05, "loss": 0.7}
    scene = CAUSES["local_stiffness"].act(Scene(specimen), soft)
    if not single:
        scene = CAUSES["calibration_gain"].act(scene, {"gain": 0.7})
    marks = draw_marks(rng, rig)
    test = measure(scene.specimen, solve(scene.specimen.body), scene.faults, marks, rng, np.ones(60))
    return Case("plate", spec, test, baseline=None, tolerances=doubts)


def counted(case: Case) -> tuple[Any, tuple[float, float], Counter[int]]:
    """Return the diagnosis, its time by clock and processor [s], and its eigenproblems by size."""
    sizes: Counter[int] = Counter()
    plain = Reduced.eigen

    def counting(model: Reduced, state: Any) -> tuple[Any, Any]:
        values, vectors = plain(model, state)
        sizes[len(values)] += 1
        return values, vectors

    with mock.patch.object(Reduced, "eigen", counting):
        clock, start = time.perf_counter(), time.process_time()
        found = diagnose(case)
        taken = time.perf_counter() - clock, time.process_time() - start
    return found, taken, sizes


def full_solution(case: Case) -> float:
    """Return the processor time of one solution of the full model for as many modes as one evaluation needs [s]."""
    structure = build_structure(case.spec)
    free = structure.free()
    stiffness = structure.matrix("stiffness")[free][:, free].tocsc()
    mass = structure.matrix("mass")[free][:, free].tocsc()
    count = len(case.measured.frequency) + 3
    times = []
    for i in range(TIMED):
        changed = stiffness * (1 + 0.01 * i)
        start = time.process_time()
        sparse_linalg.eigsh(changed, count, mass, sigma=0.0, v0=np.ones(mass.shape[0]))
        times.append(time.process_time() - start)
    return float(np.median(times))


def dense_solution(size: int) -> float:
    """Return the processor time of one dense generalised eigenproblem [s]."""
    rng = np.random.default_rng(1)
    basis = rng.standard_normal((size, size))
    stiffness, mass = basis @ basis.T, np.eye(size) + 0.01 * (basis + basis.T) / np.sqrt(size)
    times = []
    for _ in range(TIMED):
        start = time.process_time()
        linalg.eigh(stiffness, mass)
        times.append(time.process_time() - start)
    return float(np.median(times))


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--single", action="store_true", help="one effect is hidden, and no pair is needed")
    chosen = parser.parse_args()
    case = plate_case(single=chosen.single)
    found, (clock, taken), sizes = counted(case)
    number = sum(sizes.values())
    full = full_solution(case)
    least = sum(count * dense_solution(size) for size, count in sizes.items())
    print(f"answer: {found.verdict} {found.sets}; {len(found.ranking)} sets of effects weighed")
    print(
        f"one diagnosis: {clock:.1f} s, of a processor {taken:.1f} s, {number} evaluations of {dict(sizes)} unknowns"
    )
    print(
        f"full model: {1000 * full:.0f} ms an evaluation, so {full * number:.0f} s; ratio {full * number / taken:.0f}"
    )
    print(f"floor of the dense eigenproblems: {least:.1f} s; we take {taken / least:.1f} times that")


if __name__ == "__main__":
    main()
