"""Damaged files of every format: what becomes of each, counted. None may crash, hang or change without a word.

A mutant is the same for the same seed and number. Each family is read in a process of its own, whose CPU time and
memory are limited; one that dies is begun again behind the mutant that killed it.

    python benchmarks/bench_attack.py --mutants 100000 --seed 1
    python benchmarks/bench_attack.py --mutants 2000 --family MatrixMarket --show changed foreign
    python benchmarks/bench_attack.py --family MatrixMarket --only 1234 --keep mutant.mtx
"""

from __future__ import annotations

import argparse
import multiprocessing
import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "updating" / "models"))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "attack"))

from corpus import families
from judge import BAD, OUTCOMES, Judge, Verdict

WAIT = 120.0
"""Wall time without a verdict after which a process is ended and its mutant counted as a hang [s]: twenty times the
CPU time it has, for machines that are busy."""


def _judge(pipe: Connection, family: str, seed: int, start: int, stop: int, folder: str) -> None:
    """Judge mutants of a family, and send each verdict; runs in a process of its own."""
    judge = Judge(next(f for f in families() if f.name == family), seed, Path(folder))
    for index in range(start, stop):
        pipe.send(index)
        pipe.send(judge.judge(index))
    pipe.send(None)


def attack(family: str, seed: int, count: int) -> Iterator[Verdict]:
    """Yield the verdict on each mutant of a family, those that kill or stop their process among them."""
    context, start = multiprocessing.get_context("spawn"), 0
    while start < count:
        ours, theirs = context.Pipe(duplex=False)
        folder = TemporaryDirectory()
        words = (theirs, family, seed, start, count, folder.name)
        process = context.Process(target=_judge, args=words, daemon=True)
        process.start()
        theirs.close()
        at, outcome = start, "crash"
        try:
            while True:
                if not ours.poll(WAIT):
                    outcome = "hang"
                    break
                found = ours.recv()
                if found is None:
                    at, outcome = count, ""
                    break
                if isinstance(found, int):
                    at = found
                else:
                    yield found
        except EOFError:
            process.join(WAIT)  # it ends by itself: its exit code says how
        process.kill()
        process.join()
        folder.cleanup()
        if outcome:
            yield Verdict(family, at, "", "", outcome, f"exit code {process.exitcode}")
        start = at + 1


def _row(name: str, counts: Counter[str]) -> str:
    return f"| {name} | {counts.total()} | " + " | ".join(str(counts[o]) for o in OUTCOMES) + " |"


def main() -> None:
    """Attack, and print a table of outcomes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--mutants", type=int, default=10_000, help="of all families together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--family", action="append", help="only this one; may be given several times")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument(
        "--show", nargs="*", default=[], choices=OUTCOMES, help="print every mutant of an outcome"
    )
    parser.add_argument("--only", type=int, help="one mutant by its number")
    parser.add_argument("--keep", type=Path, help="where to write that mutant")
    options = parser.parse_args()
    chosen = [f for f in families() if not options.family or f.name in options.family]
    if options.only is not None:
        with TemporaryDirectory() as folder:
            judge = Judge(chosen[0], options.seed, Path(folder))
            if options.keep:
                options.keep.write_bytes(judge.mutant(options.only)[2])
            print(judge.judge(options.only))
        return
    each = -(-options.mutants // len(chosen))
    begun, totals = time.perf_counter(), Counter[str]()
    print("| family | mutants | " + " | ".join(OUTCOMES) + " |")
    print("|" + "---|" * (len(OUTCOMES) + 2))

    def one(name: str) -> list[Verdict]:
        return list(attack(name, options.seed, each))

    with ThreadPoolExecutor(options.workers) as pool:
        for family, verdicts in zip(chosen, pool.map(one, [f.name for f in chosen]), strict=True):
            counts = Counter(v.outcome for v in verdicts)
            totals += counts
            print(_row(family.name, counts), flush=True)
            for v in verdicts:
                if v.outcome in options.show:
                    print(
                        f"  {v.outcome}: {v.family} {v.index} ({v.case}; {v.damage}) {v.message[:200]}",
                        flush=True,
                    )
    print(_row("all", totals))
    print(f"\n{time.perf_counter() - begun:.0f} s")
    sys.exit(1 if any(totals[o] for o in BAD) else 0)


if __name__ == "__main__":
    main()
