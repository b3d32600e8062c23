"""Regions of imported matrices: their factors, their boxes, what belongs to none."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from imported_cases import (
    ANALYTIC,
    DENSITY,
    LENGTH,
    LINE,
    STIFF,
    E,
    beam_matrices,
    clamp,
    imported_beam,
    reduced,
    spec_of,
)
from scipy import linalg, sparse

from acquisition.errors import StudyError
from updating import Material, Region, Spec, build_structure
from updating.models.accuracy import reduction_error
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable
from updating.models.named_factors import departure, unassigned
from updating.models.reduction import reduce_structure
from updating.models.state import NOMINAL, State


@settings(max_examples=12)
@given(
    whole=st.floats(0.4, 2.5), heavier=st.floats(0.4, 2.5), root=st.floats(0.7, 1.4), tip=st.floats(0.7, 1.4),
    elements=st.sampled_from([24, 230]),
)  # fmt: skip
def test_factors_of_the_whole_and_of_regions(
    whole: float, heavier: float, root: float, tip: float, elements: int
) -> None:
    """The reduced model against the matrices of a state, and these against ones that were made so."""
    basis = reduced(imported_beam(elements, parts=(elements // 3,)))
    state = State(factors={"E": whole, "density": heavier}, regional={(0, "E"): root, (1, "density"): tip})
    pieces = [beam_matrices(elements, 0, elements // 3), beam_matrices(elements, elements // 3, elements)]
    k = clamp(Sparse(whole * (root * pieces[0][0] + pieces[1][0])))
    m = clamp(Sparse(heavier * (pieces[0][1] + tip * pieces[1][1])))
    full = basis.structure.matrices(state)
    np.testing.assert_allclose(full[0].toarray(), k.toarray(), rtol=1e-9, atol=1e-6 * STIFF)
    np.testing.assert_allclose(full[1].toarray(), m.toarray(), rtol=1e-9, atol=1e-9 * LINE)
    expected = linalg.eigh(k.toarray(), m.toarray(), eigvals_only=True, subset_by_index=(0, 5))
    assert basis.eigen(state)[0][:6] == pytest.approx(expected, rel=2e-3)
    assert basis.eigen(NOMINAL)[0][:4] == pytest.approx((2 * np.pi * ANALYTIC) ** 2, rel=1e-4)


def test_what_the_parts_leave_out_belongs_to_no_region() -> None:
    whole = imported_beam(24, parts=(8,))
    imported = Imported(
        whole.stiffness, whole.mass, whole.nodes, whole.stiffness_parts[1:], whole.mass_parts[1:]
    )
    structure = build_structure(spec_of(imported))
    np.testing.assert_allclose(
        structure.parts("stiffness")[1].toarray(),
        whole.stiffness_parts[0].toarray(),
        atol=1e-3,  # type: ignore[attr-defined]
    )
    softer = structure.matrices(State(regional={(0, "E"): 0.5}))[0]
    expected = whole.stiffness_parts[0] + 0.5 * whole.stiffness_parts[1]
    np.testing.assert_allclose(softer.toarray(), expected.toarray(), rtol=1e-9, atol=1e-3)
    assert unassigned(structure.spec) == ("unassigned.E", "unassigned.density")
    assert unassigned(spec_of(whole)) == ()
    heavier = structure.matrices(
        departure(structure.spec, {"density": 1.2, "part1.density": 0.9, "unassigned.density": 1.1})
    )[1]
    expected = 1.2 * (1.1 * whole.mass_parts[0] + 0.9 * whole.mass_parts[1])
    np.testing.assert_allclose(heavier.toarray(), expected.toarray(), rtol=1e-9, atol=1e-9 * LINE)


def test_a_region_without_parts_cannot_be_turned() -> None:
    bare, parted = imported_beam(8), imported_beam(8, parts=(4,))
    assert bare.obstacle("E") is None
    assert "stiffness_parts" in str(bare.obstacle("E", regional=True))
    assert "mass_parts" in str(bare.obstacle("density", regional=True))
    assert parted.obstacle("density", regional=True) is None
    assert "have no thickness" in str(parted.obstacle("thickness"))


def test_the_box_of_a_region_is_that_of_its_nodes() -> None:
    imported = imported_beam(24, parts=(8,))
    boxes = [imported.box(i) for i in range(2)]
    assert boxes[0] is not None
    assert boxes[1] is not None
    assert boxes[0][1][0] == pytest.approx(LENGTH / 3)
    assert boxes[1][0][0] == pytest.approx(LENGTH / 3)
    assert imported_beam(8).box(0) is None


def test_regions_of_one_name_and_a_spec_without_elements() -> None:
    spec = spec_of(imported_beam(8), regions=(Region("a", (0, 1)), Region("a", (1, 2))))
    assert spec.dim == 3
    with pytest.raises(StudyError, match="elements"):
        replace(spec, elements=(3,))
    with pytest.raises(StudyError, match="no edge"):
        replace(spec, clamped=("x0",))
    assert spec.material == Material(E, DENSITY)


@pytest.mark.parametrize("elements", [20, 60, 230])
def test_regions_of_a_lumped_beam_against_guyan(elements: int) -> None:
    """A region made softer, another heavier: what follows statically follows the new stiffness, not the nominal one."""
    whole = imported_beam(elements, parts=(elements // 4,))
    n = whole.order
    w, turn = np.arange(0, n, 2), np.arange(1, n, 2)
    shares = []
    for first, last in ((0, elements // 4), (elements // 4, elements)):
        nodes = np.zeros(elements + 1)
        nodes[first:last] += LINE * LENGTH / elements / 2
        nodes[first + 1 : last + 1] += LINE * LENGTH / elements / 2
        shares.append(nodes[1:])
    lumped = [Sparse(sparse.diags_array(np.kron(share, [1.0, 0.0])).tocsr()) for share in shares]
    imported = Imported(
        whole.stiffness, Sparse(lumped[0] + lumped[1]), whole.nodes, whole.stiffness_parts, tuple(lumped)
    )
    state = State(regional={(0, "E"): 0.5, (1, "density"): 1.3})
    k = (0.5 * whole.stiffness_parts[0] + whole.stiffness_parts[1]).toarray()
    condensed = k[np.ix_(w, w)] - k[np.ix_(w, turn)] @ np.linalg.solve(
        k[np.ix_(turn, turn)], k[np.ix_(turn, w)]
    )
    mass = np.diag(shares[0] + 1.3 * shares[1])
    expected = linalg.eigh(condensed, mass, eigvals_only=True, subset_by_index=(0, 4))
    # of 230 elements the basis errs by 5e-6 of a frequency, rounding by 2e-6: eps times largest over lowest eigenvalue
    found = reduced(imported).eigen(state)[0][:5]
    assert np.sqrt(found) == pytest.approx(np.sqrt(expected), rel=1e-5)


def test_a_reduced_basis_knows_regions_that_change() -> None:
    """A basis of ten modes of a beam in four parts, two of them changed: within 0.02 % of the full model.

    The tenth mode errs most, by 6e-6 to 2e-5; rounding is far less, 1e-10 (eps times largest over tenth eigenvalue).
    """
    ends = [0, 20, 40, 60, 80]
    parts = [beam_matrices(80, a, b) for a, b in itertools.pairwise(ends)]
    held = np.arange(2, 162)
    stiff, heavy = ([Sparse(part[kind][held][:, held]) for part in parts] for kind in (0, 1))
    node = np.arange(1, 81)
    table = NodeTable(
        node, np.column_stack([LENGTH * node / 80, 0 * node, 0 * node]), np.full(80, 3), 2 * (node - 1)
    )
    imported = Imported(sum(stiff[1:], stiff[0]), sum(heavy[1:], heavy[0]), table, tuple(stiff), tuple(heavy))
    regions = tuple(Region(f"r{i}", (0.0, 1.0)) for i in range(4))
    spec = Spec(
        "matrices",
        length=LENGTH,
        width=0.1,
        thickness=0.1,
        elements=(),
        clamped=(),
        theory="imported",
        material=Material(1, 1),
        regions=regions,
        imported=imported,
    )
    structure = build_structure(spec)
    reduced = reduce_structure(structure, table.places[[20, 79]], modes=10)
    assert reduced.basis.shape[1] < 80
    for state in (State(regional={(1, "E"): 0.7, (2, "E"): 1.2}), State(regional={(3, "density"): 1.3})):
        stiffness, mass = structure.matrices(state)
        exact = np.sqrt(structure.eigen(10, stiffness=stiffness, mass=mass)[0])
        found = np.sqrt(reduced.eigen(state)[0][:10])
        assert found == pytest.approx(exact, rel=2e-4)
        error = found / exact - 1
        assert int(np.argmax(error)) == 9
        assert reduction_error(reduced, state, 10)[9] == pytest.approx(error[9], rel=0.5)
