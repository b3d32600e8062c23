"""Models whose parameters are all factors: matrices as sums of constant parts times powers of the factors.

Paper A, Eqs. 11-14, with what never changes summed once: K = K_0 + sum_g c_g K_g and c_g = prod_k x_k^n_gk.
An evaluation is a weighted sum of small matrices and one dense eigenproblem; Eqs. 16 and 17 are quadratic forms.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import linalg

from acquisition.arrays import FloatArray, IntArray
from updating.models.base import Structure
from updating.models.reduced import Reduced
from updating.models.state import State
from updating.update.parameters.parameters import ModelParameter

NONE = frozenset[str]()
"""The releases of clamps that leave them all in place."""


@dataclass(frozen=True)
class Group:
    """Terms and regions that every parameter scales alike.

    Parameters
    ----------
    kind : {"stiffness", "mass"}
        Which matrix.
    powers : tuple of float, length n_parameters
        Power of each parameter in it [-].
    members : tuple of (int, int)
        Index of the term and of the region; the region after the last is no region.
    """

    kind: str
    powers: tuple[float, ...]
    members: tuple[tuple[int, int], ...]

    @property
    def constant(self) -> bool:
        """Whether no parameter scales it."""
        return not any(self.powers)


def groups(structure: Structure, model_parameters: Sequence[ModelParameter]) -> tuple[Group, ...]:
    """Sort a model's terms and regions into what the parameters scale alike."""
    found: dict[tuple[str, tuple[float, ...]], list[tuple[int, int]]] = {}
    for i, term in enumerate(structure.terms):
        for region in range(len(structure.spec.regions) + 1):
            powers = tuple(
                term.powers.get(str(k.factor), 0.0) if not k.regions or region in k.regions else 0.0
                for k in model_parameters
            )
            found.setdefault((term.kind, powers), []).append((i, region))
    return tuple(Group(kind, powers, tuple(where)) for (kind, powers), where in found.items())


def eligible(model_parameters: Sequence[ModelParameter]) -> bool:
    """Whether all parameters are factors of the model, or of no concern to its frequencies."""
    return all(not k.effect and k.of_deck is None for k in model_parameters)


@dataclass(frozen=True, eq=False)
class Affine:
    """A reduced model as a function of its factors.

    Parameters
    ----------
    constant : mapping of str to (n, n) array
        ``stiffness`` and ``mass`` that no parameter scales [SI].
    parts : mapping of str to (n_groups, n, n) array
        What parameters scale, as it is where they are 1 [SI].
    powers : mapping of str to (n_groups, n_parameters) array
        Powers of the parameters [-].
    """

    constant: Mapping[str, FloatArray]
    parts: Mapping[str, FloatArray]
    powers: Mapping[str, FloatArray]

    @property
    def rank(self) -> int:
        """Number of unknowns."""
        return len(self.constant["mass"])

    def matrix(self, kind: str, logs: FloatArray) -> FloatArray:
        """Return stiffness or mass at logarithms of the factors, shape (n, n) [SI]."""
        parts = self.parts[kind]
        if not len(parts):
            return self.constant[kind]
        n = parts.shape[1]
        scaled = np.exp(self.powers[kind] @ logs) @ parts.reshape(len(parts), -1)
        return np.asarray(self.constant[kind] + scaled.reshape(n, n))

    @cached_property
    def _root(self) -> FloatArray | None:
        """Inverse of the Cholesky factor of a mass that stays, transposed; None where it does not."""
        if len(self.parts["mass"]):
            return None
        lower = linalg.cholesky(self.constant["mass"], lower=True)
        return np.asarray(linalg.solve_triangular(lower, np.eye(len(lower)), lower=True).T)

    @cached_property
    def _standard(self) -> Affine:
        """The same on a basis that is orthonormal in the mass."""
        root = self._root
        assert root is not None
        constant = {"stiffness": root.T @ self.constant["stiffness"] @ root}
        return Affine(constant, {"stiffness": root.T @ self.parts["stiffness"] @ root}, self.powers)

    def eigen(self, logs: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the lowest eigenvalues [rad^2/s^2] and mass-normalised vectors (n, count)."""
        last = min(count, len(self.constant["mass"])) - 1
        if self._root is None:
            stiffness, mass = self.matrix("stiffness", logs), self.matrix("mass", logs)
            values, vectors = linalg.eigh(stiffness, mass, subset_by_index=(0, last), check_finite=False)
            return values, vectors
        stiffness = self._standard.matrix("stiffness", logs)
        values, vectors = linalg.eigh(
            stiffness, subset_by_index=(0, last), check_finite=False, overwrite_a=True
        )
        return values, np.asarray(self._root @ vectors)

    def slopes(self, logs: FloatArray, eigenvalue: FloatArray, vectors: FloatArray) -> FloatArray:
        """Return d ln f / d ln factor (n_modes, n_parameters), Eqs. 16 and 17 [-]."""
        by = {kind: self._forms(kind, logs, vectors).T @ self.powers[kind] for kind in self.parts}
        return np.asarray((by["stiffness"] / eigenvalue[:, None] - by["mass"]) / 2)

    def turns(self, logs: FloatArray, chosen: IntArray, rigid: int) -> tuple[FloatArray, FloatArray]:
        """Return derivatives of some mode shapes by the logarithms of the factors, and these shapes.

        They are (n_parameters, n, n_modes) and (n, n_modes), of one solution: its signs are the solver's.

        Modal expansion over all modes of the basis (Fox and Kapoor 1968).

        Parameters
        ----------
        logs : (n_parameters,) array
            Where [-].
        chosen : (n_modes,) int array
            Which elastic modes, from 0.
        rigid : int
            Number of rigid-body modes below them.
        """
        values, vectors = self.eigen(logs, self.rank)
        modes = chosen + rigid
        value, shape = values[modes], vectors[:, modes]
        gap = value[None, :] - values[:, None]
        near = np.abs(gap) < 1e-9 * np.abs(value).max()
        own = (modes, np.arange(len(modes)))
        by_k, by_m = (self._crossed(kind, logs, vectors, shape) for kind in ("stiffness", "mass"))
        share = np.where(near, 0.0, (by_k - value * by_m) / np.where(near, 1.0, gap))
        share[:, own[0], own[1]] = -0.5 * by_m[:, own[0], own[1]]
        return np.asarray(vectors @ share), shape

    def _crossed(self, kind: str, logs: FloatArray, left: FloatArray, right: FloatArray) -> FloatArray:
        """Return left' dK right for every parameter, shape (n_parameters, n, n_modes)."""
        scale = np.exp(self.powers[kind] @ logs)[:, None] * self.powers[kind]
        parts = left.T @ (self.parts[kind] @ right)
        return np.asarray(np.tensordot(scale.T, parts, axes=1))

    def _forms(self, kind: str, logs: FloatArray, vectors: FloatArray) -> FloatArray:
        """Return phi' K_g phi of every group and mode at the factors, shape (n_groups, n_modes)."""
        scale = np.exp(self.powers[kind] @ logs)
        return np.asarray(np.sum((self.parts[kind] @ vectors) * vectors, axis=1) * scale[:, None])


def affine(reduced: Reduced, model_parameters: Sequence[ModelParameter], base: State) -> Affine:
    """Sum the parts of a reduced model that parameters scale alike.

    Parameters
    ----------
    reduced : Reduced
        The model.
    model_parameters : sequence of ModelParameter
        Parameters; see :func:`eligible`.
    base : State
        What is in the model beforehand; must release no clamp, let no support give way and hang no absorber on it.
    """
    n = reduced.ranks[NONE]
    shape = (n, n)
    constant = {"stiffness": np.zeros(shape), "mass": reduced.point_masses[:n, :n].copy()}
    for kind, added in (("stiffness", base.stiffness), ("mass", base.mass)):
        for matrix in added:
            constant[kind] += matrix[:n, :n]
    parts: dict[str, list[FloatArray]] = {"stiffness": [], "mass": []}
    powers: dict[str, list[tuple[float, ...]]] = {"stiffness": [], "mass": []}
    for group in groups(reduced.structure, model_parameters):
        total = _total(reduced, group, base)[:n, :n]
        if group.constant:
            constant[group.kind] += total
        else:
            parts[group.kind].append(total)
            powers[group.kind].append(group.powers)
    return Affine(
        constant,
        {kind: np.array(p).reshape(-1, n, n) for kind, p in parts.items()},
        {kind: np.array(p).reshape(-1, len(model_parameters)) for kind, p in powers.items()},
    )


def _total(reduced: Reduced, group: Group, base: State) -> FloatArray:
    r = reduced.basis.shape[1]
    total = np.zeros((r, r))
    for index, region in group.members:
        term = reduced.structure.terms[index]
        own = {name: value for (i, name), value in base.regional.items() if i == region}
        total += term.scale(base.factors) * term.scale(own) * reduced.parts[index][region]
    return total
