"""Mass normalisation of shapes through drive points."""

from __future__ import annotations

import numpy as np
import pytest
from identification_cases import structure

from identification import mode_shapes


def constants_of(truth, pairs):
    return np.array([truth.shapes[i - 1] * truth.shapes[j - 1] for i, j in pairs]).astype(complex)


@pytest.fixture
def truth():
    return structure((50.0, 90.0, 130.0), (0.01, 0.01, 0.01), 6, seed=11)


def frfs_of(truth, pairs):
    return truth.frfs(np.arange(1.0, 60.0), pairs)


@pytest.mark.parametrize("references", [(4,), (2, 4), (1, 3, 6)])
def test_shapes_come_out_mass_normalised(truth, references):
    pairs = [(i, j) for j in references for i in range(1, 7)]
    constants = constants_of(truth, pairs)
    shapes = mode_shapes(frfs_of(truth, pairs), constants, np.full(constants.shape, 1e-6))
    assert shapes.scaled
    sign = np.sign(np.sum(shapes.shapes.real * truth.shapes, axis=0))
    np.testing.assert_allclose(shapes.shapes * sign, truth.shapes, atol=1e-5)


def test_a_drive_point_at_a_node_is_said(truth):
    truth.shapes[3, 1] = 1e-9
    pairs = [(i, 4) for i in range(1, 7)]
    constants = constants_of(truth, pairs)
    shapes = mode_shapes(frfs_of(truth, pairs), constants, np.full(constants.shape, 1e-3))
    assert any(w.startswith("mode(s) 2 hardly move at the drive point 4+Z") for w in shapes.warnings)


def test_a_turned_transducer_is_said(truth):
    pairs = [(i, 4) for i in range(1, 7)]
    constants = -constants_of(truth, pairs)
    shapes = mode_shapes(frfs_of(truth, pairs), constants, np.full(constants.shape, 1e-6))
    assert any("negative modal constant in mode(s) 1, 2, 3" in w for w in shapes.warnings)


def test_a_missing_frf_is_filled_from_the_other_references(truth):
    pairs = [(i, j) for j in (2, 4) for i in range(1, 7) if (i, j) != (5, 2)]
    constants = constants_of(truth, pairs)
    shapes = mode_shapes(frfs_of(truth, pairs), constants, np.full(constants.shape, 1e-6))
    wanted = truth.shapes[[d.node - 1 for d in shapes.dofs]]
    sign = np.sign(np.sum(shapes.shapes.real * wanted, axis=0))
    assert len(shapes.dofs) == 6
    np.testing.assert_allclose(shapes.shapes * sign, wanted, atol=1e-5)


def test_the_sigma_of_scaled_shapes_is_what_scatter_shows(truth, rng):
    pairs = [(i, 4) for i in range(1, 7)]
    clean, sigma = constants_of(truth, pairs), 0.003
    errors, spread = [], []
    for _ in range(400):
        dirt = sigma * (rng.standard_normal(clean.shape) + 1j * rng.standard_normal(clean.shape))
        shapes = mode_shapes(frfs_of(truth, pairs), clean + dirt, np.full(clean.shape, sigma))
        sign = np.sign(np.sum(shapes.shapes.real * truth.shapes, axis=0))
        errors.append(shapes.shapes.real * sign - truth.shapes)
        spread.append(shapes.sigma)
    np.testing.assert_allclose(np.std(errors, axis=0), np.mean(spread, axis=0), rtol=0.15)
