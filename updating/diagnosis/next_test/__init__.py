"""What to measure next: hypothetical tests, and how far each would drive the remaining explanations apart.

Each explanation predicts the outcome of each test. If one of them is right, another is off by the Mahalanobis distance
that is left when its parameters and all nuisances have done their best, jointly with the data there are already; of the
two directions the smaller counts. Tests that separate all that is left come first, the cheapest of them at the top.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

from updating.diagnosis.answer.result import NextTest, Verdict
from updating.diagnosis.next_test.base import Maker, Rival, Site, Trial, separation
from updating.diagnosis.next_test.changed import SameTest
from updating.diagnosis.next_test.free_free import Unclamped
from updating.diagnosis.next_test.instruments import Instruments
from updating.diagnosis.next_test.other_points import OtherPoints
from updating.diagnosis.next_test.unknown import advise
from updating.diagnosis.problem.face import Posed
from updating.diagnosis.problem.several import Several
from updating.diagnosis.search.search import Search

MAKERS: tuple[Maker, ...] = (Instruments(), SameTest(), OtherPoints(), Unclamped())
"""All kinds of test that are thought of."""

ENOUGH = 3.0
"""Explanations so many sigma apart are separated."""

WORTH = 1.0
"""A test that separates nothing by so many sigma is not worth a line."""

RIVALS = 4
"""So many explanations are told apart."""

LINES = 6
"""So many tests are proposed."""


@dataclass(frozen=True)
class _Found:
    trial: Trial
    site: Site
    sigmas: dict[tuple[int, int], float]

    @property
    def separated(self) -> tuple[tuple[int, int], ...]:
        return tuple(pair for pair, sigma in self.sigmas.items() if sigma >= ENOUGH)

    @property
    def told(self) -> tuple[tuple[int, int], ...]:
        """The pairs of which the proposal speaks: those separated, or the one that comes nearest to it."""
        return self.separated or (max(self.sigmas, key=lambda pair: self.sigmas[pair]),)

    @property
    def sigma(self) -> float:
        return min(self.sigmas[pair] for pair in self.told)


def propose(
    posed: Posed, found: Search, sets: tuple[tuple[str, ...], ...], verdict: Verdict = "class"
) -> tuple[NextTest, ...]:
    """Return the tests that would separate what is left: those that separate all of it first, the cheapest at the top.

    Parameters
    ----------
    posed : Problem or Several
        Test and model.
    found : Search
        What was weighed.
    sets : tuple of tuple of str
        Sets of effects of the answer.
    verdict : str
        What was decided. A cause that is named is told from its runners-up, to confirm it.
    """
    if verdict == "unknown":
        return tuple(advice for site in _sites(posed) for advice in advise(site, found))[:LINES]
    rivals = _rivals(posed, found, sets, verdict)
    if len(rivals) < 2:
        return ()
    pairs = list(combinations(range(len(rivals)), 2))
    if verdict == "named":
        pairs = [pair for pair in pairs if pair[0] == 0]
    looks = [_look(trial, site, rivals, pairs) for site in _sites(posed) for trial in _trials(site, rivals)]
    best: dict[tuple[str, int], _Found] = {}
    for look in looks:
        key = (look.trial.family, look.site.index)
        if key not in best or _worth(look) > _worth(best[key]):
            best[key] = look
    kept = [look for look in best.values() if look.sigma >= WORTH]
    kept.sort(key=lambda look: (-len(look.separated), look.trial.cost, -look.sigma))
    return tuple(_proposal(look, rivals) for look in kept[:LINES])


def _worth(look: _Found) -> tuple[int, float]:
    return len(look.separated), look.sigma


def _rivals(
    posed: Posed, found: Search, sets: tuple[tuple[str, ...], ...], verdict: Verdict
) -> tuple[Rival, ...]:
    rows = {
        row.names: row.explanation for row in found.weighed if row.names and row.explanation.best.possible
    }
    chosen = list(sets[:RIVALS])
    if verdict == "named" and sets:
        # what holds the named set and more can do all that it does
        others = [names for names in rows if not set(sets[0]) <= set(names)]
        chosen += others[: RIVALS - 2]
    return tuple(Rival(posed, rows[names]) for names in chosen if names in rows)


def _sites(posed: Posed) -> list[Site]:
    titles = posed.titles if isinstance(posed, Several) else ("",)
    return [Site(posed, i, title) for i, title in enumerate(titles)]


def _trials(site: Site, rivals: tuple[Rival, ...]) -> Iterator[Trial]:
    for maker in MAKERS:
        yield from maker.trials(site, rivals)


def _look(trial: Trial, site: Site, rivals: tuple[Rival, ...], pairs: list[tuple[int, int]]) -> _Found:
    expected = trial.outcomes(site, rivals)
    sigmas = {
        (i, j): min(
            separation(expected[i], expected[j], rivals[j]), separation(expected[j], expected[i], rivals[i])
        )
        for i, j in pairs
    }
    return _Found(trial, site, sigmas)


def _proposal(look: _Found, rivals: tuple[Rival, ...]) -> NextTest:
    apart = sorted({i for pair in look.told for i in pair})
    names = tuple(dict.fromkeys(name for i in apart for name in rivals[i].names))
    where = f"{look.site.title}: " if look.site.title else ""
    told = tuple((rivals[i].names, rivals[j].names) for i, j in look.told)
    whole = len(look.separated) == len(look.sigmas)
    return NextTest(where + look.trial.measure, names, round(look.sigma, 1), told, whole)


__all__ = ["MAKERS", "propose"]
