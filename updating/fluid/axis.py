"""One axis of the plate: the functions that carry the potential jump, and their integrals over the plate."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import make_interp_spline

from acquisition.arrays import FloatArray


@dataclass(frozen=True)
class JumpAxis:
    r"""Functions for the potential jump along one axis of the wetted plate, 0 to ``side``.

    At a free edge the jump vanishes like the square root of the distance; at an edge that touches a rigid
    wall it does not vanish but has a level tangent. Between two free edges the functions are
    :math:`\sqrt{1-t^2}\,U_n(t)` (Chebyshev, second kind), n = 0, 1, ...; with one edge at a wall the
    symmetric half of the same functions on the interval mirrored at the wall (n = 0, 2, ...); with both edges
    at walls cosines. All have closed Fourier transforms (``spectra``).

    Parameters
    ----------
    side : float
        Length of the axis. [m]
    low_wall, high_wall : float
        Rigid walls, both finite or both infinite. [m]
    low_touches, high_touches : bool
        Whether the edge at 0, or at ``side``, closes the gap to its wall.
    terms : int
        Number of functions.
    """

    side: float
    low_wall: float
    high_wall: float
    low_touches: bool
    high_touches: bool
    terms: int

    @property
    def spans(self) -> bool:
        """Whether the plate reaches from wall to wall along this axis."""
        return self.low_touches and self.high_touches

    @property
    def mirrored(self) -> bool:
        """Whether exactly one edge touches a wall, so that the functions are halves of mirrored ones."""
        return self.low_touches != self.high_touches

    @property
    def open_water(self) -> bool:
        """Whether there are no walls along this axis."""
        return math.isinf(self.low_wall)

    @property
    def centre(self) -> float:
        """Where t = 0 lies: the middle, or the wall that the plate touches. [m]"""
        if not self.mirrored:
            return 0.5 * self.side
        return 0.0 if self.low_touches else self.side

    @property
    def half(self) -> float:
        """Length that t = 1 stands for. [m]"""
        return self.side if self.mirrored else 0.5 * self.side

    @property
    def degrees(self) -> FloatArray:
        """Chebyshev degrees n of the functions, shape (terms,)."""
        return (2 if self.mirrored else 1) * np.arange(self.terms, dtype=np.float64)

    def projection(self, points: FloatArray) -> FloatArray:
        """Integrals of the functions times a deflection given at ``points``, which a quintic spline joins.

        Parameters
        ----------
        points : FloatArray
            Ascending, shape (n,). [m]

        Returns
        -------
        FloatArray
            Shape (terms, n). [m]
        """
        where, functions, weight = self._quadrature()
        spline = make_interp_spline(points, np.eye(points.size), k=min(5, points.size - 1))
        return np.asarray((functions * weight) @ spline(where), dtype=np.float64)

    @property
    def gram(self) -> FloatArray:
        """Integrals of the products of every two functions over the plate, shape (terms, terms). [m]"""
        _, functions, weight = self._quadrature()
        return np.asarray((functions * weight) @ functions.T, dtype=np.float64)

    def slopes(self, reach: float) -> FloatArray:
        """Integrals of the products of every two slopes, to within ``reach`` of the free edges.

        At a free edge a slope grows like the inverse root of the distance, so the integral of its square like
        a logarithm. With u = ln tan(angle / 2), in which the functions are sines of the angle, it is smooth.

        Parameters
        ----------
        reach : float
            Distance from a free edge at which the integral ends, above zero. [m]

        Returns
        -------
        FloatArray
            Shape (terms, terms). [1/m]
        """
        node, weight = np.polynomial.legendre.leggauss(12 * self.terms + 96)
        if self.spans:
            wave = np.pi * np.arange(self.terms) / self.side
            sines = np.sin(0.5 * np.pi * np.arange(self.terms)[:, None] * (node + 1.0)) * wave[:, None]
            return np.asarray((sines * (0.5 * self.side * weight)) @ sines.T, dtype=np.float64)
        last = -math.log(math.tan(0.5 * math.acos(1.0 - min(reach / self.half, 0.5))))
        low, high = (0.0 if self.high_touches else -last), (0.0 if self.low_touches else last)
        angle = 2.0 * np.arctan(np.exp(0.5 * (low + high) + 0.5 * (high - low) * node))
        order = self.degrees[:, None] + 1.0
        cosines = order * np.cos(order * angle)
        return np.asarray((cosines * (0.5 * (high - low) * weight)) @ cosines.T / self.half, dtype=np.float64)

    def _quadrature(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return points on the plate (n,) [m], the functions there (terms, n), and weights (n,) [m].

        Gauss points in the angle arccos t, in which the functions are sines, or along a spanning plate.
        """
        node, weight = np.polynomial.legendre.leggauss(4 * self.terms + 48)
        fraction, weight = 0.5 * (node + 1.0), 0.5 * weight
        if self.spans:
            cosines = np.cos(np.pi * np.arange(self.terms)[:, None] * fraction)
            return self.side * fraction, cosines, self.side * weight
        first = 0.5 * math.pi if self.high_touches else 0.0
        last = 0.5 * math.pi if self.low_touches else math.pi
        angle = first + (last - first) * fraction
        functions = np.sin((self.degrees[:, None] + 1.0) * angle)
        where = self.centre + self.half * np.cos(angle)
        return where, functions, weight * (last - first) * np.sin(angle) * self.half
