"""Diagnosis: does it name what is hidden in specimens simulated by another theory on another mesh?

python benchmarks/bench_diagnosis.py --trials-per-effect 4 --out rows.jsonl      a quick look, some minutes
python benchmarks/bench_diagnosis.py --trials-per-effect 40 --none 400 --pairs 10 --seed 1000 --out rows.jsonl
python benchmarks/bench_diagnosis.py --out rows.jsonl --score                    score what is there, run nothing

Specimens are Timoshenko beams and Mindlin plates solved by high polynomials, with damped modes of the full system;
the candidates of the diagnosis are Hermite beams, quadratic beams and Kirchhoff plates. A run that was stopped goes on
where it was. Two fifths of the trials have absolute level alone, two fifths a test before the effect as well, and one
fifth shapes up to a factor only. Every fourth block of five is mild.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from diagnosis.hidden import CAUSES, PAIRS
from diagnosis.run import run_trial
from diagnosis.score import by_effect, summary
from threadpoolctl import threadpool_limits

Job = tuple[int, tuple[str, ...], int, str | None, bool]


def jobs(chosen: argparse.Namespace) -> Iterator[Job]:
    """Return all trials asked for, those of the same number together."""
    only = chosen.only.split(",") if chosen.only else None
    singles = [(n,) for n in CAUSES if only is None or n in only]
    pairs = [p for p in PAIRS if only is None or "+".join(p) in only or "pairs" in only]
    none = chosen.none if only is None or "none" in only else 0
    counts = [
        ((), none),
        *((s, chosen.trials_per_effect) for s in singles),
        *((p, chosen.pairs) for p in pairs),
    ]
    for index in range(chosen.first, chosen.first + max(n for _, n in counts)):
        for names, count in counts:
            if index - chosen.first >= count or (chosen.kind == "beam" and names == ("orthotropy",)):
                continue
            if chosen.kind == "plate" and names == ("shear",):
                continue
            yield chosen.seed, names, index, chosen.kind, chosen.leave_out and bool(names)


def key(row: dict[str, Any]) -> Job:
    return row["seed"], tuple(row["names"]), row["index"], row.get("asked"), bool(row.get("left_out"))


def work(job: Job) -> dict[str, Any]:
    seed, names, index, kind, leave_out = job
    with threadpool_limits(1):
        return run_trial(seed, names, index, kind=kind, leave_out=leave_out)


def read(path: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in path.read_text().splitlines()] if path.exists() else []


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--trials-per-effect", type=int, default=2)
    parser.add_argument("--none", type=int, default=0, help="trials without any effect")
    parser.add_argument("--pairs", type=int, default=0, help="trials of each pair")
    parser.add_argument("--only", help="names, separated by commas; pairs as a+b, or 'pairs'")
    parser.add_argument("--seed", type=int, default=1, help="from 1000 on for final runs only")
    parser.add_argument("--first", type=int, default=0, help="number of the first trial")
    parser.add_argument("--kind", choices=["beam", "plate"])
    parser.add_argument("--leave-out", action="store_true", help="take the hidden effect out of the library")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--markdown", type=Path, help="file for the tables")
    parser.add_argument("--score", action="store_true", help="run nothing")
    chosen = parser.parse_args()
    rows = read(chosen.out)
    done = {key(row) for row in rows}
    todo = [] if chosen.score else [job for job in jobs(chosen) if job not in done]
    with get_context("fork").Pool(chosen.workers) as pool, chosen.out.open("a") as file:
        for row in pool.imap_unordered(work, todo):
            rows.append(row)
            file.write(json.dumps(row, default=list) + "\n")
            file.flush()
    drawn = [row for row in rows if row["verdict"] != "undrawn"]
    lost = f"{len(drawn)} trials, {len(rows) - len(drawn)} without a specimen"
    text = "\n\n".join([lost, summary(drawn), by_effect(drawn)])
    print(text)
    if chosen.markdown is not None:
        chosen.markdown.write_text(text + "\n")


if __name__ == "__main__":
    main()
