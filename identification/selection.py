"""Which chains of the stabilisation chart are candidates for modes."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from identification.stabilisation import StabilisationChart, separation

_SHARE = 1 / 3


def candidates(chart: StabilisationChart) -> ComplexArray:
    """Return one pole for every chain that holds through a third of the orders, rising in frequency [rad/s].

    The list is generous: poles outside the band that shape what is inside it are on it too, and what the
    data do not bear out is struck off by :func:`identification.pruning.significant` after the fit.
    A chain that ends where another of the same frequency, damping and participation begins, without ever
    standing beside it at one order, is the same pole.
    """
    groups = _merged(chart, _tracks(chart))
    needed = max(2, int(np.ceil(_SHARE * len(chart.orders))))
    poles = [_representative(chart, members) for members in groups if len(members) >= needed]
    found = np.array(poles, dtype=complex)
    return found[np.argsort(np.abs(found))]


def _tracks(chart: StabilisationChart) -> list[IntArray]:
    order = np.argsort(chart.track, kind="stable")
    cuts = np.flatnonzero(np.diff(chart.track[order])) + 1
    return [np.asarray(part) for part in np.split(order, cuts) if len(part)]


def _merged(chart: StabilisationChart, tracks: list[IntArray]) -> list[IntArray]:
    """Join the pieces of broken chains, longest first."""
    groups: list[IntArray] = []
    for track in sorted(tracks, key=len, reverse=True):
        for i, group in enumerate(groups):
            if np.intersect1d(chart.level[group], chart.level[track]).size == 0 and _same(
                chart, group, track
            ):
                groups[i] = np.concatenate([group, track])
                break
        else:
            groups.append(track)
    return groups


def _same(chart: StabilisationChart, a: IntArray, b: IntArray) -> bool:
    near_a, near_b = a[np.argmax(chart.level[a])], b[np.argmax(chart.level[b])]
    u, v = chart.participation[[near_a]], chart.participation[[near_b]]
    return bool(separation(chart.poles[[near_a]], u, chart.poles[[near_b]], v)[0, 0] < 1.0)


def _representative(chart: StabilisationChart, members: IntArray) -> complex:
    """Return the median of the upper half of a chain: high orders are the less biased."""
    levels: FloatArray = chart.level[members].astype(float)
    upper = members[levels >= np.median(levels)]
    return complex(np.median(chart.poles[upper].real), np.median(chart.poles[upper].imag))
