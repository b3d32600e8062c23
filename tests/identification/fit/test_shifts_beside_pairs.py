"""Shifts common to all modes are found beside pairs that share a peak, and are not taken for a mode's own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from identification_cases import Structure, column, lines, structure

from identification.identify import prepare

HERTZ = np.array([60.0, 72.0, 90.0, 91.5, 104.0, 120.0])


def test_shifts_of_all_modes_are_found_beside_a_pair() -> None:
    truth, rng = structure(HERTZ, (0.004,) * 6, 24, 2), np.random.default_rng(2)
    shifts, pairs = 0.0015 * rng.standard_normal(24), column(24)
    parts = [
        Structure(truth.poles * (1 + shift), truth.shapes).frfs(
            lines(df=0.25, low=45.0, high=135.0), [pair], noise=3e-4, rng=rng
        )
        for pair, shift in zip(pairs, shifts, strict=True)
    ]
    frfs = replace(
        parts[0],
        values=np.concatenate([p.values for p in parts]),
        responses=tuple(p.responses[0] for p in parts),
        references=tuple(p.references[0] for p in parts),
    )
    prepared = prepare(frfs, band=(45.0, 135.0))
    drift, fit = prepared.fitted.drift, prepared.fitted.fit
    assert len(fit.poles) == 6
    np.testing.assert_allclose(drift.variance, drift.variance.min(), rtol=0.02)
    np.testing.assert_allclose(
        drift.shift - drift.shift.mean(axis=0), np.tile(shifts - shifts.mean(), (6, 1)).T, atol=5e-5
    )
    model = prepared.modes()
    assert np.all(np.abs(model.modal.damping / 0.004 - 1.0) < 3.0 * model.modal.damping_sigma / 0.004 + 1e-3)
