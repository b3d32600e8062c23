"""A structure given by its matrices."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import StudyError
from updating.models.base import Structure, relative_scales, scale_of
from updating.models.fields import Sparse
from updating.models.imported.answers import part_answers
from updating.models.imported.groups import Joint, nodes_of_rows, rigid_motions, set_nodes
from updating.models.imported.matrices import Imported
from updating.models.imported.shifted import BODY, Shifted
from updating.models.solve import DENSE
from updating.models.spec import Spec
from updating.models.state import State


@dataclass(frozen=True, eq=False)
class MatrixTerm:
    """The stiffness or the mass, which grow with the modulus or the density.

    Parameters
    ----------
    kind : {"stiffness", "mass"}
        Which one.
    powers : mapping
        Power in each factor [-].
    """

    kind: str
    powers: Mapping[str, float]

    def scale(self, factors: Mapping[str, float]) -> float:
        """Return the product of the factors to their powers [-]."""
        return scale_of(self.powers, factors)


TERMS = (
    MatrixTerm("stiffness", MappingProxyType({"E": 1.0, "section": 1.0})),
    MatrixTerm("mass", MappingProxyType({"density": 1.0, "section": 1.0})),
)


@dataclass(frozen=True, eq=False)
class ImportedStructure(Structure):
    """A structure of which nothing but matrices is known.

    Parameters
    ----------
    spec : Spec
        What it is a model of; ``spec.imported`` holds the matrices.
    """

    spec: Spec
    terms: tuple[MatrixTerm, ...] = TERMS
    fixed: Mapping[str, IntArray] = field(default_factory=lambda: MappingProxyType({}))

    refinable = False

    @property
    def imported(self) -> Imported:
        """The matrices."""
        assert self.spec.imported is not None
        return self.spec.imported

    @property
    def n_dofs(self) -> int:
        """Number of degrees of freedom."""
        return self.imported.order

    @cached_property
    def unknowns(self) -> int:
        """Number of motions with mass, where the model is small enough to count them."""
        return self.n_dofs if self.n_dofs > DENSE else self._nominal.motions

    def _shifted(self, stiffness: Sparse, mass: Sparse) -> Shifted:
        known = self.imported
        return Shifted(stiffness, mass, known.source, known.decimal, known.row_places)

    @cached_property
    def _nominal(self) -> Shifted:
        return self._shifted(self.matrix("stiffness"), self.matrix("mass"))

    @cached_property
    def rigid_modes(self) -> int:
        """Number of motions that nothing holds: their strain energy is within rounding of zero.

        Raises
        ------
        StudyError
            If there are more than the six of one body.
        """
        known = self.imported
        count = min(BODY + 1, self.unknowns)
        found = self._nominal.rigid(count, known.left)
        if found > BODY:
            row = int(np.argmax(np.abs(self._nominal.lowest(count)[1][:, BODY]))) + 1
            raise StudyError(
                f"{known.source}: stiffness matrix singular: more than six motions have no stiffness, one with "
                f"most at row {row}; parts that are not joined, or a mechanism"
            )
        return found

    def parts(self, kind: str) -> tuple[Sparse, ...]:
        """Return the matrices of the regions, and of what lies in none [SI]."""
        *parts, rest = self.imported.divided(kind)
        return (*(parts or [Sparse(rest.shape)] * len(self.spec.regions)), rest)

    def matrix(self, kind: str) -> Sparse:
        """Return the stiffness or mass matrix [SI]."""
        whole = self.imported.stiffness if kind == "stiffness" else self.imported.mass
        return whole if kind == "stiffness" or not self.spec.masses else Sparse(whole + self.point_masses())

    def matrices(self, state: State) -> tuple[Sparse, Sparse]:
        """Return stiffness and mass under a state's factors, of the whole and of regions, Eqs. 11-14 [SI]."""
        total = {"stiffness": self.imported.stiffness, "mass": self.imported.mass}
        for term in self.terms:
            parts = self.parts(term.kind)
            scale = relative_scales(term, state, len(parts) - 1)
            for region in np.flatnonzero(scale != 1.0).tolist():
                total[term.kind] = Sparse(total[term.kind] + (scale[region] - 1.0) * parts[region])
            total[term.kind] = Sparse(total[term.kind] * term.scale(state.factors))
        return total["stiffness"], Sparse(total["mass"] + self.point_masses())

    def region_products(self, basis: FloatArray) -> tuple[FloatArray, ...]:
        """Return stiffness and mass on a basis, each (n_regions + 1, r, r); the last is what lies in no region [SI]."""
        return tuple(
            np.stack([basis.T @ (part @ basis) for part in self.parts(term.kind)]) for term in self.terms
        )

    def point_masses(self) -> Sparse:
        """Return the mass matrix of the masses stated by the modeller, which move in all directions [kg]."""
        total = Sparse((self.n_dofs, self.n_dofs))
        places = self.imported.places
        for mass in self.spec.masses:
            at = np.array([mass.at], dtype=float)
            total = total + mass.mass * self.unit_mass(at)
            if mass.inertia:
                turns = places.motions(at, range(3, 6))
                total = total + mass.inertia * (turns.T @ turns)
        return Sparse(total)

    def rows(self, points: FloatArray, directions: FloatArray | None = None) -> dict[str, Sparse]:
        """Return displacement and slopes along directions at points, each (n_points, n_dofs)."""
        points = np.asarray(points, dtype=float).reshape(-1, 3)
        if directions is None:
            directions = np.tile([0.0, 0.0, 1.0], (len(points), 1))
        return self.imported.places.rows(points, directions)

    def unit_mass(self, points: FloatArray) -> Sparse:
        """Return the mass matrix of 1 kg at each of some points, moving in every direction there is [-]."""
        rows = self.imported.places.motions(np.asarray(points, dtype=float).reshape(-1, 3))
        return Sparse(rows.T @ rows)

    def softenings(self, elastic: FloatArray) -> FloatArray:
        """Return the forces (n_dofs, n) of parts and joints in the lowest modes, and at node sets and supports."""
        low = elastic[:, : min(4, elastic.shape[1])]
        stiffness, mass = self._changing
        return np.hstack([*(part @ low for part in (*stiffness, *mass)), self._acting(elastic)])

    @property
    def _changing(self) -> tuple[tuple[Sparse, ...], tuple[Sparse, ...]]:
        """Parts of the stiffness and of the mass that may change, hypotheses' among them, each (n, n) [SI]."""
        known, supposed = self.imported, self.spec.hypotheses
        numbers = [pair for one in supposed for pair in one.changes]
        stiffness = [one.stiffness for one in supposed if one.stiffness is not None]
        mass = [one.mass for one in supposed if one.mass is not None]
        return (
            (*known.stiffness_parts, *stiffness, *(pair[0] for pair in numbers)),
            (*known.mass_parts, *mass, *(pair[1] for pair in numbers)),
        )

    def _acting(self, elastic: FloatArray) -> FloatArray:
        """Return the forces (n_dofs, n) at node sets and supports, and of joints in relative motion of their sides."""
        known = self.imported
        acting = [
            springs @ self._relative_motions(joint, elastic)
            for joint in known.joints
            for springs in joint.springs
            if springs.nnz
        ]
        acting += [group.motions(range(6)).toarray().T for group in known.groups]
        acting += [support.loads for support in known.supports]
        loads = np.hstack([np.zeros((self.n_dofs, 0)), *acting])
        return np.asarray(loads[:, np.abs(loads).max(axis=0, initial=0.0) > 0])

    def _relative_motions(self, joint: Joint, elastic: FloatArray) -> FloatArray:
        """Return relative motions (n_dofs, n) of the sides of a joint: one moves as a rigid body, the other does not.

        A joint that is nearly open answers with these. In the lowest modes of the model, which are taken
        where rows lie at no place, there is hardly any relative motion. Of a bracket with two bolts of four nodes each,
        one at a hundredth of its stiffness, frequencies are right to 1e-5; with the lowest modes they are 3 % too high.
        """
        places, order = self.imported.places, self.n_dofs
        moves = rigid_motions(places, order, joint.centre)
        if moves is None:
            return elastic[:, :4]
        side = set_nodes(places, self.imported.nodes.sets, joint.sides[0])
        return np.where(np.isin(nodes_of_rows(places, order), side)[:, None], moves, 0.0)

    def static_answers(
        self, loads: FloatArray, values: FloatArray, vectors: FloatArray, shift: float
    ) -> FloatArray:
        """Return the answers to loads, and the main directions of those to a change of each part or as supposed."""
        changed = part_answers(
            self._nominal.solve,
            (self.matrix("stiffness"), self.matrix("mass")),
            self._changing,
            (values, vectors, self.rigid_modes),
        )
        given = np.hstack([loads, self._acting(vectors[:, self.rigid_modes :])])
        return np.hstack([self.solve(given, shift), changed])

    def solve(self, loads: FloatArray, shift: float) -> FloatArray:
        """Return the answers of K + s M to loads (n_dofs, n); the shift is that of the one factor [SI]."""
        return self._nominal.solve(loads)

    def left_out(self, rows: Sparse, basis: FloatArray, held: FloatArray) -> FloatArray:
        """Return the residual flexibility of a basis: how much further forces move what they act on, (k, k) [m/N].

        It is the energy of what the answers on all degrees of freedom have beyond those on the basis, e^T (K + s M) e.
        The difference of the two flexibilities is the same, but of a structure that is free both are those of a rigid
        body on the shift s, beside which it is rounding.

        Parameters
        ----------
        rows : (k, n_dofs) sparse array
            Along which forces act.
        basis : (n_dofs, r) array
            Columns orthonormal in the mass [kg^-1/2].
        held : (r, r) array
            The stiffness on it [rad^2/s^2].
        """
        loads, shift = rows.toarray().T, self._nominal.shift
        known = basis @ np.linalg.solve(held + shift * np.eye(len(held)), basis.T @ loads)
        beyond = self.solve(loads, shift) - known
        forces = self.matrix("stiffness") @ beyond + shift * (self.matrix("mass") @ beyond)
        return np.asarray(beyond.T @ forces)

    def eigen(
        self,
        count: int,
        *,
        stiffness: Sparse | None = None,
        mass: Sparse | None = None,
        released: frozenset[str] = frozenset(),
    ) -> tuple[FloatArray, FloatArray]:
        """Solve for the lowest modes, rigid-body modes included; see :meth:`Structure.eigen`."""
        if stiffness is None and mass is None:
            return self._nominal.lowest(count)
        k = self.matrix("stiffness") if stiffness is None else stiffness
        m = self.matrix("mass") if mass is None else mass
        return self._shifted(k, m).lowest(count)
