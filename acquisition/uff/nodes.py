"""The nodes of several data sets as one geometry."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from acquisition.geometry import Geometry


def merge_nodes(sets: Iterable[tuple[list[int], list[list[float]]]]) -> tuple[Geometry, list[str]]:
    """Return one geometry, and a remark for each node that is given two places; the first one counts."""
    places: dict[int, list[float]] = {}
    remarks = []
    for nodes, coordinates in sets:
        for node, place in zip(nodes, coordinates, strict=True):
            known = places.setdefault(node, place)
            if not np.allclose(known, place, rtol=1e-6, atol=1e-9):
                remarks.append(f"node {node} is given at {known} and at {place} [m]; the first is used")
    return Geometry(tuple(places), np.array(list(places.values()), dtype=np.float64).reshape(-1, 3)), remarks
