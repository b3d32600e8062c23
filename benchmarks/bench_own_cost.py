"""The diagnosis and the update of one's own model, as its size, its regions and the test's points grow.

python benchmarks/bench_own_cost.py                       all rows: half an hour of a core of its own
python benchmarks/bench_own_cost.py regions               one factor: dofs, regions or points
python benchmarks/bench_own_cost.py --one 3000 20 60      one row; --profile FILE beside it writes where the time goes

An angle of sheet metal, held along one edge: a grid of bars as fine as asked for, the regions patches of it. One patch
has lost a quarter of its stiffness, which the model does not know. One accelerometer, three hits at every point, whose
places are doubted by half a millimetre, ten modes. One factor is varied at a time from a base of 3 060 degrees of
freedom, 20 regions and 60 points; each row in a process of its own. Seconds are CPU time of one thread: `identify` from
hits to modes, `pair` with the model and its reduction, `search` of the effects, `held out` modes and points, `next`
test, and an `update` of the modulus of every region by frequencies and shapes. Memory is the most of the whole process.
"""

from __future__ import annotations

import argparse
import cProfile
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import eigsh

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "examples" / "matrices"))

from bars import Section, Structure, rows_of  # noqa: E402

LENGTH, WIDTH, SHEET = 0.6, 0.3, 0.004
"""Of the sheet before it is folded in the middle, and its thickness [m]."""

MESHES = {1000: (20, 8), 3000: (30, 16), 10000: (60, 28), 30000: (100, 48), 100000: (180, 96)}
"""Bars along and across the sheet, by the degrees of freedom asked for."""

PATCHES = {5: (5, 1), 20: (5, 4), 80: (10, 8)}
"""Along and across, by the regions asked for."""

BASE = {"dofs": 3000, "regions": 20, "points": 60}
ROWS = {"dofs": (1000, 3000, 10000, 30000, 100000), "regions": (5, 20, 80), "points": (5, 60, 200)}
LOSS, MODES, REMOUNTING, POSITION = 0.25, 10, 2e-4, 5e-4
"""Of the patch's stiffness; of the band; of the frequencies, relative; and doubt in the place of a point [m]."""


def angle(mesh: tuple[int, int], patches: tuple[int, int]) -> tuple[Structure, np.ndarray]:
    """Return the angle, and the numbers of its nodes along and across the sheet."""
    made = Structure()
    along, across = np.linspace(0, LENGTH, mesh[0] + 1), np.linspace(0, WIDTH, mesh[1] + 1)
    half = LENGTH / 2
    number = np.array(
        [
            [made.node((float(min(s, half)), float(y), float(max(s - half, 0.0)))) for y in across]
            for s in along
        ]
    )
    made.held.update(int(n) for n in number[0])

    def lay(
        a: tuple[int, int], b: tuple[int, int], section: Section, second: tuple[float, float, float]
    ) -> None:
        i = min((a[0] + b[0]) * patches[0] // (2 * mesh[0]), patches[0] - 1)
        j = min((a[1] + b[1]) * patches[1] // (2 * mesh[1]), patches[1] - 1)
        made.bar(f"patch_{i + 1}_{j + 1}", (int(number[a]), int(number[b])), section, 1, second)

    steps = LENGTH / mesh[0], WIDTH / mesh[1]
    for i in range(mesh[0] + 1):  # of the mass, half lies in the bars along, half in those across
        for j in range(mesh[1] + 1):
            flat = i + 0.5 < mesh[0] / 2
            if i < mesh[0]:
                lay((i, j), (i + 1, j), Section(steps[1], SHEET, density=3925.0), (0.0, 1.0, 0.0))
            if j < mesh[1]:
                second = (1.0, 0.0, 0.0) if flat else (0.0, 0.0, 1.0)
                lay((i, j), (i, j + 1), Section(steps[0], SHEET, density=3925.0), second)
    return made, number


def assembled(made: Structure, kind: str, parts: list[str]) -> sparse.csr_array:
    """Return stiffness or mass of some parts over the free rows, without a full matrix on the way [SI]."""
    elements = [e for part in parts for e in getattr(made, kind).get(part, ())]
    rows = np.array([rows for rows, _ in elements])
    values = np.array([matrix for _, matrix in elements])
    size = rows.shape[1]
    row_of = np.full(6 * len(made.places), -1)
    row_of[made.free] = np.arange(len(made.free))
    i, j = row_of[np.repeat(rows, size)], row_of[np.tile(rows, (1, size)).ravel()]
    free = (i >= 0) & (j >= 0)
    n = len(made.free)
    return sparse.csr_array(sparse.coo_array((values.ravel()[free], (i[free], j[free])), (n, n)))


def case_of(dofs: int, regions: int, points: int):
    """Return model and FRFs of the test: what the diagnosis starts from."""
    from acquisition import Dof, Geometry, HammerPlan, estimate_frfs, hammer_test
    from acquisition.synthetic import modal_system
    from updating import Material, Spec
    from updating.models import Region
    from updating.models.imported import Imported, NodeTable

    rng = np.random.default_rng([dofs, regions, points])
    made, number = angle(MESHES[dofs], PATCHES[regions])
    parts = made.parts
    k, m = ([assembled(made, kind, [part]) for part in parts] for kind in ("stiffness", "mass"))
    whole = sum(k[1:], k[0]), sum(m[1:], m[0])
    soft = len(parts) // 3
    values, vectors = eigsh((whole[0] - LOSS * k[soft]).tocsc(), MODES + 8, whole[1].tocsc(), sigma=0.0)
    frequency = np.sqrt(np.sort(values)) / (2 * np.pi) * (1 + REMOUNTING * rng.standard_normal(len(values)))
    vectors = vectors[:, np.argsort(values)]

    nodes = rng.choice(number[1:].ravel(), points, replace=False)
    at = np.array(made.places)
    codes = np.where(at[nodes - 1, 2] > 0, 1, 3)
    row_of = {row: i for i, row in enumerate(made.free)}
    shapes = vectors[[row_of[rows_of(int(n))[c - 1]] for n, c in zip(nodes, codes, strict=True)]]
    sensor = int(np.argmax(np.min(np.abs(shapes[:, :MODES]), axis=1)))
    dof = [Dof(i + 1, int(code)) for i, code in enumerate(codes)]
    system = modal_system(
        frequency=frequency, damping=np.full(len(frequency), 0.004), response_shapes=shapes[[sensor]],
        point_shapes=shapes, responses=[dof[sensor]], points=dof,
    )  # fmt: skip
    top = 0.5 * (frequency[MODES - 1] + frequency[MODES])
    rate, samples = 3.4 * top, 4096
    plan = HammerPlan(
        rate=rate, samples=samples, hits=3, width=0.7 / top, force_noise=0.01, response_noise=1e-3,
        decay=2.0 * np.pi * rate / samples, pre_trigger=0.01 * samples / rate,
    )  # fmt: skip
    geometry = Geometry(tuple(range(1, points + 1)), at[nodes - 1])
    frfs = estimate_frfs(hammer_test(system, plan, rng=rng, geometry=geometry))

    held = np.array(made.places)
    count = len(held)
    rows = np.full(6 * count, -1)
    rows[made.free] = np.arange(len(made.free))
    numbers = np.repeat(np.arange(1, count + 1), 6)
    table = NodeTable(numbers, held[numbers - 1], np.tile(np.arange(1, 7), count), rows)
    imported = Imported(*whole, table, tuple(k), tuple(m))
    places = tuple(Region(name, (0.0, 1.0), (0.0, 1.0)) for name in parts)
    spec = Spec(
        "matrices",
        length=LENGTH / 2,
        width=WIDTH,
        thickness=LENGTH / 2,
        elements=(),
        clamped=(),
        theory="imported",
        material=Material(1.0, 1.0),
        regions=places,
        imported=imported,
    )
    return spec, frfs, (0.6 * frequency[0], top), parts[soft]


STAGES = {
    "pairing the modes": "pair",
    "comparing the effects": "search",
    "predicting modes held out": "held out",
    "choosing the next test": "next",
}


def measure(dofs: int, regions: int, points: int, profile: Path | None = None) -> dict[str, object]:
    """Diagnose and update one structure; return what each step takes [s], the answer and the most memory [GB]."""
    from identification import identify
    from updating import Axes, Case, Tolerances, diagnose, measured_from_identified
    from updating.update import update

    spec, frfs, band, soft = case_of(dofs, regions, points)
    found: dict[str, object] = {
        "dofs": spec.imported.stiffness.shape[0],
        "regions": regions,
        "points": points,
    }
    began, name = time.process_time(), "identify"

    def next_step(following: str) -> None:
        nonlocal began, name
        found[name] = float(found.get(name, 0.0)) + time.process_time() - began
        print(f"{name} {found[name]:.1f}", end=" ", file=sys.stderr, flush=True)
        began, name = time.process_time(), STAGES.get(following, following)

    model = identify(frfs, band=band)
    test = measured_from_identified(model, Axes(), spec, repeatability=REMOUNTING, position_sigma=POSITION)
    next_step("pair")
    profiler = cProfile.Profile()
    with profiler if profile else open(os.devnull):  # noqa: PTH123
        answer = diagnose(Case("angle", spec, test), progress=next_step)
        next_step("update")
        doubts = Tolerances({"E": 0.01, "density": 0.003})
        case = Case("angle", spec, test, baseline=None, tolerances=doubts)
        names = [f"{region.name}.E" for region in spec.regions]
        updated = update(case, parameters=names, data=("frequencies", "shapes"))
        next_step("end")
    if profile:
        profiler.dump_stats(profile)
    found["diagnosis"] = sum(float(found[stage]) for stage in STAGES.values())
    row = answer.ranking[0] if answer.ranking else None
    where = row.forms[0].get("region", "") if row is not None and row.forms else ""
    right = answer.verdict == "named" and where == soft and row.effects == ("local_stiffness",)
    found["answer"] = (
        "right" if right else f"{answer.verdict}: {' + '.join(row.effects) if row else ''} {where}"
    )
    found["modes"] = len(test.frequency)
    found["iterations"] = updated.iterations
    found["memory"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    return found


COLUMNS = (
    ("dofs", "{:7.0f}"), ("regions", "{:7.0f}"), ("points", "{:6.0f}"), ("modes", "{:5.0f}"), ("identify", "{:8.1f}"),
    ("pair", "{:6.1f}"), ("search", "{:7.1f}"), ("held out", "{:8.1f}"), ("next", "{:6.1f}"),
    ("diagnosis", "{:9.1f}"), ("update", "{:6.1f}"), ("memory", "{:6.2f}"), ("answer", "{}"),
)  # fmt: skip


def run(values: dict[str, int]) -> dict[str, object]:
    """Measure one row in a process of its own."""
    ran = subprocess.run(
        [sys.executable, __file__, "--one", *(str(values[name]) for name in BASE)], check=True,
        stdout=subprocess.PIPE, text=True,
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    print(file=sys.stderr)
    return json.loads(ran.stdout.splitlines()[-1])


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("factors", nargs="*", choices=[*ROWS, []])
    parser.add_argument("--one", nargs=3, type=int, metavar=("DOFS", "REGIONS", "POINTS"))
    parser.add_argument("--profile", type=Path)
    parser.add_argument("--largest", type=int, default=100000, help="leave out more degrees of freedom")
    chosen = parser.parse_args()
    if chosen.one:
        print(json.dumps(measure(*chosen.one, chosen.profile)))
        return
    print(" ".join(name.rjust(len(form.format(0))) for name, form in COLUMNS))
    for factor in chosen.factors or ROWS:
        rows = []
        for value in ROWS[factor]:
            if factor == "dofs" and value > chosen.largest:
                continue
            rows.append(run(BASE | {factor: value}))
            print(" ".join(form.format(rows[-1][name]) for name, form in COLUMNS), flush=True)
        size = np.log([float(row[factor]) for row in rows[-2:]])
        grown = {
            name: np.diff(np.log([float(row[name]) for row in rows[-2:]]))[0] / np.diff(size)[0]
            for name in ("identify", *STAGES.values(), "diagnosis", "update", "memory")
        }
        powers = ", ".join(f"{name} {power:.1f}" for name, power in grown.items())
        print(f"grow with the power of {factor}, between the last two: {powers}", flush=True)


if __name__ == "__main__":
    main()
