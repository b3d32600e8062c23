"""What several of the tests beside it need."""

from dataclasses import replace

import numpy as np
from updating_cases import blank

from updating import Damping, Material, Predictor, Region, Spec
from updating.simulation import (
    Simulated,
    simulated,
)

STEEL = Material(210e9, 7850.0, 0.3)


LENGTH, WIDTH, THICK = 0.5, 0.03, 0.005


EI, MU = 210e9 * WIDTH * THICK**3 / 12, 7850.0 * WIDTH * THICK


LOSS = 0.01


CLAMPED = Spec(
    "beam", length=LENGTH, width=WIDTH, thickness=THICK, elements=(120,), clamped=("x0",),
    theory="euler-bernoulli", material=STEEL, damping=Damping(loss_factor=LOSS),
)  # fmt: skip


FREE = replace(CLAMPED, clamped=())


HALVES = (
    Region("bare", (0.0, 0.25), alpha=3.0, beta=1e-6),
    Region("taped", (0.25, 0.5), alpha=60.0, beta=2e-5),
)


MIXED = replace(CLAMPED, damping=Damping(), regions=HALVES)


POINTS = np.array([0.2, 0.5])


def seen_from(spec: Spec, points=POINTS, **options) -> Simulated:
    return simulated(
        Predictor(spec, blank(np.linspace(0.1, 0.5, 5))), points=np.atleast_2d(points).T, **options
    )
