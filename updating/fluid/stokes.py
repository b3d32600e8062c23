r"""Stokes' boundary layer on the faces of a vibrating plate: what a fluid of low viscosity takes out of it.

Outside a thin layer the flow is the potential flow; within it the tangential velocity falls to that of the
wall over the depth :math:`\delta = \sqrt{2\eta / \rho\omega}`. A wall along which the fluid slides with the
amplitude u loses, per area, the mean power :math:`\tfrac12 \sqrt{\rho\eta\omega/2}\,u^2` (Landau and Lifshitz,
Fluid Mechanics, section 24). At an edge u grows without bound and the integral of its square with the
logarithm of the distance, so it has to end somewhere: see :func:`edge_reach`.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from acquisition.arrays import FloatArray
from acquisition.errors import InputError

from .operator import AddedMassOperator
from .section import mapped_sides

LAYER = 0.0083
"""Reach of a sharp edge in depths of the layer, when that is thin: limit of the viscous strip [-].

See docs/explain/fluid.md.
"""

NODES, WEIGHTS = np.polynomial.legendre.leggauss(300)


def layer_depth(viscosity: float, density: float, frequency: float) -> float:
    """Return the depth of Stokes' layer.

    Parameters
    ----------
    viscosity : float
        Dynamic viscosity of the fluid. [Pa s]
    density : float
        Its density. [kg/m^3]
    frequency : float
        Frequency of the vibration. [Hz]

    Returns
    -------
    float
        [m]
    """
    return math.sqrt(viscosity / (density * math.pi * frequency))


def slip_coefficient(ratio: float) -> float:
    """Integral of the squared velocity round a rectangular section in heave, over breadth and squared speed.

    From the map of :func:`~updating.fluid.heave_coefficient`: the flow round the circle is 2 cos(theta), and
    the section stretches it by |dz/dzeta|. At the corners the velocity is infinite but its square is not.

    Parameters
    ----------
    ratio : float
        Thickness over breadth t/b, 1e-9 to a hundred. [-]

    Returns
    -------
    float
        7 at t/b = 0.16, rising with the logarithm of 1/t. [-]
    """
    _, breadth, complement = mapped_sides(ratio)
    corner = math.acos(math.sqrt(complement))
    total = 0.0
    for low, high in ((0.0, corner), (corner, 0.5 * math.pi)):
        s = 0.5 * (NODES + 1.0)
        angle = low + (high - low) * s * s * (3.0 - 2.0 * s)
        weight = 0.5 * WEIGHTS * (high - low) * 6.0 * s * (1.0 - s)
        stretch = 2.0 * np.sqrt(np.abs(np.sin(angle - corner) * np.sin(angle + corner)))
        total += 4.0 * float(np.sum(weight * (2.0 * np.cos(angle)) ** 2 / stretch))
    return total / breadth


def edge_reach(width: float, thickness: float, layer: float) -> float:
    """Distance from the edge of a thin plate at which its slip ends, so that it loses what the real edge does.

    Two things blunt an edge. The plate has a thickness: the flow round its square edge is finite in the mean
    square, and the reach is chosen so that a flat strip in heave slips as much as the exact rectangular
    section. And within the depth of the layer there is no potential flow.

    Parameters
    ----------
    width : float
        Shorter side. [m]
    thickness : float
        Thickness, zero for a sharp edge. [m]
    layer : float
        Depth of Stokes' layer; zero for a blunt edge alone. [m]

    Returns
    -------
    float
        [m]

    Raises
    ------
    InputError
        If neither thickness nor layer is positive, so that the edge loses an infinite power.
    """
    if not (width > 0.0 and thickness >= 0.0 and layer >= 0.0 and thickness + layer > 0.0):
        raise InputError(
            f"boundary layer: width {width}, thickness {thickness}, layer {layer} m; the width and one of the "
            "others must be positive, none negative"
        )
    reach = LAYER * layer
    if thickness > 1e-9 * width:
        wanted = slip_coefficient(thickness / width)
        reach += width * math.exp(brentq(lambda log: _cut_strip(math.exp(log)) - wanted, -60.0, -1.5))
    return reach


def _cut_strip(reach: float) -> float:
    """Slip of the flat strip of unit width and speed, both faces, to within ``reach`` of its edges."""
    return math.log((1.0 - reach) / reach) - 2.0 + 4.0 * reach


def slip_matrix(
    operator: AddedMassOperator, shapes: FloatArray, x: FloatArray, y: FloatArray, *, reach: float
) -> FloatArray:
    r"""Integral over both faces of the products of the tangential velocities of the potential flow.

    Each face carries half of the potential jump, as in unbounded fluid; nearness of a free surface or a bottom
    shifts the shares, which changes the sum of their squares in second order only.

    Parameters
    ----------
    operator : AddedMassOperator
        Of the *thin* plate.
    shapes : FloatArray
        Normal velocities on a grid, shape (n_modes, nx, ny).
    x, y : FloatArray
        Grid lines. [m]
    reach : float
        Where slip ends at free edges, from :func:`edge_reach`. [m]

    Returns
    -------
    FloatArray
        Shape (n_modes, n_modes), symmetric; times :math:`\sqrt{\rho\eta/2}` and the root of the angular
        frequency it is the damping matrix. [m^2 shape^2]
    """
    jump = operator.loads(shapes, x, y) @ operator.factor @ operator.factor.T
    along, across = operator.along, operator.across
    sides = (along.terms, across.terms)
    surface = jump.reshape(len(shapes), *sides)
    steep = along.slopes(reach) @ surface @ across.gram + along.gram @ surface @ across.slopes(reach)
    product = 0.5 * steep.reshape(len(shapes), -1) @ jump.T
    return np.asarray(0.5 * (product + product.T), dtype=np.float64)
