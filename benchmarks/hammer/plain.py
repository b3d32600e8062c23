"""Tests with nothing odd in them: a beam, a plate, an array of accelerometers, a set-up moved from point to point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from hammer.bodies import Body, airframe, beam, plate
from hammer.setups import Setup, roving_hammer, set_up


def after_toss(rng: np.random.Generator, body: Callable[[np.random.Generator], Body]) -> Body:
    """Draw a body after the number by which `array_test` chooses one: a seed draws the same test in all versions."""
    rng.random()
    return body(rng)


def beam_test(rng: np.random.Generator) -> Setup:
    """Draw a cantilever hit at all points."""
    return roving_hammer(rng, after_toss(rng, beam), 1)


def plate_test(rng: np.random.Generator) -> Setup:
    """Draw a plate hit at all points."""
    return roving_hammer(rng, after_toss(rng, plate), 2)


def array_test(rng: np.random.Generator) -> Setup:
    """Draw a beam or a plate hit at a point or two."""
    body = (beam if rng.random() < 0.5 else plate)(rng)
    every, later = np.arange(len(body.shapes)), np.arange(len(body.shapes) // 2, len(body.shapes))
    setup = set_up(rng, body, every, rng.choice(later, int(rng.integers(1, 3)), replace=False))
    return replace(setup, plan=replace(setup.plan, drift=0.0))  # one point hit tells nothing of drift


def roving_test(rng: np.random.Generator) -> Setup:
    """Draw an airframe whose set-up is moved from point to point."""
    setup = roving_hammer(rng, after_toss(rng, airframe), 3)
    drift = float(rng.uniform(8e-4, 2e-3))
    return replace(setup, plan=replace(setup.plan, drift=drift, hits=3))
