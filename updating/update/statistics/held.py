"""Which parameters their tolerances keep from where the data would take them.

How much data determine a parameter is a matter of where it stands: a soft support is hardly seen where it is stiff.
Near the nominal model a tolerance may hold what the data, asked further away, determine well.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2

from acquisition.quantities import number, percent
from updating.update.data.system import System
from updating.update.parameters.parameters import ModelParameter
from updating.update.solve import Solution, solve

RELEASED = 4
"""So many parameters are released, one by one, those that the data pull the most [-]: each is a solution more.
Doubled: twice the time where a fit is bad; the one that the data ask for is rarely pulled less than four others."""

BEYOND = 3.0
"""Data contradict a tolerance that they would leave by more than so many times [-]. Doubled: what is 3 to 6 off is
reported as held by nothing."""

CHANCE = 1e-3
"""A misfit that falls by more than chance makes it, with this probability, falls for a reason [-]."""

WITHIN = 2.0
"""The tolerance that is advised is that which leaves where the data take a parameter within so many times of it [-].
Doubled: one of half the size, that pulls four times as hard."""


@dataclass(frozen=True)
class Held:
    """A parameter that its tolerance keeps from where the data would take it.

    Parameters
    ----------
    index : int
        Which unknown.
    coordinate : float
        Where the data take it, the others still held.
    gain : float
        By how much that lowers the misfit [variances].
    """

    index: int
    coordinate: float
    gain: float

    def sentence(self, system: System) -> str:
        """Return what is to be known of it, and what to write into the study."""
        parameter, name = system.model_parameters[self.index], system.names[self.index]
        away = abs(self.coordinate - system.centre[self.index])
        wider = f"a tolerance of `{parameter.name} = {away / WITHIN:.1g}`" if parameter.log else "a wider one"
        return (
            f"{name} is held by its tolerance of {_tolerance(parameter)}; the data alone would give "
            f"{_value(parameter, self.coordinate)}, which lowers chi-square by {number(self.gain)}. If it may be so "
            f"far off, state `bounds.{parameter.name}` about that value or {wider} in [tolerances]"
        )


def held(system: System, solution: Solution) -> tuple[Held, ...]:
    """Return the parameters that are held by their tolerances against the data, what gains the most first.

    Each is released alone and the problem solved from where it came to rest. It is held if the data leave its
    tolerance by ``BEYOND`` times and the misfit falls by more than chance and what then scatters explain.
    """
    pull = np.abs(system.prior * (solution.theta - system.centre)) * system.doubt
    first = [i for i in np.argsort(-pull, kind="stable")[:RELEASED].tolist() if pull[i] > 0]
    found = (_released(system, solution, i) for i in first)
    return tuple(sorted((h for h in found if h is not None), key=lambda h: -h.gain))


def _released(system: System, solution: Solution, index: int) -> Held | None:
    """Return a parameter with where the data take it; None if they stay near or gain nothing by it."""
    parameters = list(system.model_parameters)
    parameters[index] = replace(parameters[index], tolerated=False)
    free = replace(system, model_parameters=tuple(parameters))
    there = solve(free, solution.theta)
    at = float(there.theta[index])
    left = free.cost(there.theta, there.evaluations)
    gain = free.cost(solution.theta, solution.evaluations) - left
    scatter = max(left / max(system.count - 1, 1), 1.0)
    far = abs(at - system.centre[index]) > BEYOND * system.doubt[index]
    return Held(index, at, gain) if far and chi2.sf(gain / scatter, 1) < CHANCE else None


def sentences(system: System, found: tuple[Held, ...]) -> Iterator[str]:
    """State for each parameter held what holds it and what to do."""
    return (h.sentence(system) for h in found)


def _tolerance(parameter: ModelParameter) -> str:
    return percent(100 * parameter.doubt) if parameter.log else f"{number(parameter.doubt)} {parameter.unit}"


def _value(parameter: ModelParameter, coordinate: float) -> str:
    value = parameter.value(coordinate)
    text = f"{number(parameter.nominal * value)} {parameter.unit}"
    return f"{text} (factor {value:.3g})" if parameter.log else text
