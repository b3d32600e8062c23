"""Added mass of water on a beam that moves across its width, by doublets on its surface.

The beam is a flat strip in an ideal fluid, unbounded or between a free surface and a
bottom (``images``). Its surface carries doublet panels of constant strength;
the normal velocity of a rectangular panel in its own plane has a closed form (a vortex ring of four straight
sides; Katz and Plotkin, Low-Speed Aerodynamics, 2nd ed., section 10.4.5). Panels and collocation points are
cosine-spaced across and along, which takes care of the square-root edges. The finite thickness enters as the
ratio of the two-dimensional added mass of a rectangle to that of a flat strip.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy.optimize

from acquisition.arrays import FloatArray, frozen_array
from modalkit.simulator.bodies.images import all_corners, images

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(80)


@lru_cache(maxsize=256)
def thickness_factor(ratio: float) -> float:
    """Return how much a finite thickness raises the two-dimensional added mass of a strip.

    The outside of a rectangle is the image of the outside of the unit circle under a map with
    dz/dzeta = sqrt(1 - 2 cos(2 a) zeta^-2 + zeta^-4); its Laurent coefficients give the added mass
    rho (2 pi (1 + cos 2a) - area), in units where the map's scale is one (Newman, Marine Hydrodynamics, 1977,
    section 4.17).

    Parameters
    ----------
    ratio : float
        Thickness over width [-].

    Returns
    -------
    float
        Factor on rho pi width^2 / 4 [-].
    """
    if ratio < 1e-9:
        return 1.0
    angle = float(
        scipy.optimize.brentq(lambda a: _side(a) - ratio * _side(np.pi / 2 - a), 1e-8, np.pi / 2 - 1e-3)
    )
    thickness, width = _side(angle), _side(np.pi / 2 - angle)
    return float((2 * np.pi * (1 + np.cos(2 * angle)) - thickness * width) / (np.pi / 4 * width**2))


def _side(angle: float) -> float:
    """Return the side of the rectangle seen under twice an angle: 4 int_0^a sqrt(sin^2 a - sin^2 t) dt.

    With sin t = sin a sin u the integrand is smooth.
    """
    u = 0.25 * np.pi * (1 + _NODES)
    s = np.sin(angle)
    values = s**2 * np.cos(u) ** 2 / np.sqrt(1 - s**2 * np.sin(u) ** 2)
    return float(4 * 0.25 * np.pi * np.sum(_WEIGHTS * values))


@lru_cache(maxsize=64)
def _flat_plate(
    aspect: float, along: int, across: int, tank: tuple[float, float]
) -> tuple[FloatArray, FloatArray]:
    """Solve a plate of unit width in a tank: stations along it, and added mass between them for unit density."""
    edge_x, x = _cosine(aspect, along)
    edge_y, y = _cosine(1.0, across)
    dx = x[:, None] - edge_x[None, :]
    dy = y[:, None] - edge_y[None, :]
    grid = all_corners(dx[:, None, :, None], dy[None, :, None, :], images(*tank))
    velocity = (grid[..., 1:, 1:] - grid[..., :-1, 1:] - grid[..., 1:, :-1] + grid[..., :-1, :-1]) / (
        4 * np.pi
    )
    influence = velocity.reshape(along * across, along * across)
    spread = np.repeat(np.eye(along), across, axis=0)
    strength = np.linalg.solve(influence, spread)
    area = np.outer(np.diff(edge_x), np.diff(edge_y)).ravel()
    matrix = spread.T @ (area[:, None] * strength)
    return frozen_array(x), frozen_array(0.5 * (matrix + matrix.T))


def _cosine(length: float, count: int) -> tuple[FloatArray, FloatArray]:
    """Return ``count + 1`` edges and ``count`` collocation points, spaced evenly in the angle [m].

    The midpoints in the angle are those that make the two-dimensional strip exact (Lan, J. Aircraft 11 (1974)
    518).
    """
    step = np.pi / count
    edges = 0.5 * length * (1 - np.cos(step * np.arange(count + 1)))
    centres = 0.5 * length * (1 - np.cos(step * (np.arange(count) + 0.5)))
    return edges, centres


def added_mass(
    length: float,
    width: float,
    thickness: float,
    *,
    density: float,
    tank: tuple[float, float] = (np.inf, np.inf),
    along: int = 40,
    across: int = 10,
) -> tuple[FloatArray, FloatArray]:
    """Return the added mass of a strip, as a matrix between stations along it.

    Parameters
    ----------
    length, width, thickness : float
        Of the strip [m].
    density : float
        Of the fluid [kg/m3].
    tank : (surface, bottom)
        Their distances from the faces, above and below [m].
    along, across : int
        Panels [-].

    Returns
    -------
    stations : (along,) array
        Positions from the start [m].
    matrix : (along, along) array
        Symmetric; ``velocity @ matrix @ velocity / 2`` is the kinetic energy of the fluid [kg].
    """
    distances = tuple(round((far + 0.5 * thickness) / width, 6) for far in tank)
    x, matrix = _flat_plate(round(length / width, 6), along, across, distances)
    return x * width, density * width**3 * thickness_factor(thickness / width) * matrix


@lru_cache(maxsize=256)
def slip_factor(ratio: float) -> float:
    """Return the square of the flow's speed along a rectangle that moves across its width, integrated around it.

    In the body's frame the flow about the circle is 2 V cos(theta) fast, that about its image as much over
    ``|dz/dzeta| = 2 sqrt|sin^2 a - sin^2 theta|``, which is square-integrable at the corners (Batchelor, An
    Introduction to Fluid Dynamics, 1967, sections 5.13 and 6.5). Substitutions make both pieces smooth.

    Parameters
    ----------
    ratio : float
        Thickness over width, not zero: the edges of a plate without thickness would dissipate without end [-].

    Returns
    -------
    float
        Integral over V^2 and width [-].
    """
    angle = float(
        scipy.optimize.brentq(lambda a: _side(a) - ratio * _side(np.pi / 2 - a), 1e-8, np.pi / 2 - 1e-3)
    )
    u = 0.25 * np.pi * (1 + _NODES)
    weight = 0.25 * np.pi * _WEIGHTS
    short = np.sqrt(1 - (np.sin(angle) * np.sin(u)) ** 2)
    sine = np.cos(angle) * np.sin(u)
    broad = sine**2 / np.sqrt(1 - sine**2)
    return float(8 * np.sum(weight * (short + broad)) / _side(np.pi / 2 - angle))


def layer_damping(
    length: float, width: float, thickness: float, *, drag: float, along: int = 40, across: int = 10
) -> tuple[FloatArray, FloatArray]:
    """Return the damping of a strip by the boundary layer of a fluid, as a matrix between stations along it.

    The flow is that of the strip in two dimensions times the ratio of the doublets' strength, of which
    :func:`added_mass` is the integral, to that in two dimensions: so it is less at the ends and for short waves.

    Parameters
    ----------
    length, width, thickness : float
        Of the strip [m].
    drag : float
        Density times viscosity of the fluid [kg2/(m4 s)].
    along, across : int
        Panels [-].

    Returns
    -------
    stations : (along,) array
        Positions from the start [m].
    matrix : (along, along) array
        ``omega^(1/2) velocity @ matrix @ velocity`` is twice the mean power lost at amplitudes ``velocity``
        [kg/s^(1/2)]: the layer resists by sqrt(density viscosity omega / 2) times the speed along the wall,
        and adds as much over omega as inertia (Stokes 1851; Landau and Lifshitz, Fluid Mechanics, 2nd ed.,
        section 24).
    """
    edges, _ = _cosine(length, along)
    size = np.diff(edges)
    stations, inertia = added_mass(length, width, thickness, density=1.0, along=along, across=across)
    strip = np.pi / 4 * width**2 * thickness_factor(thickness / width)
    relative = inertia / (strip * size[:, None])
    line = np.sqrt(drag / 2) * slip_factor(thickness / width) * width
    return stations, line * relative.T @ (size[:, None] * relative)
