"""Non-uniform meshes: no candidate model has nodes where the rig has them."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray

_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


def graded_mesh(
    start: float, end: float, *, elements: int, windows: tuple[tuple[float, float], ...] = ()
) -> FloatArray:
    """Return nodes that are denser towards both ends, jittered, and refined in some windows.

    Parameters
    ----------
    start, end : float
        Ends of the beam [m].
    elements : int
        Number of elements before refinement [-].
    windows : tuple of (low, high)
        Stretches that get three elements of their own, or more where the mesh is finer [m].

    Returns
    -------
    (n_nodes,) array
        Increasing positions [m].
    """
    even = np.linspace(0.0, 1.0, elements + 1)
    graded = 0.6 * even + 0.4 * 0.5 * (1.0 - np.cos(np.pi * even))
    jitter = np.mod(np.arange(elements + 1) * _GOLDEN, 1.0) - 0.5
    spacing = np.minimum(np.diff(graded, prepend=graded[0]), np.diff(graded, append=graded[-1]))
    nodes = start + (end - start) * (graded + 0.4 * jitter * spacing)
    for window in windows:
        low, high = max(window[0], start), min(window[1], end)
        pieces = max(3, int(np.ceil(1.5 * (high - low) / np.diff(nodes).mean())))
        gap = (high - low) / pieces
        outside = (nodes < low - 0.5 * gap) | (nodes > high + 0.5 * gap)
        nodes = np.concatenate([nodes[outside], np.linspace(low, high, pieces + 1)])
    nodes = np.sort(np.concatenate([[start, end], nodes]))
    keep = np.diff(nodes, prepend=-np.inf) > 1e-5 * (end - start)
    nodes = nodes[keep]
    nodes[0], nodes[-1] = start, end
    return nodes
