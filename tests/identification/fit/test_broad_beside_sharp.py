"""A broad mode under the flank of a sharp one, as an absorber makes it: widths alone decide nothing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from identification_cases import column, lines, structure

from identification import identify

BROAD, SHARP = 450.0, 478.6


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_broad_mode_of_crooked_shape_beside_a_sharp_one_is_kept(seed):
    """An absorber's mode is complex; its pole is ten times as wide as the other and 2.4 half-widths from it."""
    rng = np.random.default_rng(seed)
    specimen = structure([216.0, BROAD, SHARP, 760.0], [0.005, 0.026, 0.0025, 0.005], 12, seed)
    frfs = specimen.frfs(lines(0.5, 50, 1000), column(12))
    turned = np.exp(1j * rng.uniform(-1.6, 1.6, 12))
    laplace = 2j * np.pi * frfs.frequency
    pole = specimen.poles[1]
    real = specimen.shapes[:, 1] * specimen.shapes[3, 1] / (2j * pole.imag)

    def term(residue):
        return residue[:, None] / (laplace - pole) + residue.conj()[:, None] / (laplace - pole.conj())

    values = frfs.values + (term(real * turned) - term(real)) * laplace**2
    noise = rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape)
    level = 1e-3 * np.sqrt(np.mean(np.abs(values) ** 2, axis=1, keepdims=True))
    model = identify(replace(frfs, values=values + level * noise), band=(100.0, 900.0))
    assert len(model) == 4
    assert np.abs(model.poles) / (2 * np.pi) == pytest.approx([216.0, BROAD, SHARP, 760.0], rel=2e-3)
