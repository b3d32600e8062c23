"""Points of a structure, laid out on paper."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray


def principal(points: FloatArray) -> FloatArray:
    """Keep the one or two coordinates in which the points lie apart; one along their line if it is oblique."""
    spread = np.ptp(points, axis=0)
    keep = np.flatnonzero(spread > 1e-3 * max(spread.max(), 1e-12))
    centred = points - points.mean(axis=0)
    _, strength, directions = np.linalg.svd(centred, full_matrices=False)
    if len(strength) > 1 and strength[1] > 1e-3 * max(strength[0], 1e-12):
        chosen = keep if len(keep) == 2 else np.sort(np.argsort(spread)[-2:])
        return np.asarray(points[:, chosen])
    if len(keep) == 1:
        return np.asarray(points[:, keep])
    along = centred @ directions[0]
    return np.asarray((along - along.min())[:, None])
