"""Frames given as matrices with a part for each storey; some storeys are softer or stiffer than modelled."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.linalg import eigh

from acquisition.arrays import FloatArray
from cases.trial import Cause, Make, Trial

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "examples" / "matrices"))

from bars import Section, Structure, rows_of, store
from hits import Points, hit

SCATTER = (0.01, 0.003)
"""Of modulus and density, relative: the tolerances of a study that states none [-]."""

ELEMENTS = 6
MODES, CLEAR = 8, 1.1
"""So many modes lie in the band, at least; it ends where the next is so many times higher [-]."""

FAINT = 0.05
"""What moves less at all points, over the most of any mode, is no mode of this test [-]."""


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame as modelled, where it is hit, and the names of its storeys."""

    structure: Structure
    points: Points
    storeys: tuple[str, ...]


def draw_frame(rng: np.random.Generator) -> Frame:
    """Draw a frame of four to six storeys: two columns welded to floors, held at the feet."""
    count, width = int(rng.integers(4, 7)), round(rng.uniform(0.4, 0.7), 3)
    heights = np.round(np.cumsum([0.0, *rng.uniform(0.25, 0.45, count)]), 3)
    column = Section(round(rng.uniform(0.006, 0.010), 4), 0.040)
    floor = Section(round(rng.uniform(0.008, 0.015), 4), 0.040)
    made = Structure()
    knots = [[made.node((x, 0.0, float(z))) for z in heights] for x in (0.0, width)]
    made.held |= {side[0] for side in knots}
    for i in range(count):
        for side in knots:
            made.bar(f"storey_{i + 1}", (side[i], side[i + 1]), column, ELEMENTS, (1.0, 0.0, 0.0))
    for i in range(1, count + 1):
        made.bar(f"floor_{i}", (knots[0][i], knots[1][i]), floor, ELEMENTS, (0.0, 0.0, 1.0))
    low, high = heights[:-1], heights[1:]
    places = [((0.0, 0.0, float(z)), 1) for z in high]
    places += [
        ((x, 0.0, float((a + b) / 2)), 1) for a, b in zip(low, high, strict=True) for x in (0.0, width)
    ]
    places += [((width / 3, 0.0, float(z)), 3) for z in high]
    places.append(((width, 0.0, float(high[-1] - (high[-1] - low[-1]) / ELEMENTS)), 1))
    points = dict(enumerate(places, start=1))
    return Frame(made, points, tuple(f"storey_{i + 1}" for i in range(count)))


def band(frame: Frame) -> tuple[float, float]:
    """Return from where to where the first modes lie that move at the points [Hz]."""
    made = frame.structure
    matrices = (made.matrix(kind).toarray() for kind in ("stiffness", "mass"))
    values, vectors = eigh(*matrices, subset_by_index=(0, 23))
    row_of = {row: i for i, row in enumerate(made.free)}
    at = np.array(made.places)
    nodes = [1 + int(np.argmin(np.linalg.norm(at - place, axis=1))) for place, _ in frame.points.values()]
    rows = [row_of[rows_of(n)[axis - 1]] for n, (_, axis) in zip(nodes, frame.points.values(), strict=True)]
    most: FloatArray = np.abs(vectors[rows]).max(axis=0)
    hertz = np.sqrt(values[most > FAINT * most.max()]) / (2 * np.pi)
    last = next(i for i in range(MODES - 1, len(hertz) - 1) if hertz[i + 1] > CLEAR * hertz[i])
    return 0.5 * float(hertz[0]), 0.5 * float(hertz[last] + hertz[last + 1])


def study(frame: Frame, ends: tuple[float, float]) -> str:
    """Return the study, in which every storey and every floor is a region."""
    parts = frame.structure.parts
    files = {kind: [f"{kind}_{part}.mtx" for part in parts] for kind in ("stiffness", "mass")}
    lines = [
        'title = "Frame"', "[test]", 'files = ["hits.uff"]', f"band = [{ends[0]:.2f}, {ends[1]:.2f}]", "[model]",
        'type = "matrices"', 'stiffness = "stiffness.mtx"', 'mass = "mass.mtx"', 'nodes = "nodes.csv"',
        *(f"{kind}_parts = {names}".replace("'", '"') for kind, names in files.items()),
        "[model.material]", "E = 210e9", "density = 7850.0",
        *(f'[[model.region]]\nname = "{part}"' for part in parts),
    ]  # fmt: skip
    return "\n".join(lines) + "\n"


def changed(rng: np.random.Generator, folder: Path, frame: Frame, left: Mapping[str, float]) -> Trial:
    """Hit a frame some of whose storeys have so much of their stiffness, and write what the modeller has."""
    made, ends = frame.structure, band(frame)
    store(made, folder, {part: [part] for part in made.parts}, {})
    factors = 1 + np.array(SCATTER) * rng.standard_normal(2)
    stiffness = made.matrix("stiffness", factors={p: factors[0] * left.get(p, 1.0) for p in made.parts})
    mass = made.matrix("mass", factors=dict.fromkeys(made.parts, factors[1]))
    rate = 2.0 ** np.ceil(np.log2(3.2 * ends[1]))
    hit(folder / "hits.uff", made, stiffness, mass, frame.points, rate=rate, rng=rng)
    (folder / "study.toml").write_text(study(frame, ends), encoding="utf-8")
    causes = tuple(
        Cause(("local_stiffness",), {"loss": 1 - kept}, (storey,)) for storey, kept in left.items()
    )
    return Trial(folder / "study.toml", causes)


def storeys(number: int, low: float, high: float) -> Make:
    """Return the case of so many storeys with a share of their stiffness between two bounds, each its own."""

    def make(rng: np.random.Generator, folder: Path) -> Trial:
        frame = draw_frame(rng)
        chosen = sorted(str(s) for s in rng.choice(frame.storeys, number, replace=False))
        return changed(rng, folder, frame, {storey: float(rng.uniform(low, high)) for storey in chosen})

    return make
