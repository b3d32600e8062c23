"""The test on a body that is modelled by matrices, of bars or bricks."""

from __future__ import annotations

from typing import Any

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.simulator.bodies.block.block import Block
from modalkit.simulator.bodies.frame.frame import Frame
from modalkit.simulator.drawing.common import draw_test, near_a_node, rayleigh, two_digits
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.setup import Setup, Tolerances

Points = tuple[tuple[float, float], ...]


def draw_on(
    rng: np.random.Generator, plan: DrawRanges, body: Frame | Block, points: Points, **more: Any
) -> tuple[Setup, FloatArray]:
    """Draw a test on a body.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    plan : DrawRanges
        Of tests.
    body : Frame or Block
        As drawn.
    points : tuple of (x, y)
        Points of the test [m].
    **more
        What else the setup states, in place of what was drawn, too.

    Returns
    -------
    setup : Setup
        Its dimensions are those of the drawing, since its model takes no others.
    frequency : (modes + 1,) array
        Of the body, one beyond the band [Hz].
    """
    modes = int(rng.choice([7, 8, 9]))
    omega, shapes = body.real_modes(modes + 1)
    seen = body.rows(np.array(points), "w") @ shapes[:, :modes]
    share = np.abs(seen) / (np.abs(seen).max(axis=0) if isinstance(body, Block) else 1.0)
    sensor = near_a_node(rng, seen, int(np.argmax(share.min(axis=1))))
    bare = omega / (2 * np.pi)
    alpha, beta = rayleigh(rng, float(bare[0]), float(bare[modes - 1]))
    stated: dict[str, Any] = {
        "length": body.end - body.start,
        "width": body.width,
        "thickness": body.thickness,
        "breadth": body.breadth,
        "E": body.E,
        "density": body.density,
        "poisson": body.poisson,
        "clamped": body.clamped,
        "theory": "",
        "tolerances": Tolerances(thickness=0.0, length=0.0, width=0.0),
        "alpha": alpha,
        "beta": beta,
        "points": points,
        "sensor": sensor,
        "sensor_mass": 0.0,
        "modes": modes,
        "band": (two_digits(0.25 * bare[0]), float(np.sqrt(bare[modes - 1] * bare[modes]).round(1))),
        "window": 0.0,
    }
    test = draw_test(rng, plan) | {"baseline": False, "environment": None}
    return Setup(**(stated | test | more)), bare
