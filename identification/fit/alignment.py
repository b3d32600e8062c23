"""FRFs carried over to common poles before modes are sought: with drift, one mode appears as several."""

from __future__ import annotations

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray
from acquisition.frfs.frf import FrfSet
from identification.fit.drift import Drift, carried_over, estimate_drift
from identification.fit.equations.refine import Fit, refine
from identification.fit.noise.weights import search_weights
from identification.fit.search.completion import without_split_modes
from identification.fit.search.split_modes import clusters

_ROUNDS, _STEPS = 4, 12
_SETTLED = 0.05
"""Change of a shift in half-power half-widths under which a further round is no gain: what is left is a second-order
error of a per mille of the peak. Twice as much saves a round now and then."""
_WORTH = 0.99
"""Part of the misfit that must remain at most for a round to count: less gain than that is not drift."""


def aligned(frfs: FrfSet, fit: Fit, known: Drift | None = None) -> tuple[FrfSet, Fit, Drift]:
    """Return FRFs carried over to common poles, the fit to them, and the drift.

    First the shifts that all modes share, which poles that split a mode between them do not upset; once such poles are
    one again, those of each mode. A round that does not lower the misfit is taken back.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs as measured.
    fit : Fit
        A fit to them, carried over by ``known`` where that is given.
    known : Drift, optional
        What is known of the drift.
    """
    drift = (Drift.none(len(frfs.values), fit.poles) if known is None else known).at(fit.poles)
    state = carried_over(frfs, fit, drift), fit, drift
    for each in (False, True):
        for _ in range(_ROUNDS):
            better = _round(frfs, *state, each=each)
            if better is None:
                break
            state = better
    return state


def _round(
    frfs: FrfSet, data: FrfSet, fit: Fit, drift: Drift, *, each: bool
) -> tuple[FrfSet, Fit, Drift] | None:
    """Return the state after one more estimate of the shifts, or None where it settles or does not help."""
    weights = search_weights(data, fit)
    own = distinct(fit.poles) if each else np.zeros(len(fit.poles), dtype=np.bool_)
    new = estimate_drift(data, fit, weights, own=own, previous=drift)
    change = np.abs(new.shift - drift.at(fit.poles).shift) * np.abs(fit.poles / fit.poles.real)
    if change.max(initial=0.0) < _SETTLED:
        return None
    moved = carried_over(frfs, fit, new)
    powers = fit.linear.powers
    before = refine(data, fit.poles, weights, powers=powers, iterations=_STEPS)
    after = refine(moved, fit.poles, weights, powers=powers, iterations=_STEPS)
    if after.cost > _WORTH * before.cost:
        return None
    return moved, without_split_modes(moved, after), new


def distinct(poles: ComplexArray) -> BoolArray:
    """Return which poles stand alone, shape (n_modes,): near others, a shift of one and of the other look alike."""
    alone = np.ones(len(poles), dtype=np.bool_)
    for group in clusters(poles):
        alone[group] = False
    return alone
