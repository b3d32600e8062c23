"""Which records an exponential window was applied to: force and responses, or the responses alone."""

from __future__ import annotations

from typing import Literal

import numpy as np

from acquisition.hits.hammer import HammerTest
from acquisition.hits.impulse import impulse_places
from acquisition.hits.noise_decay import NoiseDecay, Side, noise_decay
from acquisition.warned import Consequential

SIDES: tuple[Side, ...] = ("before", "after")

CLEAR = 9.0
"""Difference of the squared misfits of both possibilities, three standard deviations, from which one holds [-]."""

On = Literal["both", "responses"]


def windowed_records(test: HammerTest, decay: float) -> tuple[On, tuple[str, ...]]:
    """Return which records were windowed, and what to say of it.

    The noise of the force, before the pulse and after it, decays with the window or is steady. Noise after the pulse
    that decays faster has a force window of its own, which leaves the pulse as it was, and shows neither; nor does a
    force that was set to zero there. Where nothing is known the window is taken to have been on both.

    Parameters
    ----------
    test : HammerTest
        Records as they were stored.
    decay : float
        Decay rate of the window [1/s].
    """
    evidence = sum(_for_both(noise, decay) for side in SIDES if (noise := noise_decay(test, side)) is not None)
    if evidence >= CLEAR:
        return "both", ()
    time = np.concatenate([impulse_places(p.force) for p in test.points if np.isfinite(p.force).all()] or [[0.0]])
    gain = float(np.mean(np.exp(decay * time / test.rate)))
    frfs, shapes = f"{gain:.3g}", f"{np.sqrt(gain):.3g}"
    where = f"hits come {time.mean() / test.rate:.3g} s after the start of the records"
    if evidence <= -CLEAR:
        text = (
            f"{test.source}: the noise of the force does not decay, so the window of {decay:g} 1/s was on the "
            f"responses alone; the force was given the same window, counted from the start of the records. FRFs "
            f"become {frfs} times and mass-normalised shapes {shapes} times as large ({where}); if the window was on "
            "both, give --window-on both"
        )
        return "responses", (Consequential(text),)
    if frfs == "1":
        return "both", ()
    text = (
        f"{test.source}: the noise of the force does not show whether the window of {decay:g} 1/s was on the force "
        f"too; it is taken to have been on both. If it was on the responses alone, FRFs are {frfs} times and "
        f"mass-normalised shapes {shapes} times as large ({where}): give --window-on responses, or both"
    )
    return "both", (Consequential(text),)


def _for_both(noise: NoiseDecay, decay: float) -> float:
    """Return by how much the squared misfit of steady noise exceeds that of noise that decays with the window [-]."""
    if noise.rate > 1.5 * decay + 3.0 * noise.error:
        return 0.0
    return (noise.rate**2 - (noise.rate - decay) ** 2) / noise.error**2
