"""Which chains of the stabilisation chart are candidates for modes."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from identification.poles.stabilisation import StabilisationChart, separation

_SHARE = 1 / 3


def candidates(chart: StabilisationChart) -> ComplexArray:
    """Return one pole for every chain that holds through a third of the orders, rising in frequency [rad/s].

    The list is generous: poles outside the band that shape what is inside it are on it too, and what the
    data do not bear out is struck off by :func:`identification.fit.equations.pruning.significant` after the fit.
    A chain that ends where another of the same frequency, damping and participation begins, without ever
    standing beside it at one order, is the same pole.
    """
    least = needed(chart)
    poles = [representative(chart, members) for members in chains(chart) if len(members) >= least]
    found = np.array(poles, dtype=complex)
    return found[np.argsort(np.abs(found))]


def needed(chart: StabilisationChart) -> int:
    """Return through how many orders a chain must hold to be a candidate."""
    return max(2, int(np.ceil(_SHARE * len(chart.orders))))


def chains(chart: StabilisationChart) -> list[IntArray]:
    """Return the poles of every chain, as rows of the chart, pieces of broken chains joined."""
    return _merged(chart, _tracks(chart))


def _tracks(chart: StabilisationChart) -> list[IntArray]:
    order = np.argsort(chart.track, kind="stable")
    cuts = np.flatnonzero(np.diff(chart.track[order])) + 1
    return [np.asarray(part) for part in np.split(order, cuts) if len(part)]


def _merged(chart: StabilisationChart, tracks: list[IntArray]) -> list[IntArray]:
    """Join the pieces of broken chains, longest first; a joined chain is compared by its highest pole."""
    tracks = sorted(tracks, key=len, reverse=True)
    top = np.array([track[np.argmax(chart.level[track])] for track in tracks], dtype=np.int64)
    alike = (
        separation(chart.poles[top], chart.participation[top], chart.poles[top], chart.participation[top])
        < 1.0
    )
    levels = np.zeros((len(tracks), len(chart.orders)), dtype=bool)
    for i, track in enumerate(tracks):
        levels[i, chart.level[track]] = True
    groups: list[list[int]] = []
    head = np.arange(len(tracks))
    for i in range(len(tracks)):
        for group in groups:
            first = group[0]
            if alike[head[first], i] and not (levels[first] & levels[i]).any():
                group.append(i)
                levels[first] |= levels[i]
                head[first] = max(head[first], i, key=lambda k: chart.level[top[k]])
                break
        else:
            groups.append([i])
    return [np.concatenate([tracks[i] for i in group]) for group in groups]


def representative(chart: StabilisationChart, members: IntArray) -> complex:
    """Return the median of the upper half of a chain: high orders are the less biased."""
    levels: FloatArray = chart.level[members].astype(float)
    upper = members[levels >= np.median(levels)]
    return complex(np.median(chart.poles[upper].real), np.median(chart.poles[upper].imag))
