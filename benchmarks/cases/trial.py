"""What a case is, and one trial of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Cause:
    """One hidden cause, as a right answer states it.

    Parameters
    ----------
    names : tuple of str
        Names of the library for it: its own, and those that describe exactly the same change of the data.
    sizes : mapping
        Parameters of the first name that an interval has to hold [SI].
    places : tuple
        Where it sits: a right answer names one of them as its region, channel or points; empty where it need not.
    """

    names: tuple[str, ...]
    sizes: Mapping[str, float] = field(default_factory=dict)
    places: tuple[object, ...] = ()

    def __str__(self) -> str:
        stated = [*map(str, self.places[:1]), *(f"{name} {value:.3g}" for name, value in self.sizes.items())]
        return f"{self.names[0]} ({', '.join(stated)})" if stated else self.names[0]


@dataclass(frozen=True)
class Trial:
    """A study with its test on the disk, and what is hidden in it.

    Parameters
    ----------
    study : Path
        The study file.
    causes : tuple of Cause
        What is hidden; empty for nothing.
    visible : float
        By how many standard deviations it moves the data off what tolerances allow, by the rig's own model; nan where
        the rig has no such body [-].
    """

    study: Path
    causes: tuple[Cause, ...]
    visible: float = np.nan

    @property
    def hidden(self) -> str:
        """What is hidden, in words."""
        return " + ".join(map(str, self.causes)) or "nothing"


Make = Callable[[np.random.Generator, Path], Trial]
"""Random numbers and an empty folder to a trial: specimen, dimensions, noise and place are all drawn."""


@dataclass(frozen=True)
class Case:
    """A case and how it was answered before.

    Parameters
    ----------
    name : str
        On the command line.
    before : str
        The answer when the case was first met, on another simulator.
    make : callable
        Draws a trial.
    each : int
        Trials for each seed [-].
    """

    name: str
    before: str
    make: Make
    each: int = 1
