"""A soft place of a plate, with the curvature that gathers in it.

The reduced basis is smooth, so a small place that has lost most of its stiffness cannot bend there as it would.
What the basis lacks answers statically: with dK the change of stiffness, R the flexibility of the full model less
that of the basis, and a the answers of R to the forces -dK u of the low modes u and, once more, to those of a
itself, minimising the energy over the amplitudes of a leaves B' dK B - B' dK a (a' (K + dK) a)^-1 a' dK B on the
basis B: Guyan's condensation (AIAA Journal 3, 380, 1965), of residual flexibility (MacNeal 1971, Computers &
Structures 1, 581-601). The answers keep the clamps: of a place on a clamp that is released too, up to a fifth of the
shift is missing. Their inertia is neglected.

Curvature gathers within a place of one or two elements as little as in the basis. So all of this is done on elements of
a half or a third of the size, where the mesh is coarse: a cubic element's motion is one of the elements that divide it.
"""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import linalg
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from acquisition.arrays import FloatArray, IntArray
from updating.models.fields import Sparse
from updating.models.reduced import Reduced
from updating.models.structure import FieldStructure
from updating.models.terms import FieldTerm

MODES, ANSWERS = 12, 10
"""Low modes whose forces load a soft place, and how many combinations of these are answered, twice."""

FAINT = 1e-3
"""Loads weaker than this share of the strongest are left out: what they say of the energy goes with its square [-]."""

PLACES = 8
"""So many places are kept for another loss."""

LACKING = 1e-8
"""Share of its energy below which an answer lies in the basis already [-]."""


NODAL = {"w": (), "wx": (0,), "wy": (1,), "wxy": (0, 1)}
"""Degrees of freedom of a node of a thin plate, in their order."""


@dataclass(frozen=True, eq=False)
class Softening:
    """What turns a loss of stiffness at the quadrature points of a plate into a matrix on the reduced basis.

    Parameters
    ----------
    reduced : Reduced
        The nominal model.
    structure : FieldStructure
        The same before its reduction, on elements that resolve a place.
    basis : (n_dofs, r) array
        The reduced basis on these [-].
    """

    reduced: Reduced
    structure: FieldStructure
    basis: FloatArray

    def change(self, inside: FloatArray, loss: float, factors: Mapping[str, float]) -> FloatArray:
        """Return the change of stiffness that a loss makes, shape (r, r) [SI].

        Parameters
        ----------
        inside : (n_points,) array
            How far every quadrature point lies inside the place [-].
        loss : float
            Share of the stiffness that is lost there [-].
        factors : mapping
            Factors of the state on top of which it comes, the same for the place and for all around it [-].
        """
        if not loss or not inside.any():
            return np.zeros((self.basis.shape[1],) * 2)
        key = (inside.tobytes(), *sorted(factors.items()))
        if key not in self._known:
            while len(self._known) >= PLACES:
                self._known.pop(next(iter(self._known)))
            self._known[key] = self._condensed(inside, factors)
        whole, coupling, inner = self._known[key]
        energy = np.eye(len(inner)) - loss * inner
        return np.asarray(-loss * whole - loss**2 * (coupling.T @ np.linalg.solve(energy, coupling)))

    @cached_property
    def _known(self) -> dict[Hashable, tuple[FloatArray, FloatArray, FloatArray]]:
        """The places asked for last: derivatives ask for one again with another loss."""
        return {}

    def _condensed(
        self, inside: FloatArray, factors: Mapping[str, float]
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return B' P B, a' P B and a' P a for the stiffness P of a place and its answers a, orthonormal in K."""
        dofs, place = self._place(inside, factors)
        basis, scale = self.basis[dofs], self._scale(factors)
        forces = place @ basis
        first = self.structure.rigid_modes
        low = forces[:, first : first + MODES] / np.sqrt(np.diag(self._stiff)[first : first + MODES])
        load = _leading(low)
        answer, energy = self._lacking(dofs, load, basis)
        second = self._lacking(dofs, more := _leading(place @ answer), basis)
        load, answer = np.hstack([load, more]), np.hstack([answer, second[0]])
        answer = _orthonormal(load, answer, np.append(energy, second[1])) / np.sqrt(scale)
        whole, inner = basis.T @ forces, answer.T @ (place @ answer)
        return (whole + whole.T) / 2, answer.T @ forces, (inner + inner.T) / 2

    def _lacking(self, dofs: IntArray, loads: FloatArray, basis: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return what the nominal model answers to loads less what the basis does, and the energy of the whole."""
        solver, number, count = self._solver
        loose = number[dofs] >= 0
        given = np.zeros((count, loads.shape[1]), order="F")
        given[number[dofs][loose]] = loads[loose]
        answer = np.zeros_like(loads)
        answer[loose] = solver.solve(given)[number[dofs][loose]]
        smooth = basis[:, : len(self._stiff)]
        lacking = answer - smooth @ linalg.cho_solve(self._factors, smooth.T @ loads)
        return lacking, np.einsum("ij,ij->j", loads, answer)

    @cached_property
    def _shift(self) -> float:
        """A shift that holds rigid bodies; the answers of a place are independent of it [rad^2/s^2]."""
        first = self.structure.rigid_modes
        if not first:
            return 0.0
        shape = self.basis[:, first]
        return 1e-3 * float(shape @ (self.structure.matrix("stiffness") @ shape))

    @cached_property
    def _held(self) -> Sparse:
        return Sparse(self.structure.matrix("stiffness") + self._shift * self.structure.matrix("mass"))

    @cached_property
    def _solver(self) -> tuple[Any, IntArray, int]:
        """Factors of the nominal stiffness, the place of every degree of freedom in it or -1, and its size."""
        free = self.structure.free()
        number = np.full(self.structure.n_dofs, -1)
        number[free] = np.arange(len(free))
        matrix = self._held[free][:, free].tocsc()
        symmetric = {"SymmetricMode": True}
        solver = splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=symmetric)
        return solver, number, len(free)

    @cached_property
    def _stiff(self) -> FloatArray:
        """The same matrix on the clamped columns of the basis, (n, n) [SI]."""
        basis = self.basis[:, : self.reduced.ranks[frozenset()]]
        return np.asarray(basis.T @ (self._held @ basis))

    @cached_property
    def _factors(self) -> tuple[FloatArray, bool]:
        return linalg.cho_factor(self._stiff)

    @cached_property
    def _terms(self) -> tuple[FieldTerm, ...]:
        return tuple(term for term in self.structure.terms if term.kind == "stiffness")

    @cached_property
    def _fields(self) -> tuple[IntArray, dict[str, FloatArray]]:
        """Degrees of freedom of every element (n_elements, k), and the strains they make at its points."""
        fields = self.structure.fields
        names = {name for term in self._terms for name in (term.left, term.right)}
        return fields.element_dofs, {name: fields.by_element(name) for name in names}

    def _place(self, inside: FloatArray, factors: Mapping[str, float]) -> tuple[IntArray, Sparse]:
        """Return the degrees of freedom of a place (n,) and its stiffness between them (n, n) [SI]."""
        table, values = self._fields
        inside = inside.reshape(len(table), -1)
        cells = np.flatnonzero(inside.any(axis=1))
        total = np.zeros((len(cells), table.shape[1], table.shape[1]))
        for term in self._terms:
            weight = term.scale(factors) * inside[cells] * term.coefficient.reshape(inside.shape)[cells]
            left, right = values[term.left][cells], values[term.right][cells]
            total += np.swapaxes(left * weight[:, :, None], 1, 2) @ right
        total = (total + np.swapaxes(total, 1, 2)) / 2
        number = np.zeros(self.structure.n_dofs, dtype=np.int64)
        number[table[cells]] = 1
        dofs = np.flatnonzero(number)
        number[dofs] = np.arange(len(dofs))
        index = number[table[cells]]
        rows = np.broadcast_to(index[:, :, None], total.shape).ravel()
        columns = np.broadcast_to(index[:, None, :], total.shape).ravel()
        return dofs, Sparse(coo_array((total.ravel(), (rows, columns)), (len(dofs),) * 2))

    def _scale(self, factors: Mapping[str, float]) -> float:
        """Return by how much factors stiffen the structure as a whole: the geometric mean of its terms [-]."""
        return float(np.exp(np.mean([np.log(term.scale(factors)) for term in self._terms])))


def _on_finer(coarse: FieldStructure, fine: FieldStructure, basis: FloatArray) -> FloatArray:
    """Return motions (n_dofs, r) of a plate on elements that divide its own."""
    if fine is coarse:
        return basis
    (plate,), points, numbers = coarse.fields.components, *fine.fields.components[0].nodes()
    found = np.zeros((fine.n_dofs, basis.shape[1]))
    for number, rows in zip(numbers.T, plate.hermite(points, coarse.n_dofs, NODAL).values(), strict=True):
        found[number] = rows @ basis
    return found


def _leading(loads: FloatArray) -> FloatArray:
    """Return the combinations of loads (n, k) that are strongest, at most ``ANSWERS``."""
    left, size, _ = np.linalg.svd(loads, full_matrices=False)
    keep = size[:ANSWERS] > FAINT * size[0]
    return np.asarray((left * size)[:, :ANSWERS][:, keep])


def _orthonormal(load: FloatArray, answer: FloatArray, energy: FloatArray) -> FloatArray:
    """Return answers (n, k) so combined that their energies are one, without what the basis has already."""
    length = np.sqrt(np.maximum(energy, LACKING**2 * energy.max()))
    own = load.T @ answer / np.outer(length, length)
    size, turn = np.linalg.eigh((own + own.T) / 2)
    keep = size > LACKING
    return np.asarray((answer / length) @ (turn[:, keep] / np.sqrt(size[keep])))


def softening(reduced: Reduced) -> Softening:
    """Return the softening of a plate's model, kept with it.

    Raises
    ------
    StudyError
        If the model has no fields.
    """
    if "softening" not in reduced.kept:
        fine = reduced.fielded.finer
        reduced.kept["softening"] = Softening(reduced, fine, _on_finer(reduced.fielded, fine, reduced.basis))
    found: Softening = reduced.kept["softening"]
    return found
