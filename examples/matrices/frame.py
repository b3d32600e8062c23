"""A bolted frame of two storeys from its matrices to a diagnosis, with a synthetic hammer test in between.

    python frame.py OUT
    modalkit diagnose OUT/study.toml

Two columns and two beams of flat steel; each end of a beam is bolted to its column: two nodes at one place, joined by
springs. In the specimen behind the test one of the four joints is loose: it turns easily. The study has the modeller's
suspicions as hypotheses, one for each joint; no node sets name the two sides of the joints.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from bars import Section, Structure, store
from hits import Points, hit
from scipy.io import mmwrite

HEIGHTS, WIDTH = (0.40, 0.75), 0.50
COLUMN, BEAM = Section(0.008, 0.040), Section(0.006, 0.040)
JOINT = (2e7, 2e7, 2e7, 3e3, 4e3, 3e3)
LOOSE = 0.05
"""What is left of the stiffness with which a loose joint turns [-]."""

ELEMENTS = 6
JOINTS = ("joint_1", "joint_2", "joint_3", "joint_4")
REGIONS = ("column_left_1", "column_left_2", "column_right_1", "column_right_2", "beam_1", "beam_2")


def frame(turning: Mapping[str, float] | None = None) -> tuple[Structure, dict[str, list[int]]]:
    """Return the frame, its joints turning with so many times their stiffness, and its node sets."""
    made = Structure()
    sets: dict[str, list[int]] = {}
    knots: dict[str, list[int]] = {}
    for side, x in (("left", 0.0), ("right", WIDTH)):
        knots[side] = [made.node((x, 0.0, z)) for z in (0.0, *HEIGHTS)]
        sets[f"foot_{side}"] = knots[side][:1]
        made.held.add(knots[side][0])
        for storey in (1, 2):
            ends = knots[side][storey - 1], knots[side][storey]
            made.bar(f"column_{side}_{storey}", ends, COLUMN, ELEMENTS, (1.0, 0.0, 0.0))
    for storey, z in enumerate(HEIGHTS, start=1):
        ends = made.node((0.0, 0.0, z)), made.node((WIDTH, 0.0, z))
        made.bar(f"beam_{storey}", ends, BEAM, ELEMENTS, (0.0, 0.0, 1.0))
        for end, side in zip(ends, ("left", "right"), strict=True):
            name = JOINTS[2 * (storey - 1) + (side == "right")]
            left = (turning or {}).get(name, 1.0)
            springs = [k * (left if i > 2 else 1.0) for i, k in enumerate(JOINT)]
            made.spring(name, (knots[side][storey], end), springs)
            sets |= {f"{name}_column": [knots[side][storey]], f"{name}_beam": [end]}
    return made, sets


POINTS: Points = {
    1: ((0.0, 0.0, 0.2), 1), 2: ((0.0, 0.0, 0.4 + 0.35 / 2), 1), 3: ((WIDTH, 0.0, 0.2), 1),
    4: ((WIDTH, 0.0, 0.4 + 0.35 / 2), 1), 5: ((WIDTH / 3, 0.0, 0.4), 3), 6: ((2 * WIDTH / 3, 0.0, 0.4), 3),
    7: ((WIDTH / 3, 0.0, 0.75), 3), 8: ((2 * WIDTH / 3, 0.0, 0.75), 3), 9: ((WIDTH, 0.0, 0.4 + 0.35 * 5 / 6), 1),
}  # fmt: skip
"""Where the frame is hit [m], and along which axis; the last point carries the accelerometer."""


def make(folder: Path, loose: str = "joint_3", seed: int = 7) -> Path:
    """Write matrices, test and study into a folder; return the study."""
    folder.mkdir(parents=True, exist_ok=True)
    model, sets = frame()
    feet = {name: nodes for name, nodes in sets.items() if name.startswith("foot")}
    store(model, folder, {name: [name] for name in REGIONS}, feet)
    for name in JOINTS:
        mmwrite(folder / f"{name}_loose.mtx", frame({name: LOOSE})[0].matrix("stiffness"), precision=17)
    specimen = frame({loose: LOOSE})[0]
    pair = specimen.matrix("stiffness"), specimen.matrix("mass")
    hit(folder / "hits.uff", model, *pair, POINTS, rate=2048.0, rng=np.random.default_rng(seed))
    study = Path(shutil.copy(Path(__file__).parent / "frame.toml", folder / "study.toml"))
    (folder / "planned.toml").write_text(planned(study.read_text(encoding="utf-8")), encoding="utf-8")
    return study


def planned(study: str) -> str:
    """Return the text of a study before its test was made: where the frame will be hit in place of the hits."""
    points = [[*(round(c, 4) for c in place), f"+{'xyz'[axis - 1]}"] for place, axis in POINTS.values()]
    return study.replace('files = ["hits.uff"]', f"points = {points}\nsensor = {points[-1]}")


if __name__ == "__main__":
    sys.stdout.write(f"{make(Path(sys.argv[1]))}\n")
