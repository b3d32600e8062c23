"""What a forecast expects of changes hidden in the structures of `examples/matrices`, and what the diagnosis answers.

    python benchmarks/bench_forecast.py [frame|machine] [SHARE ...]

Each change of `bench_structures.py` with one cause is made in the bars themselves, as large as there and at shares of
it; the specimen, all stiffness and mass of which scatter as the study's tolerances say, is hit, and the study, which
does not hold the change, diagnosed. The forecast is that of the study's test before any of this.
"""

from __future__ import annotations

import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from bench_structures import SCATTER, STRUCTURES, fits
from hits import hit

from modalkit.planning import DesignForecast
from modalkit.planning.own import bench_of
from modalkit.planning.separability import NONE, SEEN, SURE, Distances, at_severity, distances
from modalkit.study.read import read_study
from modalkit.workflow.diagnosis import diagnose_studies
from updating import Diagnosis

SHARES = (1.0, 0.1, 0.03, 0.01)
"""Sizes, of the changes of `bench_structures.py` [-]."""

SEEDS = {"frame": 5, "machine": 7}


@dataclass(frozen=True)
class Hiding:
    """A change of the bars, and its family and severity in the forecast.

    Parameters
    ----------
    family : str
        As the forecast lists it.
    q : float
        Its severity [SI].
    answer : tuple of (effect, place, parameter, value)
        What a right answer says.
    stiffness, mass, turned : mapping
        Factors on parts, and on the turning of joints.
    """

    family: str
    q: float
    answer: tuple[str, str, str, float]
    stiffness: Mapping[str, float]
    mass: Mapping[str, float]
    turned: Mapping[str, float]


def hidings(name: str, share: float) -> Iterator[Hiding]:
    """Give the single changes of regions and joints at a share of their size (of the logarithm of the factor)."""
    for one in STRUCTURES[name][3]:
        if len(one.answers) > 1 or one.further is not None:
            continue
        effect, place, parameter, _ = one.answers[0]
        (factor,) = {*one.stiffness.values(), *one.mass.values(), *one.turned.values()}
        log = share * float(np.log(factor))
        less = float(np.exp(log))
        value = {"local_stiffness": 1 - less, "local_mass": less, "joint": less}[effect]
        family = f"joint {place} turns" if effect == "joint" else f"{effect} of {place}"
        yield Hiding(
            family, log if effect == "local_mass" else -log, (effect, place, parameter, value),
            dict.fromkeys(one.stiffness, less), dict.fromkeys(one.mass, less), dict.fromkeys(one.turned, less),
        )  # fmt: skip


def expected(found: Distances, q: float) -> tuple[str, float, str]:
    """Return what a diagnosis is expected to answer at a severity, by how many sigma, and the nearest rival."""
    sigma = at_severity(found.curve.family.grid, found.sigma[:, 0], q)
    seen = float(sigma[found.rivals.index(NONE)])
    if seen < SEEN:
        return "none", seen, NONE
    others = [i for i in found.unequal if found.rivals[i] != NONE]
    nearest = min(others, key=lambda i: sigma[i])
    kind = "named" if sigma[nearest] >= SURE else "edge" if sigma[nearest] >= SEEN else "class"
    return kind, float(sigma[nearest]), found.rivals[nearest]


def answered(diagnosis: Diagnosis, hiding: Hiding, also: Mapping[str, str]) -> str:
    """Return none, named, class, unknown or wrong, the place counted in."""
    if diagnosis.verdict in ("none", "unknown"):
        return diagnosis.verdict
    hidden = type("One", (), {"also": also})()
    for names in diagnosis.sets:
        row = next(row for row in diagnosis.ranking if row.effects == names)
        if len(names) == 1 and fits(names[0], row.forms[0], row.of(names[0]), hiding.answer, hidden):
            return "named" if len(diagnosis.sets) == 1 else "class"
    return "wrong"


def run(name: str, now: DesignForecast, hiding: Hiding, folder: Path, seed: list[int]) -> tuple[str, str]:
    """Hide a change, hit, diagnose; write a line, and return what was expected and what was answered."""
    make, build, points, _ = STRUCTURES[name]
    study = make(folder)
    nominal, sets = build()
    (folder / "nodes.csv").write_text(nominal.table(sets), encoding="ascii")
    rng = np.random.default_rng(seed)
    specimen, _ = build(hiding.turned or None)
    factors = 1 + np.array(SCATTER) * rng.standard_normal(2)
    pair = (
        specimen.matrix(
            "stiffness", factors={p: factors[0] * hiding.stiffness.get(p, 1.0) for p in specimen.parts}
        ),
        specimen.matrix("mass", factors={p: factors[1] * hiding.mass.get(p, 1.0) for p in specimen.parts}),
    )
    hit(folder / "hits.uff", specimen, *pair, points, rate=2048.0, rng=rng)
    found = now.found[now.names.index(hiding.family)]
    kind, sigma, rival = expected(found, hiding.q)
    also = {"joint": hiding.answer[1].replace("_", " ") + " is loose"}
    diagnosis = diagnose_studies([study])
    what = answered(diagnosis, hiding, also)
    sets = " | ".join(" + ".join(names) for names in diagnosis.sets[:3]) or diagnosis.verdict
    size = found.curve.family.amount(hiding.q)
    cells = (name, hiding.family, size, f"{kind} ({sigma:.1f} to {rival})", what, sets.replace("|", "/"))
    sys.stdout.write(f"| {' | '.join(cells)} |\n")
    sys.stdout.flush()
    return kind, what


def main() -> None:
    """Run all changes at all sizes, or those asked for, and count."""
    chosen = [a for a in sys.argv[1:] if a in STRUCTURES] or list(STRUCTURES)
    shares = [float(a) for a in sys.argv[1:] if a not in STRUCTURES] or SHARES
    counts: Counter[tuple[str, str]] = Counter()
    sys.stdout.write("| specimen | hidden | size | forecast | answer | set |\n|---|---|---|---|---|---|\n")
    for name in chosen:
        with tempfile.TemporaryDirectory() as folder:
            study = STRUCTURES[name][0](Path(folder))
            nominal, sets = STRUCTURES[name][1]()
            (Path(folder) / "nodes.csv").write_text(nominal.table(sets), encoding="ascii")
            bench = bench_of(read_study(study))
            asked = {hiding.family for hiding in hidings(name, 1.0)}
            now = DesignForecast(
                bench.design, distances([bench.solve(f) for f in bench.families], bench.design, bench)
            )
        assert asked <= set(now.names)
        for i, share in enumerate(shares):
            for k, hiding in enumerate(hidings(name, share)):
                with tempfile.TemporaryDirectory() as folder:
                    counts[run(name, now, hiding, Path(folder), [SEEDS[name], i, k])] += 1
    sys.stdout.write("\n| forecast | answers |\n|---|---|\n")
    for kind in ("named", "edge", "class", "none"):
        mine = {what: n for (own, what), n in counts.items() if own == kind}
        if mine:
            sys.stdout.write(f"| {kind} | {', '.join(f'{n} {what}' for what, n in sorted(mine.items()))} |\n")


if __name__ == "__main__":
    main()
