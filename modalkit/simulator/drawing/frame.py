"""Random frames and the tests on them."""

from __future__ import annotations

import numpy as np

from modalkit.simulator.bodies.frame.frame import Frame
from modalkit.simulator.drawing.common import MATERIAL_SHARES, MATERIALS
from modalkit.simulator.drawing.of_matrices import draw_on
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.setup import Setup

_RUNGS = (0.36, 0.7, 1.0)
_MODELLED = 6
"""Bars in each stretch of the modeller's mesh, half of those of the specimen [-]."""


def draw_frame(rng: np.random.Generator, plan: DrawRanges) -> Setup | None:
    """Draw a frame and its test.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    plan : DrawRanges
        Of tests.

    Returns
    -------
    Setup or None
        Its dimensions are those of the drawing, since its model takes no others; None where its first frequency is
        below 5 Hz.
    """
    length, width = round(rng.uniform(0.4, 0.9), 3), round(rng.uniform(0.18, 0.4), 3)
    depth = round(rng.uniform(0.006, 0.012), 4)
    breadth = round(depth * rng.uniform(1.5, 3.0), 4)
    modulus, density, poisson = MATERIALS[int(rng.choice(3, p=MATERIAL_SHARES))]
    rungs = (*(round(share + rng.uniform(-0.04, 0.04), 3) for share in _RUNGS[:-1]), _RUNGS[-1])
    body = Frame(
        start=0.0,
        end=length,
        width=width,
        breadth=breadth,
        thickness=depth,
        E=modulus,
        density=density,
        poisson=poisson,
        rungs=rungs,
    )
    points = _points(rng, body)
    setup, bare = draw_on(
        rng, plan, body, points,
        kind="frame", title=f"Frame of {1e3 * length:.0f} x {1e3 * width:.0f} mm",
        elements=(_MODELLED,), rungs=rungs,
    )  # fmt: skip
    return None if bare[0] < 5.0 else setup


def _points(rng: np.random.Generator, body: Frame) -> tuple[tuple[float, float], ...]:
    """Return a place on every stretch of bar, off its ends and middle by chance, and both free corners."""
    found = [(body.end, 0.0), (body.end, body.width)]
    for name in body.names:
        nodes = [bar.nodes for bar in body.mesh.bars if bar.part == name]
        first, last = body.mesh.places[nodes[0][0]], body.mesh.places[nodes[-1][1]]
        share = int(rng.integers(1, _MODELLED)) / _MODELLED
        x, y = (first + share * (last - first)).tolist()
        found.append((round(x, 6), round(y, 6)))
    return tuple(found)
