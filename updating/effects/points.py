"""Points of a test as effects speak of them: by node number."""

from __future__ import annotations

import numpy as np

from updating.measured import Measured


def indices(measured: Measured, nodes: tuple[int, ...]) -> list[int]:
    """Return the points of some nodes."""
    return [measured.nodes.index(int(node)) for node in nodes]


def places(measured: Measured, nodes: tuple[int, ...]) -> tuple[tuple[float, float, float], ...]:
    """Return where some nodes lie [m]."""
    points = measured.points[indices(measured, nodes)]
    padded = np.hstack([points, np.zeros((len(points), 3 - points.shape[1]))])
    return tuple((float(x), float(y), float(z)) for x, y, z in padded)
