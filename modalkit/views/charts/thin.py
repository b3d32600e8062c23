"""FRFs cut to what a file can carry: the same lines for all of them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from acquisition import FrfSet
from acquisition.arrays import AnyArray, IntArray

BUDGET = 60_000
"""Numbers that the FRFs of a test may take, half a megabyte; doubled, a large test is hard to mail [-]."""

FEWEST, MOST = 300, 1200
"""Lines of an FRF at least and at the most: a phone has fewer columns than the first, a screen hardly more than the
second [-]."""

LARGEST = 60
"""Most FRFs in a file, the worst; all of them are in `modalkit app`. Doubled, a report of a large test with its model
takes three megabytes [-]."""


def common_lines(frfs: FrfSet, curves: int, *, tests: int = 1) -> tuple[IntArray, int]:
    """Return the lines that are kept, and of how many FRFs.

    Of every piece of the axis those lines are kept where the sum of all FRFs is highest and lowest: no peak of it is
    lost.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    curves : int
        Curves that are drawn of each [-].
    tests : int
        Tests that share the file [-].
    """
    count = min(len(frfs.responses), max(1, LARGEST // tests))
    wanted = int(np.clip(BUDGET / (tests * curves * count), FEWEST, MOST))
    return extremes(np.abs(frfs.values).sum(axis=0), wanted), count


def extremes(values: AnyArray, most: int) -> IntArray:
    """Return where a curve is highest and lowest in every piece of it, and its ends: some ``most`` places."""
    lines = len(values)
    if lines <= most:
        return np.arange(lines)
    cuts = np.linspace(0, lines, most // 2 + 1).astype(int)
    pieces = [np.arange(a, b) for a, b in pairwise(cuts.tolist())]
    keep = {int(p[pick(values[p])]) for p in pieces for pick in (np.argmin, np.argmax)}
    return np.array(sorted(keep | {0, lines - 1}), dtype=np.int64)
