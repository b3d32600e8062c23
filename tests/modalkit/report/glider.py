"""A glider of bars in space: wing of two spars with ribs, fuselage, tail and fin, measured at some seventy points.

Nothing lies in the plane of anything else: the fin moves along y, all else along z, the nose along both.
"""

from __future__ import annotations

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.linalg import eigh

from acquisition import Dof, FrfSet, Geometry, write_uff

ROOT = Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "examples" / "matrices"))
try:
    from bars import Section, Structure, rows_of, store
finally:
    sys.path.pop(0)

BEAM, SPAR, RIB = (
    Section(0.06, 0.05, 70e9, 2700.0),
    Section(0.03, 0.012, 70e9, 2700.0),
    Section(0.02, 0.008, 70e9, 2700.0),
)
RIBS = 9
"""Ribs of half a wing."""

SOFT = 0.6
"""What is left of the stiffness of the outer left wing in the specimen [-]."""

STUDY = """\
title = "Glider of bars"
[test]
files = ["glider.uff"]
band = [3.0, 60.0]
calibration = 0.02
[model]
type = "matrices"
stiffness = "stiffness.mtx"
mass = "mass.mtx"
nodes = "nodes.csv"
stiffness_parts = [{stiffness}]
mass_parts = [{mass}]
{regions}
[tolerances]
E = 0.01
density = 0.003
"""
PARTS = (
    "fuselage",
    "wing_left_inner",
    "wing_left_outer",
    "wing_right_inner",
    "wing_right_outer",
    "tail",
    "fin",
)


def glider() -> tuple[Structure, list[tuple[int, int]], list[tuple[int, int]]]:
    """Return the structure, the measured (node, UFF direction), and the pairs of nodes that lines join."""
    made = Structure()
    lines: list[tuple[int, int]] = []
    places = {
        name: made.node(at)
        for name, at in {
            "nose": (-0.5, 0, 0),
            "wing": (0, 0, 0),
            "aft": (0.3, 0, 0),
            "end": (1.6, 0, 0),
        }.items()
    }
    made.held.add(places["wing"])
    fuselage = []
    for a, b, n in (("nose", "wing", 3), ("wing", "aft", 1), ("aft", "end", 5)):
        fuselage += made.bar("fuselage", (places[a], places[b]), BEAM, n, (0.0, 1.0, 0.0))
    measured = [
        (n, d)
        for n in dict.fromkeys(fuselage)
        if n not in made.held
        for d in ((2, 3) if n == places["nose"] else (3,))
    ]
    for side, sign in (("left", -1.0), ("right", 1.0)):
        spars = [[places["wing"]], [places["aft"]]]
        for k in range(1, RIBS + 1):
            part = f"wing_{side}_{'inner' if k <= RIBS // 2 else 'outer'}"
            y = sign * 1.5 * k / RIBS
            tip = [
                made.node((0.05 * k / RIBS, y, 0.04 * k / RIBS)),
                made.node((0.3 - 0.1 * k / RIBS, y, 0.04 * k / RIBS)),
            ]
            for spar, node in zip(spars, tip, strict=True):
                made.bar(part, (spar[-1], node), SPAR, 1, (1.0, 0.0, 0.0))
                spar.append(node)
            made.bar(part, (tip[0], tip[1]), RIB, 1, (0.0, 1.0, 0.0))
            lines.append((tip[0], tip[1]))
        measured += [(n, 3) for spar in spars for n in spar[1:]]
        lines += [pair for spar in spars for pair in pairwise(spar)]
    for sign in (-1.0, 1.0):
        tail = made.bar(
            "tail", (places["end"], made.node((1.65, sign * 0.45, 0.0))), SPAR, 4, (1.0, 0.0, 0.0)
        )
        measured += [(n, 3) for n in tail[1:]]
        lines += list(pairwise(tail))
    fin = made.bar("fin", (places["end"], made.node((1.75, 0.0, 0.5))), SPAR, 5, (1.0, 0.0, 0.0))
    second = made.bar("fin", (fin[-1], made.node((1.75, 0.3, 0.5))), RIB, 3, (1.0, 0.0, 0.0))
    third = made.bar("fin", (fin[-1], made.node((1.75, -0.3, 0.5))), RIB, 3, (1.0, 0.0, 0.0))
    measured += [(n, 2) for n in fin[1:]] + [(n, 3) for n in second[1:] + third[1:]]
    for run in (fin, second, third, list(dict.fromkeys(fuselage))):
        lines += list(pairwise(run))
    return made, measured, lines


def make_glider(folder: Path, *, title: str = "Glider", seed: int = 3) -> Path:
    """Write matrices, FRFs and study into a folder; return the study."""
    folder.mkdir(parents=True, exist_ok=True)
    made, measured, lines = glider()
    store(made, folder, {name: [name] for name in PARTS}, {})
    k, m = (
        made.matrix(kind, factors={"wing_left_outer": SOFT if kind == "stiffness" else 1.0}).toarray()
        for kind in ("stiffness", "mass")
    )
    values, vectors = eigh(k, m, subset_by_index=(0, 39))
    row = {r: i for i, r in enumerate(made.free)}
    shapes = np.array([vectors[row[rows_of(n)[d - 1]]] for n, d in measured])
    hit = [measured.index(one) for one in ((max(n for n, d in measured if d == 2), 2),)] + [20]
    f = np.arange(2.0, 64.0, 0.05)
    s, omega = 2j * np.pi * f, np.sqrt(values)
    rng = np.random.default_rng(seed)
    parts = s[None, :] ** 2 / (
        s[None, :] ** 2 + 2 * 0.006 * omega[:, None] * s[None, :] + omega[:, None] ** 2
    )
    h = np.concatenate([(shapes * shapes[r]) @ parts for r in hit])
    h += (
        2e-3
        * np.sqrt(np.mean(np.abs(h) ** 2))
        * (rng.standard_normal(h.shape) + 1j * rng.standard_normal(h.shape))
    )
    dofs = [Dof(n, d) for n, d in measured]
    nodes = tuple(sorted({n for n, _ in measured} | {n for pair in lines for n in pair}))
    geometry = Geometry(nodes, np.array([made.places[n - 1] for n in nodes], float), np.array(lines))
    frfs = FrfSet(
        f,
        h,
        tuple(dofs * len(hit)),
        tuple(dofs[r] for r in hit for _ in dofs),
        form="accelerance",
        geometry=geometry,
    )
    write_uff(folder / "glider.uff", frfs=frfs, geometry=geometry, title=title)
    quoted = {kind: ", ".join(f'"{kind}_{name}.mtx"' for name in PARTS) for kind in ("stiffness", "mass")}
    regions = "\n".join(f'[[model.region]]\nname = "{name}"' for name in PARTS)
    (folder / "study.toml").write_text(STUDY.format(**quoted, regions=regions), encoding="utf-8")
    return folder / "study.toml"


if __name__ == "__main__":
    sys.stdout.write(f"{make_glider(Path(sys.argv[1]))}\n")
