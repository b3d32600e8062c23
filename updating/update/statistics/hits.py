"""Frequencies of tests that might have been: hits drawn anew, poles refitted from those known."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from acquisition import Dof, FrfSet, HammerTest, bootstrap_frfs
from acquisition.arrays import FloatArray, IntArray
from acquisition.errors import EstimationError
from identification import ModalModel
from identification.fit.equations.refine import refine
from identification.levels.slopes import weights_of
from updating.steps import SILENT, Steps

STEPS = 12
"""Steps of each refit, which begins where the identification ended."""

AT_REST = 1e-4
"""Gain in chi-square at which a refit rests [-]."""


def redrawn_frequencies(
    model: ModalModel,
    test: HammerTest,
    *,
    rng: np.random.Generator,
    n: int = 200,
    steps: Steps = SILENT,
    **options: Any,
) -> FloatArray:
    """Draw the hits of a test anew, and refit the poles that were identified.

    The modes are not searched again: their number and the background stay those of the identification.

    Parameters
    ----------
    model : ModalModel
        Identified from the test's hits.
    test : HammerTest
        The raw hits.
    rng : numpy.random.Generator
        Source of the draws.
    n : int
        Number of draws [-].
    steps : Steps
        Where it is announced how many are drawn.
    **options
        ``estimator``, ``verdicts`` and ``windows`` of :func:`acquisition.bootstrap_frfs`, as when the FRFs were
        estimated.

    Returns
    -------
    (n, n_modes) array
        Frequencies [Hz].

    Raises
    ------
    EstimationError
        If the FRFs of the model are not those of the test, or a point has a single hit.
    """
    poles = np.concatenate([model.poles, model.background_poles])
    weights, powers = weights_of(model), model.background.powers
    found = np.empty((n, len(model)))
    rows: IntArray | None = None
    place = np.argsort(np.argsort(np.abs(poles)))[: len(model)]  # a fit sorts its poles
    for i, drawn in enumerate(bootstrap_frfs(test, rng=rng, n=n, **options)):
        steps.done(i / n)
        rows = _rows(model.frfs, drawn) if rows is None else rows
        data = (
            drawn.select(rows).double().band(float(model.frfs.frequency[0]), float(model.frfs.frequency[-1]))
        )
        fit = refine(data, poles, weights, powers=powers, iterations=STEPS, tolerance=1e-8, enough=AT_REST)
        found[i] = np.abs(fit.poles[place]) / (2 * np.pi)
    return found


def _rows(wanted: FrfSet, drawn: FrfSet) -> IntArray:
    """Return which of the drawn FRFs are those of the model, in its order."""
    where = {pair: i for i, pair in enumerate(_pairs(drawn))}
    missing = [pair for pair in _pairs(wanted) if pair not in where]
    if missing:
        raise EstimationError(
            f"bootstrap: FRF {missing[0][0]}/{missing[0][1]} of the identification is not among those of the hits "
            f"in {drawn.source}; draw from the test that was identified"
        )
    return np.array([where[pair] for pair in _pairs(wanted)])


def _pairs(frfs: FrfSet) -> Sequence[tuple[Dof, Dof]]:
    return list(zip(frfs.responses, frfs.references, strict=True))
