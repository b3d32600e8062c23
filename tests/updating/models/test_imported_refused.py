"""Matrices that cannot be those of a structure are refused."""

from __future__ import annotations

import numpy as np
import pytest
from imported_cases import (
    LENGTH,
    STIFF,
    beam_matrices,
    beam_table,
    clamp,
    imported_beam,
    spec_of,
)
from scipy import sparse

from acquisition.errors import StudyError
from updating import build_structure
from updating.models.fields import Sparse
from updating.models.imported import Imported

K, M = (clamp(matrix) for matrix in beam_matrices(8))


TABLE = beam_table(8, clamped=True)


def changed(matrix: Sparse, *entries: tuple[int, int, float]) -> Sparse:
    dense = matrix.toarray()
    for i, j, value in entries:
        dense[i, j] = value
    return Sparse(dense)


def without(matrix: Sparse, row: int) -> Sparse:
    dense = matrix.toarray()
    dense[row], dense[:, row] = 0.0, 0.0
    return Sparse(dense)


REFUSED = {
    "orders": (K, Sparse(M[:-2][:, :-2]), "of order 16 and the mass of order 14"),
    "shape": (Sparse(K[:-1]), M, "15 x 16"),
    "not finite": (changed(K, (3, 3, np.nan)), M, "not finite"),
    "not symmetric": (changed(K, (2, 0, 0.0)), M, r"stiffness: not symmetric: row (1, column 3|3, column 1)"),
    "empty row": (without(K, 4), without(M, 4), "row 5 is empty in stiffness and mass"),
    "no mass at all": (K, Sparse((16, 16)), "mass matrix is empty"),
    "negative mass": (K, changed(M, (6, 6, -1.0)), "mass matrix indefinite: row 7"),
    "no diagonal": (K, changed(M, (6, 6, 0.0)), "mass matrix indefinite: row 7"),
    "hidden negative mass": (
        K,
        Sparse(M.toarray() - 0.9 * np.eye(16) * M.diagonal()),
        "mass matrix indefinite",
    ),
    "swapped": (M, K, "rad.2/s.2 on the diagonals: are the two matrices swapped"),
    "no stiffness": (Sparse((16, 16)), M, "the stiffness matrix is empty"),
    "massless and loose": (
        without(K, 4) + Sparse(np.diag(np.eye(16)[4] * -1)),
        without(M, 4),
        "row 5 has no mass",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_matrices_that_cannot_be_are_refused(name: str) -> None:
    stiffness, mass, message = REFUSED[name]
    with pytest.raises(StudyError, match=message) as error:
        Imported(Sparse(stiffness), mass, TABLE, source="k.mtx, m.mtx")
    assert "k.mtx" in str(error.value)


@pytest.mark.parametrize("elements", [8, 230])
def test_an_indefinite_stiffness_is_refused(elements: int) -> None:
    k, m = (clamp(matrix) for matrix in beam_matrices(elements))
    pulled = Sparse(k - 3 * STIFF * sparse.diags_array(np.r_[np.zeros(k.shape[0] - 2), 1 / LENGTH**3, 0] * 4))
    imported = Imported(pulled, m, beam_table(elements, clamped=True))
    with pytest.raises(StudyError, match="stiffness matrix indefinite"):
        build_structure(spec_of(imported)).eigen(3)


def test_parts_that_are_not_joined_are_refused() -> None:
    free, mass = beam_matrices(10)
    many = [sparse.block_diag([free] * 4), sparse.block_diag([mass] * 4)]
    imported = Imported(Sparse(many[0].tocsr()), Sparse(many[1].tocsr()), beam_table(10, clamped=False))
    with pytest.raises(StudyError, match="more than six motions"):
        build_structure(spec_of(imported)).rigid_modes  # noqa: B018


@pytest.mark.parametrize("elements", [8, 230])
def test_motions_with_neither_stiffness_nor_mass_are_named_as_such(elements: int) -> None:
    """One direction of two rows is taken out of both matrices: no negative spring, and no rigid body either."""
    k, m = (clamp(matrix).toarray() for matrix in beam_matrices(elements))
    hollow = np.zeros((len(k), 1))
    hollow[[6, 9], 0] = 1.0, -0.5
    hollow /= np.linalg.norm(hollow)
    keep = np.eye(len(k)) - hollow @ hollow.T
    imported = Imported(Sparse(keep @ k @ keep), Sparse(keep @ m @ keep), beam_table(elements, clamped=True))
    with pytest.raises(
        StudyError, match=r"1 motion\(s\) have neither stiffness nor mass, one shows at row (7|10)"
    ):
        build_structure(spec_of(imported)).eigen(3)


def test_a_negative_part_is_refused() -> None:
    with pytest.raises(StudyError, match=r"part 2 of the stiffness: row 1 has -.* on its diagonal"):
        Imported(K, M, TABLE, (Sparse(2 * K), Sparse(-K)))


def test_one_triangle_is_completed() -> None:
    imported = Imported(Sparse(sparse.triu(K).tocsr()), Sparse(sparse.tril(M).tocsr()), TABLE)
    np.testing.assert_array_equal(imported.stiffness.toarray(), K.toarray())
    np.testing.assert_array_equal(imported.mass.toarray(), M.toarray())


def test_parts_that_sum_to_more_than_the_whole_are_refused() -> None:
    whole = imported_beam(24, parts=(8,))
    with pytest.raises(StudyError, match="stiffness_parts: they sum to more than the stiffness: row"):
        Imported(whole.stiffness, whole.mass, whole.nodes, (whole.stiffness, whole.stiffness_parts[1]))
    with pytest.raises(StudyError, match="part of order 16 of a mass of order 48"):
        Imported(whole.stiffness, whole.mass, whole.nodes, (), (M, M))


def test_parts_of_a_whole_without_a_diagonal_are_refused_without_a_warning() -> None:
    """The row named is one that the whole has not at all; warnings are errors here."""
    whole = imported_beam(24, parts=(8,))
    emptied = whole.stiffness
    keep = sparse.diags_array(np.where(np.arange(emptied.shape[0]) == 6, 0.0, 1.0))
    with pytest.raises(StudyError, match=r"stiffness: row 7 has .* and 0 in the whole"):
        Imported(Sparse(keep @ emptied @ keep), whole.mass, whole.nodes, whole.stiffness_parts)
