"""The places of an explanation: its posterior samples gathered in clusters, and what symmetry puts beside them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain, combinations

import numpy as np
from scipy.cluster.hierarchy import fcluster, linkage

from acquisition.arrays import FloatArray, IntArray
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.fit import highest
from updating.effects.box import Place
from updating.problem.specimen import SpecimenProblem

SEARCHED = frozenset({"x", "y", "z", "region"})
"""Parameters that say where an effect sits."""


@dataclass(frozen=True, eq=False)
class Cluster:
    """One place where a cause may sit.

    Parameters
    ----------
    place : (3,) array
        Posterior mean of the place [m].
    spread : (3,) array
        Posterior standard deviation [m].
    weight : float
        Share of the posterior probability [-].
    likely_place : int
        Which of the places that an explanation has at the same time: a mass on each of two sensors has two.
    """

    place: FloatArray
    spread: FloatArray
    weight: float
    likely_place: int = 0


def clusters(
    problem: SpecimenProblem,
    explanation: Explanation,
    channel: str,
    *,
    rules: DecisionRules = DEFAULT_RULES,
) -> tuple[Cluster, ...]:
    """Gather the places of an explanation.

    Parameters
    ----------
    problem : Problem
        Test and model.
    explanation : Explanation
        A candidate with its posterior samples.
    channel : str
        Channel whose effects are asked for; of all effects if none of that channel has a place.
    rules : DecisionRules
        What the answer is decided by.

    Returns
    -------
    tuple of Cluster
        The most probable first.
    """
    sampled = sampled_places(problem, explanation, channel)
    if not len(sampled.weights):
        return ()
    apart = rules.separate_places * _span(problem)
    found = [
        cluster
        for likely_place in np.unique(sampled.likely_places).tolist()
        for cluster in _gather(sampled.of(likely_place), apart, likely_place)
    ]
    found += _mirrored(problem, explanation, channel, found, apart, rules.least_place)
    return tuple(sorted(_stated(found, rules.least_place), key=lambda c: -c.weight))


def _stated(found: list[Cluster], least: float) -> Iterator[Cluster]:
    """Share the weight of each effect among its places, and drop those with little of it."""
    for likely_place in {cluster.likely_place for cluster in found}:
        here = [cluster for cluster in found if cluster.likely_place == likely_place]
        total = sum(cluster.weight for cluster in here)
        yield from (replace(c, weight=c.weight / total) for c in here if c.weight >= least * total)


@dataclass(frozen=True, eq=False)
class Sampled:
    """Places of the posterior samples, one row each.

    Parameters
    ----------
    places : (n, 3) array
        In model axes [m].
    weights : (n,) array
        Posterior weight; that of one sample is shared among the places that are alternatives [-].
    likely_places : (n,) int array
        Places of one effect are alternatives, such as mirror images; those of several are taken at the same time.
    """

    places: FloatArray
    weights: FloatArray
    likely_places: IntArray

    def of(self, likely_place: int) -> Sampled:
        """Return the places of one effect."""
        here = self.likely_places == likely_place
        return Sampled(self.places[here], self.weights[here], self.likely_places[here])


def sampled_places(
    problem: SpecimenProblem,
    explanation: Explanation,
    channel: str | None = None,
    *,
    most: int = 300,
    lightest: float = 1e-4,
) -> Sampled:
    """Return the places of the heaviest samples.

    Parameters
    ----------
    problem : Problem
        Test and model.
    explanation : Explanation
        A candidate with its posterior samples.
    channel : str, optional
        Channel whose effects are asked for; left out, all but the measurement. Where none of these has a place, all
        effects are.
    most : int
        How many of the heaviest are taken: of 300 some 7 lie beyond each end of 95 %.
    lightest : float
        Samples with less than this share of the heaviest one's weight are left out [-].
    """
    heavy = np.argsort(explanation.weights)[::-1][:most]
    heavy = heavy[explanation.weights[heavy] > lightest * explanation.weights[heavy[0]]]
    rows = [
        (place, float(explanation.weights[i]) / len(alternatives), likely_place)
        for i in heavy.tolist()
        for likely_place, alternatives in enumerate(
            _places_of_sample(problem, explanation, explanation.samples[i], channel)
        )
        for place in alternatives
    ]
    return Sampled(
        np.array([place for place, _, _ in rows], dtype=float).reshape(-1, 3),
        np.array([weight for _, weight, _ in rows], dtype=float),
        np.array([likely_place for _, _, likely_place in rows], dtype=np.int64),
    )


def _places_of_sample(
    problem: SpecimenProblem, explanation: Explanation, sample: FloatArray, channel: str | None
) -> list[list[Place]]:
    """Return the places of one sample by effect: one that searches its place has one, with alternatives."""
    candidate = explanation.candidate
    stage = candidate.stage(problem.predictor)
    by_channel: dict[bool, list[list[Place]]] = {True: [], False: []}
    for effect, values in candidate.split(stage, sample.tolist()):
        places = list(effect.locations(stage, values))
        searches = bool(SEARCHED & {parameter.name for parameter in effect.parameters(stage)})
        likely_places = [places] if searches else [[place] for place in places]
        asked = effect.channel == channel if channel else effect.channel != "measurement"
        by_channel[asked] += [likely_place for likely_place in likely_places if likely_place]
    return by_channel[True] or by_channel[False]


def _span(problem: SpecimenProblem) -> float:
    spec = problem.predictor.spec
    return max(spec.length, spec.width if spec.kind != "beam" else 0.0)


def _gather(sampled: Sampled, apart: float, likely_place: int, *, bridge: float = 1e-3) -> list[Cluster]:
    """Gather the samples of one effect: what hangs together is one place.

    Samples with less than ``bridge`` of the heaviest one's weight build no bridges between places.
    """
    bold = sampled.weights >= bridge * sampled.weights.max()
    places, weights = sampled.places[bold], sampled.weights[bold]
    labels = np.ones(len(places), dtype=int)
    if len(places) > 1:
        labels = fcluster(linkage(places, "single"), apart, criterion="distance")
    found = []
    for label in np.unique(labels):
        here, share = places[labels == label], weights[labels == label]
        mean = share @ here / share.sum()
        spread = np.sqrt(share @ (here - mean) ** 2 / share.sum())
        found.append(Cluster(mean, spread, float(share.sum() / weights.sum()), likely_place))
    return found


def _mirrored(
    problem: SpecimenProblem,
    explanation: Explanation,
    channel: str,
    found: list[Cluster],
    apart: float,
    least: float,
) -> list[Cluster]:
    """Look for places on the other side that explain the data as well, which the samples may have missed."""
    best = explanation.best
    leaders = {c.likely_place: c for c in sorted(found, key=lambda c: c.weight)}
    more: list[Cluster] = []
    for flipped in _flips(problem, explanation):
        peak = highest(problem, explanation.candidate, flipped, rounds=4)
        likely = np.exp(min(peak.marginal.log_likelihood - best.marginal.log_likelihood, 0.0))
        if likely < least:
            continue
        for likely_place, places in enumerate(
            _places_of_sample(problem, explanation, peak.coordinates, channel)
        ):
            known = [c.place for c in [*found, *more] if c.likely_place == likely_place]
            if likely_place not in leaders:
                continue
            for place in np.asarray(places, dtype=float):
                if min(np.linalg.norm(place - k) for k in known) > apart:
                    share = float(likely) * leaders[likely_place].weight
                    more.append(Cluster(place, leaders[likely_place].spread, share, likely_place))
    return more


def _flips(problem: SpecimenProblem, explanation: Explanation) -> Iterator[FloatArray]:
    """Give the best parameters with x, with y, and with both on the other side of the middle."""
    candidate, spec = explanation.candidate, problem.predictor.spec
    parameters = candidate.parameters(candidate.stage(problem.predictor))
    size = {"x": spec.length, "y": spec.width}
    rows: dict[str, list[int]] = {}
    for i, (name, parameter) in enumerate(parameters):
        axis = name.rpartition(".")[2]
        if axis in size and not parameter.log and np.isclose(parameter.low + parameter.high, size[axis]):
            rows.setdefault(axis, []).append(i)
    for axes in chain.from_iterable(combinations(sorted(rows), n) for n in range(1, len(rows) + 1)):
        flipped = np.array(explanation.best.coordinates, dtype=float)
        chosen = [i for axis in axes for i in rows[axis]]
        flipped[chosen] = 1 - flipped[chosen]
        yield flipped
