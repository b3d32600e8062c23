"""Images of a flat sheet in the surface and the bottom of a tank.

A sheet of doublets across the fluid between a free surface, on which the potential is zero, and a rigid bottom is
one in a fluid without end, together with its images: one in the surface has the same strength, one in the
bottom the opposite (Newman, Marine Hydrodynamics, 1977, section 4.13, turned from sources to doublets). Waves
on the surface are left out, as they may be where omega^2 is far above g over the length of the waves.
"""

from __future__ import annotations

import numpy as np

from acquisition.arrays import FloatArray

_MOST = 12
"""Pairs of images on either side: they alternate and fall with the cube of the distance. Twice as many cost twice
as much, and change the added mass of a sheet half its width above the bottom by less than 1e-4."""

Images = tuple[tuple[float, float], ...]


def images(surface: float, bottom: float) -> Images:
    """Return heights [m] and strengths [-] of all images of a sheet at height zero.

    Parameters
    ----------
    surface, bottom : float
        Distances of the free surface above and of the bottom below it; infinite ones are left out [m].
    """
    up, down = np.isfinite(surface), np.isfinite(bottom)
    if not (up and down):
        return ((2 * surface, 1.0),) if up else ((-2 * bottom, -1.0),) if down else ()
    depth = surface + bottom
    found = []
    for n in range(-_MOST, _MOST + 1):
        sign = -1.0 if n % 2 else 1.0
        found += [(2 * n * depth, sign)] if n else []
        found.append((2 * surface + 2 * n * depth, sign))
    return tuple(sorted(found))


def corner(x: FloatArray, y: FloatArray, height: float = 0.0) -> FloatArray:
    """Return what one corner of a doublet panel adds to the velocity across it, times 4 pi [1/m].

    The height derivative of the solid angle atan(x y / (z r)) under which a corner is seen (Katz and Plotkin,
    Low-Speed Aerodynamics, 2nd ed., sections 10.4.2 and 10.4.5); in the panel's own plane sqrt(x^2 + y^2) / (x y).

    Parameters
    ----------
    x, y : arrays that broadcast
        Distances from the corner [m].
    height : float
        Above the panel's plane [m].
    """
    if not height:
        return np.asarray(np.hypot(x, y) / (x * y))
    z = height * height
    a, b = x * x + z, y * y + z
    distance = np.sqrt(a + y * y)
    return np.asarray(x * y * (a + b) / (distance * a * b))


def all_corners(x: FloatArray, y: FloatArray, mirrored: Images) -> FloatArray:
    """Return the same of a panel and its images [1/m]."""
    whole = corner(x, y)
    for height, strength in mirrored:
        whole = whole + strength * corner(x, y, height)
    return whole
