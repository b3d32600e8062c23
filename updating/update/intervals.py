"""Percentile intervals of parameters from an update and its repetitions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.update.estimate import Estimate
from updating.update.parameters.parameters import ModelParameter


def check_draws(n: int, *, better: int, fewest: int = 20) -> None:
    """Refuse so few draws that they do not determine the ends of an interval.

    Raises
    ------
    StudyError
        If there are fewer than ``fewest``; ``better`` is what is advised [-].
    """
    if n < fewest:
        raise StudyError(
            f"bootstrap: {n} draws are too few for an interval; ask for {fewest} or more, better {better}"
        )


def with_intervals(
    estimates: Sequence[Estimate],
    values: FloatArray,
    model_parameters: Sequence[ModelParameter],
    *,
    level: float = 0.95,
) -> tuple[Estimate, ...]:
    """Return estimates with intervals that hold most of the draws, and those that they have already.

    Parameters
    ----------
    estimates : sequence of Estimate
        Of the data at hand.
    values : (n, p) array
        Factors and values of every draw.
    model_parameters : sequence of ModelParameter
        The parameters.
    level : float
        Part of the draws that an interval holds [-].
    """
    tails = (1 - level) / 2
    low, high = np.quantile(values, [tails, 1 - tails], axis=0)
    nominal = np.array([k.nominal for k in model_parameters])
    ends = zip(estimates, (low * nominal).tolist(), (high * nominal).tolist(), strict=True)
    return tuple(_widened(estimate, low, high) for estimate, low, high in ends)


def _widened(estimate: Estimate, low: float, high: float) -> Estimate:
    known = (low, high) if estimate.interval is None else estimate.interval
    return replace(estimate, interval=(min(low, known[0]), max(high, known[1])))
