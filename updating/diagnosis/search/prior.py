"""The prior of a set of causes, how many sets there are, and when one set holds another."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from math import comb

import numpy as np

from updating.thresholds import COUNT_PRIOR


def holds(whole: Sequence[str], part: Sequence[str]) -> bool:
    """Return whether a set of causes has all of another, one that occurs twice as often."""
    return not Counter(part) - Counter(whole)


def count_sets(causes: int, once: int, repeated: int) -> int:
    """Return how many sets of so many causes there are.

    Parameters
    ----------
    causes : int
        Causes in a set.
    once, repeated : int
        How many effects may be in it once, and how many of them a second time as well.
    """
    return sum(
        comb(repeated, twice) * comb(once - twice, causes - 2 * twice) for twice in range(causes // 2 + 1)
    )


def log_prior(causes: int, examined: int) -> float:
    """Return the logarithm of the prior of one set of so many causes, among so many effects examined [-]."""
    return float(np.log(COUNT_PRIOR[causes] / comb(max(examined, causes), causes)))
