"""Which records an exponential window was applied to: force and responses, or the responses alone."""

from __future__ import annotations

from typing import Literal

import numpy as np

from acquisition.hits.hammer import HammerTest
from acquisition.hits.impulse import impulse_places
from acquisition.hits.noise_decay import NoiseDecay, Side, falls_faster, noise_decay
from acquisition.warned import Consequential

SIDES: tuple[Side, ...] = ("before", "after")

CLEAR = 9.0
"""Difference of the squared misfits of both possibilities, three standard deviations, from which one holds [-]."""

NEGLIGIBLE = 0.005
"""Change of FRFs that is not worth a question, half a unit of the three digits it is printed with [-]."""

On = Literal["both", "responses"]


def windowed_records(test: HammerTest, decay: float) -> tuple[On, tuple[str, ...]]:
    """Return which records were windowed, and what to say of it.

    The noise of the force, before the pulse and behind it, decays with the window or is steady. Behind the pulse it may
    have a window of its own, by which it is zero or decays faster; analysers that have one put the exponential
    window on the responses alone. Where nothing is known it is taken to have been on both.

    Parameters
    ----------
    test : HammerTest
        Records as they were stored.
    decay : float
        Decay rate of the window [1/s].
    """
    sides = {side: noise for side in SIDES if (noise := noise_decay(test, side)) is not None}
    own = falls_faster(test, decay)
    evidence = sum(_for_both(noise, decay) for noise in sides.values())
    if evidence >= CLEAR:
        return "both", ()
    gain, where = _gain(test, decay)
    change = f"{gain:.3g} times and mass-normalised shapes {np.sqrt(gain):.3g} times as large ({where})"
    window = f"the window of {decay:g} 1/s"
    if evidence <= -CLEAR or own:
        steady = evidence <= -CLEAR
        why = "the noise of the force does not decay" if steady else "the force has a window of its own"
        text = (
            f"{test.source}: {why}, so {window} was on the responses alone; the force was given the same window, "
            f"counted from the start of the records. FRFs become {change}; if the window was on both, give "
            "--window-on both"
        )
        return "responses", (Consequential(text),)
    if gain - 1 < NEGLIGIBLE:
        return "both", ()
    text = (
        f"{test.source}: the noise of the force does not show whether {window} was on the force, too; it is assumed to "
        f"be on both. If it was on the responses alone, FRFs are {change}. State --window-on responses or both"
    )
    return "both", (Consequential(text),)


def _gain(test: HammerTest, decay: float) -> tuple[float, str]:
    """Return by how much FRFs grow if the force was not windowed [-], and why."""
    places = [impulse_places(p.force) for p in test.points if np.isfinite(p.force).all()]
    time = np.concatenate(places or [np.zeros(1)]) / test.rate
    gain = float(np.mean(np.exp(decay * time)))
    return gain, f"hits come {time.mean():.3g} s after the start of the records"


def _for_both(noise: NoiseDecay, decay: float) -> float:
    """Return by how much the squared misfit of steady noise exceeds that of noise that decays with the window [-]."""
    if noise.rate > 1.5 * decay + 3.0 * noise.error:  # of a window of its own
        return 0.0
    return (noise.rate**2 - (noise.rate - decay) ** 2) / noise.error**2
