"""What became of every pole of a stabilisation chart, and where every mode comes from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, IntArray
from identification.model import ModalModel
from identification.poles.selection import chains, needed, representative

NEAR = 0.01
"""Relative distance up to which a pole of the fit is the one that a chain became: the refinement moves a chain's median
by its bias, parts of a half-width. Doubled, close modes pass for one another; halved, modes lose their chains [-]."""


@dataclass(frozen=True)
class PoleReason:
    """What became of the poles of a chain.

    Parameters
    ----------
    kind : {"mode", "dropped", "outside", "background", "pruned", "short", "new"}
        A mode; one that the user dropped; outside the band; kept as background, as the data do not locate it; struck
        off by the fit; a chain too short to be a candidate; a pole that continues no other.
    text : str
        The same in a sentence.
    mode : int, optional
        Row of the mode it became.
    """

    kind: str
    text: str
    mode: int | None = None


@dataclass(frozen=True, eq=False)
class Origins:
    """Reasons for all poles of a chart, and the origin of every mode.

    Parameters
    ----------
    reasons : tuple of PoleReason
        One for each chain.
    chain : (n_poles,) int array
        Which of them each pole of the chart has.
    modes : tuple of str
        Per mode: ``chain`` of the chart, ``refinement``, which added it where the fit left a peak, or ``named`` by
        the user.
    """

    reasons: tuple[PoleReason, ...]
    chain: IntArray
    modes: tuple[str, ...]


def pole_origins(model: ModalModel, *, add: Sequence[float] = (), drop: Sequence[float] = ()) -> Origins:
    """State for every pole of the chart what became of it, and of every mode where it comes from.

    Parameters
    ----------
    model : ModalModel
        The identification.
    add, drop : sequence of float
        The frequencies that the user named [Hz].
    """
    chart = model.chart
    groups, least = chains(chart), needed(chart)
    poles = np.array([representative(chart, members) for members in groups], complex)
    number = np.zeros(len(chart.poles), dtype=np.int64)
    for i, members in enumerate(groups):
        number[members] = i
    long = np.array([len(members) >= least for members in groups])
    became = _became(model.poles, poles, long)
    reasons = tuple(
        _reason(model, poles[i], len(members), least, became, drop, i) for i, members in enumerate(groups)
    )
    named = {_nearest(model.poles, value) for value in add}
    modes = tuple(
        "named" if r in named else "chain" if r in became.values() else "refinement"
        for r in range(len(model))
    )
    return Origins(reasons, number, modes)


def _became(modes: ComplexArray, poles: ComplexArray, long: BoolArray) -> dict[int, int]:
    """Return the mode that each of some chains became: per mode the nearest of the long chains, if one is near."""
    found = {}
    for r, mode in enumerate(modes):
        distance = np.where(long, np.abs(np.abs(poles) / abs(mode) - 1.0), np.inf)
        if len(distance) and distance.min() < NEAR:
            found[int(distance.argmin())] = r
    return found


def _reason(
    model: ModalModel,
    pole: complex,
    length: int,
    least: int,
    became: Mapping[int, int],
    drop: Sequence[float],
    chain: int,
) -> PoleReason:
    """Return what became of a chain with this pole in its middle."""
    orders = len(model.chart.orders)
    if length == 1:
        return PoleReason("new", "no pole of the next lower or next higher order matches it")
    if length < least:
        text = f"holds through {length} of {orders} orders only; a candidate needs {least}"
        return PoleReason("short", text)
    if chain in became:
        mode = became[chain]
        return PoleReason("mode", f"stable through {length} of {orders} orders: mode {mode + 1}", mode)
    frequency = abs(pole) / (2 * np.pi)
    low, high = model.band
    if not low <= frequency <= high:
        return PoleReason("outside", "stable, but outside the band: it stays in the fit as background")
    if any(abs(frequency - value) <= NEAR * value for value in drop):
        return PoleReason("dropped", "stable, but dropped by you: it stays in the fit as background")
    if _near(model.background_poles, pole) is not None:
        text = (
            "stable, but the data determine neither its frequency nor its damping: it stays in the fit as "
            "background"
        )
        return PoleReason("background", text)
    beside = _near(model.poles, pole)
    if beside is not None:
        text = (
            f"stable, but the same mode as {beside + 1}: frequencies that differ between FRFs split one "
            "mode into several"
        )
        return PoleReason("pruned", text)
    return PoleReason("pruned", "stable, but not needed: it explains no more than noise")


def _near(poles: ComplexArray, pole: complex) -> int | None:
    if not len(poles):
        return None
    distance = np.abs(np.abs(poles) / abs(pole) - 1.0)
    best = int(distance.argmin())
    return best if distance[best] < NEAR else None


def _nearest(poles: ComplexArray, hertz: float) -> int:
    return int(np.abs(np.abs(poles) / (2 * np.pi) - hertz).argmin())
