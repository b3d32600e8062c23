"""The score as one long table: a row is a question, asked of a group of trials, and its answer with an interval."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from acquisition.arrays import FloatArray
from modalkit.blind.scoring.intervals import Statistic, bootstrap, wilson

ALL = "all"
"""The group of all trials that a question can be asked of."""


@dataclass(frozen=True)
class Rate:
    """The answer to a question.

    Parameters
    ----------
    question, group : str
        What is asked, and of which trials.
    count : float
        How often it is so; whole unless a class counts by its share, nan for a number that is not a share [-].
    total : int
        Trials, or parameters, or places, that are asked [-].
    rate : float
        ``count / total``, or that number; nan without trials [-, or the unit of the question].
    low, high : float
        Its 95 % interval: Wilson's of a share, the bootstrap's of another number; nan for none.
    """

    question: str
    group: str
    count: float
    total: int
    rate: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Rates:
    """All rows of a score.

    Parameters
    ----------
    rows : tuple of Rate
        In the order in which they are asked.
    """

    rows: tuple[Rate, ...]

    @cached_property
    def _by_name(self) -> dict[tuple[str, str], Rate]:
        return {(row.question, row.group): row for row in self.rows}

    def __iter__(self) -> Iterator[Rate]:
        """Return the rows in their order."""
        return iter(self.rows)

    def __getitem__(self, name: tuple[str, str]) -> Rate:
        """Return the row of a question and a group."""
        return self._by_name[name]

    def get(self, question: str, group: str = ALL) -> Rate | None:
        """Return the row of a question and a group; None where it was not asked."""
        return self._by_name.get((question, group))

    def of(self, question: str) -> list[Rate]:
        """Return the rows of a question, one for each group."""
        return [row for row in self.rows if row.question == question]

    def frame(self) -> pd.DataFrame:
        """Return the rows as a table."""
        return pd.DataFrame(
            [astuple(row) for row in self.rows], columns=[field.name for field in fields(Rate)]
        )


def share(question: str, group: str, hit: ArrayLike, among: ArrayLike | None = None) -> Rate:
    """Return how often something is so, with Wilson's interval.

    Parameters
    ----------
    question, group : str
        What is asked, and of which trials.
    hit : (n_trials,) array_like
        Whether it is so, or the credit between 0 and 1.
    among : (n_trials,) array_like of bool, optional
        Trials that are asked; default all.
    """
    hits = np.asarray(hit, dtype=float)
    asked = hits if among is None else hits[np.asarray(among, dtype=bool)]
    count, total = float(asked.sum()), len(asked)
    low, high = wilson(count, total)
    whole = int(count) if count.is_integer() else count
    return Rate(question, group, whole, total, count / total if total else math.nan, float(low), float(high))


def measured(
    question: str,
    group: str,
    values: FloatArray,
    rng: np.random.Generator,
    *,
    statistic: Statistic | None = None,
) -> Rate:
    """Return a statistic of the trials, by default the mean, with its bootstrap interval.

    Parameters
    ----------
    question, group : str
        What is asked, and of which trials.
    values : (n_trials, ...) array
        One row per trial.
    rng : numpy.random.Generator
        Draws the samples.
    statistic : callable, optional
        As :func:`modalkit.blind.scoring.intervals.bootstrap` takes it.
    """
    return Rate(question, group, math.nan, len(values), *bootstrap(values, rng, statistic=statistic))


def number(question: str, group: str, value: float, total: int) -> Rate:
    """Return a number without an interval.

    Parameters
    ----------
    question, group : str
        What is asked, and of which trials.
    value : float
        The number.
    total : int
        Trials behind it [-].
    """
    return Rate(question, group, math.nan, total, float(value), math.nan, math.nan)
