"""Which effects, how strong and where, are tried to check a forecast."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from modalkit.planning.case import Case
from modalkit.planning.forecast import Advice, DesignForecast
from modalkit.planning.separability import NONE, SURE, Distances, at_severity, crossing


def choose(
    now: DesignForecast, advice: Advice | None, count: int, rng: np.random.Generator
) -> tuple[Case, ...]:
    """Return cases about the thresholds: half are effects that the advice newly separates, then others in turn.

    Parameters
    ----------
    now : DesignForecast
        The test as it is.
    advice : Advice, optional
        What is followed.
    count : int
        How many cases [-].
    rng : numpy.random.Generator
        For signs and places.
    """
    after = now if advice is None else advice.after
    table = after.thresholds
    hard = [str(name) for name in (table["separated"] / table["clear"]).sort_values(ascending=False).index]
    first = [n for pair in (advice.separates if advice else ()) for n in pair if n != NONE]
    first, others = _possible(first, now, after), _possible(hard, now, after)
    others = [name for name in others if name not in first]
    half = -(-count // 2) if first and others else count
    names = [*_in_turn(first or others, half), *_in_turn(others or first, count - half)]
    return tuple(_case(_found(now, name), _found(after, name), rng) for name in names)


def _possible(names: Sequence[str], now: DesignForecast, after: DesignForecast) -> list[str]:
    """Return names once each, without those that a baseline has too and those that no severity shows."""
    kept = [n for n in dict.fromkeys(names) if np.isfinite(after.limits[n].seen)]
    return [n for n in kept if not (after.design.baseline and _found(now, n).curve.family.always)]


def _in_turn(names: Sequence[str], count: int) -> list[str]:
    return [names[i % len(names)] for i in range(count)]


def _found(evaluation: DesignForecast, name: str) -> Distances:
    return evaluation.found[evaluation.names.index(name)]


def _case(now: Distances, then: Distances, rng: np.random.Generator) -> Case:
    """Take the severity from which on the effect is surely separated once the advice is followed."""
    family = now.curve.family
    place, sign = int(rng.integers(len(now.places))), float(rng.choice([-1.0, 1.0]))
    side = np.flatnonzero(sign * family.grid > 0) if family.low < 0 else np.flatnonzero(family.grid > 0)
    side = side[np.argsort(np.abs(family.grid[side]))]
    size = crossing(np.abs(family.grid[side]), then.nearest[place, side], SURE)
    most = float(np.abs(family.grid[side]).max())
    q = float(np.sign(family.grid[side[0]]) * min(size, most))
    before, after = (at_severity(family.grid, one.sigma[:, place], q) for one in (now, then))
    own = now.unequal
    return Case(
        family,
        q,
        float(now.places[place]),
        float(before[own].min()),
        SURE if size <= most else float(after[own].min()),
        now.rivals[own[int(np.argmin(before[own]))]],
        then.rivals[own[int(np.argmin(after[own]))]],
    )
