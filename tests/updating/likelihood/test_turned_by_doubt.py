"""Modes turn into each other by what an effect's idealisation leaves in doubt."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh
from updating_cases import PLATE, blank

from updating import Predictor
from updating.likelihood.close_modes import turned_by_doubt

POINTS = np.array([(x, y) for x in np.linspace(0.1, 0.376, 4) for y in (0.0, 0.07, 0.2)])


def test_shapes_scatter_as_those_of_matrices_with_an_error() -> None:
    """Against drawn errors of a mass matrix: of the two modes nearest to each other, within a third."""
    predictor = Predictor(replace(PLATE, elements=(12, 8)), blank(POINTS))
    now = predictor.predict(count=6)
    doubt = 0.01
    rng = np.random.default_rng(1)
    drawn = []
    for _ in range(400):
        error = rng.standard_normal((6, 6))
        error = 2 * doubt * np.triu(error) + 2 * doubt * np.triu(error, 1).T
        _, mixed = eigh(np.diag(now.frequency**2), np.eye(6) + error)
        mixed = mixed / np.diag(mixed)  # the turn alone: levels are another doubt
        drawn.append(mixed - np.eye(6))
    seen = np.einsum("nim,pi->npm", np.array(drawn), now.seen)
    own = now.gain * (seen * now.hit + now.seen * np.einsum("nim,pi->npm", np.array(drawn), now.hit))
    expected = np.sqrt(
        np.sum(turned_by_doubt(now, np.full(6, doubt), np.zeros(len(now.seen), dtype=bool)), axis=0)
    )
    close = int(np.argmin(np.diff(np.log(now.frequency))))
    found = np.sqrt(np.sum(np.mean(own**2, axis=0), axis=0))
    np.testing.assert_allclose(expected[close : close + 2], found[close : close + 2], rtol=1 / 3)


def test_no_doubt_turns_nothing() -> None:
    now = Predictor(replace(PLATE, elements=(12, 8)), blank(POINTS)).predict(count=4)
    assert not turned_by_doubt(now, np.zeros(4), np.zeros(len(now.seen), dtype=bool)).any()
