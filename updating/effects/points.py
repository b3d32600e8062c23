"""Points of a test as effects speak of them: by node number."""

from __future__ import annotations

import numpy as np

from acquisition.errors import StudyError
from updating.measured import Measured


def points_of(measured: Measured, role: str) -> list[int]:
    """Return the points that are ``"hit"``, or ``"seen"``."""
    return sorted({int(p) for p in (measured.hit if role == "hit" else measured.seen) if p >= 0})


def indices(measured: Measured, nodes: tuple[int, ...]) -> list[int]:
    """Return the points of some nodes.

    Raises
    ------
    StudyError
        If the test has no such node.
    """
    if missing := [node for node in nodes if int(node) not in measured.nodes]:
        there = ", ".join(map(str, measured.nodes[:12]))
        raise StudyError(f"the test has no point {missing[0]}; it has {there or 'no points'}")
    return [measured.nodes.index(int(node)) for node in nodes]


def places(measured: Measured, nodes: tuple[int, ...]) -> tuple[tuple[float, float, float], ...]:
    """Return where some nodes lie [m]."""
    points = measured.points[indices(measured, nodes)]
    padded = np.hstack([points, np.zeros((len(points), 3 - points.shape[1]))])
    return tuple((float(x), float(y), float(z)) for x, y, z in padded)
