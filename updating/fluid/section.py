"""Added mass of a rectangular section moving normal to its longer side, in closed form."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk, ellipkm1

from acquisition.arrays import FloatArray
from acquisition.errors import InputError


def _sides(logit: float) -> tuple[float, float, float]:
    """Return thickness and breadth of the rectangle outside which the unit circle's exterior maps, and 1 - m."""
    m = 1.0 / (1.0 + math.exp(-logit))
    complement = 1.0 / (1.0 + math.exp(logit))
    thickness = 4.0 * float(ellipe(m) - complement * ellipk(m))
    breadth = 4.0 * float(ellipe(complement) - m * ellipkm1(m))
    return thickness, breadth, complement


def mapped_sides(ratio: float) -> tuple[float, float, float]:
    """Return the rectangle of given t/b as the image of the unit circle: thickness, breadth and 1 - m.

    The map is that of :func:`heave_coefficient` with c = 1, m = sin(alpha)^2 and alpha where the corner lies.

    Raises
    ------
    InputError
        If the ratio is not between 1e-9 and a hundred.
    """
    if not 1e-9 <= ratio <= 100.0:
        raise InputError(f"section: thickness over breadth is {ratio}; it must lie between 0 and 100")

    def miss(logit: float) -> float:
        thickness, breadth, _ = _sides(logit)
        return math.log(thickness / breadth / ratio)

    return _sides(float(brentq(miss, -28.0, 7.0, xtol=1e-12)))


def heave_coefficient(ratio: float) -> float:
    r"""Added mass of a thick rectangular section relative to that of the flat strip, rho pi b^2 / 4.

    The exterior of the unit circle maps on the exterior of the rectangle by the Schwarz-Christoffel formula
    dz/dzeta = c sqrt(1 - 2 cos(2 alpha) / zeta^2 + 1 / zeta^4). With m = sin(alpha)^2 the sides are
    t = 4 c (E(m) - (1 - m) K(m)) and b = 4 c (E(1 - m) - m K(1 - m)), and the added mass follows from the
    first two coefficients of the map: rho (4 pi c^2 (1 - m) - b t).

    Parameters
    ----------
    ratio : float
        Thickness over breadth t/b, zero to a hundred. [-]

    Returns
    -------
    float
        1 for a flat strip, 1.14 for t/b = 0.1, 1.51 for a square. [-]

    Raises
    ------
    InputError
        If the ratio is negative or beyond a hundred.

    References
    ----------
    Newman, Marine Hydrodynamics (1977), chapter 4 (added mass from the map's coefficients); Wendel (1956).
    """
    if 0.0 <= ratio < 1e-9:
        return 1.0
    thickness, breadth, complement = mapped_sides(ratio)
    return (4.0 * math.pi * complement - breadth * thickness) * 4.0 / (math.pi * breadth**2)


def strip_theory(shapes: FloatArray, x: FloatArray, *, width: float, thickness: float = 0.0) -> FloatArray:
    """Added mass of a slender beam by strip theory: pi b^2/4 per length at every section. A check only.

    Flow past the ends and between sections of unlike motion is left out, so it is an upper bound.

    Parameters
    ----------
    shapes : FloatArray
        Deflections at ``x``, shape (n_modes, nx).
    x : FloatArray
        Stations, ascending, shape (nx,). [m]
    width : float
        Breadth b across the motion. [m]
    thickness : float
        Thickness of the section; zero is a flat strip. [m]

    Returns
    -------
    FloatArray
        Shape (n_modes, n_modes), for a fluid of unit density. [m^3 shape^2]
    """
    mass = math.pi * width**2 / 4.0 * heave_coefficient(thickness / width)
    products = shapes[:, None, :] * shapes[None, :, :]
    return np.asarray(mass * np.trapezoid(products, x, axis=-1), dtype=np.float64)
