"""Blind trials: how many a second, from one worker to two, cost beside the floor, and what a million would take.

    uv run python benchmarks/bench_blind.py              # 24 trials each way; some 10 minutes on two cores
    uv run python benchmarks/bench_blind.py --trials 4   # the short form

The *floor* of a trial is what cannot be left out: the simulation of its test, and the diagnosis alone, in a process
that has everything loaded, one after the other on one core. A trial costs more by its draw, its seal, the true
shrinkage, pipes and files. Cold is the diagnosis as a command of its own, which loads modalkit each time.

A million trials on a cluster of N cores takes ``10^6 cost / N``, as long as the scheduler hands tasks out faster
than they end: it takes ``10^6 overhead`` for that alone, whatever N is. Cost is that of one worker, overhead that of
an empty task through the same loop, both measured here.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from modalkit.blind import DrawRanges, diagnosers, draw_trial, run_blind, write_trial
from modalkit.blind.answer import read_answer
from modalkit.blind.shrunk import true_shrinkage
from modalkit.workers.cluster import Ended, connected

CORES = (2, 16, 64, 256, 1024, 4096)


def floor(seed: int, trials: int, plan: DrawRanges) -> dict[str, float]:
    """Seconds per trial of what cannot be left out, and of the rest that is timed alone."""
    spent = dict.fromkeys(("draw", "simulation", "diagnosis", "shrinkage"), 0.0)
    with diagnosers(1) as diagnose, tempfile.TemporaryDirectory() as name:
        for index in range(-1, trials):  # the first is run twice, to load what is loaded late
            folder = Path(name) / str(index + 1)
            folder.mkdir()
            times = [time.perf_counter()]
            trial = draw_trial(seed, max(index, 0), plan=plan)
            times.append(time.perf_counter())
            study = write_trial(trial, folder)
            times.append(time.perf_counter())
            answer = read_answer(diagnose(study, trial.truth.without))
            times.append(time.perf_counter())
            true_shrinkage(trial, answer)
            times.append(time.perf_counter())
            if index >= 0:
                for key, begin, end in zip(spent, times, times[1:], strict=False):
                    spent[key] += (end - begin) / trials
    return spent


def cold_and_warm(seed: int, plan: DrawRanges) -> tuple[float, float]:
    """Seconds of one and the same diagnosis as a command of its own, and in a warm process."""
    with tempfile.TemporaryDirectory() as name, diagnosers(1) as diagnose:
        study = write_trial(draw_trial(seed, 0, plan=plan), Path(name))
        diagnose(study, ())
        times = [time.perf_counter()]
        words = [sys.executable, "-m", "modalkit", "diagnose", study.name, "--json", "d.json"]
        subprocess.run(words, cwd=name, check=True, capture_output=True)
        times.append(time.perf_counter())
        diagnose(study, ())
        times.append(time.perf_counter())
    return times[1] - times[0], times[2] - times[1]


def per_trial(seed: int, trials: int, plan: DrawRanges, workers: int) -> float:
    """Seconds per trial of a run with warm processes."""
    with diagnosers(workers) as diagnose:
        run_blind(workers, seed, plan=plan, diagnose=diagnose, workers=workers)  # until all is loaded
        begin = time.perf_counter()
        run_blind(trials, seed, plan=plan, diagnose=diagnose, workers=workers)
        return (time.perf_counter() - begin) / trials


def nothing(name: str, index: int) -> str:
    """Do nothing, on a cluster, and answer as much as a trial does."""
    return json.dumps({"index": index, "filler": "x" * 12000})


def overhead(tasks: int) -> float:
    """Seconds per empty task on a cluster of two worker processes."""
    from distributed import LocalCluster

    with (
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
        connected(cluster.scheduler_address, command=[sys.executable, "-c", "input()"]) as found,
    ):
        for count in (50, tasks):
            begin = time.perf_counter()
            ended = sum(isinstance(e, Ended) for e in found.happens(nothing, _numbers(count)))
            assert ended == count
        return (time.perf_counter() - begin) / tasks


def _numbers(count: int) -> Sequence[tuple[int]]:
    return [(index,) for index in range(count)]


def million(cost: float, each: float) -> list[Mapping[str, Any]]:
    """Hours for a million trials by the number of cores: work shared among them, or the scheduler, what is longer."""
    return [
        {"cores": n, "hours": max(1e6 * cost / n, 1e6 * each) / 3600, "work": 1e6 * cost / n > 1e6 * each}
        for n in CORES
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", type=int, default=24)
    parser.add_argument("--tasks", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", default="beam,plate")
    given = parser.parse_args()
    plan = DrawRanges(kinds=tuple(given.kinds.split(",")))

    parts = floor(given.seed, given.trials, plan)
    least = parts["simulation"] + parts["diagnosis"]
    print(f"{given.trials} trials, kinds {given.kinds}, seed {given.seed}")
    print(
        "one after the other: "
        + ", ".join(f"{k} {v:.2f} s" for k, v in parts.items())
        + f"; floor {least:.2f} s"
    )
    cold, warm = cold_and_warm(given.seed, plan)
    print(f"diagnosis of trial 0: cold {cold:.2f} s, warm {warm:.2f} s")
    one = per_trial(given.seed, given.trials, plan, 1)
    print(f"1 worker : {one:.2f} s a trial, {1 / one:.3f} trials/s, {one / least:.2f} of the floor")
    two = per_trial(given.seed, given.trials, plan, 2)
    print(f"2 workers: {two:.2f} s a trial, {1 / two:.3f} trials/s, speed-up {one / two:.2f}")
    each = overhead(given.tasks)
    print(f"Dask: {1e3 * each:.2f} ms an empty task, {100 * each / one:.3f} % of a trial")
    for row in million(one, each):
        limit = "" if row["work"] else " (as fast as one scheduler hands out)"
        print(
            f"10^6 trials on {row['cores']:5d} cores: {row['hours']:8.1f} h = {row['hours'] / 24:6.1f} days{limit}"
        )


if __name__ == "__main__":
    main()
