"""Tests of all kinds in the model's coordinates: places, directions, signs, what is left out."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from updating_cases import BEAM, PLATE, ExactBeam

from acquisition import Dof, Geometry, ModalData
from acquisition.errors import StudyError
from acquisition.frfs.frf import FrfSet
from identification import ModalModel, identify
from updating import Axes, Measured, measured_from_identified, measured_from_modes

NODES = (3, 5, 9)
X = np.array([0.1, 0.25, 0.376])
TRUE = ExactBeam(0.376, 0.0305, 0.0047625)
FREQUENCY = TRUE.frequencies(3)
SHAPES = TRUE.shapes(FREQUENCY, X)


def modal(directions: tuple[int, ...] = (3, 3, 3), coordinates: np.ndarray | None = None) -> ModalData:
    places = np.stack([X, 0 * X, 0 * X], axis=1) if coordinates is None else coordinates
    shapes = SHAPES.astype(complex)
    dofs = tuple(Dof(n, d) for n, d in zip(NODES, directions, strict=True))
    return ModalData(
        frequency=FREQUENCY,
        frequency_sigma=0.01 * FREQUENCY,
        dofs=dofs,
        shapes=shapes,
        scaled=True,
        geometry=Geometry(NODES, places),
    )


def test_modes_of_a_file_keep_their_shapes_but_no_level_where_none_is_stated() -> None:
    data = replace(modal(), scaled=False)
    test = measured_from_modes(data, Axes(), BEAM, repeatability=0.002, title="a")
    np.testing.assert_allclose(test.constants, data.shapes.real)  # type: ignore[union-attr]
    assert (test.absolute, test.repeated, test.has_shapes, test.sensors) == (False, False, True, ())
    assert test.nodes == NODES
    assert (test.hit == -1).all()
    np.testing.assert_allclose(test.points[:, 0], X)
    assert (test.repeatability, test.title) == (0.002, "a")
    assert np.isnan(test.damping).all()


def test_mass_normalised_shapes_keep_their_level_and_say_so() -> None:
    test = measured_from_modes(modal(), Axes(), BEAM, calibration=0.05)
    assert (test.absolute, test.sensors, test.calibration, test.level_sigma) == (True, (), 0.05, 0.025)
    assert any("stated to be mass-normalised" in w and "calibration = 0.05" in w for w in test.warnings)
    unknown = measured_from_modes(modal(), Axes(), BEAM, calibration=1.0)
    assert not any("mass-normalised" in w for w in unknown.warnings)


def test_complex_shapes_of_any_phase_are_turned_to_the_real_axis() -> None:
    data = modal()
    assert data.shapes is not None
    later = replace(data, shapes=data.shapes * np.exp(1j * np.array([0.5, 1.6, -2.0])))
    found = measured_from_modes(later, Axes(), BEAM).constants
    np.testing.assert_allclose(np.abs(found), np.abs(data.shapes.real), rtol=1e-9)


def test_frequencies_alone_have_no_shapes() -> None:
    data = ModalData(frequency=np.array([10.0, 20.0]), frequency_sigma=np.array([0.1, np.nan]))
    test = measured_from_modes(data, Axes(), BEAM, repeatability=1e-3)
    assert not test.has_shapes
    assert test.constants.shape == (0, 2)
    assert test.frequency_sigma == pytest.approx([0.1, 0.0])
    with pytest.raises(StudyError, match="mode 2 at 20 Hz has no uncertainty"):
        measured_from_modes(data, Axes(), BEAM)


def test_what_is_not_along_z_is_left_out_and_said() -> None:
    test = measured_from_modes(modal((3, 1, 3)), Axes(), BEAM)
    assert test.nodes == (3, 9)
    assert len(test.constants) == 2
    assert "5+X" in test.warnings[0]


@settings(max_examples=20)
@given(turn=st.sampled_from([(0, 1, 2), (1, 2, 0), (2, 0, 1)]), shift=st.floats(-2, 2))
def test_any_axes_of_the_test_give_the_same_points(turn: tuple[int, int, int], shift: float) -> None:
    """The model's x, y, z lie along the test's axes ``turn``."""
    places = np.zeros((3, 3))
    places[:, turn[0]] = X
    unit = np.eye(3)
    data = modal(tuple([turn[2] + 1] * 3), places + shift)
    axes = Axes((shift,) * 3, tuple(unit[turn[0]]), tuple(unit[turn[1]]))
    test = measured_from_modes(data, axes, BEAM)
    np.testing.assert_allclose(test.points[:, 0], X, atol=1e-12)
    np.testing.assert_allclose(test.constants, modal().shapes.real)  # type: ignore[union-attr]


def test_a_model_seen_from_below_turns_the_signs() -> None:
    below = measured_from_modes(modal(), Axes(y=(0.0, -1.0, 0.0)), BEAM)
    np.testing.assert_allclose(below.constants, -measured_from_modes(modal(), Axes(), BEAM).constants)


def test_points_off_the_structure_are_said_with_their_node() -> None:
    places = np.stack([1000 * X, 0 * X, 0 * X], axis=1)
    with pytest.raises(StudyError, match=r"test point 3 lies at \[100\.0\].*units of the file"):
        measured_from_modes(modal(coordinates=places), Axes(), BEAM)
    aside = np.stack([X, 0 * X + 0.5, 0 * X], axis=1)
    measured_from_modes(modal(coordinates=aside), Axes(), BEAM)  # a beam has no y
    with pytest.raises(StudyError, match="off the plate"):
        measured_from_modes(modal(coordinates=aside), Axes(), PLATE)


def test_a_subset_of_modes_is_a_test_of_its_own() -> None:
    test = measured_from_modes(modal(), Axes(), BEAM)
    part = test.modes(np.array([2, 0]))
    assert part.frequency == pytest.approx(test.frequency[[2, 0]])
    np.testing.assert_array_equal(part.constants, test.constants[:, [2, 0]])
    assert part.points is test.points


def frfs(sign: int = 1, seen: int = 3) -> FrfSet:
    """FRFs of the exact beam: hit at every node along z, seen at the last."""
    frequency = np.arange(0.0, 700.0, 0.125)
    true = TRUE.frequencies(4)
    shape = TRUE.shapes(true, X)
    s = 2j * np.pi * frequency[:, None]
    w = 2 * np.pi * true
    modes = 1 / (s**2 + 2 * 0.01 * w * s + w**2)
    values = np.einsum("fr,pr->pf", modes, shape * shape[-1]) * s[:, 0] ** 2
    places = np.stack([X, 0 * X, 0 * X], axis=1)
    return FrfSet(
        frequency,
        sign * values,
        (Dof(9, sign * seen),) * 3,
        tuple(Dof(n, 3) for n in NODES),
        geometry=Geometry(NODES, places),
    )


@pytest.fixture(scope="module")
def identified() -> ModalModel:
    return identify(frfs(), band=(5.0, 650.0))


def test_identified_modes_keep_their_level(identified: ModalModel) -> None:
    test = measured_from_identified(identified, Axes(), BEAM, calibration=0.05)
    assert (test.absolute, test.calibration) == (True, 0.05)
    assert test.frequency == pytest.approx(TRUE.frequencies(3), rel=1e-4)
    where = {node: i for i, node in enumerate(test.nodes)}
    assert set(test.sensors) == {where[9]}
    shape = TRUE.shapes(test.frequency, test.points[:, 0])
    constants = shape[test.seen] * shape[test.hit]
    np.testing.assert_allclose(test.constants, constants, rtol=0.02, atol=0.01 * np.abs(constants).max())
    assert not test.repeated


def test_a_transducer_that_points_down_changes_nothing(identified: ModalModel) -> None:
    up = measured_from_identified(identified, Axes(), BEAM)
    down = measured_from_identified(identify(frfs(-1), band=(5.0, 650.0)), Axes(), BEAM)
    np.testing.assert_allclose(down.constants, up.constants, rtol=1e-6, atol=1e-9)


def test_a_test_seen_from_below_is_the_same_test(identified: ModalModel) -> None:
    up = measured_from_identified(identified, Axes(), BEAM)
    below = measured_from_identified(identified, Axes(y=(0.0, -1.0, 0.0)), BEAM)
    np.testing.assert_allclose(below.constants, up.constants)


def test_frfs_across_the_models_z_are_refused(identified: ModalModel) -> None:
    with pytest.raises(StudyError, match="along the model's z"):
        measured_from_identified(identified, Axes(y=(0.0, 0.0, 1.0)), BEAM)


def test_the_scatter_of_imaginary_parts_widens_sigma(identified: ModalModel) -> None:
    rng = np.random.default_rng(1)
    plain = measured_from_identified(identified, Axes(), BEAM)
    size = np.sqrt(np.mean(identified.constants.real**2, axis=0))
    noise = 0.2 * size * rng.standard_normal(identified.constants.shape)
    rough = measured_from_identified(
        replace(identified, constants=identified.constants + 1j * noise), Axes(), BEAM
    )
    ratio = rough.constants_sigma.mean(axis=0) / size
    assert (ratio > 0.05).all()
    assert (ratio < 0.5).all()
    assert (rough.constants_sigma >= plain.constants_sigma - 1e-12).all()
    assert isinstance(rough, Measured)
