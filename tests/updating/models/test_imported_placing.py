"""Test points among imported nodes: exact where they are, fair between, refused beyond."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from imported_cases import AXES, imported_beam, spec_of

from acquisition import Dof, Geometry, ModalData
from acquisition.errors import StudyError
from updating import Axes, measured_from_modes
from updating.models.fields import Sparse
from updating.models.imported import Imported, NodeTable
from updating.models.imported.placing import Places


def cloud(kind: str, seed: int = 0) -> np.ndarray:
    """Return nodes on a line, on a slanted plane, or in a block."""
    rng = np.random.default_rng(seed)
    grid = np.arange(7) / 6
    if kind == "line":
        return np.outer(np.arange(13) / 12, [0.3, 0.2, 0.1])
    if kind == "plane":
        flat = np.array([(x, y) for x in grid for y in grid]) + 0.01 * rng.standard_normal((49, 2))
        return flat @ np.array([[0.5, 0.1, 0.0], [0.0, 0.3, 0.4]])
    block = np.array([(x, y, z) for x in grid for y in grid for z in grid[:4]])
    return 0.4 * block + 0.003 * rng.standard_normal(block.shape)


def places(at: np.ndarray, directions: tuple[int, ...] = (3,)) -> Places:
    node = np.repeat(np.arange(len(at)) + 1, len(directions))
    table = NodeTable(
        node, np.repeat(at, len(directions), axis=0), np.tile(directions, len(at)), np.arange(len(node))
    )
    return Places.of(table, len(node))


@settings(max_examples=40)
@given(kind=st.sampled_from(["line", "plane", "block"]), seed=st.integers(0, 10**6), node=st.booleans())
def test_a_quadratic_motion_is_followed_exactly(kind: str, seed: int, node: bool) -> None:
    """Value and slope, as far as the nodes spread; across them the slope is nothing."""
    at = cloud(kind, 1)
    rng = np.random.default_rng(seed)
    constant, linear, square = rng.standard_normal(), rng.standard_normal(3), rng.standard_normal((3, 3))
    square = square + square.T

    def value(p: np.ndarray) -> np.ndarray:
        return constant + p @ linear + 0.5 * np.einsum("...i,ij,...j->...", p, square, p)

    chosen = rng.integers(0, len(at), 3)
    point = at[chosen[0]] if node else at[chosen].mean(axis=0)
    centred = at - at.mean(axis=0)
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    span = axes[: {"line": 1, "plane": 2, "block": 3}[kind]]
    found = places(at).find(point, 2)
    there = value(at[found.index])
    assert found.weights @ there == pytest.approx(value(point), rel=1e-6, abs=1e-6)
    gradient = span.T @ (span @ (linear + square @ point))
    np.testing.assert_allclose(found.slopes @ there, gradient, rtol=1e-5, atol=1e-5)
    assert found.on


@pytest.mark.parametrize("kind", ["line", "plane", "block"])
def test_at_a_node_the_node_alone_speaks(kind: str) -> None:
    at = cloud(kind)
    found = places(at).find(at[5], 2)
    assert found.nearest == 5
    assert found.weights.tolist() == np.eye(len(found.weights))[0].tolist()


@pytest.mark.parametrize("count", [2, 3, 4])
def test_of_several_nodes_at_a_point_each_may_be_meant(count: int) -> None:
    """Their mean is read, and the parts besides have the covariance of one of them, each as likely."""
    line = cloud("line")
    at = np.vstack([line, np.tile(line[5], (count - 1, 1))])
    found = places(at).find(line[5], 2)
    there = np.isin(found.index, [5, *range(len(line), len(at))])
    np.testing.assert_allclose(found.weights, there / count, atol=1e-12)
    motion = np.random.default_rng(count).standard_normal(len(at))
    one_of = motion[found.index][there]
    assert np.sum((found.sides @ motion[found.index]) ** 2) == pytest.approx(np.var(one_of))


def test_a_node_that_is_held_is_not_meant_beside_one_that_moves() -> None:
    at = np.array([[0.0, 0, 0], [0.1, 0, 0], [0.2, 0, 0], [0.3, 0, 0], [0.2, 0, 0]])
    table = NodeTable(np.arange(5), at, np.full(5, 3), np.array([0, 1, 2, 3, -1]))
    rows = Places.of(table, 4).rows(at[[2]], np.array([[0.0, 0.0, 1.0]]))
    assert rows["w"].toarray().tolist() == [[0.0, 0.0, 1.0, 0.0]]
    assert "side0" not in rows


@pytest.mark.parametrize("kind", ["line", "plane", "block"])
def test_a_point_beyond_the_nodes_is_off(kind: str) -> None:
    at = cloud(kind)
    beyond = at.max(axis=0) + 0.3 * np.ptp(at, axis=0)
    assert not places(at).find(beyond, 2).on


def test_layers_of_an_expanded_shell_are_averaged() -> None:
    table = NodeTable(np.array([4, 4, 4]), np.zeros((3, 3)), np.array([3, 3, 1]), np.array([0, 1, 2]))
    rows = Places.of(table, 3).rows(np.zeros((1, 3)), np.array([[0.0, 0.0, 1.0]]))["w"].toarray()
    assert rows.tolist() == [[0.5, 0.5, 0.0]]


def test_a_node_that_is_held_is_at_rest() -> None:
    at = np.array([[0.0, 0, 0], [0.1, 0, 0], [0.2, 0, 0], [0.3, 0, 0]])
    table = NodeTable(np.arange(4), at, np.full(4, 3), np.array([-1, 0, 1, 2]))
    rows = Places.of(table, 3).rows(at, np.tile([0.0, 0.0, 1.0], (4, 1)))["w"].toarray()
    np.testing.assert_allclose(rows, [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], atol=1e-12)


def test_a_slope_lies_in_the_surface_that_is_hit() -> None:
    at = cloud("plane")
    normal = np.cross([0.5, 0.1, 0.0], [0.0, 0.3, 0.4])
    normal = normal / np.linalg.norm(normal)
    rows = places(at, (1, 2, 3)).rows(at[:5], np.tile(normal, (5, 1)))
    along = np.stack([rows[n].toarray() for n in ("wx", "wy", "wz")])
    np.testing.assert_allclose(np.einsum("i,ijk->jk", normal, along), 0.0, atol=1e-9)
    assert np.abs(along).max() > 1


@pytest.mark.parametrize("kind", ["line", "plane", "block"])
def test_a_section_turns_with_its_node(kind: str) -> None:
    """A bar that twists moves beside its axis: w of a turn by omega is omega x r, and its slopes are of that."""
    at, turn = cloud(kind), np.array([0.3, -0.7, 0.2])
    motion = np.hstack([np.cross(turn, at), np.tile(turn, (len(at), 1))]).ravel()
    along = np.array([0.48, -0.6, 0.64])
    rows = places(at, (1, 2, 3, 4, 5, 6)).rows(at[:3], np.tile(along, (3, 1)))
    found = np.stack([rows[name] @ motion for name in ("wx", "wy", "wz")])
    gradient = np.cross(along, turn)  # of omega x r . n by r
    expected = gradient - along * (along @ gradient)
    np.testing.assert_allclose(found, np.tile(expected, (3, 1)).T, atol=1e-12)


def plate(directions: tuple[int, ...] = (1, 2, 3)) -> Imported:
    """Return a grid of masses on springs, 0.4 x 0.2 m."""
    at = np.array([(x, y, 0.0) for x in 0.4 * np.arange(9) / 8 for y in 0.2 * np.arange(5) / 4])
    node = np.repeat(np.arange(len(at)) + 1, len(directions))
    table = NodeTable(
        node, np.repeat(at, len(directions), axis=0), np.tile(directions, len(at)), np.arange(len(node))
    )
    n = len(node)
    return Imported(Sparse(np.diag(1e4 + np.arange(n))), Sparse(np.eye(n)), table)


def modes(dofs: tuple[Dof, ...], coordinates: np.ndarray, axes: np.ndarray | None = None) -> ModalData:
    nodes = tuple(dict.fromkeys(d.node for d in dofs))
    return ModalData(
        frequency=np.array([10.0]), frequency_sigma=np.array([0.01]), dofs=dofs,
        shapes=np.arange(1.0, len(dofs) + 1)[:, None].astype(complex),
        geometry=Geometry(nodes, coordinates, axes=axes),
    )  # fmt: skip


def test_directions_of_a_test_are_kept() -> None:
    dofs = (Dof(1, 3), Dof(1, -1), Dof(2, 2), Dof(3, 4), Dof(3, -3))
    at = np.array([[0.1, 0.1, 0.0], [0.2, 0.1, 0.0], [0.3, 0.1, 0.0]])
    test = measured_from_modes(modes(dofs, at), AXES, spec_of(plate()))
    assert test.directions is not None
    assert test.nodes == (1, 1, 2, 3)
    assert test.directions.tolist() == [[0, 0, 1], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert test.constants[:, 0].tolist() == [1.0, -2.0, 3.0, -5.0]
    assert any("3+RX" in warning for warning in test.warnings)


def test_axes_of_the_test_and_of_a_node_are_turned_into_the_models() -> None:
    axes = Axes((0.0, 0.0, 1.0), (0.0, 1.0, 0.0), (-1.0, 0.0, 0.0))
    turned = np.array([[[np.cos(0.5), np.sin(0.5), 0], [-np.sin(0.5), np.cos(0.5), 0], [0, 0, 1]]])
    test = measured_from_modes(
        modes((Dof(1, 1), Dof(1, 3)), np.array([[-0.1, 0.2, 1.0]]), turned), axes, spec_of(plate())
    )
    assert test.points[0] == pytest.approx([0.2, 0.1, 0.0])
    assert test.directions is not None
    assert np.abs(test.directions[0]) == pytest.approx([np.sin(0.5), np.cos(0.5), 0.0])
    assert test.directions[1].tolist() == [0, 0, 1]


def test_directions_that_the_node_table_lacks_are_left_out() -> None:
    dofs = (Dof(1, 3), Dof(1, 1), Dof(2, 3))
    at = np.array([[0.1, 0.1, 0.0], [0.2, 0.1, 0.0]])
    test = measured_from_modes(modes(dofs, at), AXES, spec_of(plate((3,))))
    assert test.nodes == (1, 2)
    assert any("no direction of the node table: 1+X" in warning for warning in test.warnings)


def test_points_between_nodes_are_said_to_be() -> None:
    at = np.array([[0.125, 0.1, 0.0], [0.2, 0.1, 0.0]])
    test = measured_from_modes(modes((Dof(7, 3), Dof(8, 3)), at), AXES, spec_of(plate()))
    assert any("point 7 is 25 mm from the nearest" in warning for warning in test.warnings)
    on = measured_from_modes(
        modes((Dof(8, 3), Dof(9, 3)), at[[1, 1]] + [[0, 0, 0], [0.1, 0, 0]]), AXES, spec_of(plate())
    )
    assert on.warnings == ()


ASTRAY = [
    (
        1.0,
        (0.0, 0.0, 0.3),
        "test point 8 lies at .* off the imported structure: the nearest node .* away.*check axes",
    ),
    (1000.0, (0.0, 0.0, 0.0), "the test seems a thousand times too large: is it in mm"),
]


@pytest.mark.parametrize(("scale", "shift", "message"), ASTRAY)
def test_points_off_the_structure_are_refused(scale: float, shift: tuple[float, ...], message: str) -> None:
    at = np.array([[0.1, 0.1, 0.0], [0.4, 0.2, 0.0]])
    at = scale * at + np.array([[0, 0, 0], shift])
    with pytest.raises(StudyError, match=message) as error:
        measured_from_modes(modes((Dof(7, 3), Dof(8, 3)), at), AXES, spec_of(plate()))
    assert "\n" not in str(error.value)


def test_a_node_table_in_millimetres_is_suspected() -> None:
    imported = imported_beam(20)
    table = imported.nodes
    wrong = NodeTable(table.node, 1000 * table.places, table.direction, table.row)
    at = np.array([[0.1, 0.0, 0.0], [0.5, 0.0, 0.0]])
    with pytest.raises(
        StudyError, match=r'the node table seems a thousand times too large.*units = "mm-t-s" in'
    ):
        measured_from_modes(
            modes((Dof(7, 3), Dof(8, 3)), at),
            AXES,
            spec_of(Imported(imported.stiffness, imported.mass, wrong)),
        )
