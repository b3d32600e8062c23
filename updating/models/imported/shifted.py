"""One factor of K + s M for lowest modes, static answers, and whether the stiffness is what it should be."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.linalg import LinAlgError, eigh
from scipy.sparse import linalg

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.checks import negative_pivots
from updating.models.imported.hollow import check_hollow
from updating.models.imported.ordering import factored
from updating.models.imported.rounding import EPS, energies, relative_rounding, without_stiffness
from updating.models.solve import DENSE

SMALL_SHIFT = 1e-9
"""The shift relative to the middle of the ratios of stiffness to mass on the diagonals [-]."""

STEP = 100.0
"""By what the shift is raised while rounding makes K + s M indefinite [-]."""

BODY = 6
"""Rigid motions of a body [-]."""


@dataclass(frozen=True, eq=False)
class Shifted:
    """Stiffness and mass, and K + s M factored.

    Parameters
    ----------
    stiffness, mass : (n, n) sparse arrays
        Symmetric; the mass positive semidefinite [SI].
    source : str
        For messages.
    decimal : float
        Half a unit of the last digit of the stiffness's file, relative to the entry; 0 if it was not rounded [-].
    places : (n, 3) array, optional
        Where the rows are, by which they are ordered [m].
    """

    stiffness: Sparse
    mass: Sparse
    source: str = "model"
    decimal: float = 0.0
    places: FloatArray | None = None

    @cached_property
    def _ratio(self) -> float:
        """The middle of the ratios of stiffness to mass on the diagonals [rad^2/s^2]."""
        ratio = np.abs(self.stiffness.diagonal()) / self.mass.diagonal()
        return float(np.median(ratio[ratio > 0])) if (ratio > 0).any() else 1 / SMALL_SHIFT

    @property
    def shift(self) -> float:
        """The shift s [rad^2/s^2]."""
        return self._settled[0]

    @cached_property
    def factor(self) -> Any:
        """Triangular factors, the pivots on the diagonal.

        Raises
        ------
        StudyError
            If the stiffness has a negative eigenvalue that its rounding does not explain.
        """
        if self.shift > SMALL_SHIFT * self._ratio:
            self.lowest(1)
        return self._settled[1]

    @cached_property
    def _settled(self) -> tuple[float, Any]:
        """The shift and the factor, the shift raised until no pivot is negative."""
        shift = SMALL_SHIFT * self._ratio
        while True:
            factor = self._factored(shift)
            found = negative_pivots(factor)
            if found is None:
                return shift, factor
            if shift >= self._ratio:
                raise StudyError(
                    f"{self.source}: stiffness matrix indefinite: {found[0]} negative eigenvalue(s), met first at row "
                    f"{found[1]}; check signs, Lagrange multipliers (not supported) and preloads beyond buckling"
                )
            shift *= STEP

    def _factored(self, shift: float) -> Any:
        try:
            factor = factored(Sparse(self.stiffness + shift * self.mass), self.places)
        except RuntimeError as error:
            raise StudyError(
                f"{self.source}: singular: some motion has neither stiffness nor mass ({error}); leave out degrees of "
                "freedom that nothing holds"
            ) from error
        check_hollow(self.stiffness, self.mass, factor, self.source, self.places)
        return factor

    def solve(self, loads: FloatArray) -> FloatArray:
        """Return (K + s M)^-1 times loads (n, k) [SI]."""
        return np.asarray(self.factor.solve(np.ascontiguousarray(loads)))

    def lowest(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest eigenvalues [rad^2/s^2] and mass-normalised vectors (n, count) [kg^-1/2].

        Raises
        ------
        StudyError
            If fewer motions have mass, or the stiffness is indefinite.
        """
        n = self.stiffness.shape[0]
        if n <= DENSE or count > n // 3:
            values, vectors = (part[..., :count] for part in self._spectrum)
        else:
            values, vectors = self._sparse(count)
        if count > len(values):
            raise StudyError(
                f"{self.source}: {len(values)} degrees of freedom with mass are too few for {count} modes"
            )
        self._check_definite(values[0], vectors[:, :1])
        return values, vectors

    def _check_definite(self, value: float, vector: FloatArray) -> None:
        """See that the lowest mode has no negative energy beyond rounding."""
        energy, bound = energies(self.stiffness, vector, relative_rounding(self.stiffness, self.decimal))
        if energy[0] < -bound[0]:
            row = int(np.argmax(np.abs(vector[:, 0]))) + 1
            raise StudyError(
                f"{self.source}: stiffness matrix indefinite: eigenvalue {value:.3g} rad^2/s^2, most at row {row}; "
                "check signs and preloads beyond buckling"
            )

    @property
    def motions(self) -> int:
        """Number of motions with mass."""
        return len(self._spectrum[0])

    def rigid(self, count: int, decimal: float) -> int:
        """Return how many of the lowest modes have no stiffness within rounding.

        Parameters
        ----------
        count : int
            Number of modes to count among.
        decimal : float
            As the class's, of rigid motions: what is left where rounding has been taken from them [-].
        """
        _, vectors = self.lowest(count)
        found = without_stiffness(self.stiffness, vectors, relative_rounding(self.stiffness, decimal))
        return int(np.argmin(found)) if not found.all() else count

    def _sparse(self, count: int) -> tuple[FloatArray, FloatArray]:
        """Solve by shift and invert (Lanczos)."""
        n = self.stiffness.shape[0]
        shift, factor = self._settled
        inverse = linalg.LinearOperator((n, n), matvec=factor.solve, dtype=float)
        try:
            values, vectors = linalg.eigsh(
                self.stiffness, count, self.mass, sigma=-shift, OPinv=inverse, which="LM", v0=np.ones(n)
            )
        except linalg.ArpackError as error:
            raise StudyError(
                f"{self.source}: no modes found ({error}); is the stiffness that of the structure?"
            ) from error
        order = np.argsort(values)
        return values[order], vectors[:, order]

    @cached_property
    def _spectrum(self) -> tuple[FloatArray, FloatArray]:
        """All modes with mass, solved for 1 / (lambda + s) twice, at last with the first elastic one as the shift.

        Low modes are then as exact as the stiffness, however light other motions are; what is below rounding of the
        largest 1 / (lambda + s) has no mass.
        """
        shift = self._settled[0]
        values, vectors = self._inverse(shift, min(2 * BODY + 1, len(self.mass.diagonal())))
        loose = without_stiffness(self.stiffness, vectors, relative_rounding(self.stiffness, self.decimal))
        self._check_definite(values[0], vectors[:, :1])
        elastic = values[~loose & (values > 0)]
        _, vectors = self._inverse(float(elastic[0]) if len(elastic) else shift, self.stiffness.shape[0])
        values = energies(self.stiffness, vectors, 0.0)[0]
        order = np.argsort(values, kind="stable")
        return values[order], vectors[:, order]

    def _inverse(self, shift: float, count: int) -> tuple[FloatArray, FloatArray]:
        """Solve M v = v (K + s M) / (lambda + s) for the largest of 1 / (lambda + s)."""
        n = self.stiffness.shape[0]
        held = self.stiffness + shift * self.mass
        try:
            inverse, vectors = eigh(self.mass.toarray(), held.toarray(), subset_by_index=(n - count, n - 1))
        except LinAlgError as error:
            if shift * SMALL_SHIFT > self._ratio:
                raise StudyError(
                    f"{self.source}: stiffness and mass are indefinite together ({error})"
                ) from error
            return self._inverse(STEP * shift, count)
        heavy = inverse > n * EPS * inverse[-1]
        inverse, vectors = inverse[heavy][::-1], vectors[:, heavy][:, ::-1]
        return 1 / inverse - shift, vectors / np.sqrt(inverse)
