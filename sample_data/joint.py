"""A cantilever whose clamp gives the harder it is hit: what stands behind ``beam_joint``, all of it invented.

The structure is that of the model, but of 53 Timoshenko elements. All its frequencies fall by 8e-5 per newton of the
hammer's peak force, as they would where a clamp slips; its damping grows with the force.
"""

from __future__ import annotations

import numpy as np

from acquisition import Dof, Geometry, HammerPlan, HammerTest, ModalSystem, hammer_test, modal_system
from acquisition.arrays import FloatArray
from updating import Material, Measured, Predictor, Spec

SLOPE = -8e-5
"""Relative change of all frequencies per newton of the peak force [1/N]."""
FRICTION = 2e-5
"""Change of all damping ratios per newton of the peak force [1/N]."""
RATIO = 0.006
"""Damping ratio of all modes for the softest of hits [-]."""
HITS = 6
MODES = 5
LENGTH = 0.376
SEED = 105
PLAN = HammerPlan(
    rate=1280.0,
    samples=1024,
    hits=HITS,
    peak=60.0,
    level_scatter=0.5,
    width=2.4e-3,
    pre_trigger=0.02,
    force_noise=0.01,
    response_noise=3e-4,
    position_sigma=0.0,
    decay=4.0,
    adc_bits=20,
)


def behind() -> tuple[FloatArray, FloatArray]:
    """Return frequencies [Hz] and shapes (n_points, n_modes) [kg^-1/2] for the softest of hits."""
    spec = Spec(
        "beam",
        length=LENGTH,
        width=0.0305,
        thickness=0.0047625,
        elements=(53,),
        clamped=("x0",),
        theory="timoshenko",
        material=Material(210e9, 7850.0, 0.3),
    )
    points, nothing = _points(), np.full(1, np.nan)
    n = len(points)
    own_predictor = Measured(
        frequency=np.array([500.0]), frequency_sigma=nothing, damping=nothing, damping_sigma=nothing,
        points=points[:, None], nodes=tuple(range(1, n + 1)), seen=np.arange(n), hit=np.full(n, -1),
        constants=np.ones((n, 1)), constants_sigma=np.ones((n, 1)), absolute=False,
    )  # fmt: skip
    found = Predictor(spec, own_predictor).predict(count=MODES)
    return found.frequency, found.constants


def _points() -> FloatArray:
    return np.asarray(LENGTH * np.arange(1, 6) / 5)


def joint_test() -> HammerTest:
    """Hit the beam softly and hard at five points, the accelerometer at the free end."""
    frequency, shapes = behind()
    nodes = [Dof(i + 1, 3) for i in range(len(shapes))]

    def at_level(level: float) -> ModalSystem:
        return modal_system(
            frequency=frequency * (1 + SLOPE * level),
            damping=np.full(MODES, RATIO + FRICTION * level),
            response_shapes=shapes[-1:],
            point_shapes=shapes,
            responses=nodes[-1:],
            points=nodes,
        )

    flat = np.zeros((len(shapes), 3))
    flat[:, 0] = _points()
    places = Geometry(tuple(range(1, len(flat) + 1)), flat)
    return hammer_test(at_level, PLAN, rng=np.random.default_rng(SEED), geometry=places)
