"""Tests whose records are long, or windowed by the analyser."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition import HammerTest
from hammer.bodies import Array, Body, beam
from hammer.plain import beam_test
from hammer.setups import Setup, roving_hammer


def long_test(rng: np.random.Generator) -> Setup:
    """Draw a well damped beam whose records last ten times as long as it rings."""
    body = beam(rng)
    setup = roving_hammer(
        rng, replace(body, damping=0.008, shapes=body.shapes[-4:], slopes=_last(body, 4)), 1
    )
    slowest = float(-setup.system.poles.real.max())
    samples = int(min(10 * 4.6 / slowest, 40.0) * setup.plan.rate)
    return replace(setup, plan=replace(setup.plan, samples=samples, decay=0.0, hits=int(rng.integers(1, 4))))


def force_window_test(rng: np.random.Generator) -> Setup:
    """Draw a beam whose records have a force window, and an exponential one on the responses alone."""
    setup = beam_test(rng)
    decay = max(setup.plan.decay, 2.0)
    plan = replace(setup.plan, decay=0.0, pre_trigger=float(rng.uniform(0.02, 0.1)))
    length = plan.pre_trigger + plan.width + 0.02

    def analyser(test: HammerTest) -> HammerTest:
        time = np.arange(test.samples) / test.rate
        points = tuple(
            replace(p, force=p.force * (time < length), motion=p.motion * np.exp(-decay * time))
            for p in test.points
        )
        return replace(test, points=points)

    return replace(setup, plan=plan, analyser=analyser, stated=decay)


def _last(body: Body, count: int) -> tuple[Array, Array]:
    return body.slopes[0][-count:], body.slopes[1][-count:]
