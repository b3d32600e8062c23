"""Real measurements by others, with the numbers others found in them."""

from __future__ import annotations

import numpy as np
import pytest

from acquisition import read_uff
from acquisition.dof import Dof
from acquisition.frfs.frf import FrfSet
from identification import identify, second_opinion

BEAM_HZ, BEAM_DAMPING = (111.993, 306.852, 596.367, 974.181), (1.4e-4, 1.2e-4, 1.0e-4, 1.0e-4)


@pytest.fixture
def beam(shared_data) -> FrfSet:
    """A free-free beam, roving hammer, one accelerometer pointing -x, half-power band of 1.6 lines."""
    data = np.load(shared_data("frf/ModeLAB/beam_9frf_repacked.npz"))
    values = data["H_m_s2_per_N"].astype(complex)
    sensor, hits = (Dof(100, -1),) * 9, tuple(Dof(i, 1) for i in range(1, 10))
    return FrfSet(data["freq_Hz"], values, sensor, hits, form="accelerance")


@pytest.mark.long
def test_very_light_damping_four_modes_and_no_fifth(beam):
    model = identify(beam, band=(65.0, 1000.0))
    assert len(model) == 4
    np.testing.assert_allclose(model.modal.frequency, BEAM_HZ, rtol=2e-4)
    np.testing.assert_allclose(model.modal.damping, BEAM_DAMPING, rtol=0.25)
    assert model.modal.dofs == tuple(Dof(i, 1) for i in range(1, 10))
    assert any("no drive point" in w for w in model.warnings)


@pytest.mark.long
def test_second_opinion_finds_the_published_poles(beam):
    table = second_opinion(beam, band=(65.0, 1000.0), order=30)
    np.testing.assert_allclose(table["frequency [Hz]"], BEAM_HZ, rtol=2e-4)


@pytest.mark.long
def test_free_beam_at_one_hertz_spacing(shared_data):
    content = read_uff(shared_data("uff/pyuff/measurement.uff"))
    frfs = content.frfs
    model = identify(frfs, band=(20.0, 1000.0))
    wanted = np.array([51.517, 142.176, 278.662, 460.395, 687.165, 958.544])
    found = model.modal.frequency[np.abs(model.modal.frequency[:, None] - wanted).argmin(axis=0)]
    np.testing.assert_allclose(found, wanted, rtol=1e-3)
    assert len(model) == 6
