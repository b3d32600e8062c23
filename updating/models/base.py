"""What every structure offers, whether it is assembled here or imported: one base, one sibling for each origin."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import ClassVar, Protocol

import numpy as np
from scipy.sparse.linalg import splu

from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.solve import lowest
from updating.models.spec import Spec
from updating.models.state import State
from updating.models.yielding import Yielding

FACTORS = ("E", "density", "thickness", "width", "length", "section", "area", "inertia")
"""What a model can be scaled by; ``section`` scales stiffness and mass alike, ``area`` and ``inertia`` are a beam's."""

Powers = Mapping[str, float]


class Term(Protocol):
    """One part of a stiffness or mass matrix that grows with powers of the factors."""

    @property
    def kind(self) -> str:
        """Which matrix it belongs to: ``stiffness`` or ``mass``."""

    @property
    def powers(self) -> Powers:
        """Power of the term in each factor; what is missing is 0 [-]."""

    def scale(self, factors: Mapping[str, float]) -> float:
        """Return the product of the factors to their powers [-]."""


def scale_of(powers: Powers, factors: Mapping[str, float]) -> float:
    """Return the product of factors to their powers [-]."""
    scale = 1.0
    for name, value in factors.items():
        scale *= value ** powers.get(name, 0.0)
    return scale


def region_scales(term: Term, state: State, regions: int) -> FloatArray:
    """Return the factors of a state on a term in every region, and outside all of them, (regions + 1,) [-]."""
    scale = np.full(regions + 1, term.scale(state.factors))
    for (region, factor), value in state.regional.items():
        scale[region] *= value ** term.powers.get(factor, 0.0)
    return scale


def relative_scales(term: Term, state: State, regions: int) -> FloatArray:
    """Return what a state's factors of regions alone make of a term there, and outside all of them, (regions + 1,)."""
    scale = np.ones(regions + 1)
    for (region, factor), value in state.regional.items():
        scale[region] *= value ** term.powers.get(factor, 0.0)
    return scale


def supports_at(structure: Structure, state: State) -> tuple[Yielding, ...]:
    """Return the supports of a state that give way, as stiff and heavy as its factors make what pulls at them."""
    if not state.yielding:
        return ()
    regions = len(structure.spec.regions)
    by = {term.kind: region_scales(term, state, regions) for term in structure.terms}  # one term of each kind
    return tuple(
        one.at(by["stiffness"], by["mass"], carried=state.carried.get(name, 1.0))
        for name, one in state.yielding.items()
    )


def added(structure: Structure, state: State) -> dict[str, tuple[FloatArray, ...]]:
    """Return what a state adds to the ``stiffness`` and to the ``mass``, its supports that give way included [SI]."""
    supports = supports_at(structure, state)
    return {
        "stiffness": (*state.stiffness, *(one.stiffness for one in supports)),
        "mass": (*state.mass, *(one.carried for one in supports)),
    }


class Structure(ABC):
    """A linear structure: a sum of terms over regions, ready to be reduced or solved.

    Attributes
    ----------
    spec : Spec
        What it is a model of.
    terms : sequence of Term
        Its stiffness and mass, term by term.
    fixed : mapping of str to int array
        Degrees of freedom that a clamp holds and an effect may release, by kind.
    along : mapping of str to int array
        Of those the ones that one edge alone holds, by kind and edge, which an effect may release by themselves.
    """

    spec: Spec
    terms: Sequence[Term]
    fixed: Mapping[str, IntArray]
    along: Mapping[str, IntArray] = MappingProxyType({})
    refinable: ClassVar[bool] = True
    """Whether it can be built again on another mesh, to see what its own leaves off."""

    @property
    @abstractmethod
    def n_dofs(self) -> int:
        """Number of degrees of freedom before any is fixed."""

    @property
    @abstractmethod
    def rigid_modes(self) -> int:
        """Number of rigid-body modes that the supports leave."""

    @abstractmethod
    def matrix(self, kind: str) -> Sparse:
        """Return the stiffness or mass matrix over all degrees of freedom [SI]."""

    @abstractmethod
    def matrices(self, state: State) -> tuple[Sparse, Sparse]:
        """Return stiffness and mass under a state's factors, of the whole and of regions, Eqs. 11-14 [SI]."""

    @abstractmethod
    def region_products(self, basis: FloatArray) -> tuple[FloatArray, ...]:
        """Return every term on a basis, each (n_regions + 1, r, r); the last is what lies in no region [SI]."""

    @abstractmethod
    def point_masses(self) -> Sparse:
        """Return the mass matrix of the masses stated by the modeller [kg]."""

    @abstractmethod
    def rows(self, points: FloatArray, directions: FloatArray | None = None) -> dict[str, Sparse]:
        """Return displacement ``w`` and slopes at points, each (n_points, n_dofs).

        Where a model has several nodes at a point, ``side0`` and more are what the one that is meant
        moves differently from ``w``, their mean, per standard deviation.

        Parameters
        ----------
        points : (n_points, dim) array
            Places in model axes [m].
        directions : (n_points, 3) array, optional
            Unit vectors along which the displacement is meant; left out, the model's z.
        """

    def rows_on(
        self, points: FloatArray, directions: FloatArray | None, basis: FloatArray
    ) -> dict[str, FloatArray]:
        """Return the same on a basis (n_dofs, r), each (n_points, r)."""
        return {name: np.asarray(rows @ basis) for name, rows in self.rows(points, directions).items()}

    @abstractmethod
    def unit_mass(self, points: FloatArray) -> Sparse:
        """Return the mass matrix of 1 kg at each of some points [-]."""

    @property
    def stretched(self) -> tuple[State, ...]:
        """States far from the nominal one whose lowest modes join the reduced basis."""
        return ()

    @abstractmethod
    def softenings(self, elastic: FloatArray) -> FloatArray:
        """Return the loads (n_dofs, n) that a softened place feels when the structure moves in its lowest modes."""

    def static_answers(
        self, loads: FloatArray, values: FloatArray, vectors: FloatArray, shift: float
    ) -> FloatArray:
        """Return the static answers (n_dofs, k) to loads, and to what a softened place feels in the lowest modes.

        Parameters
        ----------
        loads : (n_dofs, n) array
            Loads [N].
        values, vectors : (m,) and (n_dofs, m) arrays
            All modes of the basis, rigid-body modes included [rad^2/s^2, kg^-1/2].
        shift : float
            What holds a structure that is free, see :meth:`solve` [rad^2/s^2].
        """
        return self.solve(np.hstack([loads, self.softenings(vectors[:, self.rigid_modes :])]), shift)

    @property
    def unknowns(self) -> int:
        """Number of degrees of freedom that are free and carry mass."""
        return len(self.free())

    def free(self, released: frozenset[str] = frozenset()) -> IntArray:
        """Return the degrees of freedom that the clamps leave free, where some kinds are released."""
        held = [dofs for kind, dofs in self.fixed.items() if kind not in released]
        keep = np.ones(self.n_dofs, dtype=bool)
        keep[np.concatenate(held).astype(int) if held else np.zeros(0, dtype=int)] = False
        for name in released & self.along.keys():
            keep[self.along[name]] = True
        return np.flatnonzero(keep)

    def solve(self, loads: FloatArray, shift: float) -> FloatArray:
        """Return the answers of K + shift M to loads (n_dofs, n) [SI]; the shift holds what is free [rad^2/s^2]."""
        free = self.free()
        held = self.matrix("stiffness") + shift * self.matrix("mass")
        answer = np.zeros((self.n_dofs, loads.shape[1]))
        answer[free] = splu(held[free][:, free].tocsc()).solve(loads[free])
        return answer

    def eigen(
        self,
        count: int,
        *,
        stiffness: Sparse | None = None,
        mass: Sparse | None = None,
        released: frozenset[str] = frozenset(),
    ) -> tuple[FloatArray, FloatArray]:
        """Solve for the lowest modes of the full model, rigid-body modes included.

        Parameters
        ----------
        count : int
            Number of modes.
        stiffness, mass : sparse arrays, optional
            Matrices in place of the nominal ones [SI].
        released : frozenset of str
            Parts of the clamps that do not hold.

        Returns
        -------
        eigenvalues : (count,) array
            Squares of the angular frequencies [rad^2/s^2].
        vectors : (n_dofs, count) array
            Mass-normalised eigenvectors over all degrees of freedom [kg^-1/2].

        Raises
        ------
        StudyError
            If the model has fewer degrees of freedom than modes asked for.
        """
        free = self.free(released)
        k = (self.matrix("stiffness") if stiffness is None else stiffness)[free][:, free]
        m = (self.matrix("mass") if mass is None else mass)[free][:, free]
        if count > len(free):
            raise StudyError(
                f"the model has {len(free)} degrees of freedom, too few for {count} modes; use more elements"
            )
        values, vectors = lowest(k, m, count)
        full = np.zeros((self.n_dofs, count))
        full[free] = vectors
        return values, full
