"""Figures of structures in space: nothing flattened, no air coloured, no direction dropped; the user's own mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from figure_text import assert_legible, panels, words
from glider import PARTS, make_glider
from matplotlib.collections import LineCollection, PathCollection, PolyCollection
from test_localisation_figure import diagnosis_with

import modalkit
from acquisition import Dof, Geometry, ModalData
from modalkit.figures import localisation_figure, shapes_figure
from modalkit.figures.diagnosis.structure import probabilities
from modalkit.figures.space import View
from modalkit.views.mesh import mesh_of
from updating.diagnosis.answer.located import Zone
from updating.nominal import predictor_of


@pytest.fixture(scope="module")
def glider(tmp_path_factory: pytest.TempPathFactory) -> modalkit.Session:
    return modalkit.open_study(make_glider(tmp_path_factory.mktemp("glider")))


def test_a_view_keeps_lengths_across_it_and_fills_its_panel() -> None:
    corners = np.array([[x, y, z] for x in (0.0, 2.0) for y in (0.0, 1.0) for z in (0.0, 0.5)])
    view = View.fit(corners, 4.0, 3.0)
    assert view.axes @ view.axes.T == pytest.approx(np.eye(3), abs=1e-12)
    flat = view.flat(corners)
    assert flat.min() >= 0 and (flat <= [4.0, 3.0]).all()
    assert max((np.ptp(flat, axis=0) / [4.0, 3.0]).tolist()) == pytest.approx(0.95)
    step = view.axes[0] * 0.1  # to the right: so many inches on paper as the scale says
    moved = view.flat(corners + step) - flat
    assert moved == pytest.approx(np.tile([0.1 * view.scale, 0.0], (8, 1)))


def box(extra: list[Dof] | None = None) -> ModalData:
    """Return a closed square, a fin that stands on it, and a point in the air, moving along z and the fin along y."""
    places = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0.5, 0.5], [1, 0.5, 1.0], [2, 2, 2]], float
    )
    lines = np.array([[1, 2], [2, 3], [3, 4], [4, 1], [5, 6]])
    dofs = [*(Dof(n, 3) for n in (1, 2, 3, 4, 7)), Dof(5, 2), Dof(6, 2), *(extra or [])]
    shapes = np.linspace(-1.0, 1.0, len(dofs))[:, None].astype(complex)
    geometry = Geometry(tuple(range(1, 8)), places, lines)
    return ModalData(
        frequency=np.array([10.0]),
        frequency_sigma=np.array([0.1]),
        dofs=tuple(dofs),
        shapes=shapes,
        geometry=geometry,
    )


def test_air_is_not_coloured_and_no_direction_is_dropped() -> None:
    figure = shapes_figure(box(extra=[Dof(7, 1)]))
    (axes,) = figure.axes
    (faces,) = (c for c in axes.collections if isinstance(c, PolyCollection))
    assert len(faces.get_paths()) == 1  # the square, and nothing between it, the fin and the point
    (points,) = (c for c in axes.collections if isinstance(c, PathCollection))
    assert len(points.get_offsets()) == 7  # type: ignore[arg-type]
    assert "7 points, 8 directions" in words(figure)
    assert_legible(figure)


def test_a_point_is_drawn_where_all_its_directions_take_it() -> None:
    """Point 7 moves along z and along x: on paper it goes where their sum, seen from the eye, goes."""
    modal = box(extra=[Dof(7, 1)])
    (axes,) = shapes_figure(modal).axes
    (points,) = (c for c in axes.collections if isinstance(c, PathCollection))
    places, lines = modal.geometry.coordinates, [c for c in axes.collections if isinstance(c, LineCollection)]
    assert lines
    eye = np.array([np.cos(0.5) * np.cos(-0.9), np.cos(0.5) * np.sin(-0.9), np.sin(0.5)])
    right = np.array([-np.sin(-0.9), np.cos(-0.9), 0.0])
    up = np.cross(eye, right)
    assert modal.shapes is not None
    motion = np.zeros((7, 3))
    for k, dof in enumerate(modal.dofs):
        motion[dof.node - 1, abs(dof.direction) - 1] += modal.shapes[k, 0].real
    drawn = np.asarray(points.get_offsets())
    order = [0, 1, 2, 3, 6, 4, 5]  # as the degrees of freedom name the nodes
    reach = 0.13 * np.linalg.norm(np.ptp(places, axis=0)) / np.linalg.norm(motion, axis=1).max()
    for sign in (1.0, -1.0):
        moved = (places + sign * reach * motion)[order]
        flat = np.stack([moved @ right, moved @ up], axis=1)
        scale, *_ = np.linalg.lstsq((flat - flat[0]).ravel()[:, None], (drawn - drawn[0]).ravel(), rcond=None)
        if (drawn - drawn[0]) == pytest.approx(scale[0] * (flat - flat[0]), abs=1e-6):
            return
    pytest.fail("no sign of the mode puts the points where they are drawn")


def test_what_has_no_coordinates_says_which_directions_it_leaves_out() -> None:
    dofs = (Dof(1, 3), Dof(2, 3), Dof(3, 3), Dof(3, 1))
    shapes = np.ones((4, 1), complex)
    figure = shapes_figure(
        ModalData(frequency=np.array([10.0]), frequency_sigma=np.array([0.1]), dofs=dofs, shapes=shapes)
    )
    assert "not drawn" in words(figure) and "3+X" in words(figure)


@pytest.mark.long
def test_shapes_of_a_glider_are_drawn_with_model_and_test(glider: modalkit.Session) -> None:
    assert glider.identified is not None
    figure = shapes_figure(glider.identified.modal)
    assert len(figure.axes) == len(glider.identified)
    assert "64 points, 65 directions" in words(figure)
    assert_legible(figure)
    both = shapes_figure(glider.case.measured, predictor_of(glider.case))
    assert "65 directions" in words(both) and "model" in words(both)
    assert_legible(both)


def test_the_mesh_of_bars_is_that_of_the_matrices(glider: modalkit.Session) -> None:
    mesh = mesh_of(glider.case.spec)
    assert mesh is not None
    assert not mesh.faces
    lengths = [np.linalg.norm(mesh.places[a] - mesh.places[b]) for a, b in mesh.lines]
    assert max(lengths) < 0.3  # bars, and nothing across the air
    names = [region.name for region in glider.case.spec.regions]
    fin = mesh.places[mesh.region == names.index("fin")]
    assert fin[:, 2].min() > 0 and fin[:, 2].max() == pytest.approx(0.5)


def test_regions_are_shaded_by_their_probability(glider: modalkit.Session) -> None:
    made = diagnosis_with("beam", "named", points=())
    zones = tuple(Zone(name, (0.0, 0.0, 0.0), 0.88 if name == "fin" else 0.02) for name in PARTS)
    at = (1.7, 0.0, 0.3)
    where = replace(made.where, zones=zones, location=at, locations=(at,), names=("fin",))
    stated = replace(made, where=where)
    mesh = mesh_of(glider.case.spec)
    assert mesh is not None
    held = probabilities(stated, glider.case, mesh)
    assert set(np.round(held[np.isfinite(held)], 2).tolist()) == {0.02, 0.88}
    figure = localisation_figure(stated, glider.case)
    assert "at fin" in words(figure) and "65 test points" in words(figure)
    assert_legible(figure)
    bars = max(
        (c for c in panels(figure)["where"].collections if isinstance(c, LineCollection)),
        key=lambda c: c.get_linewidths()[0],
    )
    dark = np.asarray(bars.get_color())[:, :3].sum(axis=1)
    assert dark.min() < 0.6 * np.median(dark)


def test_the_skin_of_elements_is_what_no_two_share() -> None:
    from modalkit.views.mesh import _skin

    bricks = [("C3D8", (0, 1, 2, 3, 4, 5, 6, 7)), ("C3D8", (4, 5, 6, 7, 8, 9, 10, 11))]
    lines, faces = _skin([*bricks, ("B31", (8, 12)), ("S3", (0, 1, 13))], {n: n for n in range(14)})
    assert lines == [(8, 12)]
    assert len(faces) == 2 * 6 - 2 + 1
    assert frozenset((4, 5, 6, 7)) not in {frozenset(face) for face in faces}
