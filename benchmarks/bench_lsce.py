"""LSCE: modalkit beside sdypy-EMA, time and memory, each in a process of its own.

python benchmarks/bench_lsce.py             1025 lines, order 40
python benchmarks/bench_lsce.py --large     and 4097 lines, order 60: the peer runs for some 100 s and takes 700 MB
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
from pathlib import Path

import common
import numpy as np
from scipy import fft

OUTPUTS = 25


def ours(lines: int, order: int) -> dict[str, float]:
    """Orders 1 to ``order``, complex coefficients."""
    from identification import lsce

    frfs = common.synthetic(OUTPUTS, lines, np.random.default_rng(1))
    before = _peak()
    orders = range(1, order + 1)
    poles = lsce(frfs, orders=orders).poles[-1]
    after = _peak()

    def transforms() -> None:
        for _ in range(3):
            fft.fft(frfs.values, axis=1)

    return {
        "seconds": common.seconds(lambda: lsce(frfs, orders=orders), 9),
        "megabytes": after - before,
        "found": common.modes_found(poles),
        "classic": common.classic_floor(orders, transforms),
        "least": common.own_floor(orders, transforms),
    }


def theirs(lines: int, order: int) -> dict[str, float]:
    """1 to ``order`` pairs of poles, real coefficients; the band starts at 0, where it is right."""
    from sdypy import EMA

    frfs = common.synthetic(OUTPUTS, lines, np.random.default_rng(1))
    model = EMA.Model(
        frf=np.array(frfs.values),
        freq=np.array(frfs.frequency),
        lower=0,
        upper=1000,
        pol_order_high=order,
        frf_form="accelerance",
    )
    before = _peak()
    with common.quiet():
        taken = common.seconds(lambda: model.get_poles(method="lsce", show_progress=False), 1)
    return {
        "seconds": taken,
        "megabytes": _peak() - before,
        "found": common.modes_found(np.asarray(model.all_poles[-1])),
    }


def _peak() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def _run(who: str, lines: int, order: int) -> dict[str, float]:
    command = [sys.executable, __file__, "--worker", who, str(lines), str(order)]
    root = str(Path(__file__).resolve().parents[1])
    done = subprocess.run(
        command, capture_output=True, text=True, check=True, env={**os.environ, "PYTHONPATH": root}
    )
    return {key: float(value) for key, value in json.loads(done.stdout).items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("--large", action="store_true", help="4097 lines, order 60 as well")
    parser.add_argument("--worker", nargs=3, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.worker:
        who, lines, order = chosen.worker
        print(json.dumps({"ours": ours, "theirs": theirs}[who](int(lines), int(order))))
        return
    for lines, order in [(1025, 40), *([(4097, 60)] if chosen.large else [])]:
        own, peer = _run("ours", lines, order), _run("theirs", lines, order)
        print(
            f"{OUTPUTS} outputs, {lines} lines, orders 1-{order}: {own['seconds']:.4f} s, "
            f"sdypy-EMA {peer['seconds']:.2f} s, ratio {peer['seconds'] / own['seconds']:.0f}; "
            f"{own['seconds'] / own['classic']:.2f} of the classic floor {own['classic']:.4f} s, "
            f"{own['seconds'] / own['least']:.1f} of our own {own['least']:.4f} s; "
            f"peak memory {own['megabytes']:.0f} MB above the data, sdypy-EMA {peer['megabytes']:.0f} MB; "
            f"modes {own['found']:.0f} and {peer['found']:.0f} of 12"
        )


if __name__ == "__main__":
    main()
