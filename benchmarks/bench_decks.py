"""A deck as a model, as its size grows: what CalculiX, the factor, the modes and the reduced basis take.

python benchmarks/bench_decks.py                 1 200 to 25 000 degrees of freedom: two minutes
python benchmarks/bench_decks.py 2 4 6 10        up to 107 000: ten minutes more, 9 GB

A block of 4 n x 2 n x n bricks (C3D20R) in four regions, twelve test points; each size in a process of its own, nothing
kept from earlier runs. Seconds are CPU time, of CalculiX and modalkit, one thread; memory is the larger of the two.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

SIZE = (0.4, 0.2, 0.1)
POINTS = 12
ROOT = Path(__file__).resolve().parents[1]


def deck(n: int) -> str:
    """Return the deck of a block [SI]."""
    sys.path.insert(0, str(ROOT / "examples" / "deck"))
    from bricks import brick_deck

    counts = (4 * n, 2 * n, n)
    lines = tuple(
        np.linspace(0.0, side, count + 1).tolist() for side, count in zip(SIZE, counts, strict=True)
    )
    cards: list[str] = brick_deck(
        lines, lambda x, y, z: f"R{int(4 * x / SIZE[0])}", {"CLAMP": lambda x, y, z: x == 0.0}
    )
    cards += ["*MATERIAL, NAME=STEEL", "*ELASTIC", "210e9, 0.3", "*DENSITY", "7850."]
    cards += [f"*SOLID SECTION, ELSET=R{i}, MATERIAL=STEEL" for i in range(4)]
    return "\n".join([*cards, "*BOUNDARY", "CLAMP, 1, 3"]) + "\n"


def spent() -> float:
    """Return the CPU time of this process and of those it has run [s]."""
    return time.process_time() + sum(resource.getrusage(resource.RUSAGE_CHILDREN)[:2])


def measure(n: int) -> dict[str, float]:
    """Read a block of one size and reduce it; return what each step takes [s], and the most memory [GB]."""
    from updating.models import Material, Spec, build_structure
    from updating.models.imported.decks import read_deck_model
    from updating.models.imported.of_deck import imported as made_of
    from updating.models.parts import Region
    from updating.models.reduction import reduce_structure
    from updating.models.state import State

    found: dict[str, float] = {}
    started = spent()

    def step(name: str) -> None:
        nonlocal started
        found[name] = spent() - started
        print(f"{name} {found[name]:.1f}", end=" ", file=sys.stderr, flush=True)
        started = spent()

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "block.inp")
        path.write_text(deck(n), encoding="ascii")
        started = spent()
        model = read_deck_model(path)
        found["dofs"] = len(model.base.node)
        step("whole")
        imported = made_of(model)
        step("parts")
    regions = tuple(Region(r.name, (0.0, 1.0)) for r in model.division.regions)
    structure = build_structure(
        Spec(
            "matrices",
            length=SIZE[0],
            width=SIZE[1],
            thickness=SIZE[2],
            elements=(),
            clamped=(),
            theory="imported",
            material=Material(1.0, 1.0),
            regions=regions,
            imported=imported,
        )
    )
    structure.solve(np.ones((structure.n_dofs, 1)), 0.0)
    step("factor")
    rng = np.random.default_rng(1)
    points = np.column_stack(
        [rng.uniform(0.05, SIZE[0], POINTS), rng.uniform(0, SIZE[1], POINTS), np.full(POINTS, SIZE[2])]
    )
    reduced = reduce_structure(structure, points, None, modes=40)
    step("reduce")
    state = State(regional={(1, "E"): 0.7, (2, "E"): 1.2})
    stiffness, mass = structure.matrices(state)
    full = structure.eigen(10, stiffness=stiffness, mass=mass)[0]
    step("again")
    small = reduced.eigen(state)[0][:10]
    found["error"] = float(np.abs(np.sqrt(small / full) - 1).max())
    step("once")
    most = [resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return found | {"memory": max(most) / 1e6}


COLUMNS = (
    ("dofs", "unknowns", "{:9.0f}"), ("whole", "ccx", "{:7.1f}"), ("parts", "4 parts", "{:8.1f}"),
    ("factor", "factor", "{:7.1f}"), ("reduce", "modes, basis", "{:13.1f}"), ("again", "solved anew", "{:12.1f}"),
    ("once", "reduced", "{:8.3f}"), ("error", "its error", "{:10.1e}"), ("memory", "GB", "{:5.1f}"),
)  # fmt: skip


def main(sizes: list[int]) -> None:
    """Print a row for each size, and with what power of the size each step grows."""
    widths = [len(form.format(0.0)) for _, _, form in COLUMNS]
    print(" ".join(title.rjust(w) for (_, title, _), w in zip(COLUMNS, widths, strict=True)))
    rows = []
    for n in sizes:
        run = subprocess.run(
            [sys.executable, __file__, "--one", str(n)], check=True, stdout=subprocess.PIPE, text=True,
            env={**os.environ, "MODALKIT_CACHE": "", "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
        )  # fmt: skip
        rows.append(json.loads(run.stdout.splitlines()[-1]))
        print(file=sys.stderr)
        print(" ".join(form.format(rows[-1][name]) for name, _, form in COLUMNS), flush=True)
    if len(rows) > 1:
        size = np.log([row["dofs"] for row in rows[-2:]])
        grown = {
            name: np.diff(np.log([max(row[name], 1e-12) for row in rows[-2:]]))[0] / np.diff(size)[0]
            for name, _, _ in COLUMNS
        }
        print("grow with the power, between the last two: ", end="")
        print(
            ", ".join(
                f"{title} {grown[name]:.1f}" for name, title, _ in COLUMNS if name not in ("dofs", "error")
            )
        )


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(measure(int(sys.argv[2]))))
    else:
        main([int(word) for word in sys.argv[1:]] or [2, 4, 6])
