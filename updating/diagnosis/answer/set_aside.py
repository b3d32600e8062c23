"""Names of data that an explanation takes to be worse than stated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.compared import Search
from updating.likelihood.comparison import CHANNELS
from updating.likelihood.outliers import Outlier

KINDS = {
    "frequency": "frequency",
    "damping": "damping",
    "frf": "shape",
    "phase": "phase",
    "level": "level",
    "trend": "trend",
}
"""What the data of each channel are of a mode."""


@dataclass(frozen=True)
class SetAside:
    """No cause, but data that are worse than stated.

    Parameters
    ----------
    data : tuple of str
        Which data.
    probability : float
        Of no cause with data set aside, these or others [-].
    p_value : float
        How well all other data fit [-].
    """

    data: tuple[str, ...]
    probability: float
    p_value: float

    def __str__(self) -> str:
        return without(self.data)


def without(data: Sequence[str]) -> str:
    """State which data are set aside."""
    return f"without {', '.join(data)}"


def most_probable(problem: DiagnosisProblem, titles: Sequence[str], found: Search) -> SetAside | None:
    """Return which data are worse than stated if there is no cause; None where no set takes any to be.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    titles : sequence of str
        Of the studies; given where there are several.
    found : Search
        What was compared.
    """
    if not found.set_aside:
        return None
    first = found.set_aside[0]
    total = float(sum(row.probability for row in found.set_aside))
    return SetAside(names_of(problem, titles, first.explanation.candidate.outliers), total, first.p_value)


def names_of(
    problem: DiagnosisProblem, titles: Sequence[str], outliers: Sequence[Outlier]
) -> tuple[str, ...]:
    """Return the names of data taken to be worse than stated, each once."""
    return tuple(dict.fromkeys(_name(problem, titles, outlier) for outlier in outliers))


def _name(problem: DiagnosisProblem, titles: Sequence[str], outlier: Outlier) -> str:
    if outlier.tolerance is not None:
        specimens = zip(problem.specimens, _heads(titles), strict=True)
        names = [f"{head}{name}" for one, head in specimens for name in one.names]
        return f"tolerance of {names[outlier.tolerance]}"
    if outlier.source is not None:
        return of_channel(problem, titles, outlier.source)
    assert outlier.mode is not None
    return of_mode(problem, titles, outlier.mode, outlier.channel)


def of_mode(problem: DiagnosisProblem, titles: Sequence[str], mode: int, channel: int | None) -> str:
    """Name the data of a mode, of one kind or all; modes of further specimens count on."""
    which, heads = 0, _heads(titles)
    while mode >= (count := len(problem.specimens[which].measured.frequency)):
        which, mode = which + 1, mode - count
    kind = "" if channel is None else f" {KINDS[CHANNELS[channel]]}"
    return f"{heads[which]}mode {mode + 1}{kind}"


def of_channel(problem: DiagnosisProblem, titles: Sequence[str], source: int) -> str:
    """Name all constants of a measuring channel by the point where it roves; channels of further specimens count on."""
    which, heads = 0, _heads(titles)
    while source >= (count := len(problem.specimens[which].measured.seen)):
        which, source = which + 1, source - count
    test = problem.specimens[which].measured
    roving = test.hit if len(np.unique(test.hit)) >= len(np.unique(test.seen)) else test.seen
    return f"{heads[which]}point {test.nodes[int(roving[source])]} in all modes"


def _heads(titles: Sequence[str]) -> list[str]:
    """Return what stands before a name, one per specimen."""
    return [f"{title}: " for title in titles] if len(titles) > 1 else [""]
