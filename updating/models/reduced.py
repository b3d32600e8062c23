"""Re-analysis on a small basis that keeps every change a State can express.

The basis holds the lowest modes of the nominal model, the static answers to softening each region and to
loading each test point, and, behind them, what a clamp sets free when it is released, whole or, of a plate, along a
part of an edge. Matrices of any state
are sums of small precomputed ones, so a prediction costs one dense eigenproblem of some fifty unknowns.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from acquisition.errors import StudyError
from updating.models.absorbers import bordered
from updating.models.base import Structure, Term, added, region_scales, relative_scales, scale_of, supports_at
from updating.models.columns import cut_off
from updating.models.fields import Fields, Sparse
from updating.models.solve import solve_pencil
from updating.models.stacked import StackedTerms
from updating.models.state import State
from updating.models.structure import FieldStructure
from updating.models.terms import product

ROTATION, TRANSLATION = frozenset({"rotation"}), frozenset({"translation"})
"""What a clamp may release."""


PLACES = 8
"""Rows of so many sets of points are kept."""


def _all(_: Term) -> float:
    """All of a term."""
    return 1.0


@dataclass(frozen=True, eq=False)
class Change:
    """A change of the stiffness or the mass of a reduced model: a term that has no regions.

    Parameters
    ----------
    kind : {"stiffness", "mass"}
        Which matrix.
    matrix : (r, r) array
        In the coordinates of the reduced basis [SI].
    powers : mapping
        Power in each factor, as a term has it [-].
    """

    kind: str
    matrix: FloatArray
    powers: Mapping[str, float]

    def scale(self, factors: Mapping[str, float]) -> float:
        """Return the product of the factors to their powers [-]."""
        return scale_of(self.powers, factors)


@dataclass(frozen=True, eq=False)
class Reduced:
    """A structure on a reduced basis.

    Parameters
    ----------
    structure : Structure
        The full model.
    basis : (n_dofs, r) array
        Columns orthonormal in the nominal mass: clamped ones first, then what the releases add [kg^-1/2].
    ranks : mapping of frozenset to int
        For each set of releases (none, the rotation, the translation, both), how many leading columns belong to it;
        where the translation alone is released, :meth:`matrices` holds the slopes that other columns have.
    changes : tuple of Change
        What a better theory changes of the whole.
    lifts : mapping of str to slice
        Columns that a part of an edge needs where it lets go, by kind and edge: ``rotation x0``.
    """

    structure: Structure
    basis: FloatArray
    ranks: Mapping[frozenset[str], int]
    changes: tuple[Change, ...] = ()
    lifts: Mapping[str, slice] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def whole(self) -> bool:
        """Whether matrices are over all degrees of freedom: not on a reduced basis."""
        return False

    @property
    def small(self) -> Reduced:
        """The structure on a reduced basis: this one."""
        return self

    def refuse_whole(self, what: str) -> None:
        """Do nothing: ``what`` is known here; a model of all degrees of freedom refuses it."""

    def project(self, full: Sparse) -> FloatArray:
        """Return a matrix over all degrees of freedom (n_dofs, n_dofs) on the basis, (r, r)."""
        return np.asarray(self.basis.T @ (full @ self.basis))

    def generalised(self, loads: Sparse) -> FloatArray:
        """Return loads on all degrees of freedom (n_dofs, n) on the basis, (r, n)."""
        return np.asarray(self.basis.T @ loads.toarray())

    @cached_property
    def sampled(self) -> dict[str, FloatArray]:
        """Fields of the basis at the quadrature points, each (n_points, r)."""
        return {n: np.asarray(m @ self.basis) for n, m in self.fielded.fields.sampled.items()}

    @cached_property
    def kept(self) -> dict[Hashable, Any]:
        """What others computed from the structure alone, for all tests of it."""
        return {}

    @property
    def fields(self) -> Fields:
        """The fields of a structure that has some.

        Raises
        ------
        StudyError
            If the structure is given by imported matrices.
        """
        return self.fielded.fields

    @property
    def fielded(self) -> FieldStructure:
        """The structure, where it has fields; else as :attr:`fields`."""
        if not isinstance(self.structure, FieldStructure):
            raise StudyError("imported matrices have no fields: no place inside them can be changed")
        return self.structure

    @cached_property
    def parts(self) -> tuple[FloatArray, ...]:
        """Matrix of every term and region, each term (n_regions + 1, r, r) [SI]; the last is no region."""
        return self.structure.region_products(self.basis)

    def weighted(
        self,
        kind: str,
        weights: FloatArray,
        factors: Mapping[str, float] | None = None,
        *,
        share: Callable[[Term], float] = _all,
    ) -> FloatArray:
        """Return the stiffness or mass matrix of the structure under weights at the quadrature points.

        Parameters
        ----------
        kind : {"stiffness", "mass"}
            Which matrix.
        weights : (n_points,) array
            Factor at every quadrature point; only where it is not zero is anything computed [-].
        factors : mapping, optional
            Factors of the state on top of which it comes [-].
        share : callable
            Share of a term that counts [-].

        Returns
        -------
        (r, r) array [SI]
        """
        rows = np.flatnonzero(weights)
        total = np.zeros((self.basis.shape[1],) * 2)
        for term in self.fielded.terms:
            if term.kind == kind:
                part = product(term, self.sampled, rows, weights[rows])
                total += part * term.scale(factors or {}) * share(term)
        return total

    @cached_property
    def point_masses(self) -> FloatArray:
        """Matrix of the masses stated by the modeller, shape (r, r) [kg in w]."""
        return self.project(self.structure.point_masses())

    def matrices(self, state: State) -> tuple[FloatArray, FloatArray]:
        """Return stiffness and mass of a state on the columns its releases admit, absorbers behind them [SI]."""
        n = self.ranks[state.released]
        stiffness, mass = np.zeros((n, n)), self.point_masses[:n, :n].copy()
        self.stacked(state).add_to(stiffness, mass, state.factors)
        more = added(self.structure, state)
        for matrix in more["stiffness"]:
            stiffness += matrix[:n, :n]
        for matrix in more["mass"]:
            mass += matrix[:n, :n]
        if state.released == TRANSLATION:
            stiffness, mass = self._without_slopes(stiffness, mass)
        if (idle := self._idle(state.released)) is not None:
            stiffness, mass = cut_off(stiffness, mass, idle)
        if state.absorbers:
            stiffness = bordered(stiffness, state.absorbers, "stiffness")
            mass = bordered(mass, state.absorbers, "mass")
        return stiffness, mass

    def _without_slopes(self, stiffness: FloatArray, mass: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the matrices with the slopes at the clamps held.

        What turns there is cut off from all else and put on a frequency above every other.
        """
        held, turning = self._slopes
        above = 1e3 * float(np.abs(np.diag(stiffness)).max()) * turning
        return held @ stiffness @ held + above, held @ mass @ held + turning

    @cached_property
    def _slopes(self) -> tuple[FloatArray, FloatArray]:
        """Projections (r, r) on what has no slope at the clamps, and on the rest."""
        slopes = self.basis[self.structure.fixed["rotation"], : self.ranks[TRANSLATION]]
        _, size, directions = np.linalg.svd(slopes, full_matrices=False)
        turning = directions[size > 1e-8 * size[0]]
        rest = turning.T @ turning
        return np.eye(len(rest)) - rest, rest

    def _idle(self, released: frozenset[str]) -> BoolArray | None:
        """Mark the columns that a clamp with a released part leaves out, (r,); None where there is no such part.

        A whole kind that is released beside one takes the columns of all edges, so that none are nearly alike.
        """
        if not released & self.lifts.keys() or released >= self.lifts.keys() | self.structure.fixed.keys():
            return None
        idle = np.arange(self.basis.shape[1]) >= self.ranks[frozenset()]
        for name, columns in self.lifts.items():
            if name in released or name.split()[0] in released:
                idle[columns] = False
        return idle

    @cached_property
    def sums(self) -> tuple[FloatArray, ...]:
        """Matrix of every term over all regions, each (r, r) [SI]."""
        return tuple(p.sum(axis=0) for p in self.parts)

    def terms(self, state: State) -> list[tuple[Term, FloatArray]]:
        """Return every term and change with its matrix, the factors of the whole structure not applied."""
        terms: list[tuple[Term, FloatArray]] = list(
            zip(self.structure.terms, self._totals(state), strict=True)
        )
        return terms + [(change, change.matrix) for change in self.changes]

    def stacked(self, state: State) -> StackedTerms:
        """Return the same on the columns that a state's releases admit; kept where it changes no region."""
        n = self.ranks[state.released]
        if state.regional:
            return StackedTerms.of(self.terms(state), n)
        if n not in self._stacks:
            self._stacks[n] = StackedTerms.of(self.terms(state), n)
        return self._stacks[n]

    @cached_property
    def _stacks(self) -> dict[int, StackedTerms]:
        return {}

    def _totals(self, state: State) -> list[FloatArray]:
        if not state.regional:
            return list(self.sums)
        totals = []
        for term, parts, whole in zip(self.structure.terms, self.parts, self.sums, strict=True):
            scale = relative_scales(term, state, len(parts) - 1)
            totals.append(whole if np.all(scale == 1.0) else np.tensordot(scale, parts, axes=1))
        return totals

    def sensitivity(
        self, state: State, factor: str, regions: Sequence[int] = ()
    ) -> tuple[FloatArray, FloatArray]:
        """Return dK and dM per unit of the logarithm of a factor, at a state [SI].

        Of some regions; where none is named, of the whole.
        """
        if not regions:
            return self._of_the_whole(state, factor)
        n = self.ranks[state.released]
        change = self._of_supports(state, factor, regions)
        for term, parts in zip(self.structure.terms, self.parts, strict=True):
            power = term.powers.get(factor, 0.0)
            scale = power * region_scales(term, state, len(parts) - 1)
            for region in regions if power else ():
                change[term.kind] += scale[region] * parts[region][:n, :n]
        return change["stiffness"], change["mass"]

    def _of_the_whole(self, state: State, factor: str) -> tuple[FloatArray, FloatArray]:
        """Return dK and dM per unit of the logarithm of a factor of the whole, at a state [SI]."""
        n = self.ranks[state.released]
        change = self._of_supports(state, factor, range(len(self.structure.spec.regions) + 1))
        for term, parts in self.terms(state):
            power = term.powers.get(factor, 0.0)
            if power:
                change[term.kind] += power * term.scale(state.factors) * parts[:n, :n]
        return change["stiffness"], change["mass"]

    def _of_supports(self, state: State, factor: str, regions: Sequence[int]) -> dict[str, FloatArray]:
        """Return what the supports that give way add to dK and dM where some regions scale [SI]."""
        n, chosen = self.ranks[state.released], list(regions)
        power = {term.kind: term.powers.get(factor, 0.0) for term in self.structure.terms}
        change = {"stiffness": np.zeros((n, n)), "mass": np.zeros((n, n))}
        for one in supports_at(self.structure, state):
            held = power["stiffness"] * one.held_by[chosen].sum()
            change["stiffness"] += held * one.strained
            change["mass"] += held * one.drawn + power["mass"] * one.carried_by[chosen].sum() * one.carried
        return change

    def rows(self, points: FloatArray, directions: FloatArray | None = None) -> dict[str, FloatArray]:
        """Return displacement and slopes of the basis at points (n_points, dim) [m], each (n_points, r).

        Parameters
        ----------
        points : (n_points, dim) array
            Places in model axes [m].
        directions : (n_points, 3) array, optional
            Unit vectors along which the displacement is meant; left out, the model's z.
        """
        key = points.tobytes(), None if directions is None else directions.tobytes()
        if key not in self._rows:
            while len(self._rows) >= PLACES:
                self._rows.pop(next(iter(self._rows)))
            self._rows[key] = self.structure.rows_on(points, directions, self.basis)
        return dict(self._rows[key])

    @cached_property
    def _rows(self) -> dict[tuple[bytes, bytes | None], dict[str, FloatArray]]:
        """Rows of the points asked for last: a search asks for a place again with another size."""
        return {}

    def unit_mass(self, points: FloatArray) -> FloatArray:
        """Return the mass matrix of 1 kg at each of some points (n_points, dim) [m], shape (r, r) [-]."""
        return self.project(self.structure.unit_mass(points))

    def eigen(self, state: State) -> tuple[FloatArray, FloatArray]:
        """Return all eigenvalues [rad^2/s^2] and mass-normalised vectors of a state in the reduced basis.

        Eigenvalues are not numbers where the state has lost its mass.
        """
        stiffness, mass = self.matrices(state)
        idle = self._idle(state.released)
        if idle is None:
            return solve_pencil(stiffness, mass)
        used = np.ones(len(mass), dtype=bool)
        used[: len(idle)] = ~idle
        vectors = np.zeros((len(mass), int(used.sum())))
        values, vectors[used] = solve_pencil(stiffness[np.ix_(used, used)], mass[np.ix_(used, used)])
        return values, vectors
