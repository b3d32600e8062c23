"""Hits as column text, without a layout."""

from __future__ import annotations

from pathlib import Path

import numpy as np

RATE, SAMPLES = 1024.0, 1024
TIME = np.arange(SAMPLES) / RATE
HEAD = "time,hammer [N],acc 1 [m/s2]"


def hits(folder: Path, head: str = HEAD) -> list[str]:
    """Write two hits at each of two points, and return their names."""
    rng = np.random.default_rng(4)
    names = []
    for node in (1, 2):
        for hit in (1, 2):
            force = 100 * np.exp(-(((TIME - 0.02) / 0.0015) ** 2))
            motion = np.exp(-5 * TIME) * np.sin(530 * TIME) + 1e-4 * rng.standard_normal(SAMPLES)
            names.append(f"P{node}_{hit}.csv")
            rows = np.stack([TIME, force, motion], axis=1)
            np.savetxt(folder / names[-1], rows, "%.8g", ",", header=head, comments="")
    return names
