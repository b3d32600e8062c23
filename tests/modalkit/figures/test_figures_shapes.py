"""Figures of mode shapes: of points, over a model, and where there is nothing to draw."""

from __future__ import annotations

import numpy as np
import pytest
from figure_cases import case_of, model_of
from figure_text import assert_legible, words

from acquisition import Dof, Geometry, InputError, ModalData
from modalkit.figures import shapes_figure
from updating import Predictor


@pytest.mark.long
def test_shapes_of_identified_modes() -> None:
    for model in (model_of(1), model_of(12)):
        figure = shapes_figure(model.modal)
        assert len(figure.axes) == len(model)
        assert_legible(figure)


@pytest.mark.parametrize("kind", ["beam", "plate"])
@pytest.mark.parametrize("modes", [1, 5])
def test_shapes_over_the_model(kind: str, modes: int) -> None:
    case = case_of(kind, modes=modes)
    figure = shapes_figure(case.measured, Predictor(case.spec, case.measured))
    assert len(figure.axes) == modes
    assert_legible(figure)
    assert_legible(shapes_figure(case.measured))


def test_the_curve_of_a_perfect_model_passes_through_the_points() -> None:
    case = case_of("beam", modes=3)
    for axes in shapes_figure(case.measured, Predictor(case.spec, case.measured)).axes:
        curve = next(line for line in axes.get_lines() if len(np.asarray(line.get_xdata())) > 50)
        dots = next(line for line in axes.get_lines() if line.get_marker() == "o")
        x, y = np.asarray(dots.get_xdata(), dtype=float), np.asarray(dots.get_ydata(), dtype=float)
        there = np.interp(
            x, np.asarray(curve.get_xdata(), dtype=float), np.asarray(curve.get_ydata(), dtype=float)
        )
        assert np.abs(y).max() == pytest.approx(1.0)
        assert there == pytest.approx(y, abs=2e-3)


def plate_modes(nodes: list[int], lines: list[tuple[int, int]] | None = None) -> ModalData:
    """Return a bending and a torsion mode at points of a grid of 4 by 3, numbered along x."""
    place = np.array([[0.1 * ((n - 1) % 4), 0.1 * ((n - 1) // 4), 0.0] for n in nodes])
    along, across = np.cos(np.pi * place[:, 0] / 0.3), np.cos(np.pi * place[:, 1] / 0.2)
    return ModalData(
        frequency=np.array([100.0, 200.0]),
        frequency_sigma=np.ones(2),
        dofs=tuple(Dof(n, 3) for n in nodes),
        shapes=np.stack([along, along * across], axis=1).astype(complex),
        geometry=Geometry(tuple(nodes), place, lines=np.array(lines or np.zeros((0, 2)), int)),
    )


def test_shapes_are_drawn_with_the_lines_of_the_geometry() -> None:
    bare, joined = (shapes_figure(plate_modes(list(range(1, 13)), j)) for j in (None, [(1, 2), (2, 6)]))
    for without, with_lines in zip(bare.axes, joined.axes, strict=True):
        assert len(with_lines.get_lines()) == len(without.get_lines()) + 2
    beam = shapes_figure(plate_modes([1, 2, 3, 4], [(1, 2), (3, 4)]))
    segments = [line for line in beam.axes[0].get_lines() if line.get_alpha() == 0.5]
    assert [np.asarray(line.get_xdata()).tolist() for line in segments] == [
        [0.0, 0.1],
        [0.2, pytest.approx(0.3)],
    ]


@pytest.mark.parametrize("gone", [[], [6]])
def test_shapes_of_a_plate_fill_full_grids_and_others(gone: list[int]) -> None:
    figure = shapes_figure(plate_modes([n for n in range(1, 13) if n not in gone]))
    assert all(len(axes.collections) >= 2 for axes in figure.axes)
    assert_legible(figure)


def test_one_point_has_no_shape_to_draw() -> None:
    modal = ModalData(
        frequency=np.array([10.0]),
        frequency_sigma=np.ones(1),
        dofs=(Dof(1, 3),),
        shapes=np.ones((1, 1)).astype(complex),
    )
    figure = shapes_figure(modal)
    assert "1 mode at one test point: there is no shape to draw" in words(figure)
    assert not figure.axes


def test_shapes_where_no_point_has_a_place() -> None:
    modal = ModalData(
        frequency=np.array([10.0]),
        frequency_sigma=np.ones(1),
        dofs=(Dof(1, 3), Dof(2, 3)),
        shapes=np.array([[1.0], [0.5]]).astype(complex),
    )
    figure = shapes_figure(modal)
    assert figure.axes[0].get_xlabel() == "test point"
    with pytest.raises(InputError, match="no shapes"):
        shapes_figure(ModalData(frequency=np.array([10.0]), frequency_sigma=np.ones(1)))
