"""A reduced basis for an update by factors: low modes, and what they become where the parameters are turned."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import linalg as sparse_linalg

from acquisition.arrays import FloatArray
from updating.models.fields import Sparse
from updating.models.reduced import Reduced
from updating.models.reduction import SMALL
from updating.models.state import NOMINAL, State
from updating.models.structure import FieldStructure
from updating.update.parameters.affine import NONE, Group, groups
from updating.update.parameters.parameters import ModelParameter

RANGE = 1.6
"""Modes up to so many times the highest measured frequency are examined."""

ANSWERS = (120, 50)
"""Most static answers that are worked out, and most of their directions that join the basis."""

WIDE = (200, 80)
"""The same of a basis for many updates."""

SAME = 1e-12
"""Directions with less than this share of the largest one's square add nothing [-]."""


def update_basis(
    structure: FieldStructure,
    model_parameters: Sequence[ModelParameter],
    *,
    highest: float,
    count: int,
    state: State = NOMINAL,
    answers: tuple[int, int] = ANSWERS,
) -> Reduced:
    """Build the basis on which the factors of an update are turned.

    It holds the lowest modes of the model at a state and the static answers to the forces that appear where the
    parts of the model that a parameter scales are changed in these modes: the first terms of the series of
    combined approximations (Kirsch, Int. J. Numer. Meth. Engng 35 (1992)). It does not include the release of a clamp.

    Parameters
    ----------
    structure : Structure
        The full model.
    model_parameters : sequence of ModelParameter
        The parameters.
    highest : float
        Highest measured frequency [Hz].
    count : int
        Number of measured modes [-].
    state : State
        Where in the space of the parameters; only its factors are used.
    answers : tuple of int
        Most static answers that are worked out, and most of their directions that join the basis [-].
    """
    stiffness, mass = structure.matrices(state)
    values, modes, solver = _modes(structure, stiffness, mass, highest, count)
    changed = [g for g in groups(structure, model_parameters) if not g.constant]
    if modes.shape[1] == len(structure.free()) or not changed:
        return Reduced(structure, modes, {NONE: modes.shape[1]})
    first, each = structure.rigid_modes, max(2, answers[0] // len(changed))
    low, eigenvalue = modes[:, first : first + each], values[first : first + each]
    load = _loads(structure, changed, low, eigenvalue)[structure.free()]
    answer = np.zeros((structure.n_dofs, load.shape[1]))
    answer[structure.free()] = solver.solve(load)
    basis = _joined(modes, answer, mass, answers[1])
    return Reduced(structure, basis, {NONE: basis.shape[1]})


def extended(reduced: Reduced, modes: FloatArray) -> Reduced:
    """Return a reduced model whose basis also holds some modes of the full model (n_dofs, n) at another state."""
    mass = reduced.structure.matrix("mass")
    basis = _joined(reduced.basis[:, : reduced.ranks[NONE]], modes, mass, modes.shape[1])
    return Reduced(reduced.structure, basis, {NONE: basis.shape[1]})


def _modes(
    structure: FieldStructure, stiffness: Sparse, mass: Sparse, highest: float, count: int
) -> tuple[FloatArray, FloatArray, Factor]:
    """Return the modes below ``RANGE`` times the highest measured one and a few more."""
    unknowns, wanted = len(structure.free()), structure.rigid_modes + count + 8
    factor = Factor(structure, stiffness, mass)
    if unknowns <= SMALL:
        return *structure.eigen(unknowns, stiffness=stiffness, mass=mass), factor
    while True:
        wanted = min(wanted, unknowns - 1)
        values, vectors = factor.lowest(wanted)
        if values[-1] > (2 * np.pi * RANGE * highest) ** 2 or wanted == unknowns - 1:
            return values, vectors, factor
        wanted = int(1.5 * wanted)


class Factor:
    """A stiffness factorised once, for modes and static answers alike.

    Parameters
    ----------
    structure : Structure
        The model.
    stiffness, mass : (n_dofs, n_dofs) sparse arrays
        Its matrices [SI].
    """

    def __init__(self, structure: FieldStructure, stiffness: Sparse, mass: Sparse) -> None:
        """Factorise."""
        free = structure.free()
        self._size, self._free = structure.n_dofs, free
        self._stiffness, self._mass = stiffness[free][:, free].tocsc(), mass[free][:, free].tocsc()
        scale = float(self._stiffness.diagonal().sum() / self._mass.diagonal().sum())
        self._shift = -1e-6 * scale if structure.rigid_modes else 0.0
        self._factor = sparse_linalg.splu(
            (self._stiffness - self._shift * self._mass).tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )

    def solve(self, load: FloatArray) -> FloatArray:
        """Return the answer of the free degrees of freedom to loads on them, (n_free, n_loads)."""
        return np.asarray(self._factor.solve(load))

    def lowest(self, count: int, start: FloatArray | None = None) -> tuple[FloatArray, FloatArray]:
        """Return the lowest eigenvalues [rad^2/s^2] and mass-normalised vectors (n_dofs, count)."""
        n = len(self._free)
        inverse = sparse_linalg.LinearOperator((n, n), matvec=self._factor.solve, dtype=float)
        begin = np.ones(n) if start is None else start[self._free]
        values, vectors = sparse_linalg.eigsh(
            self._stiffness, count, self._mass, sigma=self._shift, which="LM", v0=begin, OPinv=inverse
        )
        order = np.argsort(values)
        full = np.zeros((self._size, count))
        full[self._free] = vectors[:, order]
        return values[order], full


def _loads(
    structure: FieldStructure, changed: Sequence[Group], modes: FloatArray, eigenvalue: FloatArray
) -> FloatArray:
    """Return the forces of every changed group in some modes, shape (n_dofs, n_groups * n_modes)."""
    fields, last = structure.fields.sampled, len(structure.spec.regions)
    sampled = {name: np.asarray(matrix @ modes) for name, matrix in fields.items()}
    shape = (len(structure.region_of), len(changed), modes.shape[1])
    stress: dict[str, FloatArray] = {}
    for i, group in enumerate(changed):
        for index, region in group.members:
            term = structure.terms[index]
            rows = np.flatnonzero(structure.region_of == (-1 if region == last else region))
            weight = term.coefficient[rows, None] * (eigenvalue if group.kind == "mass" else 1.0)
            weight = weight * (1.0 if term.left == term.right else 0.5)
            for here, other in {(term.left, term.right), (term.right, term.left)}:
                stress.setdefault(here, np.zeros(shape))[rows, i] += weight * sampled[other][rows]
    parts = [fields[name].T @ values.reshape(shape[0], -1) for name, values in sorted(stress.items())]
    return np.asarray(sum(parts))


def _joined(modes: FloatArray, extra: FloatArray, mass: Sparse, most: int) -> FloatArray:
    """Append the main directions of ``extra`` that the modes lack, orthonormal in the mass."""
    largest, new = float(np.max(np.einsum("ij,ij->j", extra, mass @ extra), initial=0.0)), extra
    for _ in range(2):
        new = new - modes @ (modes.T @ (mass @ new))
    values, vectors = np.linalg.eigh(new.T @ (mass @ new))
    keep = (values > SAME * max(largest, 1e-300)) & (np.arange(len(values)) >= len(values) - most)
    new = new @ (vectors[:, keep] / np.sqrt(values[keep]))
    new = new - modes @ (modes.T @ (mass @ new))
    return np.hstack([modes, new])
