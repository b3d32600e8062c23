"""The probabilities of an answer, names of the same change taken together, and no effect as a set of its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, FloatArray
from modalkit.blind.answer import Answer
from modalkit.blind.scoring.judge import accepted, merged
from modalkit.blind.trial import Truth

CREDIBLE = 0.95
"""Probability that the smallest set of rows is to hold [-]."""


@dataclass(frozen=True, eq=False)
class Posterior:
    """Probabilities of the sets compared, most probable first.

    Parameters
    ----------
    probability : (n_sets,) array
        Of each set; they add up to 1 [-].
    right : (n_sets,) array of bool
        Which are the truth.
    unknown : bool
        Whether the answer is that none of them explains the data: then it commits to nothing.
    """

    probability: FloatArray
    right: BoolArray
    unknown: bool

    @property
    def confidence(self) -> float:
        """Probability of the first set; 0 where the answer is ``unknown`` [-]."""
        return 0.0 if self.unknown or not len(self.probability) else float(self.probability[0])

    @property
    def first_is_right(self) -> bool:
        """Whether the first set is the truth, whatever the verdict."""
        return bool(len(self.right) and self.right[0])

    @property
    def truth(self) -> float:
        """Probability of the truth [-]."""
        return float(self.probability[self.right].sum())

    @property
    def brier(self) -> float:
        """Sum of squares of probability minus truth, the right sets taken as one [-]; 0 is perfect, 2 the worst.

        References
        ----------
        G. W. Brier, Mon. Weather Rev. 78 (1950) 1, equation 2, for one forecast.
        """
        return float((self.probability[~self.right] ** 2).sum() + (1.0 - self.truth) ** 2)

    def credible(self, level: float = CREDIBLE) -> tuple[int, bool]:
        """Return the size of the smallest set of rows that holds a probability, and whether the truth is in it."""
        if not len(self.probability):
            return 0, False
        size = int(np.searchsorted(np.cumsum(self.probability), level - 1e-12)) + 1
        size = min(size, len(self.probability))
        return size, bool(self.right[:size].any())


def posterior(answer: Answer, truth: Truth) -> Posterior:
    """Return the probabilities of an answer beside the truth.

    Parameters
    ----------
    answer : Answer
        Its ranking leaves no effect out: that has what the rows lack to 1.
    truth : Truth
        What was hidden.

    Returns
    -------
    Posterior
        Names that may be the same change stay apart where this truth separates them, as a window and damping that
        rises with frequency: a false one takes no part in the true one's merit.
    """
    shares: dict[tuple[frozenset[str], bool], float] = {}
    for row in answer.ranking:
        key = merged(row.effects), accepted(row.effects, truth)
        shares[key] = shares.get(key, 0.0) + row.probability
    total = sum(shares.values())
    nothing = frozenset[str](), not truth.effects
    shares[nothing] = max(0.0, 1.0 - total) if shares else float(answer.verdict == "none")
    keys = sorted(shares, key=lambda key: (-shares[key], sorted(key[0]), key[1]))
    values = np.array([shares[key] for key in keys])
    return Posterior(
        values / max(values.sum(), 1e-300),
        np.array([right for _, right in keys], dtype=bool),
        answer.verdict == "unknown",
    )
