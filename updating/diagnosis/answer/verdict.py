"""From probabilities to an answer: named, a class, unknown, or none."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from scipy.stats import chi2

from updating.diagnosis.answer.in_no_library import SOMETHING_ELSE
from updating.diagnosis.answer.quantiles import quantiles
from updating.diagnosis.answer.ranked import ParameterEstimate, Ranked
from updating.diagnosis.answer.result import Shortcoming, Verdict
from updating.diagnosis.answer.rules import DEFAULT_RULES, DecisionRules
from updating.diagnosis.answer.set_aside import names_of
from updating.diagnosis.problem.face import DiagnosisProblem
from updating.diagnosis.search.compared import Compared, Search
from updating.diagnosis.search.evidence import Explanation
from updating.diagnosis.search.prior import holds
from updating.problem.candidate import Candidate
from updating.thresholds import NEGLIGIBLE_PROBABILITY

NAME = "name"
"""Unit of what is a name of the user's own model."""


def is_significant(found: Search, p_value: float, *, rules: DecisionRules = DEFAULT_RULES) -> bool:
    """Return whether there is a gap: tolerances and noise do not explain the data, or an effect does far better.

    A change in a few data is lost among many in a chi-squared over all; an effect that makes just that change sees it,
    if setting data aside, without any effect, does not explain them as well.
    Where that fit is one which chance makes seldom, and the empty set stays credible, there is no gap that is sure.
    """
    rows = [row for row in found.compared if row.names]
    nothing = _of_nothing(found)
    gains = [row.explanation.log_evidence - nothing for row in rows if not rejected(row, rules)]
    if p_value < rules.significant_gap or max(gains, default=-np.inf) > rules.effect_shows_gap:
        return True
    probability = found.empty.probability * np.exp(nothing - found.empty.explanation.log_evidence)
    share = probability / (probability + sum(row.probability for row in rows))
    return bool(share < 1 - rules.credible_share and _by_chance(found, rules) < rules.chance_of_a_fit)


def _of_nothing(found: Search) -> float:
    """Return the log evidence of no effect, with data set aside where that explains more [-]."""
    return max(found.empty.explanation.log_evidence, _set_aside(found))


def _set_aside(found: Search) -> float:
    """Return the log evidence of no effect beside what any set sets aside, the most of these [-]."""
    return max((row.without for row in found.compared if row.names), default=-np.inf)


def _by_chance(found: Search, rules: DecisionRules) -> float:
    """Return the chance that noise alone makes one of the single effects that fit so much more likely (Wilks 1938)."""
    singles = [row for row in found.compared if len(row.names) == 1 and not rejected(row, rules)]
    empty = found.empty.explanation
    least = empty.best.marginal.log_likelihood + empty.candidate.log_weight
    chances = [_chance(row, least) for row in singles if row.explanation.samples.shape[1]]
    return float(min(1.0, rules.places_per_form * len(singles) * min(chances, default=1.0)))


def _chance(row: Compared, least: float) -> float:
    """Return the chance of a single's gain over no effect, and over no effect with the same data set aside."""
    one = row.explanation
    if not one.best.possible:
        return 1.0
    best, weight = one.best.marginal.log_likelihood, one.candidate.log_weight
    gains = (best - least, best + weight - row.without)
    return float(max(chi2.sf(2 * gain, one.samples.shape[1]) for gain in gains) * np.exp(-weight))


def decide(
    found: Search,
    lacks: Shortcoming | None = None,
    *,
    significant: bool,
    unnamed: float = 0.0,
    rules: DecisionRules = DEFAULT_RULES,
) -> tuple[Verdict, tuple[tuple[str, ...], ...]]:
    """Return the verdict and the sets of effects it rests on.

    Parameters
    ----------
    found : Search
        What was compared, most probable first.
    lacks : str, optional
        What :func:`shortcoming` states.
    significant : bool
        Whether there is a gap.
    unnamed : float
        Probability that the cause is in no library [-].
    rules : DecisionRules
        What the answer is decided by.
    """
    if not significant:
        return "none", ()
    if lacks:
        return "unknown", ()
    sets = _credible(found, rules, unnamed)
    return ("class", sets) if len(sets) > 1 else ("named", sets)


def shortcoming(
    found: Search,
    *,
    comparable: bool = True,
    closed: float | None = None,
    left: bool = False,
    aside: bool = False,
    unnamed: float = 0.0,
    rules: DecisionRules = DEFAULT_RULES,
) -> Shortcoming | None:
    """Return what the most probable set lacks to be an answer, the first that holds; None where it lacks nothing.

    Parameters
    ----------
    found : Search
        What was compared, most probable first.
    comparable : bool
        Whether most measured modes have a partner: the rest alone names no cause.
    closed : float, optional
        What the first set closes of what can be closed, on modes held out; None where there is nothing to close [%].
    left : bool
        Whether the first set leaves more than noise.
    aside : bool
        Whether all of the gap lies in data that the first set takes to be worse than stated, and does not explain.
    unnamed : float
        Probability that the cause is in no library [-].
    rules : DecisionRules
        What the answer is decided by.
    """
    rows = [row for row in found.compared if row.names]
    if not rows or rejected(rows[0], rules):
        return "fit"
    if left and (aside if closed is None else closed < rules.closes_nearly_all):
        return "closing"
    if not _better(found, rules) or sum(row.probability for row in rows) < rules.credible_share:
        return "evidence"  # the rest is no cause, all data as stated or some worse
    if not rows[0].explanation.settled:
        return "samples"
    if unnamed >= rules.credible_share:
        return "library"
    return None if comparable or len(_credible(found, rules)) > 1 else "partners"


def rejected(row: Compared, rules: DecisionRules) -> bool:
    """Return whether a set is no answer.

    It fits too badly (sets of several, which have more freedom, must fit better), or only at a size beyond what is
    plausible.
    """
    return bool(row.extreme) or row.p_value < (
        rules.doubted_fit if len(row.names) > 1 else rules.rejected_fit
    )


def _better(found: Search, rules: DecisionRules) -> list[Compared]:
    """Return the sets that fit and whose evidence is beyond that of the empty one, with or without data set aside."""
    rows = [row for row in found.compared if row.names and not rejected(row, rules)]
    least = _of_nothing(found) + rules.beyond_nothing
    return [row for row in rows if row.explanation.log_evidence > least]


def _credible(found: Search, rules: DecisionRules, unnamed: float = 0.0) -> tuple[tuple[str, ...], ...]:
    """Return the fewest sets that hold the certainty asked for, and those that fit as well as the first.

    A cause in no library is one of them, and listed last: where it is more probable than all that is left out, or where
    it holds by itself more than may be left out.

    All sets have a share: one whose parameter lies at the end of its range, or which fits badly, is no answer by
    itself, and what it holds makes the others no more certain. What setting data aside explains without it is no cause
    and has none. Where no set is better than no effect there are no sets. A rival whose best parameters fit as well is
    behind by its prior alone: by how many parameters it has, and how widely they may range, and that is no
    measurement. A part of the first that fits by itself stays, too, unless the whole is better by as much as shows a
    gap: that there is something beside it is the more probable, and not sure.
    """
    better = _better(found, rules)
    if not better:
        return ()
    first = better[0]
    least = _set_aside(found) + rules.beyond_nothing
    rows = [row for row in found.compared if row.names and row.explanation.log_evidence > least]
    stated = _statements(first, rows, rules)
    total = max(sum(row.probability for row in rows), 1e-300)
    sets: list[tuple[str, ...]] = []
    held, other = 0.0, unnamed > 1 - rules.credible_share
    for row, probability in stated:
        share = (1 - unnamed) * probability / total
        alike = row in better and (
            (_close(first, row, rules) and _as_good(first, row, rules)) or _part_left(first, row, rules)
        )
        before = held + (unnamed if unnamed > share else 0.0)  # what is more probable comes first
        other = other or (unnamed > share and held < rules.credible_share)
        if before < rules.credible_share or alike:
            sets.append(row.names)
        held += share
    if sets and other:
        sets.append((SOMETHING_ELSE,))
    return tuple(sets)


def _statements(
    first: Compared, rows: Sequence[Compared], rules: DecisionRules
) -> list[tuple[Compared, float]]:
    """Return the sets that say different things about the data, with the probability that each holds [-].

    What adds to a set a cause that shows in no datum makes the same statement as that set, and counts for it.
    """
    own: list[tuple[Compared, list[Compared]]] = []
    for row in sorted(rows, key=lambda row: (row is not first, len(row.names))):
        base = next((faint for one, faint in own if _adds_nothing(one, row, rules)), None)
        if base is None:
            own.append((row, [row]))
        else:
            base.append(row)
    place = {id(row): index for index, row in enumerate(rows)}
    return [
        (row, sum(one.probability for one in faint))
        for row, faint in sorted(own, key=lambda pair: place[id(pair[0])])
    ]


def _adds_nothing(base: Compared, row: Compared, rules: DecisionRules) -> bool:
    """Return whether a set is another with more causes, and fits no better."""
    gain = row.explanation.best.marginal.log_likelihood - base.explanation.best.marginal.log_likelihood
    more = row is not base and holds(row.names, base.names)
    return more and 2 * gain < rules.close_fits


def _part_left(first: Compared, row: Compared, rules: DecisionRules) -> bool:
    """Return whether a set is a part of the first that fits by itself, and not much worse."""
    part = row is not first and holds(first.names, row.names) and row.as_stated >= rules.doubted_fit
    return part and first.explanation.log_evidence - row.explanation.log_evidence < rules.whole_beside_part


def _as_good(first: Compared, row: Compared, rules: DecisionRules) -> bool:
    """Return whether a rival that fits as well stays, though it may be behind by its prior alone.

    It does where it is not far behind, or where its fit is no greater an achievement: no more of its parameters are
    determined by the data than of the first's, and none lies at the very end of what is believed.
    """
    if row.probability > rules.rival_share * first.probability:
        return True
    apart = not holds(first.names, row.names) and not holds(row.names, first.names)
    usual = np.abs(row.explanation.best.coordinates - 0.5) < 0.5 * rules.usual_share
    return bool(apart and usual.all() and _determined(row, rules) <= _determined(first, rules))


def _determined(row: Compared, rules: DecisionRules) -> int:
    """Return how many parameters of a set the data determine: whose posterior is much narrower than their prior."""
    samples, weights = row.explanation.samples, row.explanation.weights
    mean = weights @ samples
    return int((np.sqrt(weights @ (samples - mean) ** 2) < rules.determined_spread).sum())


def included(found: Search) -> dict[str, float]:
    """Return the probability of each effect compared that it is among the causes [-]."""
    total = sum(row.probability for row in (*found.compared, *found.set_aside))
    names = dict.fromkeys(name for row in found.compared for name in row.names)
    return {
        name: sum(row.probability for row in found.compared if name in row.names) / total for name in names
    }


def rank(
    problem: DiagnosisProblem,
    titles: Sequence[str],
    found: Search,
    *,
    rules: DecisionRules = DEFAULT_RULES,
) -> tuple[Ranked, ...]:
    """Turn what was compared into rows of the ranking, the empty set left out."""
    rows = [row for row in found.compared if row.names]
    total = sum(row.probability for row in (*found.compared, *found.set_aside))
    return tuple(
        Ranked(
            effects=row.names,
            probability=row.probability / total,
            equivalents=tuple(o.names for o in rows if o is not row and _close(row, o, rules)),
            parameters=estimates(
                problem,
                row.explanation,
                row.extreme,
                most=300 if row.probability > NEGLIGIBLE_PROBABILITY else 40,
            ),
            plausible=not row.extreme,
            p_value=row.p_value,
            forms=_fixed(row.explanation),
            other_forms=tuple(_fixed(one) for one, _ in row.forms[1:] if one.names == row.names),
            set_aside=names_of(problem, titles, row.explanation.candidate.outliers),
        )
        for row in rows
    )


def _fixed(explanation: Explanation) -> tuple[Mapping[str, Any], ...]:
    """Return what the form of each effect fixes."""
    return tuple(form.values for form in explanation.candidate.forms)


def _close(a: Compared, b: Compared, rules: DecisionRules) -> bool:
    best = [row.explanation.best.marginal.log_likelihood for row in (a, b)]
    return bool(2 * abs(best[0] - best[1]) < rules.close_fits)


def estimates(
    problem: DiagnosisProblem,
    explanation: Explanation,
    extreme: Sequence[str] = (),
    *,
    most: int = 300,
    two_sided: float = 1.96,
) -> dict[str, ParameterEstimate]:
    """Return posterior median and 95 % interval of every parameter and derived quantity, and the points it means.

    Parameters
    ----------
    problem : SpecimenProblem or Several
        Test and model.
    explanation : Explanation
        A candidate with its posterior samples.
    extreme : sequence of str
        Parameters at an end of their range.
    most : int
        How many of the heaviest samples are taken: of 300 some 7 lie beyond each end of 95 %, of 40 one.
    two_sided : float
        Standard deviations to either side that hold 95 % of a normal distribution [-].
    """
    candidate = explanation.candidate
    searched = problem.parameters(candidate)
    keep = np.argsort(explanation.weights)[::-1][:most]
    weights = explanation.weights[keep] / explanation.weights[keep].sum()
    samples = [explanation.samples[i] for i in keep]
    drawn = [problem.values(candidate, u) for u in samples]
    result = {}
    for name, parameter in searched:
        low, middle, high = quantiles(np.array([d[name] for d in drawn]), weights)
        scale = two_sided * parameter.scale_doubt * middle
        low, high = (
            middle - float(np.hypot(middle - low, scale)),
            middle + float(np.hypot(high - middle, scale)),
        )
        aside = parameter.default is not None
        result[name] = ParameterEstimate(middle, parameter.unit, low, high, name in extreme, aside)
    result |= {
        name: place
        for name, place in _at_form_places(problem, candidate, two_sided).items()
        if name in drawn[0]
    }
    labels = [f"{effect.key}.{label}" for effect in candidate.effects for label in effect.labels]
    sensors = [f"{effect.key}.channel" for effect in candidate.effects if effect.of_sensor]
    own = [f"{effect.key}.{name}" for effect in candidate.effects for name in effect.named]
    stated = [(label, "node") for label in labels] + [(sensor, "channel") for sensor in sensors]
    for name, unit in [*stated, *((name, NAME) for name in own)]:
        if name in drawn[0]:
            result[name] = ParameterEstimate(drawn[0][name], unit, None, None, False)
    derived = [problem.derived(candidate, u) for u in samples]
    for name, (_, unit) in derived[0].items():
        low, middle, high = quantiles(np.array([d[name][0] for d in derived]), weights)
        result[name] = ParameterEstimate(middle, unit, low, high, at_bound=False)
    return result


def _at_form_places(
    problem: DiagnosisProblem, candidate: Candidate, two_sided: float
) -> dict[str, ParameterEstimate]:
    """Return the places that forms fix, an end or a test point, as well known as the test's points are."""
    here = problem.specimens[0]
    spec, found = here.predictor.spec, {}
    sizes = {"x": spec.length, "y": spec.width} if spec.outlined else {}
    for effect, form in zip(candidate.effects, candidate.forms, strict=True):
        for axis, size in sizes.items():
            if axis in form.values:
                at, beside = float(form.values[axis]), two_sided * here.measured.position_sigma
                low, high = max(at - beside, 0.0), min(at + beside, size)
                found[f"{effect.key}.{axis}"] = ParameterEstimate(at, "m", low, high, at_bound=False)
    return found
