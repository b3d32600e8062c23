"""The cases in which the diagnosis once failed, made anew on the rig, and judged as blind trials are.

    uv run python benchmarks/bench_cases.py --seeds 3               # some 20 to 30 s a trial on one core
    uv run python benchmarks/bench_cases.py --only tank frame_stiffer --seed 7

Specimen, dimensions, noise and places are drawn from the seed; the study states the nominal body and what its tester
knows, and is diagnosed as `modalkit diagnose` does it. A line for each trial as it ends: the outcome, what is hidden
and by how many sigma the rig's own model sees it, the answer with probabilities and sizes, what it leaves or lacks.
Then a table, beside the answers when the cases were first met (on another simulator).
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
import warnings
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path

import numpy as np
from cases.judge import OUTCOMES, answered, holds, lacking, outcome
from cases.register import CASES
from cases.trial import Case, Trial
from threadpoolctl import threadpool_limits

from acquisition.errors import ModalkitError
from modalkit.workflow.diagnosis import diagnose_studies

Job = tuple[str, int, int]
"""Name of a case, seed, and number of the trial."""


@dataclass(frozen=True)
class Judged:
    """One trial, judged.

    Parameters
    ----------
    case : str
        Its name.
    outcome : str
        One of the outcomes, or ``failed``.
    holds : bool or None
        Whether the intervals hold the hidden sizes; None where there is none to ask.
    seconds : float
        Of the diagnosis [s].
    line : str
        All of it in words.
    """

    case: str
    outcome: str
    holds: bool | None
    seconds: float
    line: str


def run(job: Job, keep: Path | None = None) -> Judged:
    """Make a trial anew, have it diagnosed, and judge the answer."""
    name, seed, index = job
    rng = np.random.default_rng([seed, index, zlib.crc32(name.encode())])
    with tempfile.TemporaryDirectory(prefix="case-") as temporary, threadpool_limits(1):
        folder = keep / f"{name}-{seed}-{index}" if keep else Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        trial = CASES[name].make(rng, folder)
        begin = time.perf_counter()
        kind, held, said = judged(trial)
        seconds = time.perf_counter() - begin
    seen = f", {trial.visible:.0f} sigma" if trial.causes and np.isfinite(trial.visible) else ""
    hidden = f"{name} {seed}.{index}: {kind}. Hidden: {trial.hidden}{seen}"
    sizes = {True: "; intervals hold it", False: "; an interval misses it", None: ""}[held]
    return Judged(name, kind, held, seconds, f"{hidden}. Answer: {said}{sizes} [{seconds:.0f} s]")


def judged(trial: Trial) -> tuple[str, bool | None, str]:
    """Return the outcome, whether the intervals hold the sizes, and the answer in words."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = diagnose_studies([trial.study])
    except (ModalkitError, ArithmeticError, LookupError, TypeError, ValueError) as error:
        return "failed", None, f"{type(error).__name__}: {error}"
    return outcome(found, trial), holds(found, trial), f"{answered(found, trial)}; {lacking(found)}"


def each(jobs: Sequence[Job], workers: int, keep: Path | None) -> Iterator[Judged]:
    """Yield the trials as they end, each from a process of its own, with which goes what it has cached."""
    with get_context("fork").Pool(workers, maxtasksperchild=1) as pool:
        yield from pool.imap_unordered(partial(run, keep=keep), jobs)


def table(found: Sequence[Judged]) -> str:
    """Return a row for each case."""
    heads = ("case", "before", *OUTCOMES, "failed", "interval holds", "mean time")
    lines = [f"| {' | '.join(heads)} |", "|" + "---|" * len(heads)]
    for name, case in CASES.items():
        own = [trial for trial in found if trial.case == name]
        if own:
            lines.append(f"| {' | '.join(row(case, own))} |")
    return "\n".join(lines)


def row(case: Case, own: Sequence[Judged]) -> list[str]:
    """Return the cells of a case: how many of its trials ended how."""
    counts = [sum(trial.outcome == kind for trial in own) for kind in (*OUTCOMES, "failed")]
    asked = [trial.holds for trial in own if trial.holds is not None]
    shares = [f"{n} of {len(own)}" if n else "-" for n in counts]
    held = f"{sum(asked)} of {len(asked)}" if asked else "-"
    return [case.name, case.before, *shares, held, f"{np.mean([t.seconds for t in own]):.0f} s"]


def main() -> None:
    """Run the cases asked for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=list(CASES), metavar="NAME", help=", ".join(CASES))
    parser.add_argument("--seeds", type=int, default=3, help="how many, one after the other")
    parser.add_argument("--seed", type=int, default=1, help="the first")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="folder for studies and tests")
    given = parser.parse_args()
    jobs = [
        (name, seed, index)
        for seed in range(given.seed, given.seed + given.seeds)
        for name in given.only or CASES
        for index in range(CASES[name].each)
    ]
    found = []
    for one in each(jobs, given.workers, given.keep):
        found.append(one)
        print(one.line, flush=True)
    sys.stdout.write(f"\n{table(found)}\n")


if __name__ == "__main__":
    main()
