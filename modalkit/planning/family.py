"""An effect at all its severities and places: what is varied, how far, and how it is said."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from acquisition.arrays import FloatArray
from modalkit.simulator.hidden import HIDDEN_EFFECTS, Values
from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup

_FINEST = 1e-3
_RATIO = 1.8


@dataclass(frozen=True, eq=False)
class Family:
    """One kind of effect as a curve, or for each of its places a curve, in the space of the data.

    Parameters
    ----------
    name : str
        Under the contract's names; the rig's secret of that name acts.
    values : callable
        ``values(q, place)``: parameters under the contract's names; ``q`` = 0 is no effect [SI].
    low, high : float
        Range of ``q``; ``low`` is 0 where the effect has one sign [SI].
    clear : float
        Size of ``q`` that is asked about: a clear case [SI].
    words : str
        What a severity is said of: 'a sensor heavier than stated by'.
    amount : callable
        ``amount(q)`` is the severity in physical units, as text that continues the words.
    places : (n,) array
        Where it may sit [m], or which of its forms it takes; empty where there is but one.
    separately : bool
        Whether places are forms of which none is between two others.
    always : bool
        Whether it was there from the start, so that a baseline of the same specimen has it too.
    graded : bool
        Whether it has severities; without, only ``clear`` counts.
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

    def say(self, q: float) -> str:
        """Return a severity [SI] in words."""
        return f"{self.words} {self.amount(q)}"

    def act(self, scene: Scene, q: float, place: float) -> Scene:
        """Return a scene with the effect.

        Parameters
        ----------
        scene : Scene
            Without it.
        q : float
            Severity; 0 is none [SI].
        place : float
            Where [m], or which form.
        """
        return HIDDEN_EFFECTS[self.name].act(scene, self.values(q, place)) if q else scene

    @property
    def grid(self) -> FloatArray:
        """Severities that are solved, 0 among them, ever closer towards it, (n_severities,) [SI]."""
        if not self.graded:
            return np.array([0.0, self.clear])
        sides = [-_steps(-self.low)[::-1]] if self.low < 0 else []
        return np.concatenate([*sides, [0.0], _steps(self.high)])

    @property
    def sites(self) -> FloatArray:
        """Places, or one that means nothing."""
        return self.places if len(self.places) else np.zeros(1)

    @property
    def asked(self) -> tuple[float, ...]:
        """Clear severities, one for each sign."""
        return (-self.clear, self.clear) if self.low < 0 else (self.clear,)


def _steps(end: float) -> FloatArray:
    count = int(np.ceil(np.log(1 / _FINEST) / np.log(_RATIO)))
    return np.asarray(end * _RATIO ** -np.arange(count, -1.0, -1.0))


Maker = Callable[[Setup], Family | None]
"""Makes a family for a setup; None where the effect cannot be."""
