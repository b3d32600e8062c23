"""Curves made short enough to be sent and drawn."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np

from acquisition.arrays import AnyArray, FloatArray
from acquisition.errors import InputError
from acquisition.frfs.frf import FrfSet

POINTS = 3000
"""Points of a curve at the most: more than a wide screen has columns. Longer ones keep the extremes of every piece, so
that no peak is lost; twice as many double what a page loads and show nothing more [-]."""


def envelope(x: FloatArray, y: AnyArray, whole: tuple[int, int] = (0, 0)) -> tuple[list[float], list[float]]:
    """Return a curve in at most ``POINTS`` points, the lowest and the highest of every piece in their order.

    Parameters
    ----------
    x, y : (n,) arrays
        The curve; y is real.
    whole : (int, int)
        First sample, and that behind the last, of a part of which every sample is kept as well.
    """
    if len(x) <= POINTS:
        return x.tolist(), np.asarray(y, dtype=float).tolist()
    cuts = np.linspace(0, len(x), POINTS // 2 + 1).astype(int)
    ends = [(a + int(y[a:b].argmin()), a + int(y[a:b].argmax())) for a, b in pairwise(cuts)]
    keep = np.union1d(np.ravel(ends), np.arange(*whole))
    return x[keep].tolist(), np.asarray(y[keep], dtype=float).tolist()


def decibels(values: AnyArray) -> FloatArray:
    """Return magnitudes as levels [dB re the unit of ``values``]; nothing is far below all."""
    return np.asarray(20 * np.log10(np.maximum(np.abs(values), 1e-300)))


def lines(x: FloatArray, **curves: AnyArray | None) -> dict[str, Any]:
    """Return curves over common lines, all cut to the same ``POINTS`` lines at the most.

    Parameters
    ----------
    x : (n,) array
        The lines.
    **curves : (n,) arrays or None
        Real curves by name; the first decides which lines of a piece are kept, one that is None is left out.
    """
    given = {name: np.asarray(values, dtype=float) for name, values in curves.items() if values is not None}
    keep = np.arange(len(x))
    if len(x) > POINTS:
        first = next(iter(given.values()))
        cuts = np.linspace(0, len(x), POINTS // 2 + 1).astype(int)
        pieces = [np.arange(a, b) for a, b in pairwise(cuts)]
        keep = np.unique([i for p in pieces for i in (p[first[p].argmin()], p[first[p].argmax()])])
    return {"x": x[keep].tolist()} | {name: values[keep].tolist() for name, values in given.items()}


def check_frf(frfs: FrfSet, index: int) -> None:
    """See that there is such an FRF.

    Raises
    ------
    InputError
        If there is none.
    """
    if not 0 <= index < len(frfs.responses):
        raise InputError(f"there is no FRF {index + 1}; there are {len(frfs.responses)}")
