"""What several of the tests beside it need."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy.io import mmwrite

from modalkit.planning.own import OwnBench, bench_of
from modalkit.study.read import read_study

MASSES, SPRINGS = 6, 6


K, M = 1e6, 1.0


PARTS = ("low", "middle", "high")


STUDY = """
title = "Chain"
[test]
band = [1.0, 290.0]
{test}
[model]
type = "matrices"
stiffness = "stiffness.mtx"
mass = "mass.mtx"
nodes = "nodes.csv"
stiffness_parts = ["stiffness_low.mtx", "stiffness_middle.mtx", "stiffness_high.mtx"]
mass_parts = ["mass_low.mtx", "mass_middle.mtx", "mass_high.mtx"]
{model}
[[model.region]]
name = "low"
[[model.region]]
name = "middle"
[[model.region]]
name = "high"
[tolerances]
E = {E}
density = {density}
{more}
"""


POINTS = 'points = ["2+X", "4+X", "6+X"]\nsensor = "6+X"'


def chain(folder: Path) -> None:
    """Write six masses in a row between springs, the first held; two springs and two masses to a region."""
    whole = np.zeros((2, MASSES, MASSES))
    for i, part in enumerate(PARTS):
        k, m = np.zeros((MASSES, MASSES)), np.zeros((MASSES, MASSES))
        for n in (2 * i, 2 * i + 1):
            k[n, n] += K
            if n:
                k[n - 1, n - 1] += K
                k[n - 1, n] = k[n, n - 1] = -K
            m[n, n] = M
        whole += k, m
        mmwrite(folder / f"stiffness_{part}.mtx", k, precision=17)
        mmwrite(folder / f"mass_{part}.mtx", m, precision=17)
    mmwrite(folder / "stiffness.mtx", whole[0], precision=17)
    mmwrite(folder / "mass.mtx", whole[1], precision=17)
    softer = whole[0].copy()
    softer[2, 2] -= 0.5 * K
    softer[1, 1] -= 0.5 * K
    softer[1, 2] = softer[2, 1] = -0.5 * K
    mmwrite(folder / "softer.mtx", softer, precision=17)
    lines = [
        f"{n + 1}, {0.1 * (n + 1):g}, 0, 0, 1, {n + 1}, {'end' if n == 5 else ''}" for n in range(MASSES)
    ]
    (folder / "nodes.csv").write_text("\n".join(["node, x, y, z, direction, row, sets", *lines]) + "\n")


def study(folder: Path, **words: str) -> Path:
    chain(folder)
    known = {"test": POINTS, "model": "", "E": "0.01", "density": "0.003", "more": ""} | words
    path = folder / "study.toml"
    path.write_text(STUDY.format(**known))
    return path


def bench(folder: Path, **words: str) -> OwnBench:
    found = bench_of(read_study(study(folder, **words)))
    assert isinstance(found, OwnBench)
    return found


PLATE = """
[test]
{test}
[model]
type = "plate"
length = 0.4
width = 0.2
thickness = 0.003
elements = [8, 4]
clamped = ["x0"]
[model.material]
E = 210e9
density = 7850.0
"""
