"""Structures given by matrices against analysis, against the built-in models' own matrices, and what is refused."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from imported_cases import (
    DENSITY,
    LENGTH,
    LINE,
    STIFF,
    E,
    beam_matrices,
    beam_table,
    clamp,
    imported_beam,
    seen_from,
    spec_of,
)
from scipy import linalg, sparse
from scipy.optimize import brentq

from acquisition.errors import StudyError
from updating import LIBRARY, Material, PointMass, Predictor, Region, Spec, build_structure
from updating.models.accuracy import reduction_error
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable
from updating.models.imported.checks import negative_pivots
from updating.models.imported.ordering import factored
from updating.models.named_factors import departure, unassigned
from updating.models.reduced import Reduced
from updating.models.reduction import reduce_structure
from updating.models.state import NOMINAL, State

ROOTS = np.array([1.8751040687, 4.6940911330, 7.8547574382, 10.995540735])
"""cos x cosh x = -1."""

ANALYTIC = (ROOTS / LENGTH) ** 2 * np.sqrt(STIFF / LINE) / (2 * np.pi)


def frequencies(structure: object, count: int, first: int = 0) -> np.ndarray:
    values = structure.eigen(first + count)[0]  # type: ignore[attr-defined]
    return np.sqrt(np.maximum(values[first:], 0)) / (2 * np.pi)


@pytest.mark.parametrize("elements", [30, 230])
def test_a_cantilever_written_out_by_hand(elements: int) -> None:
    """Small ones are solved densely, large ones by shift and invert."""
    structure = build_structure(spec_of(imported_beam(elements)))
    assert frequencies(structure, 4) == pytest.approx(ANALYTIC, rel=2e-5)
    assert structure.rigid_modes == 0


@pytest.mark.parametrize("elements", [20, 230])
def test_a_free_beam_has_two_motions_that_nothing_holds(elements: int) -> None:
    imported = imported_beam(elements, clamped=False)
    structure = build_structure(spec_of(imported))
    assert structure.rigid_modes == 2
    expected = (np.array([4.7300407449, 7.8532046241]) / LENGTH) ** 2 * np.sqrt(STIFF / LINE) / (2 * np.pi)
    assert frequencies(structure, 2, 2) == pytest.approx(expected, rel=2e-5)
    assert imported.total_mass == pytest.approx(LINE * LENGTH, rel=1e-9)


def test_vectors_are_mass_normalised() -> None:
    structure = build_structure(spec_of(imported_beam(230)))
    _, vectors = structure.eigen(6)
    gram = vectors.T @ (structure.matrix("mass") @ vectors)
    np.testing.assert_allclose(gram, np.eye(6), atol=1e-8)


def exported(spec: Spec) -> Imported:
    """Take a built-in model's own matrices, with the rows of its vertices' displacement."""
    built = build_structure(spec)
    free = built.free()
    renumbered = np.full(built.n_dofs, -1)
    renumbered[free] = np.arange(len(free))
    mesh = built.fields.components[0].basis.mesh.p.T  # type: ignore[attr-defined]
    rows = built.rows(mesh)["w"].tolil()
    row = np.array([renumbered[int(np.argmax(np.abs(rows[[i]].toarray())))] for i in range(len(mesh))])
    places = np.zeros((len(mesh), 3))
    places[:, : mesh.shape[1]] = mesh
    table = NodeTable(np.arange(len(mesh)) + 1, places, np.full(len(mesh), 3), row)
    cut = {kind: Sparse(built.matrix(kind)[free][:, free]) for kind in ("stiffness", "mass")}
    return Imported(cut["stiffness"], cut["mass"], table)


STEEL = Material(210e9, 7850.0, 0.3)
BUILT = {
    "beam": Spec(
        "beam",
        length=0.376,
        width=0.03,
        thickness=0.005,
        elements=(30,),
        clamped=("x0",),
        theory="euler-bernoulli",
        material=STEEL,
    ),
    "plate": Spec(
        "plate",
        length=0.376,
        width=0.2,
        thickness=0.003175,
        elements=(12, 8),
        clamped=("x0",),
        theory="kirchhoff",
        material=STEEL,
    ),
    "free plate": Spec(
        "plate",
        length=0.376,
        width=0.2,
        thickness=0.003175,
        elements=(12, 8),
        clamped=(),
        theory="kirchhoff",
        material=STEEL,
    ),
}


@pytest.mark.parametrize("name", BUILT)
def test_a_built_in_model_comes_back_as_itself(name: str) -> None:
    spec = BUILT[name]
    built, again = build_structure(spec), build_structure(spec_of(exported(spec)))
    assert again.rigid_modes == built.rigid_modes
    first = built.rigid_modes
    assert frequencies(again, 12, first) == pytest.approx(frequencies(built, 12, first), rel=1e-7)


def test_a_built_in_model_comes_back_with_its_shapes_and_slopes() -> None:
    """At nodes the rows are the nodes' own; between them, and for slopes, neighbours are asked."""
    spec = BUILT["plate"]
    built, again = build_structure(spec), build_structure(spec_of(exported(spec)))
    rng = np.random.default_rng(3)
    inside = np.array([0.02, 0.0]) + rng.random((12, 2)) * [0.35, 0.2]
    points = np.hstack([inside, np.zeros((12, 1))])
    _, ours = built.eigen(6)
    _, theirs = again.eigen(6)
    there, here = again.rows(points), built.rows(inside)
    signs = np.sign(np.sum((here["w"] @ ours) * (there["w"] @ theirs), axis=0))
    size = np.abs(here["w"] @ ours).max(axis=0)
    np.testing.assert_allclose((there["w"] @ theirs) * signs / size, here["w"] @ ours / size, atol=0.02)
    for slope in ("wx", "wy"):
        size = np.abs(here[slope] @ ours).max(axis=0)
        miss = ((there[slope] @ theirs) * signs - here[slope] @ ours) / size
        assert np.sqrt(np.mean(miss**2)) < 0.06, slope
    assert not np.any(there["wz"].toarray())  # the direction of hitting has no slope


def reduced(imported: Imported, **options: object) -> Reduced:
    structure = build_structure(spec_of(imported, **options))  # type: ignore[arg-type]
    return reduce_structure(structure, np.array([[LENGTH, 0, 0], [0.3 * LENGTH, 0, 0]]), None, modes=12)


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


def test_lumped_masses_without_rotary_inertia_are_condensed() -> None:
    """Against Guyan's condensation, exact where the rows left out carry no mass (Guyan 1965)."""
    elements = 20
    k, _ = (clamp(matrix) for matrix in beam_matrices(elements))
    share = np.full(elements, LINE * LENGTH / elements)
    share[-1] /= 2
    lumped = np.zeros(2 * elements)
    lumped[::2] = share
    imported = Imported(k, Sparse(np.diag(lumped)), beam_table(elements, clamped=True))
    w, turn = np.arange(0, 2 * elements, 2), np.arange(1, 2 * elements, 2)
    dense = k.toarray()
    condensed = dense[np.ix_(w, w)] - dense[np.ix_(w, turn)] @ np.linalg.solve(
        dense[np.ix_(turn, turn)], dense[np.ix_(turn, w)]
    )
    expected = linalg.eigh(condensed, np.diag(share), eigvals_only=True, subset_by_index=(0, 5))
    structure = build_structure(spec_of(imported))
    assert structure.eigen(6)[0] == pytest.approx(expected, rel=1e-5)
    basis = reduced(imported)
    assert basis.eigen(NOMINAL)[0][:6] == pytest.approx(expected, rel=1e-5)


def test_a_mass_matrix_that_is_singular_without_an_empty_row_is_taken() -> None:
    """Two rows share one mass through a sum, as with reduced integration: one motion has stiffness and no mass."""
    imported = imported_beam(10)
    mass = imported.mass.toarray()
    turn = np.zeros(mass.shape[0])
    turn[[5, 7]] = 1.0, -1.0
    length = turn @ mass @ turn
    singular = mass - np.outer(mass @ turn, mass @ turn) / length
    found = build_structure(spec_of(Imported(imported.stiffness, Sparse(singular), imported.nodes)))
    assert found.unknowns == mass.shape[0] - 1
    inverse = linalg.eigh(singular, imported.stiffness.toarray(), eigvals_only=True)[::-1]
    assert found.eigen(5)[0] == pytest.approx(1 / inverse[:5], rel=1e-8)


def test_a_mass_that_the_modeller_knows_of() -> None:
    """A beam with a tip mass: 1 + cos x cosh x + (m / m0) x (cos x sinh x - sin x cosh x) = 0 (Blevins 1979)."""
    ratio = 0.2
    spec = spec_of(imported_beam(40), (PointMass((LENGTH, 0.0, 0.0), ratio * LINE * LENGTH),))

    def characteristic(x: float) -> float:
        return 1 + np.cos(x) * np.cosh(x) + ratio * x * (np.cos(x) * np.sinh(x) - np.sin(x) * np.cosh(x))

    roots = np.array([brentq(characteristic, 1.0, 1.87), brentq(characteristic, 3.5, 4.69)])
    expected = (roots / LENGTH) ** 2 * np.sqrt(STIFF / LINE) / (2 * np.pi)
    assert frequencies(build_structure(spec), 2) == pytest.approx(expected, rel=1e-4)


def test_the_inertia_of_a_mass_turns_with_the_rows_of_rotation() -> None:
    tip = PointMass((LENGTH, 0.0, 0.0), 0.0, 1e-4)
    structure = build_structure(spec_of(imported_beam(10), (tip,)))
    added = (structure.matrix("mass") - imported_beam(10).mass).toarray()
    expected = np.zeros_like(added)
    expected[-1, -1] = 1e-4
    np.testing.assert_allclose(added, expected, atol=1e-12)


def test_effects_that_apply_and_those_that_do_not() -> None:
    points = np.array([[0.2, 0, 0], [LENGTH, 0, 0]])
    test = seen_from(points, np.tile([0.0, 0.0, 1.0], (2, 1)))
    predictor = Predictor(spec_of(imported_beam(24)), test)
    why = {name: effect.why_not(predictor) for name, effect in LIBRARY.items()}
    assert {n for n, stated in why.items() if stated is None} >= {
        "E",
        "density",
        "section_scale",
        "sensor_mass",
    }
    assert str(why["length"]) == "not for imported matrices"
    assert why["clamp_rotation"] is None  # the node that the support holds is in the table
    assert "no stiffness_parts" in str(why["local_stiffness"])
    heavier = LIBRARY["sensor_mass"].state(predictor, {"mass": 0.02})
    with_tip = spec_of(imported_beam(24), (PointMass((LENGTH, 0, 0), 0.02),))
    found = predictor.predict(heavier, count=3).frequency
    assert found == pytest.approx(frequencies(build_structure(with_tip), 3), rel=1e-4)


def test_constants_along_oblique_directions() -> None:
    """A pair of equal springs in x and y: a hit at 30 degrees sees each by its share."""
    node = NodeTable(
        np.array([1, 1, 2, 2]),
        np.array([[0, 0, 0]] * 2 + [[1, 0, 0]] * 2),
        np.array([1, 2, 1, 2]),
        np.arange(4),
    )
    imported = Imported(Sparse(np.diag([1e4, 4e4, 1e4, 4e4])), Sparse(np.diag([1.0, 1.0, 2.0, 2.0])), node)
    along = np.array([[np.cos(np.pi / 6), np.sin(np.pi / 6), 0.0], [0.0, 1.0, 0.0]])
    rows = build_structure(spec_of(imported)).rows(np.array([[0, 0, 0], [1, 0, 0]]), along)["w"].toarray()
    np.testing.assert_allclose(rows, [[np.cos(np.pi / 6), 0.5, 0, 0], [0, 0, 0, 1]], atol=1e-12)


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


@pytest.mark.long
def test_a_body_is_factored_by_its_places(rng: np.random.Generator) -> None:
    """Same answers, same pivots' signs and rows as by minimum degree; of a solid block less fill."""
    side = 14
    grid = np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    line = sparse.diags_array([1.0, 1.0, 1.0], offsets=[-1, 0, 1], shape=(side, side))
    near = sparse.kron(sparse.kron(line, line), line)
    near = sparse.kron(near, np.ones((3, 3))).tocsr()
    matrix = Sparse(1.001 * sparse.diags_array(near.sum(axis=1)) - near)
    places = np.repeat(grid.astype(float), 3, axis=0)
    places[rng.choice(len(places), 30, replace=False)] = np.nan
    by_degree, by_places = factored(matrix), factored(matrix, places)
    loads = rng.standard_normal((len(places), 2))
    np.testing.assert_allclose(by_places.solve(loads), by_degree.solve(loads), atol=1e-10)
    assert by_places.U.nnz < by_degree.U.nnz
    row = 1234
    held = matrix.tolil()
    held[row, row] = -1.0
    assert negative_pivots(factored(Sparse(held.tocsr()), places)) == (1, row + 1)


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
