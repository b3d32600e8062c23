"""Whether FRFs are good enough to explain a gap by: coherence, hits refused, and what a window leaves to be known.

What reciprocity and drive points show, tones, and records that end too early is reported by the identification itself.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition import HitVerdict
from acquisition.arrays import FloatArray
from acquisition.hits.verdicts import usual_fault
from identification.model import ModalModel

COHERENT = 0.9
"""Coherence about a mode that sound hits reach [-]."""

MANY = 0.25
"""Share of refused hits that is worth a word [-]."""

HEAVY = 30.0
"""Decay of a window over that of a mode beyond which an error of 1 % in it spoils that mode's damping [-]."""

HALF_WIDTHS = 2.0
"""Lines so near to a mode count as its own [half-power half-widths, the window's part included]."""


def frf_health(model: ModalModel, hits: Sequence[HitVerdict] = ()) -> tuple[str, ...]:
    """Return warnings on the FRFs that modes were identified from.

    Parameters
    ----------
    model : ModalModel
        The modes, with their FRFs.
    hits : sequence of HitVerdict
        What is thought of the hits, where there are any.
    """
    return (*_on_coherence(model), *_on_hits(hits), *_on_window(model))


def mode_coherence(model: ModalModel) -> FloatArray | None:
    """Return the coherence about each mode, FRFs weighted by how much the mode shows in them, (n_modes,) [-].

    None where the FRFs carry no coherence.
    """
    frfs = model.frfs
    if frfs.coherence is None:
        return None
    centre = np.abs(model.poles) / (2 * np.pi)
    reach = HALF_WIDTHS * (frfs.decay - model.poles.real) / (2 * np.pi) + frfs.df / 2
    near = np.abs(frfs.frequency[None, :] - centre[:, None]) <= reach[:, None]
    power = np.abs(model.constants) ** 2
    lines = near.sum(axis=1)
    mean = (frfs.coherence @ near.T.astype(np.float64)) / np.maximum(lines, 1)
    return np.asarray(np.where(lines > 0, (power * mean).sum(axis=0) / power.sum(axis=0), np.nan))


def _on_coherence(model: ModalModel) -> tuple[str, ...]:
    found = mode_coherence(model)
    if found is None:
        return ()
    poor = np.flatnonzero(found < COHERENT)
    if not len(poor):
        return ()
    return (
        f"coherence near mode(s) {', '.join(str(int(m) + 1) for m in poor)} falls to {found[poor].min():.2f}: the hits "
        "scatter in place, there is noise, or the structure is nonlinear; hit more often and at the same place",
    )


def _on_hits(hits: Sequence[HitVerdict]) -> tuple[str, ...]:
    refused = [v for v in hits if not v.used]
    if len(refused) <= MANY * len(hits):
        return ()
    usual = usual_fault(refused)
    often = "" if usual is None else f", most for: {usual[1]}"
    return (
        f"{len(refused)} of {len(hits)} hits are not used{often}; repeat the test before you interpret it",
    )


def _on_window(model: ModalModel) -> tuple[str, ...]:
    decay = model.frfs.decay
    own = -model.poles.real
    heavy = np.flatnonzero(decay > HEAVY * own)
    if not len(heavy):
        return ()
    worst = int(heavy[np.argmin(own[heavy])])
    times = decay / own[worst]
    return (
        f"the exponential window of {decay:.3g} 1/s was removed from the damping. It is {times:.2g} times the "
        f"damping of mode {worst + 1}, so an error of 1 % in the window is an error of {times:.2g} % in that damping; "
        "record longer, with a weaker window",
    )
