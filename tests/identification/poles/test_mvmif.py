"""The multivariate mode indicator function against two degrees of freedom solved by hand."""

from __future__ import annotations

import numpy as np
import pytest

from acquisition import Dof, FrfSet, InputError
from acquisition.arrays import ComplexArray, FloatArray
from identification import mvmif
from identification.poles.mvmif import in_phase

LINES = np.arange(1.0, 200.0)
ROOT = np.sqrt(0.5)
SHAPES = np.array([[ROOT, ROOT], [ROOT, -ROOT]])
"""Modes of two unit masses on equal springs: in phase, and against one another."""


def amplitudes(hertz: tuple[float, float], zeta: float = 0.01) -> ComplexArray:
    """Return 1 / (w_r^2 - w^2 + 2 i zeta w_r w) of each mode, shape (2, n_lines)."""
    w, own = 2 * np.pi * LINES, 2 * np.pi * np.array(hertz)[:, None]
    return 1 / (own**2 - w**2 + 2j * zeta * own * w)


def frfs_of(values: ComplexArray, form: str = "receptance", flip: int = 1) -> FrfSet:
    """Return a matrix (n_responses, n_references, n_lines) as FRFs; ``flip`` turns the first response."""
    rows, columns = values.shape[:2]
    pairs = [
        (Dof(i + 1, 3 * (flip if i == 0 else 1)), Dof(j + 1, 3)) for i in range(rows) for j in range(columns)
    ]
    sign = np.array([a.sign * b.sign for a, b in pairs])
    flat = values.reshape(rows * columns, -1) * sign[:, None]
    return FrfSet(LINES, flat, tuple(a for a, _ in pairs), tuple(b for _, b in pairs), form)


def receptances(q: ComplexArray) -> ComplexArray:
    """Return H = Phi diag(q) Phi^T, shape (2, 2, n_lines)."""
    return np.einsum("ir,rl,jr->ijl", SHAPES, q, SHAPES)


def parts(q: ComplexArray) -> FloatArray:
    """Return Re(q)^2 / |q|^2, smallest first: H_r and H_i have the eigenvectors Phi, which are orthonormal."""
    return np.sort(q.real**2 / np.abs(q) ** 2, axis=0)


@pytest.mark.parametrize("hertz", [(50.0, 120.0), (100.0, 104.0), (100.0, 100.0)])
def test_two_degrees_of_freedom_have_the_values_solved_by_hand(hertz: tuple[float, float]) -> None:
    q = amplitudes(hertz)
    table = mvmif(frfs_of(receptances(q), flip=-1))
    np.testing.assert_allclose(table.to_numpy().T, parts(q), atol=1e-12)
    assert table.index.name == "frequency [Hz]"
    if hertz[0] != hertz[1]:
        low = [
            line
            for line in LINES[1:-1]
            if table.loc[line, 1] < min(table.loc[line - 1, 1], table.loc[line + 1, 1])
        ]
        assert low == list(hertz)
    else:
        assert table.loc[100.0, 2] < 1e-12, "two modes at one line are two minima there"


@pytest.mark.parametrize(("form", "power"), [("accelerance", 2), ("mobility", 1)])
def test_velocity_and_acceleration_give_the_same(form: str, power: int) -> None:
    h = receptances(amplitudes((50.0, 120.0)))
    moved = h * (2j * np.pi * LINES) ** power
    np.testing.assert_allclose(mvmif(frfs_of(moved, form)), mvmif(frfs_of(h)), atol=1e-12)


def test_more_references_than_responses_are_taken_as_responses() -> None:
    h = np.einsum("ir,rl,jr->ijl", np.array([[1.0, 0.3]]), amplitudes((50.0, 120.0)), np.eye(2))
    table = mvmif(frfs_of(h))
    assert table.shape[1] == 1
    assert table.loc[50.0, 1] < 1e-3
    np.testing.assert_allclose(table, mvmif(frfs_of(h.swapaxes(0, 1))))


def test_forces_that_move_nothing_are_no_mode() -> None:
    q = amplitudes((50.0, 120.0))[0]
    shape = np.array([1.0, 2.0])
    h = shape[:, None, None] * shape[None, :, None] * q
    table = mvmif(frfs_of(h))
    np.testing.assert_allclose(table[1], q.real**2 / np.abs(q) ** 2, atol=1e-12)
    np.testing.assert_allclose(table[2], 1.0, atol=1e-12)
    assert np.isnan(in_phase(np.zeros((1, 2, 2), complex))).all()


def test_a_band_and_a_matrix_with_gaps() -> None:
    frfs = frfs_of(receptances(amplitudes((50.0, 120.0))))
    assert list(mvmif(frfs, band=(40.0, 60.0), count=1).columns) == [1]
    assert mvmif(frfs.select(np.arange(3))).attrs["left_out"] == ["2+Z"]
    with pytest.raises(InputError, match="every reference"):
        mvmif(frfs.select(np.array([0, 3])))
