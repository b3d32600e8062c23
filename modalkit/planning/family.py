"""An effect at all its severities and places: what is varied, how far, and how it is worded."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.quantities import severity

_FINEST = 1e-3
_RATIO = 1.8

Values = Mapping[str, Any]
"""Values of an effect's parameters, and the names of places, under the contract's names [SI]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Family:
    """One kind of effect as a curve, or for each of its places a curve, in the space of the data.

    Parameters
    ----------
    name : str
        How it is listed: the effect's name, and where several places are asked about one by one, which it is.
    values : callable
        ``values(q, place)``: parameters under the contract's names; ``q`` = 0 is no effect [SI].
    low, high : float
        Range of ``q``; ``low`` is 0 where the effect has one sign [SI].
    clear : float
        Size of ``q`` that is asked about: a clear case [SI].
    words : str
        What a severity refers to: 'a sensor heavier than stated by'.
    amount : callable
        ``amount(q)`` is the severity in physical units, as text that continues the words.
    places : (n,) array
        Where it may sit [m], or which of its forms it takes; empty where there is but one.
    separately : bool
        Whether it can sit at its places alone, not between two of them.
    always : bool
        Whether it was there from the start, so that a baseline of the same specimen has it too.
    graded : bool
        Whether it has severities; without, only ``clear`` counts.
    effect : str
        The effect under the contract's name; left out, that of the family.
    at : str
        Its place in the names of the user's own model; empty where it has none.
    finest : float
        Smallest severity that is solved, of the largest [-].
    both : bool
        Whether both signs are asked about; otherwise one below zero only stands in for others.
    """

    name: str
    values: Callable[[float, float], Values]
    low: float
    high: float
    clear: float
    words: str
    amount: Callable[[float], str]
    places: FloatArray = field(default_factory=lambda: np.zeros(0))
    separately: bool = False
    always: bool = False
    graded: bool = True
    effect: str = ""
    at: str = ""
    finest: float = _FINEST
    both: bool = True

    @property
    def cause(self) -> str:
        """Name of the effect."""
        return self.effect or self.name

    def say(self, q: float) -> str:
        """Return a severity [SI] in words."""
        return f"{self.words} {self.amount(q)}"

    @property
    def grid(self) -> FloatArray:
        """Severities that are solved, 0 among them, ever closer towards it, (n_severities,) [SI]."""
        if not self.graded:
            return np.array([0.0, self.clear])
        sides = [-_steps(-self.low, self.finest)[::-1]] if self.low < 0 else []
        return np.concatenate([*sides, [0.0], _steps(self.high, self.finest)])

    @property
    def sites(self) -> FloatArray:
        """Places, or one that means nothing."""
        return self.places if len(self.places) else np.zeros(1)

    @property
    def asked(self) -> tuple[float, ...]:
        """Clear severities, one for each sign."""
        return (-self.clear, self.clear) if self.low < 0 and self.both else (self.clear,)


def _steps(end: float, finest: float) -> FloatArray:
    count = int(np.ceil(np.log(1 / finest) / np.log(_RATIO)))
    return np.asarray(end * _RATIO ** -np.arange(count, -1.0, -1.0))


def per_cent(q: float) -> str:
    """Return the logarithm of a factor as a change in per cent."""
    return f"{severity(100 * abs(np.expm1(q)))} %"


def factor(name: str, noun: str, *, most: float, clear: float) -> Family:
    """Return a property of the whole specimen, off by exp(q).

    Parameters
    ----------
    name, noun : str
        The effect, and the wording of its severity.
    most : float
        Largest factor [-].
    clear : float
        Logarithm of the factor that is asked about [-].
    """
    end = float(np.log(most))
    return Family(
        name=name,
        values=lambda q, _: {"factor": float(np.exp(q))},
        low=-end,
        high=end,
        clear=clear,
        words=f"{noun} off by more than",
        amount=per_cent,
        always=True,
    )
