"""Structures whose frequencies follow the force, and tests of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from acquisition import Dof, HammerPlan, HammerTest, ModalSystem, hammer_test, modal_system

FREQUENCY = np.array([40.0, 105.0, 178.0, 260.0])
BAND = (15.0, 320.0)
SLOPES = np.array([-3e-5, 2e-5, 0.0, -1e-5])
PLAN = HammerPlan(
    rate=1024.0,
    samples=1024,
    hits=4,
    level_scatter=0.4,
    width=4e-3,
    width_scatter=0.0,
    response_noise=2e-3,
    force_noise=0.02,
)


def structure(
    slope: np.ndarray | float,
    points: int = 4,
    damping_slope: float = 0.0,
    shift: Sequence[float] = (0.0,),
    damping: float = 0.01,
) -> Callable[[float], ModalSystem]:
    rng = np.random.default_rng(5)
    seen, hit = rng.standard_normal((2, 4)), rng.standard_normal((points, 4))

    def at(level: float) -> ModalSystem:
        return modal_system(
            frequency=FREQUENCY * np.exp(slope * level + shift[0]),
            damping=damping * np.ones(4) + damping_slope * level,
            response_shapes=seen,
            point_shapes=hit,
            responses=[Dof(98, 3), Dof(99, 3)],
            points=[Dof(i + 1, 3) for i in range(points)],
        )

    return at


def struck(
    at: Callable[[float], ModalSystem], seed: int, plan: HammerPlan = PLAN
) -> tuple[HammerTest, np.ndarray]:
    """A test, and the level each hit had."""
    levels: list[float] = []

    def noted(level: float) -> ModalSystem:
        levels.append(level)
        return at(level)

    test = hammer_test(noted, plan, rng=np.random.default_rng(seed))
    return test, np.array(levels[-sum(p.count for p in test.points) :])
