"""Beams that change during the test: another mounting at one point, frequencies that follow the force."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.synthetic import ModalSystem
from hammer.plain import beam_test
from hammer.setups import Setup


def odd_mounting_test(rng: np.random.Generator) -> Setup:
    """Draw a beam whose mounting is another one while one point is hit."""
    setup = beam_test(rng)
    other = setup.system.with_frequencies(1 - rng.uniform(0.01, 0.04, len(setup.system.poles)))
    odd = int(rng.integers(len(setup.system.points)))
    return replace(setup, at_hit=lambda point, hit, level: other if point == odd else setup.system)


def softening_test(rng: np.random.Generator) -> Setup:
    """Draw a beam whose frequencies fall as the force grows."""
    return _following(rng, -1.0)


def hardening_test(rng: np.random.Generator) -> Setup:
    """Draw a beam whose frequencies rise with the force."""
    return _following(rng, 1.0)


def _following(rng: np.random.Generator, sign: float) -> Setup:
    """Make frequencies follow the force; ``system`` is the structure at the median force."""
    setup = beam_test(rng)
    change = sign * rng.uniform(0.002, 0.02, len(setup.system.poles)) / setup.plan.peak
    plan = replace(setup.plan, level_scatter=0.6, drift=0.0)

    def at_hit(point: int, hit: int, level: float) -> ModalSystem:
        return setup.system.with_frequencies(np.exp(change * (level - plan.peak)))

    return replace(setup, plan=plan, at_hit=at_hit, by_levels=True)
