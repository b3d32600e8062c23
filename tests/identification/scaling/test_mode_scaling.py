"""Mass normalisation of shapes through drive points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from identification_cases import structure

from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.geometry import Geometry
from acquisition.modal_data import ModalData
from identification import mode_shapes
from identification.scaling import modal_constants, real_modes

EXACT = 1e-6


def constants_of(truth, pairs):
    return np.array([truth.shapes[i - 1] * truth.shapes[j - 1] for i, j in pairs]).astype(complex)


@pytest.fixture
def truth():
    return structure((50.0, 90.0, 130.0), (0.01, 0.01, 0.01), 6, seed=11)


def frfs_of(truth, pairs):
    return truth.frfs(np.arange(1.0, 60.0), pairs)


def columns_of(*references):
    return [(i, j) for j in references for i in range(1, 7)]


def scaled(truth, pairs, *, sigma=EXACT, change=lambda c: c):
    constants = change(constants_of(truth, pairs))
    return mode_shapes(frfs_of(truth, pairs), constants, np.full(constants.shape, sigma))


def assert_right(shapes, truth, *, factor=1.0, atol=1e-5):
    wanted = truth.shapes[[d.node - 1 for d in shapes.dofs]] * factor
    sign = np.sign(np.sum(shapes.shapes.real * wanted, axis=0))
    np.testing.assert_allclose(shapes.shapes * sign, wanted, atol=atol)


@pytest.mark.parametrize("references", [(4,), (2, 4), (1, 3, 6)])
def test_shapes_come_out_mass_normalised(truth, references):
    shapes = scaled(truth, columns_of(*references))
    assert shapes.scaled
    assert_right(shapes, truth)


def test_a_drive_point_at_a_node_is_said(truth):
    truth.shapes[3, 1] = 1e-9
    shapes = scaled(truth, columns_of(4), sigma=1e-3)
    assert any(w.startswith("mode(s) 2 hardly move at the drive point 4+Z") for w in shapes.warnings)
    assert np.isfinite(shapes.sigma).all()
    assert (shapes.sigma[:, 1] > 0.3 * np.abs(shapes.shapes[:, 1])).sum() >= 5


def test_a_mode_that_is_zero_throughout_is_no_crash(truth):
    truth.shapes[:, 1] = 0.0
    for references in ((4,), (2, 4)):
        shapes = scaled(truth, columns_of(*references), sigma=1e-3)
        assert np.isfinite(shapes.shapes).all()
        assert any("mode(s) 2 hardly move" in w for w in shapes.warnings)


def test_a_turned_transducer_is_said(truth):
    shapes = scaled(truth, columns_of(4), change=np.negative)
    assert any("negative modal constant in mode(s) 1, 2, 3" in w for w in shapes.warnings)


def test_a_drive_point_that_cannot_be_one_is_said(truth):
    shapes = scaled(truth, columns_of(4), change=lambda c: c * np.array([1.0, -1.0, 1.0]))
    assert any("in mode(s) 2 and a positive one in others" in w for w in shapes.warnings)


def test_modes_that_overlap_say_nothing_of_a_drive_point(truth):
    pairs = columns_of(4)
    constants = constants_of(truth, pairs) * np.array([1.0, 1.0, -1.0])
    sigma = np.full(constants.shape, EXACT)
    apart = 2 * np.pi * np.array([-0.5 + 50.0j, -0.9 + 90.0j, -1.3 + 130.0j])
    overlapping = np.append(apart[:2], 2 * np.pi * (-0.9 + 92.0j))
    frfs = frfs_of(truth, pairs)
    assert not mode_shapes(frfs, constants, sigma, poles=apart).scaled
    shapes = mode_shapes(frfs, constants, sigma, poles=overlapping)
    assert shapes.scaled
    assert not any("negative" in w for w in shapes.warnings)
    assert any("180 degrees in mode(s) 3: strongly complex" in w for w in shapes.warnings)


def test_a_delay_between_the_channels_is_said(truth):
    shapes = scaled(truth, columns_of(4), change=lambda c: c * np.exp(1j * np.radians([5.0, 30.0, 60.0])))
    assert any("up to 60 degrees in mode(s) 2, 3" in w for w in shapes.warnings)


def test_signs_of_direction_are_no_obstacle_to_a_drive_point(truth):
    pairs = columns_of(4)
    frfs = frfs_of(truth, pairs)
    frfs = replace(frfs, responses=tuple(Dof(d.node, -3) for d in frfs.responses), values=-frfs.values)
    constants = constants_of(truth, pairs)
    shapes = mode_shapes(frfs, constants, np.full(constants.shape, EXACT))
    assert shapes.scaled
    assert not shapes.warnings
    assert_right(shapes, truth)


def test_a_missing_frf_is_filled_from_the_other_references(truth):
    pairs = [p for p in columns_of(2, 4) if p != (5, 2)]
    shapes = scaled(truth, pairs)
    assert len(shapes.dofs) == 6
    assert_right(shapes, truth)


def test_references_that_see_each_other_scale_without_a_drive_point(truth):
    pairs = [p for p in columns_of(2, 4) if p not in ((2, 2), (4, 4))]
    shapes = scaled(truth, pairs)
    assert shapes.scaled
    assert_right(shapes, truth)


def test_a_hit_next_to_the_sensor_is_no_drive_point(truth):
    pairs = [p for p in columns_of(4) if p != (4, 4)]
    where = Geometry(range(1, 7), np.column_stack([0.1 * np.arange(6) ** 2, np.zeros((6, 2))]))
    constants = constants_of(truth, pairs)
    frfs = replace(frfs_of(truth, pairs), geometry=where)
    shapes = mode_shapes(frfs, constants, np.full(constants.shape, EXACT))
    assert not shapes.scaled
    assert "the nearest are 3+Z/4+Z, 500 mm apart" in shapes.warnings[0]
    plain = mode_shapes(frfs_of(truth, pairs), constants, np.full(constants.shape, EXACT))
    assert "not mass-normalised; measure one drive point" in plain.warnings[0]


def test_hit_and_sensor_across_each_other_are_no_drive_point(truth):
    pairs = columns_of(4)
    frfs = frfs_of(truth, pairs)
    frfs = replace(frfs, references=(Dof(4, 1),) * len(pairs))
    constants = constants_of(truth, pairs)
    assert not mode_shapes(frfs, constants, np.full(constants.shape, EXACT)).scaled


def test_points_tied_to_nothing_are_left_out_and_named(truth):
    pairs = [(1, 4), (2, 4), (3, 4), (4, 4), (5, 6)]
    shapes = scaled(truth, pairs)
    assert [d.node for d in shapes.dofs] == [1, 2, 3, 4]
    assert any("connects 5+Z to the other points" in w for w in shapes.warnings)
    assert_right(shapes, truth)


@pytest.mark.long
@settings(max_examples=40)
@given(
    st.permutations(range(12)),
    st.floats(1e-9, 1e9),
    st.sampled_from([(4,), (2, 4), (1, 3)]),
    st.lists(st.sampled_from([-1.0, 1.0]), min_size=6, max_size=6),
)
def test_neither_units_nor_order_nor_signs_change_the_scale(order, unit, references, flips):
    truth = structure((50.0, 90.0, 130.0), (0.01, 0.01, 0.01), 6, seed=11)
    truth = replace(truth, shapes=truth.shapes * np.array(flips)[:, None])
    whole = columns_of(*references)
    pairs = [whole[i] for i in order if i < len(whole)]
    dirt = 0.01 * np.random.default_rng(5).standard_normal((12, 3))[[i for i in order if i < len(whole)]]
    constants = constants_of(truth, pairs) * (1 + dirt)
    sigma = 0.01 * np.abs(constants)
    plain = mode_shapes(frfs_of(truth, pairs), constants, sigma)
    other = mode_shapes(frfs_of(truth, pairs), unit * constants, unit * sigma)
    assert_right(other, truth, factor=np.sqrt(unit), atol=0.1 * np.sqrt(unit))
    np.testing.assert_allclose(other.shapes, np.sqrt(unit) * plain.shapes, rtol=1e-6)
    np.testing.assert_allclose(other.sigma, np.sqrt(unit) * plain.sigma, rtol=1e-6)
    sorted_pairs = [whole[i] for i in range(len(whole))]
    back = [pairs.index(p) for p in sorted_pairs]
    again = mode_shapes(frfs_of(truth, sorted_pairs), constants[back], sigma[back])
    place = [plain.dofs.index(d) for d in again.dofs]
    np.testing.assert_allclose(np.abs(plain.shapes[place]), np.abs(again.shapes), rtol=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("references", [(4,), (2, 4), (1, 3, 6)])
def test_the_covariance_of_scaled_shapes_is_what_scatter_shows(truth, rng, references):
    pairs = columns_of(*references)
    clean, sigma = constants_of(truth, pairs), 0.003
    found, message = [], []
    for _ in range(500):
        dirt = sigma * (rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape))
        shapes = mode_shapes(frfs_of(truth, pairs), clean + dirt, np.full(clean.shape, sigma))
        sign = np.sign(np.sum(shapes.shapes.real * truth.shapes, axis=0))
        found.append(shapes.shapes.real * sign - truth.shapes)
        message.append([shapes.covariance(r) for r in range(3)])
        np.testing.assert_allclose(np.sqrt(np.diag(shapes.covariance(1))), shapes.sigma[:, 1], rtol=1e-9)
    for r in range(3):
        seen, wanted = np.cov(np.array(found)[:, :, r].T), np.mean(message, axis=0)[r]
        size = np.sqrt(np.diag(wanted))
        np.testing.assert_allclose(seen / np.outer(size, size), wanted / np.outer(size, size), atol=0.2)


def test_drive_points_are_weighed_by_their_sigma(truth):
    pairs = columns_of(2, 4)
    constants = constants_of(truth, pairs)
    wrong, sigma = np.array([j == 2 for _, j in pairs]), np.full(constants.shape, 1e-4)
    constants[wrong] *= 1.3
    sigma[wrong] = 1.0
    shapes = mode_shapes(frfs_of(truth, pairs), constants, sigma)
    assert_right(shapes, truth, atol=1e-3)


@pytest.mark.long
def test_constants_that_fit_no_single_shape_widen_sigma(truth, rng):
    pairs = columns_of(1, 3, 6)
    clean, sigma = constants_of(truth, pairs), 0.01
    deviations = []
    for _ in range(200):
        dirt = sigma * (rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape))
        shapes = mode_shapes(frfs_of(truth, pairs), clean + dirt, np.full(clean.shape, sigma / 10))
        sign = np.sign(np.sum(shapes.shapes.real * truth.shapes, axis=0))
        deviations.append((shapes.shapes.real * sign - truth.shapes) / shapes.sigma)
    assert 0.85 < np.sqrt(np.mean(np.square(deviations))) < 1.2


def test_residues_of_every_form_give_the_same_constants(truth):
    step = 1e-3
    wanted = constants_of(truth, columns_of(4))
    for power, form in enumerate(("receptance", "mobility", "accelerance")):
        residues = np.empty(wanted.shape, complex)
        for r, pole in enumerate(truth.poles):
            ring = pole + step * np.exp(2j * np.pi * np.arange(16) / 16)
            for n, (i, j) in enumerate(columns_of(4)):
                values = truth.receptance(ring, i, j) * ring**power
                residues[n, r] = np.mean(values * (ring - pole))
        np.testing.assert_allclose(modal_constants(residues, truth.poles, form), wanted, rtol=1e-6)
    with pytest.raises(InputError, match="positive imaginary part"):
        modal_constants(np.ones((1, 1)), [-1.0 + 0j])
    with pytest.raises(InputError, match="unknown FRF form"):
        modal_constants(np.ones((1, 1)), [-1.0 + 1j], "inertance")


def test_complex_modes_keep_their_constants(truth, rng):
    complex_shapes = truth.shapes + 0.2j * rng.standard_normal(truth.shapes.shape)
    pairs = columns_of(2, 4)
    constants = np.array([complex_shapes[i - 1] * complex_shapes[j - 1] for i, j in pairs])
    shapes = mode_shapes(frfs_of(truth, pairs), constants, np.full(constants.shape, EXACT))
    back = shapes.shapes * np.exp(-1j * shapes.phase)
    products = np.array([back[i - 1] * back[j - 1] for i, j in pairs])
    np.testing.assert_allclose(products, constants, atol=1e-4)


def test_real_modes_are_the_nearest_real_ones(truth):
    dofs = tuple(Dof(i, 3) for i in range(1, 7))
    turned = truth.shapes * np.exp(1j * np.array([0.3, -1.0, 0.7]))
    modes = ModalData(
        frequency=truth.hertz, frequency_sigma=np.full(3, np.nan), dofs=dofs, shapes=turned, scaled=True
    )
    shapes = real_modes(modes).shapes
    np.testing.assert_allclose(np.abs(shapes.real), np.abs(truth.shapes), rtol=1e-12)
    np.testing.assert_array_equal(shapes.imag, 0.0)
    bare = ModalData(frequency=truth.hertz, frequency_sigma=np.full(3, np.nan))
    assert real_modes(bare) is bare
