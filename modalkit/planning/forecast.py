"""The forecast of a test: which effects it separates, from what severity on, and which change of it gains most."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Literal

import numpy as np
import pandas as pd
from scipy.cluster.hierarchy import fcluster, linkage
from scipy.spatial.distance import squareform
from threadpoolctl import threadpool_limits

from modalkit.planning.bench import Bench
from modalkit.planning.changes import Change
from modalkit.planning.curves import Curve
from modalkit.planning.design import Design
from modalkit.planning.separability import CLASS, EQUAL, NONE, SEEN, SURE, Distances, distances

_CAP = 10.0


@dataclass(frozen=True)
class Limit:
    """From what severity on an effect shows.

    Parameters
    ----------
    seen, separated, sure : float
        Severity from which it is seen, separated from all others by 3 sigma, and by 5; infinite for never [SI].
    clear : float
        Severity that is asked about [SI].
    nearest : str
        Who can do most of what it does, when it is clear.
    sigma : float
        Distance to that one [-].
    """

    seen: float
    separated: float
    sure: float
    clear: float
    nearest: str
    sigma: float


Kind = Literal["named", "place", "edge", "class", "unseen"]
"""Separated from all surely; except from itself elsewhere; by less; not separated from some; not from no effect."""


@dataclass(frozen=True)
class Outcome:
    """What a diagnosis is expected to answer.

    Parameters
    ----------
    kind : str
        ``named``; named with its ``place`` in doubt; on the ``edge`` of it; in a ``class`` with others; or ``unseen``.
    rivals : tuple of str
        Those from which it is not separated, or hardly, the nearest first.
    """

    kind: Kind
    rivals: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class DesignForecast:
    """What one test separates.

    Parameters
    ----------
    design : Design
        The test.
    found : tuple of Distances
        Every effect against all others.
    """

    design: Design
    found: tuple[Distances, ...]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(one.curve.family.name for one in self.found)

    @cached_property
    def matrix(self) -> pd.DataFrame:
        """Standard deviations from each effect, clear, to all that another can do; the first column is ``none``."""
        rows = [dict(zip(one.rivals, one.clear(one.sigma), strict=True)) for one in self.found]
        return pd.DataFrame(rows, index=list(self.names), columns=[NONE, *self.names])

    @cached_property
    def limits(self) -> dict[str, Limit]:
        """From what severity on each effect is seen, and separated from all others, by name."""
        return {one.curve.family.name: _limit(one) for one in self.found}

    @property
    def thresholds(self) -> pd.DataFrame:
        """The limits as a table [SI]."""
        rows = [asdict(limit) for limit in self.limits.values()]
        return pd.DataFrame(rows, index=list(self.limits))

    @cached_property
    def pairs(self) -> dict[tuple[str, str], float]:
        """Separation of each pair of effects: the smaller of the two directions [-]."""
        table = self.matrix[list(self.names)].to_numpy(dtype=float)
        both = np.fmin(table, table.T)
        return {
            (a, self.names[j]): float(both[i, j]) for i, a in enumerate(self.names) for j in range(i + 1, len(both))
        }  # fmt: skip

    @property
    def unseen(self) -> tuple[str, ...]:
        """Effects that, clear as they are, would be taken for none."""
        return tuple(self.matrix.index[self.matrix[NONE] < CLASS])

    @property
    def shown_pairs(self) -> dict[tuple[str, str], float]:
        """Separation of each pair of effects that are seen, clear as they are [-]."""
        unseen = set(self.unseen)
        return {pair: sigma for pair, sigma in self.pairs.items() if not unseen & set(pair)}

    @cached_property
    def outcomes(self) -> dict[str, Outcome]:
        """What a diagnosis is expected to answer to each effect, as strong as is asked about."""
        return {one.curve.family.name: _outcome(one) for one in self.found}

    @property
    def classes(self) -> tuple[tuple[str, ...], ...]:
        """Groups of effects that all lie less than 2 sigma from each other; those that are not seen are left out."""
        pairs = self.shown_pairs
        names = [name for name in self.names if name not in self.unseen]
        if len(names) < 2:
            return ()
        separately = np.zeros((len(names), len(names)))
        for (a, b), sigma in pairs.items():
            separately[names.index(a), names.index(b)] = separately[names.index(b), names.index(a)] = sigma
        label = fcluster(linkage(squareform(separately), "complete"), CLASS, "distance")
        groups = [tuple(n for n, own in zip(names, label, strict=True) if own == g) for g in np.unique(label)]
        return tuple(g for g in groups if len(g) > 1)

    @property
    def separated_share(self) -> float:
        """Share of the pairs of effects that are 3 sigma apart or more [-]."""
        values = np.array(list(self.pairs.values()))
        return float(np.mean(values >= SEEN)) if len(values) else 1.0

    @property
    def shown_share(self) -> float:
        """Share of the pairs of effects that are seen that are 3 sigma apart or more [-]."""
        values = np.array(list(self.shown_pairs.values()))
        return float(np.mean(values >= SEEN)) if len(values) else 1.0

    @property
    def worth(self) -> float:
        """Share of pairs separated, and beside it how low thresholds are on a logarithmic scale, as one number [-]."""
        table = self.thresholds
        depth = np.log(np.clip(table["clear"] / table["separated"], 1 / _CAP, _CAP))
        near = np.clip(list(self.pairs.values()), 0.1, SEEN) / SEEN
        return float(self.separated_share + np.mean(depth) / np.log(_CAP) + np.mean(near))


def _limit(one: Distances) -> Limit:
    family = one.curve.family
    clear = one.clear(one.sigma)
    own = [i for i in one.unequal if one.rivals[i] != NONE]
    rival, sigma = min(
        ((one.rivals[i], float(clear[i])) for i in own), key=lambda pair: pair[1], default=(NONE, np.inf)
    )
    return Limit(
        seen=one.threshold(one.sigma[0]),
        separated=one.threshold(one.nearest),
        sure=one.threshold(one.nearest, SURE),
        clear=family.clear,
        nearest=rival,
        sigma=sigma,
    )


def _outcome(one: Distances) -> Outcome:
    clear = one.clear(one.sigma)
    if clear[one.rivals.index(NONE)] < SEEN:
        return Outcome("unseen")
    rivals = zip(clear.tolist(), one.rivals, one.causes, strict=True)
    near = sorted((s, rival, cause) for s, rival, cause in rivals if rival != NONE and s < SURE)
    untold = [(rival, cause) for sigma, rival, cause in near if sigma < SEEN]
    if not near:
        return Outcome("named")
    if not untold:
        return Outcome("edge", tuple(rival for _, rival, _ in near))
    own = {cause for _, cause in untold} == {one.curve.family.cause}
    return Outcome("place" if own else "class", tuple(rival for rival, _ in untold))


@dataclass(frozen=True, eq=False)
class Advice:
    """A change, and what it brings.

    Parameters
    ----------
    change : Change
        What to do.
    after : DesignForecast
        The test then.
    separates : tuple of (str, str)
        Pairs separated then and not before; ``none`` stands for an effect that becomes visible.
    factor : float
        How many times smaller the severities it separates become, geometric mean [-].
    worth : float
        Growth of the share of pairs separated, of thresholds and of small separations, as one number [-].
    """

    change: Change
    after: DesignForecast
    separates: tuple[tuple[str, str], ...]
    factor: float
    worth: float


@dataclass(frozen=True, eq=False)
class Forecast:
    """The complete plan of a test.

    Parameters
    ----------
    bench : Bench
        The structure and its test.
    curves : tuple of Curve
        The effects.
    now : DesignForecast
        The test as it is.
    advice : tuple of Advice
        Changes, the most worth first.
    """

    bench: Bench
    curves: tuple[Curve, ...]
    now: DesignForecast
    advice: tuple[Advice, ...]


def forecast(bench: Bench, *, progress: Callable[[str], None] | None = None) -> Forecast:
    """Forecast which effects a test separates.

    Parameters
    ----------
    bench : Bench
        The structure and its test.
    progress : callable, optional
        Called with what is being done.

    Returns
    -------
    Forecast
        What it separates now, and what each change would bring.
    """
    with threadpool_limits(1, user_api="blas"):  # two threads are slower on small eigenproblems
        return _forecast(bench, progress or (lambda _: None))


def _forecast(bench: Bench, say: Callable[[str], None]) -> Forecast:
    curves = []
    for family in bench.families:
        say(f"solving {family.name}")
        curves.append(bench.solve(family))
    kept = tuple(curves)

    def forecast_of(design: Design, *, fine: bool = True) -> DesignForecast:
        return DesignForecast(design, distances(kept, design, bench, fine=fine))

    design = bench.design
    now = forecast_of(design)
    say("weighing changes")
    tried = bench.changes(design, lambda d: forecast_of(d, fine=False).worth)
    found = [_advice(change, now, forecast_of) for change in tried]
    found.sort(key=lambda one: -one.worth)
    return Forecast(bench, kept, now, tuple(found))


def _advice(change: Change, now: DesignForecast, forecast_of: Callable[[Design], DesignForecast]) -> Advice:
    after = _with_what_was_there(forecast_of(change.design), now)
    before, then = now.pairs, after.pairs
    newly = [pair for pair in before if before[pair] < SEEN <= then[pair] and not _equal(pair)]
    for name in now.names:
        if shown(now, name) < SEEN <= shown(after, name):
            newly.append((name, NONE))
    old, new = now.thresholds, after.thresholds
    ratio = np.clip(old["separated"], None, _CAP * old["clear"]) / np.clip(
        new["separated"], None, _CAP * old["clear"]
    )
    factor = float(np.exp(np.mean(np.log(ratio))))
    return Advice(change, after, tuple(newly), factor, after.worth - now.worth)


def shown(forecast_of: DesignForecast, name: str) -> float:
    """Return by how many sigma an effect, clear, stands off none [-]."""
    return float(forecast_of.found[forecast_of.names.index(name)].clear_of(NONE))


def _equal(pair: tuple[str, str]) -> bool:
    return pair in EQUAL or pair[::-1] in EQUAL


def _with_what_was_there(after: DesignForecast, now: DesignForecast) -> DesignForecast:
    """Leave the effects that were always there as they are: a baseline has them too, so that they cancel."""
    if not after.design.baseline or now.design.baseline:
        return after
    pairs = zip(after.found, now.found, strict=True)
    return DesignForecast(after.design, tuple(b if b.curve.family.always else a for a, b in pairs))
