"""Peaks are those that scipy finds."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import scipy.signal

from acquisition.hits.peaks import find_peaks


@pytest.mark.parametrize("seed", range(20))
def test_peaks_are_those_of_scipy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    smooth = np.convolve(rng.standard_normal(600), np.ones(1 + seed % 7), "same")
    wave = np.round(smooth, 1) if seed % 2 else smooth  # with flat tops, or without
    height, prominence = np.quantile(wave, rng.uniform()), rng.uniform(0, 2 * wave.std())
    for distance in (1, 3) if seed % 2 == 0 else (1,):  # which of two equal peaks stays is left to chance
        expected, _ = scipy.signal.find_peaks(wave, height=height, distance=distance, prominence=prominence)
        assert (
            find_peaks(wave, height=height, distance=distance, prominence=prominence).tolist()
            == expected.tolist()
        )


@pytest.mark.parametrize("wave", [[], [1.0], [1.0, 1.0], [0.0, 1.0], [2.0, 1.0, 2.0], [0.0, 1.0, 1.0, 0.0]])
def test_short_and_flat_curves_have_the_peaks_they_have(wave: list[float]) -> None:
    curve = np.array(wave)
    assert find_peaks(curve).tolist() == scipy.signal.find_peaks(curve)[0].tolist()


@pytest.mark.long
@pytest.mark.usefixtures("no_hang")
def test_the_peaks_of_a_long_tone_take_no_square_of_their_number() -> None:
    """A sweep of a shaker, read as a force, is looked at too: by each peak's whole record it took minutes."""
    wave = np.sin(0.5 * np.arange(1_000_000)) * np.linspace(1.0, 2.0, 1_000_000)
    found = find_peaks(wave, height=0.1, prominence=0.1)
    expected, _ = scipy.signal.find_peaks(wave, height=0.1, prominence=0.1)
    assert found.tolist() == expected.tolist() and len(found) > 50_000


@pytest.mark.long
def test_looking_into_a_file_loads_no_statistics() -> None:
    """They take a second of CPU, more than all the rest of it."""
    sample = Path(__file__).resolve().parents[3] / "sample_data" / "beam_dry" / "beam_dry.uff"
    code = (
        "import sys; sys.argv = ['modalkit', 'inspect', sys.argv[1]]\n"
        "from modalkit.cli import main\n"
        "try:\n    main()\n"
        "except SystemExit:\n    pass\n"
        "sys.stderr.write(' '.join(m for m in ('scipy.stats', 'scipy.signal') if m in sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, str(sample)], capture_output=True, text=True, check=True
    )
    assert done.stderr == ""
