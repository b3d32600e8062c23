"""Where the plate stands between its walls, and how many functions each axis needs."""

from __future__ import annotations

import math

from acquisition.errors import InputError

from .axis import JumpAxis

TOUCHING = 1e-6
"""Gap below which an edge closes on a wall, relative to the plate's side."""

FAR = 8.0
"""Walls farther than this many times the cube root of width^2 length are left out."""


def place(
    length: float,
    width: float,
    walls: tuple[float, float, float, float] | None,
    terms: tuple[int, int],
) -> tuple[JumpAxis, JumpAxis]:
    """Place the plate x in [0, length], y in [0, width] between its walls.

    Parameters
    ----------
    length, width : float
        Sides of the plate. [m]
    walls : tuple of four floats or None
        x0, x1, y0, y1. [m]
    terms : tuple of two ints
        Functions along x and y.

    Returns
    -------
    tuple of JumpAxis
        Along x and across y.

    Raises
    ------
    InputError
        If the plate reaches beyond a wall or fills the tank.
    """
    x0, x1, y0, y1 = walls or (-math.inf, math.inf, -math.inf, math.inf)
    reach = _reach(_mirrored(length, x0, x1), _mirrored(width, y0, y1))
    along = _axis("x", length, (x0, x1), reach, terms[0])
    across = _axis("y", width, (y0, y1), reach, terms[1])
    if along.spans and across.spans:
        raise InputError(
            "added mass: the plate fills the tank from wall to wall, so the fluid below it cannot move; "
            "leave a gap or give other walls"
        )
    return along, across


def term_counts(length: float, width: float) -> tuple[int, int]:
    """Functions per axis: more along a slender side, where the flow changes over a width at the ends."""

    def count(side: float, other: float) -> int:
        return 14 + min(14, round(4.0 * math.sqrt(max(side / other, 1.0))))

    return count(length, width), count(width, length)


def _mirrored(side: float, low: float, high: float) -> float:
    """Side of the plate together with its image, where it touches a wall. [m]"""
    return side if min(-low, high - side) > TOUCHING * side else 2.0 * side


def _reach(length: float, width: float) -> float:
    """Distance beyond which a wall changes the added mass by less than 2e-4: its image is a dipole's."""
    short, long = sorted((length, width))
    return FAR * float((short**2 * long) ** (1.0 / 3.0))


def _axis(name: str, side: float, walls: tuple[float, float], reach: float, terms: int) -> JumpAxis:
    """Place one axis between its walls; a wall beyond ``reach`` is moved there, or left out."""
    tolerance = TOUCHING * side
    gaps = (-walls[0], walls[1] - side)
    if min(gaps) < -tolerance:
        raise InputError(
            f"added mass: the plate occupies {name} = 0 to {side} m but the walls stand at {walls[0]} and "
            f"{walls[1]} m; give walls outside the plate, in the model's axes"
        )
    low, high = (gap <= tolerance for gap in gaps)
    if min(gaps) > reach:
        return JumpAxis(side, -math.inf, math.inf, low, high, terms)
    low_wall = 0.0 if low else -min(gaps[0], reach)
    high_wall = side + (0.0 if high else min(gaps[1], reach))
    return JumpAxis(side, low_wall, high_wall, low, high, terms)
