"""Cost of an identification as points grow: 39 modes of a plate, 3 references, 2048 lines, 1 % noise.

A process for each size measures processor time and largest memory of `identify`, then those of one more pick (to its
picture). Beside them stands the floor: the FFTs of the data, and one linear least-squares fit
of all residues at the poles found. Exponents are slopes of logarithms from the smallest size to the largest.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import time
from itertools import pairwise

import numpy as np
from scipy import fft

from acquisition import Dof, FrfSet
from acquisition.arrays import FloatArray
from identification.fit.equations.residues import fit_residues
from identification.identify import prepare

MODES, BEYOND, LINES, REFERENCES, TOP = 39, 6, 2048, 3, 1000.0
SIDES = (1.0, 0.815)
SAME = 1e-3  # relative difference of frequencies of the same mode


def plate(points: int, rng: np.random.Generator) -> tuple[FrfSet, FloatArray]:
    """Return FRFs of a simply supported plate at scattered points, and the frequencies in the band [Hz]."""
    orders = np.array([(m, n) for m in range(1, 20) for n in range(1, 20)])
    shape = np.sum((orders / SIDES) ** 2, axis=1)
    first = np.argsort(shape)[: MODES + BEYOND]
    orders, hertz = orders[first], shape[first] * TOP / shape[first][MODES - 1 : MODES + 1].mean()
    damping = rng.uniform(0.002, 0.005, len(hertz))
    place = rng.uniform(0.03, 0.97, (points, 2))
    shapes = np.prod(np.sin(np.pi * place[:, None, :] * orders[None, :, :]), axis=2)
    omega = 2 * np.pi * hertz
    poles = omega * (-damping + 1j * np.sqrt(1 - damping**2))
    frequency = np.linspace(0.0, TOP, LINES)
    s = 2j * np.pi * frequency
    terms = (1 / (s[:, None] - poles) - 1 / (s[:, None] - poles.conj())) / (2j * poles.imag)
    hit = [int(part * points) for part in (0.0, 0.37, 0.81)]
    values = np.concatenate([(shapes * shapes[r]) @ terms.T * s**2 for r in hit])
    noise = rng.standard_normal((2, *values.shape)) * 0.01 * np.sqrt(np.mean(np.abs(values) ** 2) / 2)
    responses = tuple(Dof(i + 1, 3) for _ in hit for i in range(points))
    references = tuple(Dof(r + 1, 3) for r in hit for _ in range(points))
    return FrfSet(frequency, values + noise[0] + 1j * noise[1], responses, references), hertz[:MODES]


def measure(points: int, seed: int) -> dict[str, float]:
    """Return what one size costs, and how many modes are found and invented."""
    frfs, truth = plate(points, np.random.default_rng(seed))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    start = time.process_time()
    prepared = prepare(frfs)
    model = prepared.modes()
    cost = time.process_time() - start
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    found = model.modal.frequency
    near = np.abs(found[:, None] / truth - 1) < SAME
    pick = float(np.mean(found[-3:-1]))
    start = time.process_time()
    prepared.provisional(pick)
    picture = time.process_time() - start
    start = time.process_time()
    for _ in range(2):
        fft.ifft(frfs.values, int(fft.next_fast_len(round(1.08 * LINES))), axis=1)
    fit_residues(prepared.data, model.poles)
    floor = time.process_time() - start
    return {
        "points": points,
        "cost": cost,
        "floor": floor,
        "picture": picture,
        "memory": memory,
        "data": before,
        "found": int(near.any(axis=0).sum()),
        "invented": int((~near.any(axis=1)).sum()),
    }


def exponent(first: dict[str, float], last: dict[str, float], key: str) -> float:
    """Return by which power of the points a cost grows between two sizes [-]."""
    return math.log(last[key] / first[key]) / math.log(last["points"] / first["points"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0] if __doc__ else "")
    parser.add_argument("points", nargs="*", type=int, default=[25, 100, 300, 900])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--one", action="store_true", help="one size, in this process")
    given = parser.parse_args()
    if given.one:
        print(json.dumps(measure(given.points[0], given.seed)))
        return
    results: list[dict[str, float]] = []
    for points in given.points:
        command = [sys.executable, __file__, str(points), "--one", "--seed", str(given.seed)]
        environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        r = json.loads(done.stdout)
        results.append(r)
        print(
            f"{points:4} points: identify {r['cost']:6.1f} s, floor {r['floor']:.2f} s; a pick to its picture "
            f"{r['picture']:.2f} s; memory {r['memory']:.0f} MB, {r['data']:.0f} MB before; "
            f"{r['found']} of {MODES} modes, {r['invented']} invented; load {os.getloadavg()[0]:.0f}",
            flush=True,
        )
    for first, last in pairwise(results):
        powers = ", ".join(f"{key} {exponent(first, last, key):.2f}" for key in ("cost", "floor", "memory"))
        print(f"{first['points']} to {last['points']} points, exponents: {powers}")


if __name__ == "__main__":
    main()
