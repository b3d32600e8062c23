"""The reduced basis of a structure: its lowest modes, static answers, and what its clamps set free."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain, combinations
from types import MappingProxyType

import numpy as np
from scipy import sparse

from acquisition.arrays import FloatArray
from updating.models.base import Structure
from updating.models.columns import columns_along, extend_basis
from updating.models.fields import Sparse
from updating.models.imported.placing import SIDE
from updating.models.reduced import ROTATION, TRANSLATION, Reduced
from updating.models.structure import FieldStructure

STATIC = float(np.finfo(float).eps) / 1e-6
"""Modes with a first eigenvalue over their own below this are static beside the first [-]: kept, they would round it by
more than 1e-6. Twice as much: modes of beams with fine meshes are left out, which round next to nothing."""

SMALL = 90
"""Up to so many unknowns a model is its own reduced basis."""

FAR_MODES = 12
"""Elastic modes of a structure that is far from the nominal one, released or stretched, which join the basis."""


def reduce_structure(
    structure: Structure, points: FloatArray, directions: FloatArray | None = None, *, modes: int = 30
) -> Reduced:
    """Build the reduced basis of a structure.

    Parameters
    ----------
    structure : Structure
        The full model.
    points : (n_points, dim) array
        Test points, whose static answers join the basis [m].
    directions : (n_points, 3) array, optional
        Directions in which they move; left out, the model's z.
    modes : int
        Number of nominal modes kept beside the rigid-body modes.

    Returns
    -------
    Reduced
    """
    mass, stiffness, unknowns = structure.matrix("mass"), structure.matrix("stiffness"), structure.unknowns
    count = unknowns if unknowns <= SMALL else min(modes + structure.rigid_modes, unknowns)
    values, vectors = structure.eigen(count)
    low = values <= values[min(structure.rigid_modes, count - 1)] / STATIC
    values, basis = values[low], vectors[:, low]
    if len(values) < unknowns:
        loads = _loads(structure.rows(points, directions))
        basis = extend_basis(basis, _static_answers(structure, mass, values, basis, loads), mass)
        for state in structure.stretched:
            stiff, heavy = structure.matrices(state)
            count = structure.rigid_modes + min(FAR_MODES, modes)
            shapes = structure.eigen(count, stiffness=stiff, mass=heavy)[1]
            basis = extend_basis(basis, shapes, mass)
    ranks = {frozenset[str](): basis.shape[1]}
    if structure.fixed:
        for released in (ROTATION, TRANSLATION, ROTATION | TRANSLATION):
            basis = extend_basis(basis, _released_shapes(structure, stiffness, mass, released, modes), mass)
            ranks[released] = basis.shape[1]
        ranks[TRANSLATION] = basis.shape[1]
    return _with_parts(structure, Reduced(structure, basis, ranks), mass)


def _loads(rows: Mapping[str, Sparse]) -> FloatArray:
    """Return the unit forces at points whose static answers join the basis, on every side of a joint, (n_dofs, n)."""
    there = [matrix for name, matrix in rows.items() if name == "w" or name.startswith(SIDE)]
    found = sparse.vstack(there).toarray()
    return np.asarray(found[np.any(found != 0, axis=1)].T)


def _with_parts(structure: Structure, reduced: Reduced, mass: Sparse) -> Reduced:
    """Return a plate's model with columns behind the others for parts of its clamped edges that let go."""
    if not isinstance(structure, FieldStructure) or not structure.along:
        return reduced
    clamped, behind = reduced.basis[:, : reduced.ranks[frozenset()]], reduced.basis.shape[1]
    columns, lifts = columns_along(structure, clamped, mass, behind)
    basis = np.hstack([reduced.basis, columns])
    kinds = [*structure.fixed, *lifts]
    sets = chain.from_iterable(combinations(kinds, n) for n in range(1, len(kinds) + 1))
    ranks = {frozenset(s): basis.shape[1] for s in sets} | dict(reduced.ranks)
    return Reduced(structure, basis, ranks, lifts=MappingProxyType(lifts))


def _static_answers(
    structure: Structure, mass: Sparse, values: FloatArray, vectors: FloatArray, loads: FloatArray
) -> FloatArray:
    """Solve for the static answers to softening each region in the low modes and to loads (n_dofs, n)."""
    shift = 1e-3 * float(values[structure.rigid_modes]) if structure.rigid_modes else 0.0
    answer = structure.static_answers(loads, values, vectors, shift)
    lengths = np.sqrt(np.einsum("ij,ij->j", answer, mass @ answer))
    answer, lengths = answer[:, lengths > 0], lengths[lengths > 0]  # a force on a clamped edge moves nothing
    left, size, _ = np.linalg.svd(_remove(answer / lengths, vectors, mass), full_matrices=False)
    return np.asarray(left[:, (size > 1e-8 * size.max(initial=0.0)).nonzero()[0]])


def _remove(answer: FloatArray, vectors: FloatArray, mass: Sparse) -> FloatArray:
    return np.asarray(answer - vectors @ (vectors.T @ (mass @ answer)))


def _released_shapes(
    structure: Structure, stiffness: Sparse, mass: Sparse, released: frozenset[str], modes: int
) -> FloatArray:
    """Return modes of the structure on springs of middling and low stiffness where its clamps were."""
    freed = np.concatenate([structure.fixed[kind] for kind in sorted(released)])
    count = min(FAR_MODES, modes)
    shapes = []
    for ratio in (1e-1, 1e-4):
        spring = np.zeros(structure.n_dofs)
        spring[freed] = ratio * np.abs(stiffness.diagonal()[freed])
        held = Sparse(stiffness + sparse.diags_array(spring))
        shapes.append(structure.eigen(count, stiffness=held, released=released)[1])
    return np.hstack(shapes)
