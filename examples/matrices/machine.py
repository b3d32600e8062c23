"""A machine on four feet from its matrices to a diagnosis, with a synthetic hammer test in between.

    python machine.py OUT
    modalkit diagnose OUT/study.toml

A welded frame of square bars carries a motor and stands on four rubber feet, springs to the ground. In the specimen
behind the test one foot has a third less stiffness: its rubber is of another batch. Every foot is a region.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from bars import Place, Section, Structure, rows_of, store
from hits import Points, hit

LENGTH, WIDTH, HEIGHT = 0.80, 0.50, 0.30
RAIL, LEG = Section(0.040, 0.040), Section(0.030, 0.030)
MOTOR, INERTIA = 18.0, (0.08, 0.11, 0.12)
FOOT = (8e5, 8e5, 2.5e6, 300.0, 300.0, 300.0)
SOFT = 0.67
"""What is left of the stiffness of the soft foot [-]."""

ELEMENTS = 4
CORNERS: dict[str, tuple[float, float]] = {
    "front_left": (0.0, 0.0), "front_right": (0.0, WIDTH), "rear_left": (LENGTH, 0.0), "rear_right": (LENGTH, WIDTH),
}  # fmt: skip
SIDES = {"left": ("front_left", "rear_left"), "right": ("front_right", "rear_right")}
ENDS = {"front": ("front_left", "front_right"), "rear": ("rear_left", "rear_right")}
REGIONS = {
    **{f"foot_{name}": [f"foot_{name}"] for name in CORNERS},
    "legs": [f"leg_{name}" for name in CORNERS],
    "rail_left": ["rail_left"],
    "rail_right": ["rail_right"],
    "cross_bars": ["cross_front", "cross_rear"],
    "motor": ["motor"],
}
"""Regions of the model and their parts."""


def machine(feet: Mapping[str, float] | None = None) -> tuple[Structure, dict[str, list[int]]]:
    """Return the machine, its feet so many times as stiff as modelled, and its node sets."""
    made, sets = Structure(), {}
    top: dict[str, int] = {}
    for name, (x, y) in CORNERS.items():
        bottom, top[name] = made.node((x, y, 0.0)), made.node((x, y, HEIGHT))
        made.bar(f"leg_{name}", (bottom, top[name]), LEG, 2, (1.0, 0.0, 0.0))
        springs = np.diag(FOOT) * (feet or {}).get(name, 1.0)
        made.stiffness[f"foot_{name}"] = [(rows_of(bottom), springs)]
        sets[f"under_{name}"] = [bottom]
    middles = {}
    for side, ends in SIDES.items():
        nodes = made.bar(f"rail_{side}", (top[ends[0]], top[ends[1]]), RAIL, ELEMENTS, (0.0, 1.0, 0.0))
        middles[side] = nodes[ELEMENTS // 2]
    for end, corners in ENDS.items():
        made.bar(f"cross_{end}", (top[corners[0]], top[corners[1]]), RAIL, ELEMENTS, (1.0, 0.0, 0.0))
    nodes = made.bar("motor", (middles["left"], middles["right"]), RAIL, ELEMENTS, (1.0, 0.0, 0.0))
    made.body("motor", nodes[ELEMENTS // 2], MOTOR, INERTIA)
    sets["motor"] = [nodes[ELEMENTS // 2]]
    return made, sets


def _along(share: float, y: float) -> Place:
    return share * LENGTH, y, HEIGHT


POINTS: Points = {
    1: (_along(0.0, 0.0), 3), 2: (_along(0.5, 0.0), 3), 3: (_along(1.0, 0.0), 3), 4: (_along(0.0, WIDTH), 3),
    5: (_along(0.5, WIDTH), 3), 6: (_along(1.0, WIDTH), 3), 7: (_along(0.25, 0.0), 2), 8: (_along(0.75, WIDTH), -2),
    9: ((0.0, WIDTH / 4, HEIGHT), 1), 10: ((LENGTH, 3 * WIDTH / 4, HEIGHT), -1), 11: ((0.0, 0.0, HEIGHT / 2), 1),
    12: (_along(0.25, WIDTH), 3),
}  # fmt: skip
"""Where the machine is hit [m], and along which axis; the last point carries the accelerometer."""


def make(folder: Path, soft: str = "rear_left", seed: int = 5) -> Path:
    """Write matrices, test and study into a folder; return the study."""
    folder.mkdir(parents=True, exist_ok=True)
    model, sets = machine()
    store(model, folder, REGIONS, sets)
    specimen = machine({soft: SOFT})[0]
    pair = specimen.matrix("stiffness"), specimen.matrix("mass")
    hit(folder / "hits.uff", model, *pair, POINTS, rate=2048.0, rng=np.random.default_rng(seed))
    return Path(shutil.copy(Path(__file__).parent / "machine.toml", folder / "study.toml"))


if __name__ == "__main__":
    sys.stdout.write(f"{make(Path(sys.argv[1]))}\n")
