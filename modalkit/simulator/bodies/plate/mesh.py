"""Lines between a plate's elements: uneven, and dense where something sits."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.mesh import graded_mesh

_LAYER_MOST = 0.2


def plate_lines(
    start: float,
    end: float,
    *,
    elements: int,
    layer: float,
    windows: tuple[tuple[float, float], ...] = (),
    lines: tuple[float, ...] = (),
) -> FloatArray:
    """Return lines that keep to the borders of some windows and to some given lines.

    Parameters
    ----------
    start, end : float
        Ends [m].
    elements : int
        Number of elements before refinement, without those of the layers [-].
    layer : float
        Width of the outermost elements, at most a fifth of the whole [m].
    windows : tuple of (low, high)
        Stretches with borders on lines and a line in their middle [m].
    lines : tuple of float
        Further places for lines [m].

    Returns
    -------
    (n_lines,) array
        Increasing positions; fixed ones within 1 % of an element of each other are merged [m].
    """
    layer = min(layer, _LAYER_MOST * (end - start))
    low, high = start + layer, end - layer
    base = graded_mesh(low, high, elements=elements)
    size = (high - low) / elements
    wanted = [place for left, right in windows for place in (left, 0.5 * (left + right), right)]
    fixed = np.unique([place for place in (*wanted, *lines) if low < place < high])
    fixed = fixed[np.diff(fixed, prepend=-np.inf) > 0.01 * size]
    fixed = fixed[(fixed > low + 0.01 * size) & (fixed < high - 0.01 * size)]
    if not len(fixed):
        return np.concatenate([[start], base, [end]])
    far = np.abs(base[:, None] - fixed).min(axis=1) > 0.3 * size
    far[[0, -1]] = True
    return np.sort(np.concatenate([[start], base[far], fixed, [end]]))
