"""Supports of imported matrices that give way on springs, in as many directions at once as one likes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

import numpy as np
from scipy import sparse

from acquisition.arrays import FloatArray
from updating.models.fields import Sparse


@dataclass(frozen=True, eq=False)
class Yielding:
    """A support that moves as one body on springs.

    With its motion q eliminated, K_ff x - L q = f and -L^T x + (K_qq + S) q = 0 leave K_ff - L (K_qq + S)^-1 L^T
    (static condensation, Guyan 1965), over the directions in which it gives way. The mass of the rows that move with it
    is carried along by the same q = T x, T = (K_qq + S)^-1 L^T: T^T M_qq T + G T + T^T G^T.

    Parameters
    ----------
    loads : (r, 6) array
        L: forces on the structure, negative, when the support shifts along x, y, z or turns about them by one, in the
        coordinates of a basis [SI].
    own : (6, 6) array
        K_qq: forces on the support at the same [SI].
    mass : (6, 6) array
        M_qq of the rows that the support held [kg, kg m, kg m^2].
    inertia : (r, 6) array
        G, their mass in common with the rows of the structure [SI].
    compliance : (6,) array
        C = S^-1: of the springs, zero where the support holds [m/N, rad/(N m)].
    held_by : (n_regions + 1,) array
        Each region's share in L and K_qq, the last that of none [-].
    carried_by : (n_regions + 1,) array
        Each region's share in M_qq and G, likewise [-].
    """

    loads: FloatArray
    own: FloatArray
    mass: FloatArray
    inertia: FloatArray
    compliance: FloatArray
    held_by: FloatArray
    carried_by: FloatArray

    def beside(self, other: Yielding) -> Yielding:
        """Return the same support on the springs of both, one behind the other: compliances add."""
        return replace(self, compliance=self.compliance + other.compliance)

    def at(self, stiffness: FloatArray, mass: FloatArray, *, carried: float = 1.0) -> Yielding:
        """Return the same support where each region is some times as stiff and heavy.

        Parameters
        ----------
        stiffness, mass : (n_regions + 1,) array
            Factors of the regions [-].
        carried : float
            Factor of the mass that the support carries along, whatever the regions weigh [-].
        """
        if np.all(stiffness == 1.0) and np.all(mass == 1.0) and carried == 1.0:
            return self
        held, weights = self.held_by * stiffness, self.carried_by * mass
        stiffer, heavier = held.sum(), weights.sum()
        return replace(
            self,
            loads=self.loads * stiffer,
            own=self.own * stiffer,
            mass=self.mass * heavier * carried,
            inertia=self.inertia * heavier * carried,
            held_by=held / stiffer,
            carried_by=weights / heavier,
        )

    @cached_property
    def _condensed(self) -> tuple[FloatArray, FloatArray]:
        """S and (K_qq + S)^-1 over the directions in which it gives way, nothing elsewhere, each (6, 6)."""
        gives = np.flatnonzero(self.compliance > 0)
        springs, inverse = np.zeros((6, 6)), np.zeros((6, 6))
        springs[gives, gives] = 1.0 / self.compliance[gives]
        inner = np.ix_(gives, gives)
        inverse[inner] = np.linalg.inv(self.own[inner] + springs[inner])
        return springs, inverse

    @property
    def stiffness(self) -> FloatArray:
        """What is added to the stiffness of the structure, (r, r) [SI]."""
        return self._across(-self._condensed[1])

    @property
    def strained(self) -> FloatArray:
        """What is added to twice the energy in the structure, without the springs, (r, r) [SI].

        It is the derivative of ``stiffness`` by the logarithm of L and K_qq, too: the springs do not scale.
        """
        return self.stiffness - self.springs

    @property
    def springs(self) -> FloatArray:
        """Twice the energy in the springs, q^T S q, as a form of the structure's motion, (r, r) [SI]."""
        springs, inverse = self._condensed
        return self._across(inverse @ springs @ inverse)

    @property
    def carried(self) -> FloatArray:
        """What is added to the mass of the structure, (r, r) [SI]."""
        inverse = self._condensed[1]
        own, common = self._across(inverse @ self.mass @ inverse), self._times(self.inertia, inverse)
        return own + common + common.T

    @property
    def drawn(self) -> FloatArray:
        """The derivative of ``carried`` by the logarithm of L and K_qq, (r, r) [SI]: a stiffer structure draws it."""
        springs, inverse = self._condensed
        more = inverse @ springs @ inverse
        half = self._across(more @ self.mass @ inverse) + self._times(self.inertia, more)
        return half + half.T

    def _times(self, left: FloatArray, middle: FloatArray) -> FloatArray:
        """Return left times middle times L^T, sparse where L is."""
        if sparse.issparse(self.loads):
            return cast(FloatArray, Sparse(left @ Sparse(middle) @ cast(Sparse, self.loads).T))
        return np.asarray(left @ middle @ self.loads.T)

    def _across(self, middle: FloatArray) -> FloatArray:
        return self._times(self.loads, middle)


def together(first: Mapping[str, Yielding], second: Mapping[str, Yielding]) -> dict[str, Yielding]:
    """Return the supports of both; one that stands in both is on the springs of both."""
    found = dict(first)
    for name, one in second.items():
        found[name] = found[name].beside(one) if name in found else one
    return found
