"""Structures given by matrices against analysis, against the built-in models' own matrices, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest
from imported_cases import (
    ANALYTIC,
    LENGTH,
    LINE,
    STIFF,
    beam_matrices,
    beam_table,
    clamp,
    imported_beam,
    reduced,
    seen_from,
    spec_of,
)
from scipy import linalg, sparse
from scipy.optimize import brentq

from updating import LIBRARY, Material, PointMass, Predictor, Spec, build_structure
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable
from updating.models.imported.checks import negative_pivots
from updating.models.imported.ordering import factored
from updating.models.state import NOMINAL


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
