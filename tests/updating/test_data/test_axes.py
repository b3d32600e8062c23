"""The model's axes in test coordinates."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from acquisition.errors import StudyError
from updating import Axes

number = st.floats(-10, 10)
triple = st.tuples(number, number, number)


@given(origin=triple, turn=triple, point=triple, stretch=st.floats(0.1, 10))
def test_any_turned_and_shifted_axes_are_undone(
    origin: tuple[float, float, float],
    turn: tuple[float, float, float],
    point: tuple[float, float, float],
    stretch: float,
) -> None:
    """Axes of any length give lengths in metres, and z completes them right-handed."""
    rotation = Rotation.from_rotvec(turn).as_matrix()
    axes = Axes(origin, tuple(stretch * rotation[:, 0]), tuple(rotation[:, 1]))
    seen = rotation @ np.array(point) + np.array(origin)
    assert axes.to_model(seen[None])[0] == pytest.approx(point, abs=1e-9)
    np.testing.assert_allclose(axes.rotation, rotation.T, atol=1e-9)
    assert np.linalg.det(axes.rotation) == pytest.approx(1.0)


def test_nothing_said_is_the_test_s_own_axes() -> None:
    points = np.arange(6.0).reshape(2, 3)
    np.testing.assert_array_equal(Axes().to_model(points), points)


def test_a_file_with_y_down_the_beam() -> None:
    axes = Axes((0.0, 1.0, 0.0), x=(0.0, -1.0, 0.0), y=(1.0, 0.0, 0.0))
    assert axes.to_model(np.array([[0.2, 0.4, 0.0]]))[0] == pytest.approx([0.6, 0.2, 0.0])
    assert axes.rotation[2] == pytest.approx([0.0, 0.0, 1.0])


@pytest.mark.parametrize(
    ("x", "y"),
    [((1.0, 0.0, 0.0), (1.0, 1.0, 0.0)), ((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)), ((1.0, 0, 0), (-1.0, 0, 0))],
)
def test_axes_that_are_not_perpendicular_are_refused(
    x: tuple[float, float, float], y: tuple[float, float, float]
) -> None:
    with pytest.raises(StudyError, match=r"not perpendicular|has no direction"):
        Axes(x=x, y=y)


@pytest.mark.parametrize("length", [1e300, 1e-300])
def test_axes_of_any_length_turn_alike(length: float) -> None:
    axes = Axes(x=(0.0, length, 0.0), y=(-length, 0.0, 0.0))
    np.testing.assert_array_equal(axes.rotation, [[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
    with pytest.raises(StudyError, match="not perpendicular"):
        Axes(x=(length, 0.0, 0.0), y=(length, length, 0.0))
