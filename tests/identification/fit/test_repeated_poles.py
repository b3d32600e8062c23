"""Two modes at the very same frequency, as square plates have them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from identification_cases import lines, structure

from identification import identify


def test_two_modes_at_one_frequency_are_warned_of():
    truth = structure((60.0, 120.0, 120.0, 200.0), (0.004, 0.003, 0.003, 0.004), 12, seed=5)
    pairs = [(i, j) for j in (4, 8) for i in range(1, 13)]
    frfs = truth.frfs(lines(df=0.25, high=300.0), pairs, noise=0.005, rng=np.random.default_rng(1))
    assert any("Two modes at one frequency" in w for w in identify(frfs).warnings)


@pytest.mark.long
@pytest.mark.parametrize("references", [(4,), (4, 8)])
@pytest.mark.parametrize("half_widths", [0.2, 0.5, 0.9])
def test_two_modes_within_a_half_width_are_two_whose_references_see_them_alike(
    half_widths: float, references: tuple[int, ...]
) -> None:
    """Frames of equal bays have such pairs; one pole for each FRF explains them far worse than two common ones."""
    hertz = (60.0, 120.0, 120.0 * (1 + 0.004 * half_widths), 200.0)
    drawn = structure(hertz, (0.004, 0.004, 0.004, 0.004), 12, seed=5)
    shapes = drawn.shapes.copy()
    shapes[:, 2] = np.copysign(shapes[:, 2], shapes[:, 1])  # their residues have the same signs everywhere
    shapes[7, 1:3] = 0.8 * shapes[3, 1:3]
    truth = replace(drawn, shapes=shapes)
    pairs = [(i, j) for j in references for i in range(1, 13)]
    frfs = truth.frfs(lines(df=0.1, high=300.0), pairs, noise=0.001, rng=np.random.default_rng(2))
    found = identify(frfs)
    assert len(found) == 4
    np.testing.assert_allclose(np.abs(found.poles) / (2 * np.pi), hertz, rtol=2e-4)
    np.testing.assert_allclose(-found.poles.real / np.abs(found.poles), 0.004, rtol=0.03)
    assert not any("FRF to FRF" in warning for warning in found.warnings)
