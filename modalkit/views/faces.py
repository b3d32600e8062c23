"""Surfaces between trace lines: what three or four lines close is a face, all else is air."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition.arrays import FloatArray

FLAT = 0.15
"""Four points are a face if none lies farther off the plane of the others than this part of their size: a shell bends
less from corner to corner, a diagonal across a structure more [-]."""


def closed_faces(points: FloatArray, lines: Sequence[tuple[int, int]]) -> list[tuple[int, ...]]:
    """Return the triangles and quadrilaterals (without a diagonal) that lines close, as rows of ``points``.

    Parameters
    ----------
    points : (n, 3) array
        Places [m].
    lines : sequence of (int, int)
        Rows that are joined.
    """
    near: dict[int, set[int]] = {}
    for a, b in lines:
        if a != b:
            near.setdefault(a, set()).add(b)
            near.setdefault(b, set()).add(a)
    found: set[frozenset[int]] = set()
    faces: list[tuple[int, ...]] = []
    for a in sorted(near):
        for b in sorted(near[a]):
            for c in sorted(near[b] - {a}):
                if c in near[a]:
                    _add((a, b, c), faces, found)
                    continue
                for d in sorted((near[c] & near[a]) - {b}):
                    if d not in near[b] and _flat(points[[a, b, c, d]]):
                        _add((a, b, c, d), faces, found)
    return faces


def _add(face: tuple[int, ...], faces: list[tuple[int, ...]], found: set[frozenset[int]]) -> None:
    if frozenset(face) not in found:
        found.add(frozenset(face))
        faces.append(face)


def _flat(corners: FloatArray) -> bool:
    """Return whether four corners lie in a plane, and span one."""
    centred = corners - corners.mean(axis=0)
    size = np.linalg.svd(centred, compute_uv=False)
    return bool(size[1] > 0.05 * size[0] and size[2] <= FLAT * size[0])
