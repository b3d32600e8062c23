"""What to measure next: hypothetical tests, and how far each would drive the remaining explanations apart.

Each explanation predicts the outcome of each test. If one of them is right, another is off by the Mahalanobis distance
that is left when its parameters and all nuisances have done their best, jointly with the data there are already; of the
two directions the smaller counts. Tests that separate all that is left come first, the cheapest of them at the top; of
a cause that is named those that separate it from its most probable rival, since nothing else confirms it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

from updating.diagnosis.answer.mechanism import Mechanism
from updating.diagnosis.answer.result import NextTest, Verdict
from updating.diagnosis.answer.rules import DEFAULT_RULES
from updating.diagnosis.next_test.base import Maker, Rival, Site, Trial, separation
from updating.diagnosis.next_test.changed import SameTest
from updating.diagnosis.next_test.free_free import Unclamped
from updating.diagnosis.next_test.instruments import Instruments
from updating.diagnosis.next_test.other_points import OtherPoints
from updating.diagnosis.next_test.unknown import advise
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.problem.several import Several
from updating.diagnosis.search.compared import Search
from updating.diagnosis.search.prior import holds

MAKERS: tuple[Maker, ...] = (Instruments(), SameTest(), OtherPoints(), Unclamped())
"""All kinds of test that are thought of."""


@dataclass(frozen=True)
class _Found:
    trial: Trial
    site: Site
    sigmas: dict[tuple[int, int], float]
    first: tuple[int, int] | None = None  # of a named cause: the pair of it and its most probable rival
    bar: float = DEFAULT_RULES.separated_sigma

    @property
    def separated(self) -> tuple[tuple[int, int], ...]:
        return tuple(pair for pair, sigma in self.sigmas.items() if sigma >= self.bar)

    @property
    def stated(self) -> tuple[tuple[int, int], ...]:
        """The pairs that the proposal names: those separated; else the first, or the one that comes nearest."""
        return self.separated or (self.first or max(self.sigmas, key=lambda pair: self.sigmas[pair]),)

    @property
    def confirms(self) -> bool:
        return self.first is None or self.first in self.separated

    @property
    def sigma(self) -> float:
        return min(self.sigmas[pair] for pair in self.stated)


def propose(
    diagnosis_problem: DiagnosisProblem,
    found: Search,
    sets: tuple[tuple[str, ...], ...],
    verdict: Verdict = "class",
    mechanisms: Sequence[Mechanism] = (),
    *,
    separated: float = DEFAULT_RULES.separated_sigma,
    worthwhile: float = 1.0,
    most: int = 6,
) -> tuple[NextTest, ...]:
    """Return the tests that would separate what is left: those that separate all of it first, the cheapest at the top.

    Parameters
    ----------
    diagnosis_problem : Problem or Several
        Test and model.
    found : Search
        What was compared.
    sets : tuple of tuple of str
        Sets of effects of the answer.
    verdict : str
        What was decided. A cause that is named is separated from its runners-up, to confirm it, the most probable of
        them first.
    mechanisms : sequence of Mechanism
        What the answer changes. Where no set is an answer the first tests are for these.
    separated : float
        The rule ``separated_sigma`` [sigma].
    worthwhile : float
        A test that separates nothing by so many sigma is not worth a line [sigma].
    most : int
        So many tests are proposed: what a reader takes in.
    """
    if verdict == "unknown":
        sites = _sites(diagnosis_problem)
        return tuple(advice for site in sites for advice in advise(site, found, mechanisms))[:most]
    rivals = _rivals(diagnosis_problem, found, sets, verdict)
    if len(rivals) < 2:
        return ()
    pairs = list(combinations(range(len(rivals)), 2))
    first = (0, 1) if verdict == "named" else None
    if first:
        pairs = [pair for pair in pairs if pair[0] == 0]
    evaluations = [
        _evaluated(trial, site, rivals, pairs, first, separated)
        for site in _sites(diagnosis_problem)
        for trial in _trials(site, rivals)
    ]
    best: dict[tuple[str, int], _Found] = {}
    for evaluation in evaluations:
        key = (evaluation.trial.family, evaluation.site.index)
        if key not in best or _worth(evaluation) > _worth(best[key]):
            best[key] = evaluation
    kept = [evaluation for evaluation in best.values() if evaluation.sigma >= worthwhile]
    kept = [evaluation for evaluation in kept if evaluation.confirms] or kept
    kept.sort(key=_order)
    return tuple(_proposal(evaluation, rivals) for evaluation in kept[:most])


def _worth(evaluation: _Found) -> tuple[bool, int, float]:
    return evaluation.confirms, len(evaluation.separated), evaluation.sigma


def _order(evaluation: _Found) -> tuple[bool, int, int, float]:
    return not evaluation.confirms, -len(evaluation.separated), evaluation.trial.cost, -evaluation.sigma


def _rivals(
    diagnosis_problem: DiagnosisProblem,
    found: Search,
    sets: tuple[tuple[str, ...], ...],
    verdict: Verdict,
    *,
    most: int = 4,
) -> tuple[Rival, ...]:
    """Return the explanations that are compared: six pairs of four, each predicted under every test."""
    rows = {
        row.names: row.explanation for row in found.compared if row.names and row.explanation.best.possible
    }
    chosen = list(sets[:most])
    if verdict == "named" and sets:
        # what holds the named set and more can do all that it does
        others = [names for names in rows if not holds(names, sets[0])]
        chosen += others[: most - 2]
    return tuple(Rival(diagnosis_problem, rows[names]) for names in chosen if names in rows)


def _sites(diagnosis_problem: DiagnosisProblem) -> list[Site]:
    titles = diagnosis_problem.titles if isinstance(diagnosis_problem, Several) else ("",)
    return [Site(diagnosis_problem, i, title) for i, title in enumerate(titles)]


def _trials(site: Site, rivals: tuple[Rival, ...]) -> Iterator[Trial]:
    for maker in MAKERS:
        yield from maker.trials(site, rivals)


def _evaluated(
    trial: Trial,
    site: Site,
    rivals: tuple[Rival, ...],
    pairs: list[tuple[int, int]],
    first: tuple[int, int] | None,
    bar: float,
) -> _Found:
    expected = trial.outcomes(site, rivals)
    sigmas = {
        (i, j): min(
            separation(expected[i], expected[j], rivals[j]), separation(expected[j], expected[i], rivals[i])
        )
        for i, j in pairs
    }
    return _Found(trial, site, sigmas, first, bar)


def _proposal(evaluation: _Found, rivals: tuple[Rival, ...]) -> NextTest:
    named_rivals = sorted({i for pair in evaluation.stated for i in pair})
    names = tuple(dict.fromkeys(name for i in named_rivals for name in rivals[i].names))
    where = f"{evaluation.site.title}: " if evaluation.site.title else ""
    stated = tuple((rivals[i].names, rivals[j].names) for i, j in evaluation.stated)
    whole = len(evaluation.separated) == len(evaluation.sigmas)
    return NextTest(where + evaluation.trial.measure, names, round(evaluation.sigma, 1), stated, whole)


__all__ = ["MAKERS", "propose"]
