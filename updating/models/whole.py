"""A structure on the basis of all its degrees of freedom: with the interface of a reduced one.

An effect states what it does to a reduced model. Asked on this one, the same lines give the same change of the full
matrices, so that no effect needs an exact form beside its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import chain, combinations
from typing import Any, cast

import numpy as np
from scipy import sparse

from acquisition.arrays import FloatArray
from acquisition.errors import ModalkitError
from updating.models.base import Structure, Term, added
from updating.models.fields import Fields, Sparse
from updating.models.imported_structure import ImportedStructure
from updating.models.reduced import Reduced
from updating.models.state import State
from updating.models.structure import FieldStructure


class ReducedOnlyError(ModalkitError):
    """What was asked for is a full matrix on all degrees of freedom, and known on a reduced basis alone."""


@dataclass(frozen=True, eq=False)
class Whole(Reduced):
    """A structure as its own basis: every matrix is sparse and over all degrees of freedom.

    Parameters
    ----------
    structure, basis, ranks
        As of :class:`Reduced`; the basis is a sparse unit matrix.
    on_basis : Reduced
        The same structure on a reduced basis, for what needs one.
    """

    on_basis: Reduced = field(kw_only=True)

    @classmethod
    def of(cls, small: Reduced) -> Whole:
        """Take the structure of a reduced model."""
        structure = small.structure
        kinds = sorted([*structure.fixed, *structure.along])
        sets = chain.from_iterable(combinations(kinds, n) for n in range(len(kinds) + 1))
        every = sparse.eye_array(structure.n_dofs, format="csr")
        ranks = {frozenset(s): structure.n_dofs for s in sets}
        return cls(structure, cast(FloatArray, every), ranks, on_basis=small)

    @property
    def small(self) -> Reduced:
        """The structure on a reduced basis."""
        return self.on_basis

    @property
    def whole(self) -> bool:
        """Whether matrices are over all degrees of freedom."""
        return True

    def refuse_whole(self, what: str) -> None:
        """State that something is known on a reduced basis alone.

        Raises
        ------
        ReducedOnlyError
            Always.
        """
        raise ReducedOnlyError(f"{what} is known on a reduced basis alone")

    def project(self, full: Sparse) -> FloatArray:
        """Return a matrix over all degrees of freedom as it is."""
        return cast(FloatArray, full)

    def generalised(self, loads: Sparse) -> FloatArray:
        """Return loads on all degrees of freedom (n_dofs, n) as they are."""
        return cast(FloatArray, loads)

    def weighted(
        self,
        kind: str,
        weights: FloatArray,
        factors: Mapping[str, float] | None = None,
        *,
        share: Callable[[Term], float] = lambda _: 1.0,
    ) -> FloatArray:
        """Return the stiffness or mass matrix under weights (n_points,) at the quadrature points [SI]."""
        total = Sparse((self.structure.n_dofs,) * 2)
        fields: Fields = self.fields
        for term in self.fielded.terms:
            if term.kind == kind:
                left, right = fields.sampled[term.left], fields.sampled[term.right]
                weight = term.coefficient * weights * (term.scale(factors or {}) * share(term))
                part = left.T @ sparse.diags_array(weight) @ right
                total = total + (part if term.left == term.right else (part + part.T) / 2)
        return cast(FloatArray, Sparse(total))

    @property
    def parts(self) -> tuple[FloatArray, ...]:
        """Matrix of every term and region, each a tuple of n_regions + 1 [SI]; the last is no region."""
        structure: Structure = self.structure
        if isinstance(structure, ImportedStructure):
            return cast(tuple[FloatArray, ...], tuple(structure.parts(term.kind) for term in structure.terms))
        raise ReducedOnlyError("a region's share of a field")

    @property
    def sums(self) -> tuple[FloatArray, ...]:
        """Matrix of every term over all regions [SI]."""
        structure: Structure = self.structure
        if isinstance(structure, ImportedStructure):
            return cast(
                tuple[FloatArray, ...], tuple(structure.matrix(term.kind) for term in structure.terms)
            )
        assert isinstance(structure, FieldStructure)
        found = []
        for term in structure.terms:
            left, right = (self.fields.sampled[name] for name in (term.left, term.right))
            part = left.T @ sparse.diags_array(term.coefficient) @ right
            found.append(Sparse(part if term.left == term.right else (part + part.T) / 2))
        return cast(tuple[FloatArray, ...], tuple(found))

    def matrices(self, state: State) -> tuple[FloatArray, FloatArray]:
        """Return stiffness and mass of a state, what its releases hold included [SI]."""
        stiffness, mass = self.structure.matrices(state)
        more = added(self.structure, state)
        for matrix in more["stiffness"]:
            stiffness = Sparse(stiffness + matrix)
        for matrix in more["mass"]:
            mass = Sparse(mass + matrix)
        return cast(FloatArray, stiffness), cast(FloatArray, mass)

    def rows(self, points: FloatArray, directions: FloatArray | None = None) -> dict[str, FloatArray]:
        """Return displacement and slopes at points (n_points, dim) [m], each (n_points, n_dofs)."""
        return cast(dict[str, FloatArray], self.structure.rows(points, directions))

    def unit_mass(self, points: FloatArray) -> FloatArray:
        """Return the mass matrix of 1 kg at each of some points (n_points, dim) [m] [-]."""
        return cast(FloatArray, self.structure.unit_mass(points))

    def eigen(self, state: State) -> tuple[FloatArray, FloatArray]:
        """Refuse: a full model is asked for a few modes, see :func:`updating.update.parameters.exact.full_modes`."""
        raise ReducedOnlyError("all modes of a model at once")


def size_of(matrix: Any) -> tuple[int, ...] | None:
    """Return the shape of a matrix, sparse or dense, None of anything else."""
    known = sparse.issparse(matrix) or isinstance(matrix, np.ndarray)
    return tuple(getattr(matrix, "shape", ())) if known else None
