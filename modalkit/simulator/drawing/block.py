"""Random ribbed plates and brackets, and the tests on them."""

from __future__ import annotations

import numpy as np

from modalkit.simulator.bodies.block.block import Block
from modalkit.simulator.drawing.common import MATERIAL_SHARES, MATERIALS
from modalkit.simulator.drawing.of_matrices import draw_on
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.setup import Setup

HIGHEST = 6000.0
"""Frequency at which a band ends at the most: a hammer's pulse holds no more [Hz]."""

MODELLED = 12
"""Bricks along the modeller's mesh; the specimen has those of :class:`Block` [-]. With 10, meshes of some ribbed plates
err by 0.3 % from mode to mode, and the mesh is what a diagnosis finds."""

REPEATABILITY = 0.001
"""What these tests state: re-mounting does that, and the mesh moves single frequencies by 0.05 % beside what all have
in common [-]. Doubled, faint effects are lost."""


def draw_ribbed(rng: np.random.Generator, plan: DrawRanges) -> Setup | None:
    """Draw a ribbed plate and its test; see :func:`_draw`."""
    length = round(rng.uniform(0.3, 0.6), 3)
    thickness = round(length / rng.uniform(60, 100), 4)
    height = round(thickness * rng.uniform(2.0, 3.5), 4)
    return _draw(rng, plan, "ribbed", (length, rng.uniform(0.55, 0.8), thickness), height, 1.5 * thickness)


def draw_bracket(rng: np.random.Generator, plan: DrawRanges) -> Setup | None:
    """Draw a bracket and its test; see :func:`_draw`."""
    length = round(rng.uniform(0.2, 0.4), 3)
    thickness = round(length / rng.uniform(28, 45), 4)
    height = round(length * rng.uniform(0.2, 0.3), 4)
    return _draw(rng, plan, "bracket", (length, rng.uniform(0.55, 0.8), thickness), height, 1.2 * thickness)


def _draw(
    rng: np.random.Generator,
    plan: DrawRanges,
    kind: str,
    size: tuple[float, float, float],
    height: float,
    breadth: float,
) -> Setup | None:
    """Draw material and test of a body of some length, width over it, and thickness [m].

    Returns
    -------
    Setup or None
        Its dimensions are those of the drawing, since its model takes no others; None where the band ends
        above ``HIGHEST``.
    """
    length, width, thickness = size[0], round(size[0] * size[1], 3), size[2]
    modulus, density, poisson = MATERIALS[int(rng.choice(3, p=MATERIAL_SHARES))]
    breadth = round(breadth, 4)
    body = Block(
        kind=kind,
        start=0.0,
        end=length,
        width=width,
        thickness=thickness,
        height=height,
        breadth=breadth,
        E=modulus,
        density=density,
        poisson=poisson,
        elements=MODELLED,
    )
    points = _points(rng, body)
    setup, bare = draw_on(
        rng, plan, body, points,
        kind=kind, title=f"{kind.capitalize()} of {1e3 * length:.0f} x {1e3 * width:.0f} mm",
        elements=(MODELLED,), height=height, repeatability=REPEATABILITY,
    )  # fmt: skip
    return None if bare[-1] > HIGHEST else setup


def _points(rng: np.random.Generator, body: Block) -> tuple[tuple[float, float], ...]:
    """Return crossings of the modeller's mesh on the upper face: the far corners, and one in each of twelve fields."""
    lines = body.bricks.mesh.x, body.bricks.mesh.y
    found = {(body.end, 0.0), (body.end, body.width)}
    for column in np.array_split(np.arange(1, len(lines[0])), 4):
        for row in np.array_split(np.arange(len(lines[1])), 3):
            found.add(
                (round(float(lines[0][rng.choice(column)]), 9), round(float(lines[1][rng.choice(row)]), 9))
            )
    return tuple(sorted(found))
