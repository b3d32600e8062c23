"""FRFs sorted in columns: one excitation, the responses it was measured at."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import IntArray
from updating.test_data.measured_frfs import MeasuredFrfs


@dataclass(frozen=True, eq=False)
class Columns:
    """Which points each FRF connects, whichever side is the shorter taken as excitation by reciprocity.

    Parameters
    ----------
    points : (n_points,) int array
        Points of the test that take part.
    response, excitation : (n_frf,) int arrays
        Row of ``points`` at both ends of each FRF.
    """

    points: IntArray
    response: IntArray
    excitation: IntArray

    @property
    def groups(self) -> list[tuple[int, IntArray]]:
        """Every excitation with the FRFs that belong to it."""
        return [(int(e), np.flatnonzero(self.excitation == e)) for e in np.unique(self.excitation)]


def columns(frfs: MeasuredFrfs) -> Columns:
    """Sort FRFs by their excitations, or by their sensors where these are fewer."""
    points, both = np.unique(np.concatenate([frfs.seen, frfs.hit]), return_inverse=True)
    seen, hit = np.split(both.ravel(), 2)
    roving_hammer = len(np.unique(seen)) < len(np.unique(hit))
    return Columns(points, hit if roving_hammer else seen, seen if roving_hammer else hit)
