"""Pairs of FRFs with response and reference exchanged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from acquisition import Dof, FrfSet
from acquisition.frfs.reciprocity import COLUMNS, reciprocity

FREQUENCY = np.arange(10.0, 200.0, 0.5)
SHAPES = np.array([[1.0, 0.5, -0.4], [0.3, -1.0, 0.8], [-0.7, 0.6, 1.0]])
POLES = 2 * np.pi * np.array([40.0, 90.0, 150.0]) * (1j - 0.01)


def frfs(signs=(1, 1, 1)) -> FrfSet:
    """The full matrix of three places, measured by transducers and hammers that may point the other way."""
    s = 2j * np.pi * FREQUENCY
    terms = s**2 / ((s - POLES[:, None]) * (s - POLES.conj()[:, None]))
    pairs = [(i, j) for i in range(3) for j in range(3)]
    values = np.array([signs[i] * (SHAPES[i] * SHAPES[j]) @ terms for i, j in pairs])
    return FrfSet(
        FREQUENCY,
        values,
        tuple(Dof(i + 1, 3 * signs[i]) for i, _ in pairs),
        tuple(Dof(j + 1, 3) for _, j in pairs),
    )


def changed(row: int, factor) -> FrfSet:
    values = np.array(frfs().values)
    values[row] = values[row] * factor
    return replace(frfs(), values=values)


def test_a_reciprocal_matrix_is_found_so_whatever_the_directions():
    for signs in ((1, 1, 1), (-1, 1, -1)):
        table = reciprocity(frfs(signs))
        assert len(table) == 3 and tuple(table.columns) == COLUMNS
        assert np.allclose(table["correlation"], 1) and np.allclose(table["level ratio"], 1)
        assert np.allclose(table["phase [deg]"], 0, atol=1e-9) and not table["message"].any()


def test_only_pairs_that_exist_are_listed():
    table = reciprocity(frfs().select([0, 1, 2, 3]))
    assert table[["frf", "mirror"]].to_numpy().tolist() == [["2+Z/1+Z", "1+Z/2+Z"]]
    empty = reciprocity(frfs().select([0, 1, 2]))
    assert empty.empty and tuple(empty.columns) == COLUMNS


@pytest.mark.parametrize(
    ("factor", "word", "column", "value"),
    [
        (-1.0, "sign", "phase [deg]", 180.0),
        (1.3, "calibration", "level ratio", 1.3),
        (np.exp(0.5j), "lags", "phase [deg]", np.degrees(0.5)),
        (0.0, "dead", "correlation", 0.0),
    ],
)
def test_what_is_wrong_is_told(factor, word, column, value):
    row = reciprocity(changed(3, factor)).iloc[0]  # 2/1 against 1/2
    assert word in row["message"] and abs(row[column]) == pytest.approx(value)


def test_a_place_mistaken_is_not_reciprocal():
    values = np.array(frfs().values)
    values[[3, 6]] = values[[6, 3]]
    assert reciprocity(replace(frfs(), values=values))["message"].str.contains("not reciprocal").sum() == 2


def test_noise_alone_is_no_fault(rng):
    clean = frfs()
    level = np.sqrt(0.2 * np.mean(np.abs(clean.values) ** 2, axis=1, keepdims=True) / 2)
    shape = clean.values.shape
    dirt = level * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))
    noisy = replace(clean, values=clean.values + dirt, variance=2 * level**2 * np.ones(shape))
    table = reciprocity(noisy)
    assert table["correlation"].max() < 0.85 and not table["message"].any()
    assert reciprocity(replace(noisy, variance=None))["message"].str.contains("not reciprocal").all()


def test_a_band_may_be_chosen():
    values = np.array(frfs().values)
    values[3, FREQUENCY > 150] *= 3.0
    spoiled = replace(frfs(), values=values)
    assert (
        reciprocity(spoiled).iloc[0]["message"]
        and not reciprocity(spoiled, band=(10.0, 140.0))["message"].any()
    )
