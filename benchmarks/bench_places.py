"""One body, soft spot, spring or layer at place after place of a bar: is it found where it is, and by its own name?

    python benchmarks/bench_places.py                              # body, free and clamped: 18 and 16 diagnoses
    python benchmarks/bench_places.py --effects local_stiffness --held free

A bar of aluminium 0.8 m long is simulated as `modalkit simulate` does it, hit at 12 points from 20 to 1400 Hz; the
effect stands at nine places, in two sizes (for a body: 50 g with rotary inertia, 10 g without). Each test is diagnosed
with the whole library. Where the effect changes nothing, as a soft spot at a free end, `none` is the right answer.
"""

from __future__ import annotations

import argparse
import tempfile
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from threadpoolctl import threadpool_limits

from modalkit.simulation.setup import Options
from modalkit.simulation.simulate import simulate_test
from modalkit.study.named_effects import parse_effect
from modalkit.study.read import read_study
from modalkit.workflow.diagnosis import diagnose_studies
from updating import LIBRARY

PLACES = (0.0, 0.05, 0.13, 0.2, 0.3, 0.338, 0.5, 0.615, 0.7)
SIZES = {
    "lumped_mass": ("mass=50g,x={x},bulk=4", "mass=10g,x={x}"),
    "local_stiffness": ("x={x},extent=0.04,loss=0.5", "x={x},extent=0.08,loss=0.25"),
    "ground_spring": ("x={x},stiffness=2e4", "x={x},stiffness=2e5"),
    "local_mass": ("x={x},extent=0.1,mass=50g", "x={x},extent=0.2,mass=20g"),
}
HELD = {"free": "[]", "clamped": '["x0"]'}
STUDY = """title = "Bar, {held}"
[test]
band = [{low}, 1400.0]
[model]
type = "beam"
length = 0.8
width = 0.04
thickness = 0.008
elements = 40
clamped = {clamped}
theory = "euler-bernoulli"
[model.material]
E = 70e9
density = 2700.0
poisson = 0.33
"""


@dataclass(frozen=True)
class Job:
    """One diagnosis.

    Parameters
    ----------
    held : str
        ``free`` or ``clamped``.
    effect : str
        Its name.
    size : int
        Which of its sizes.
    place : float
        Where it stands [m].
    """

    held: str
    effect: str
    size: int
    place: float

    @property
    def values(self) -> str:
        """The effect as the command line takes it."""
        return f"{self.effect}:{SIZES[self.effect][self.size].format(x=self.place)}"


def jobs(held: list[str], effects: list[str]) -> Iterator[Job]:
    """Yield what is asked for; a clamped root holds nothing that could be moved."""
    for end in held:
        for effect in effects:
            for size in range(len(SIZES[effect])):
                for place in PLACES:
                    if place > 0 or end == "free":
                        yield Job(end, effect, size, place)


def run(job: Job, seed: int) -> str:
    """Simulate and diagnose; return the answer in a line."""
    with tempfile.TemporaryDirectory(prefix="place-") as temporary, threadpool_limits(1):
        study = Path(temporary) / "study.toml"
        text = STUDY.format(held=job.held, low=20 if job.held == "free" else 5, clamped=HELD[job.held])
        study.write_text(text, encoding="utf-8")
        effect = parse_effect(job.values, "beam", LIBRARY)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            made = simulate_test(read_study(study), [effect], seed=seed, options=Options(points=12))
            made.write(Path(temporary) / "bar.uff")
            study.write_text(text.replace("[test]", '[test]\nfiles = ["bar.uff"]'), encoding="utf-8")
            found = diagnose_studies([study])
    sets = ", ".join(" + ".join(names) for names in found.sets)
    sizes = [
        f"{name} = {one.value:.4g} ({one.low95:.4g} to {one.high95:.4g}) {one.unit}"
        for row in found.ranking[:1]
        for name, one in row.parameters.items()
        if isinstance(one.value, float) and one.low95 is not None and one.high95 is not None
    ]
    return f"{job.held}, {job.values}: {found.verdict} {sets}; {'; '.join(sizes)}"


def main() -> None:
    """Print a line for each diagnosis as it ends."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--effects", nargs="+", choices=list(SIZES), default=["lumped_mass"])
    parser.add_argument("--held", nargs="+", choices=list(HELD), default=list(HELD))
    parser.add_argument("--seed", type=int, default=100)
    parser.add_argument("--workers", type=int, default=1)
    given = parser.parse_args()
    with get_context("fork").Pool(given.workers, maxtasksperchild=1) as pool:
        for line in pool.imap(partial(run, seed=given.seed), jobs(given.held, given.effects)):
            print(line, flush=True)


if __name__ == "__main__":
    main()
