"""One factor of K + s M for lowest modes, static answers, and whether the stiffness is what it should be."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import linalg

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.checks import negative_pivots
from updating.models.imported.hollow import check_hollow
from updating.models.imported.ordering import factored
from updating.models.solve import DENSE, lowest

SMALL_SHIFT = 1e-9
"""The shift relative to the middle of the ratios of stiffness to mass on the diagonals [-]."""

ROUNDING = 1e-4
"""A negative eigenvalue beyond this share of the shift, and of the seventh, is none that rounding makes [-]."""


@dataclass(frozen=True, eq=False)
class Shifted:
    """Stiffness and mass, and K + s M factored.

    Parameters
    ----------
    stiffness, mass : (n, n) sparse arrays
        Symmetric; the mass positive definite [SI].
    source : str
        For messages.
    massless : bool
        Whether some motions have no mass, or next to none, so that 1 / (lambda + s) is solved for.
    places : (n, 3) array, optional
        Where the rows are, by which they are ordered [m].
    """

    stiffness: Sparse
    mass: Sparse
    source: str = "model"
    massless: bool = False
    places: FloatArray | None = None

    @cached_property
    def shift(self) -> float:
        """The shift s [rad^2/s^2]."""
        ratio = np.abs(self.stiffness.diagonal()) / self.mass.diagonal()
        return SMALL_SHIFT * float(np.median(ratio[ratio > 0])) if (ratio > 0).any() else 1.0

    @cached_property
    def factor(self) -> Any:
        """Triangular factors, the pivots on the diagonal.

        Raises
        ------
        StudyError
            If the stiffness has a negative eigenvalue beyond the shift.
        """
        try:
            factor = factored(Sparse(self.stiffness + self.shift * self.mass), self.places)
        except RuntimeError as error:
            raise StudyError(
                f"{self.source}: singular: some motion has neither stiffness nor mass ({error}); leave out degrees of "
                "freedom that nothing holds"
            ) from error
        check_hollow(self.stiffness, self.mass, factor, self.source, self.places)
        found = negative_pivots(factor)
        if found is not None:
            raise StudyError(
                f"{self.source}: stiffness matrix indefinite: {found[0]} negative eigenvalue(s), met first at row "
                f"{found[1]}; check signs, Lagrange multipliers (not supported) and preloads beyond buckling"
            )
        return factor

    def solve(self, loads: FloatArray) -> FloatArray:
        """Return (K + s M)^-1 times loads (n, k) [SI]."""
        return np.asarray(self.factor.solve(np.ascontiguousarray(loads)))

    def lowest(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest eigenvalues [rad^2/s^2] and mass-normalised vectors (n, count) [kg^-1/2].

        Raises
        ------
        StudyError
            If there are fewer degrees of freedom, or the stiffness is indefinite.
        """
        n = self.stiffness.shape[0]
        if count > n:
            raise StudyError(f"{self.source}: {n} degrees of freedom are too few for {count} modes")
        if n <= DENSE or count > n // 3:
            values, vectors = self._dense(count)
        else:
            values, vectors = self._sparse(count)
        rounding = max(ROUNDING * self.shift, ROUNDING * abs(float(values[min(6, count - 1)])))
        if values[0] < -rounding:
            row = int(np.argmax(np.abs(vectors[:, 0]))) + 1
            raise StudyError(
                f"{self.source}: stiffness matrix indefinite: eigenvalue {values[0]:.3g} rad^2/s^2, most at row {row}; "
                "check signs and preloads beyond buckling"
            )
        return values, vectors

    def _sparse(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Solve by shift and invert (Lanczos)."""
        n = self.stiffness.shape[0]
        inverse = linalg.LinearOperator((n, n), matvec=self.factor.solve, dtype=float)
        try:
            values, vectors = linalg.eigsh(
                self.stiffness, count, self.mass, sigma=-self.shift, OPinv=inverse, which="LM", v0=np.ones(n)
            )
        except linalg.ArpackError as error:
            raise StudyError(
                f"{self.source}: no modes found ({error}); is the stiffness that of the structure?"
            ) from error
        order = np.argsort(values)
        return values[order], vectors[:, order]

    def _dense(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Solve the whole spectrum; where the mass is (nearly) singular, for 1 / (lambda + s)."""
        if not self.massless:
            values, vectors = lowest(self.stiffness, self.mass, count)
        else:
            n = self.stiffness.shape[0]
            held = (self.stiffness + self.shift * self.mass).toarray()
            _ = self.factor  # says what is wrong with the stiffness, if anything is
            inverse, vectors = eigh(self.mass.toarray(), held, subset_by_index=(n - count, n - 1))
            inverse = np.maximum(inverse[::-1], 1e-300)
            values, vectors = 1 / inverse - self.shift, vectors[:, ::-1] / np.sqrt(inverse)
        return values, vectors
