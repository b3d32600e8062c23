"""Do 95 % intervals of frequency and damping hold the truth on a simulator that shares nothing with the library's own?

Structures with damping that is not proportional are integrated in time. Pulses are of finite width; filters before
the converters, converters, noise of both channels, an exponential window or none, misses of the points and a drift of
the frequencies are drawn (`hammer/integrated.py`). Identified as files of hits are.

    python benchmarks/bench_integrated.py --seeds 30

A mode counts where identified and true pole are nearest to each other and within a half-width. What is missed or
invented is printed too.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
from bench_hammer import share
from hammer.integrated import Procedure, Structure, procedure, recorded, structure

from acquisition import UffContent
from acquisition.errors import EstimationError
from modalkit.workflow.identification import from_content
from modalkit.workflow.processing_options import ProcessingOptions

Row = tuple[float, float, dict[str, bool]]
"""Errors of frequency and damping over their sigma [-], and the classes that the mode is of."""


def trial(seed: int) -> tuple[list[Row], list[float], list[str], float]:
    """Return the rows of one test, the modes missed and invented, and processor time [s]."""
    rng = np.random.default_rng([seed, 20])
    made = structure(rng)
    plan = procedure(made, rng)
    test = recorded(made, plan, rng)
    began = time.process_time()
    try:
        band = (0.4 * abs(made.poles[0]) / (2 * np.pi), made.top)
        model = from_content(UffContent(tests=(test,)), [Path("integrated")], ProcessingOptions()).identify(
            band=band
        )
    except EstimationError as error:
        print(f"  {seed}: {error}")
        return [], [], [], time.process_time() - began
    cpu = time.process_time() - began
    true, found = made.poles, model.poles
    distance = np.abs(true[:, None] - found[None, :]) / np.abs(true.real)[:, None]
    best = distance.argmin(axis=0)
    mine = [k for k, r in enumerate(best) if distance[r, k] < 1.0 and distance[r].argmin() == k]
    zeta, data = -true.real / np.abs(true), model.modal
    rows: list[Row] = []
    for k in mine:
        r = int(best[k])
        f = (data.frequency[k] - abs(true[r]) / (2 * np.pi)) / data.frequency_sigma[k]
        d = (data.damping[k] - zeta[r]) / data.damping_sigma[k]
        rows.append((float(f), float(d), _classes(made, plan, r)))
    missed = [
        round(float(abs(p)) / (2 * np.pi), 2)
        for r, p in enumerate(true)
        if band[0] < abs(p) / (2 * np.pi) < 0.97 * made.top and r not in {int(best[k]) for k in mine}
    ]
    invented = [f"{data.frequency[k]:.2f}" for k in range(len(found)) if k not in mine]
    return rows, missed, invented, cpu


def _classes(made: Structure, plan: Procedure, r: int) -> dict[str, bool]:
    others = np.delete(made.poles, r)
    return {
        "windowed": plan.window > 0,
        "no window": plan.window == 0,
        "close": bool(np.min(np.abs(others - made.poles[r])) < 0.04 * abs(made.poles[r])),
        "drift": plan.drift > 0,
        "no drift": plan.drift == 0,
        plan.filter: True,
        "noise under 1e-3": plan.noise < 1e-3,
        "misses under 0.3 mm": plan.misses < 3e-4,
        "3 hits": plan.hits == 3,
    }


def main() -> None:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=30)
    parser.add_argument("--first", type=int, default=0)
    arguments = parser.parse_args()
    rows: list[Row] = []
    counts, spent = [0, 0], 0.0
    for seed in range(arguments.first, arguments.first + arguments.seeds):
        new, missed, invented, cpu = trial(seed)
        rows += new
        counts[0] += len(missed)
        counts[1] += len(invented)
        spent += cpu
        worst = [f"{f:.1f}/{d:.1f}" for f, d, _ in new if max(abs(f), abs(d)) > 2.6]
        print(
            f"  {seed}: {len(new)} modes, missed {missed}, invented {invented}, far off {worst}", flush=True
        )
    z = np.array([r[:2] for r in rows])
    print(f"{arguments.seeds} tests, {len(rows)} modes; missed {counts[0]}, invented {counts[1]}; "
          f"{spent / arguments.seeds:.1f} s of CPU each")  # fmt: skip
    for name in ["all", *sorted({c for r in rows for c in r[2]})]:
        of = np.array([name == "all" or r[2].get(name, False) for r in rows])
        inside = np.abs(z[of]) < 1.96
        print(
            f"{name}: frequency {share(int(inside[:, 0].sum()), int(of.sum()))}, damping "
            f"{share(int(inside[:, 1].sum()), int(of.sum()))}; mean pull {z[of].mean(axis=0).round(2)}, r.m.s. "
            f"{np.sqrt(np.mean(z[of] ** 2, axis=0)).round(2)}"
        )


if __name__ == "__main__":
    main()
