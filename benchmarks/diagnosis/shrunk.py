"""How far the gap truly shrinks: the best answer as found, tolerances included, against a second test."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any
from unittest import mock

import numpy as np

from diagnosis.mesh import Floats
from updating import Case, Measured
from updating.diagnosis import diagnose as engine
from updating.diagnosis.search.search import search
from updating.likelihood.comparison import CHANNELS
from updating.problem.candidate import Candidate


@contextmanager
def overheard() -> Iterator[dict[str, Any]]:
    """Keep what the search found, beside the answer that is made of it."""
    kept: dict[str, Any] = {}
    plain = search

    def listen(problem: Any, *given: Any, **named: Any) -> Any:
        kept["problem"], kept["found"] = problem, plain(problem, *given, **named)
        return kept["found"]

    with mock.patch.object(engine, "search", listen):
        yield kept


def truly_closed(
    case: Case, again: Measured, kept: dict[str, Any], metric: str, floor: float
) -> float | None:
    """Return the share of the closable gap that the best answer closes on a second test [%].

    Parameters
    ----------
    case : Case
        What was diagnosed.
    again : Measured
        A second test of the same specimen.
    kept : dict
        From :func:`overheard`.
    metric : str
        Channel by which the gap is measured.
    floor : float
        Noise floor in that channel [-].
    """
    found = kept["found"]
    best = next((row.explanation for row in found.compared if row.names), None)
    if best is None or metric not in CHANNELS:
        return None
    problem = engine.pose(replace(case, measured=again))[0]
    old = kept["problem"]
    if len(problem.measured.frequency) != len(old.measured.frequency):
        return None
    nothing = problem.at(Candidate(), np.zeros(0))
    now = problem.at(best.candidate, best.best.coordinates)
    rows = now.of(metric)
    left = now.residual - now.nuisance @ best.best.marginal.shift
    before, after = (_relative(r[rows], metric) for r in (nothing.residual, left))
    closable = np.mean(before**2) - floor**2
    return float(100 * (1 - (np.mean(after**2) - floor**2) / closable)) if closable > 0 else None


def _relative(residual: Floats, metric: str) -> Floats:
    return np.asarray(np.exp(-residual) - 1 if metric in ("frequency", "damping") else residual)
