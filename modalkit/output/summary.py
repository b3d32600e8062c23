"""A diagnosis as a colleague would write it: five lines that answer, and the sentences beside the tables."""

from __future__ import annotations

import math
from collections import Counter
from itertools import combinations

import numpy as np

from acquisition.quantities import number, place, probability
from modalkit.output.forms import numbers_a_form
from modalkit.output.how_far import SHOWN, beneath, by_chance, closes, deviating, sure
from modalkit.output.mechanism import content_text, shared_text
from modalkit.output.names import is_numbered, owners
from modalkit.output.shortcomings import WORDINGS
from updating import Diagnosis
from updating.diagnosis.answer.in_no_library import SOMETHING_ELSE, SomethingElse
from updating.diagnosis.answer.ranked import Ranked
from updating.diagnosis.answer.result import NextTest
from updating.diagnosis.answer.verdict import NAME
from updating.diagnosis.answer.where import CHANNELS, acting_together
from updating.effects import Twin, in_a_set, twin_of
from updating.effects.regions import named_places

IN_THE_PLACE = frozenset({"x", "y", "z", "region"})
"""Parameters that the line on the place shows."""


NO_CAUSE = "no cause: tolerances and noise alone"
"""The row of a ranking that is the answer where there is no gap."""

LIKELY = 0.5
"""A region is named if it holds so much of the probability [-]."""


def summary_text(diagnosis: Diagnosis) -> list[str]:
    """Return five lines: what, where, how far, how sure, what next."""
    return [f"{f'{name}:':<9}{text}" for name, text in answers(diagnosis).items()]


def answers(diagnosis: Diagnosis) -> dict[str, str]:
    """Return the answer to each of the five questions."""
    return {
        "Cause": _cause(diagnosis),
        "Where": _where(diagnosis),
        "Closes": closes(diagnosis),
        "Sure": sure(diagnosis),
        "Next": _next(diagnosis),
    }


def _cause(diagnosis: Diagnosis) -> str:
    if diagnosis.verdict == "none" and (odd := deviating(diagnosis)):
        return f"no gap beyond tolerances and noise, once isolated deviations are left out: {odd}"
    if diagnosis.verdict == "none":
        certain = "" if diagnosis.suspected is None else "certain "
        if not diagnosis.comparable:
            return "no gap beyond tolerances and noise in the modes that have a partner; most have none"
        allowed = f"tolerances and noise{beneath(diagnosis)}"
        return f"no {certain}gap beyond {allowed}; {_suspected(diagnosis.suspected)}"
    if diagnosis.verdict == "unknown":
        return f"unknown: {_unknown(diagnosis)}"
    if diagnosis.verdict == "named":
        names = diagnosis.sets[0]
        library = diagnosis.known
        known = in_a_set([name for name in names if name in library], library)
        summary = " ".join(dict.fromkeys(effect.sentence(_stated(diagnosis, effect.key)) for effect in known))
        parts = [f"{' + '.join(names)}.", summary, _elsewhere(diagnosis), _values(diagnosis)]
        return " ".join(part for part in parts if part)
    if diagnosis.level == "mechanism":
        return shared_text(diagnosis)
    text = "these data cannot separate: " + ", ".join(_with_size(diagnosis, s) for s in diagnosis.sets)
    twin = _twin(diagnosis)
    return f"{text}; {twin.why}" if twin else text


def _suspected(row: Ranked | None) -> str:
    """Name what is probable though chance might make the gap; nothing where no cause is."""
    if row is None:
        return "there is nothing to explain"
    return (
        f"if there is one, its most probable cause is {' + '.join(row.effects)} "
        f"({probability(row.probability)})"
    )


def _unknown(diagnosis: Diagnosis) -> str:
    """State what the most probable set lacks to be an answer."""
    if not diagnosis.comparable:
        return (
            "most measured modes have no partner in the model, and the few that have one do not identify "
            "a cause; check axes, points, signs and boundary conditions first"
        )
    nothing = "the gap is real, and no effect or set of effects compared explains it"
    if not diagnosis.ranking:
        return nothing
    if diagnosis.mechanisms:
        return f"the gap is real; a cause outside the library explains it best: {content_text(diagnosis)}"
    first = " + ".join(diagnosis.ranking[0].effects)
    if diagnosis.lacks in (None, "fit"):
        ends = [f"{name} = {e.bare}" for name, e in diagnosis.ranking[0].parameters.items() if e.at_bound]
        if not ends or diagnosis.ranking[0].p_value < diagnosis.rules.rejected_fit:
            return nothing
        return f"the gap is real; {first} fits only at an end of its plausible range: {', '.join(ends)}"
    if diagnosis.lacks != "evidence":
        other = diagnosis.something_else if diagnosis.lacks == "library" else None
        but = WORDINGS[diagnosis.lacks].but if other is None else _of_no_library(other)
        return f"the gap is real; {first} fits best, but {but}"
    odds = f"{np.exp(diagnosis.rules.beyond_nothing):.0f} times as likely"
    aside, rival = diagnosis.set_aside, "tolerances or noise that are worse than stated"
    if aside is not None and aside.probability > by_chance(diagnosis):
        rival = f"no cause with data that are worse than stated ({', '.join(aside.data)})"
    return f"{first} would explain the gap, but is not {odds} as {rival}"


def _of_no_library(other: SomethingElse) -> str:
    """State how likely a cause is that no library has, and what it would change."""
    would = f": {', '.join(map(str, other.changes[:3]))}" if other.changes else ""
    return f"a cause outside the library has a probability of {probability(other.probability)}{would}"


def _stated(diagnosis: Diagnosis, effect: str) -> dict[str, object]:
    """Return the values of one effect of the first set, by their own names."""
    row = _row(diagnosis, diagnosis.sets[0])
    return {} if row is None else {name: e.value for name, e in row.of(effect).items()}


def _twin(diagnosis: Diagnosis) -> Twin | None:
    """Return the text on a class whose two members make one and the same change, or None."""
    if any(len(names) > 1 for names in diagnosis.sets):
        return None
    return twin_of(frozenset(diagnosis.effects))


def _row(diagnosis: Diagnosis, names: tuple[str, ...]) -> Ranked | None:
    return next((row for row in diagnosis.ranking if row.effects == names), None)


def _values(diagnosis: Diagnosis) -> str:
    """Return the sizes of a named cause, and whether they are believable."""
    row = _row(diagnosis, diagnosis.sets[0])
    if row is None:
        return ""
    stated = []
    keys = dict.fromkeys(name.rpartition(".")[0] for name in row.parameters)
    named = dict(zip(keys, (owner for owner, _ in owners(row)), strict=True))
    for name, estimate in row.parameters.items():
        effect, _, parameter = name.rpartition(".")
        if (
            estimate.aside
            or parameter in IN_THE_PLACE
            or estimate.unit == NAME
            or numbers_a_form(name, estimate)
        ):
            continue
        bare = parameter.replace("_", " ")
        several = len(row.effects) > 1 and (parameter == "factor" or len(set(row.effects)) < len(row.effects))
        whose = f"{named[effect]} " if several else ""
        stated.append(f"{whose}{bare} {estimate}" + (", the end of its range" if estimate.at_bound else ""))
    text = f"({'; '.join(stated[:SHOWN])}; 95 % in brackets)" if stated else ""
    return text if row.plausible else f"{text} This size is implausible: consider other causes, too.".strip()


MULTIPLIERS = frozenset({"factor", "gain"})
"""Parameters that multiply what the model or the data have."""


def _with_size(diagnosis: Diagnosis, names: tuple[str, ...]) -> str:
    """Return a set of effects, with where each is by name, and its size where it is one number."""
    row = _row(diagnosis, names)
    if names == (SOMETHING_ELSE,) and diagnosis.something_else is not None:
        return f"a cause outside the library ({probability(diagnosis.something_else.probability)})"
    if row is None:
        return " + ".join(names)
    text = " + ".join(name + _at(row, i) for i, name in enumerate(names))
    numbers = {key.rpartition(".")[2]: e for key, e in row.parameters.items() if e.unit != NAME}
    if len(numbers) != 1 or len(names) > 1:
        return text
    ((name, estimate),) = numbers.items()
    if not isinstance(estimate.value, float):
        return text
    if estimate.unit != "-":
        return f"{text} ({estimate.bare})"
    return f"{text} ({'x' if name in MULTIPLIERS else name.replace('_', ' ')} {estimate.bare})"


def _at(row: Ranked, index: int) -> str:
    """Return where the form of one effect of a set is, in the user's own names."""
    names = _alike(row, index)
    return f" of {' or '.join(names)}" if names else ""


def _alike(row: Ranked, index: int) -> tuple[str, ...]:
    """Return the places by name where one effect of a set may be, the most probable first: mirrored ones are alike."""
    every = [forms[index] for forms in (row.forms, *row.other_forms) if index < len(forms)]
    return tuple(dict.fromkeys(name for values in every for name in named_places(values)[:1]))[:SHOWN]


def _elsewhere(diagnosis: Diagnosis) -> str:
    """State where else an effect of a named set may be; nothing where it may be in one place only."""
    row = _row(diagnosis, diagnosis.sets[0])
    places = [] if row is None else [_alike(row, i) for i in range(len(row.effects))]
    return " ".join(
        f"{' or '.join(others)} in place of {first} fits, too."
        for first, *others in filter(None, places)
        if others
    )


def _where(diagnosis: Diagnosis) -> str:
    where = diagnosis.where
    if diagnosis.verdict == "none" and deviating(diagnosis):
        return "nowhere else: all other data agree"
    if diagnosis.suspected:
        return "no place is certain"
    if diagnosis.verdict == "none" or where.channel == "none":
        return "nowhere: all channels agree"
    if diagnosis.verdict == "unknown" and diagnosis.mechanisms:
        band = f". {where.band}" if where.band else ""
        return f"{' and '.join(f'{m.channel} {m.where}' for m in diagnosis.mechanisms[:3])}{band}"
    if diagnosis.verdict == "unknown":
        band = f"{where.band} " if where.band else ""
        return f"{band}The {where.channel} is where the best-fitting (rejected) explanations act; do not trust it."
    acting = acting_together({**dict.fromkeys(CHANNELS, 0.0), **where.channels}, rules=diagnosis.rules)
    each = " each" if len(acting) > 1 else ""
    text = f"{' and '.join(acting)} ({probability(where.channels[where.channel])}{each})"
    if where.location is None and not where.names:
        if where.channel != "measurement":
            return f"{text}, spread over the whole structure"
        return f"{text}, {_points(where.points)}" if where.points else text
    places = list(dict.fromkeys(place(at) for at in where.locations[:3]))
    if where.names and places:
        return f"{text}, {' and '.join(where.names)} (about {' and '.join(places)})"
    if where.location is None:
        return f"{text}, {' and '.join(where.names)}"
    text += ", at " + (" and ".join(places) if places else place(where.location))
    zone = min(where.zones, key=lambda z: math.dist(z.center, where.location or z.center), default=None)
    one_of_several = zone is not None and len(where.zones) > 1 and len(places) < 2
    if zone and one_of_several and not is_numbered(zone.name) and round(zone.probability, 2) >= LIKELY:
        text += f", region {zone.name}"
    if where.nearest:
        text += f" (nearest test {_points(where.nearest)})"
    beside = tuple(node for node in where.points if node not in where.nearest)
    return f"{text}; in the measurement, {_points(beside)}" if beside else text


def _points(points: tuple[int, ...]) -> str:
    return f"point{'s' if len(points) > 1 else ''} {', '.join(map(str, points))}"


def _next(diagnosis: Diagnosis) -> str:
    if diagnosis.verdict == "none" and deviating(diagnosis):
        return "repeat the deviating measurements: their points or signs may be wrong"
    if diagnosis.verdict == "none" and not diagnosis.comparable:
        return (
            "first find out why most modes have no partner in the model: points, signs, axes, units, clamps"
        )
    if diagnosis.suspected:
        return "if it matters, test again with more hits, more points and narrower tolerances"
    if diagnosis.verdict == "none":
        return "nothing; the model may be used within its tolerances"
    if diagnosis.verdict == "class" and (twin := _twin(diagnosis)):
        return twin.instead
    if diagnosis.next_test:
        test = diagnosis.next_test[0]
        if diagnosis.verdict == "unknown":
            return test.measure
        if diagnosis.verdict == "named":
            return f"{_inspection(diagnosis)}{_confirming(diagnosis, test)}"
        return f"{test.measure}: {separated(test)}"
    names = diagnosis.sets[0] if diagnosis.verdict == "named" else diagnosis.effects
    ways = "; ".join(dict.fromkeys(diagnosis.known[n].separated_by for n in names if n in diagnosis.known))
    if diagnosis.verdict == "named":
        return f"no rival is left to separate; to confirm: {ways}"
    if diagnosis.verdict == "unknown":
        return (
            "examine the modes that deviate most (below); measure more points there, and test the bare "
            "specimen"
        )
    return ways


def _inspection(diagnosis: Diagnosis) -> str:
    """Return where to look before anything is measured: at the place of a cause that sits in the structure."""
    where = diagnosis.where
    places = dict.fromkeys(place(at) for at in where.locations[:3])
    if where.channel == "measurement" or not places:
        return ""
    at = " and ".join(where.names) or f"the structure at {' and '.join(places)}"
    return f"look at {at} first; "


def _confirming(diagnosis: Diagnosis, test: NextTest) -> str:
    """Return how a named cause is confirmed: separated from the most probable other set, or why it cannot be."""
    bar = diagnosis.rules.separated_sigma
    if test.expected_sigma < bar:
        return (
            f"no available test would confirm it by {bar:g} sigma; the best is: {test.measure}: "
            f"{separated(test)}"
        )
    sentence = f"to confirm it, {test.measure}: {separated(test)}"
    named = diagnosis.sets[0]
    behind = next((row.effects for row in diagnosis.ranking if row.effects not in diagnosis.sets), named)
    if behind == named or not test.pairs or any(behind in pair for pair in test.pairs):
        return sentence
    why = ", which contains it" if not Counter(named) - Counter(behind) else ""
    return f"{sentence}; it cannot separate {' + '.join(named)} from {' + '.join(behind)}{why}"


SIZES = {1: "single causes", 2: "pairs", 3: "sets of three", 4: "sets of four"}
"""Sets of causes, by how many causes they have."""


def of_no_library_text(diagnosis: Diagnosis) -> str:
    """State how likely a cause is that is in no library, and whether the first set leaves room for one."""
    other = diagnosis.something_else
    if other is None or not diagnosis.ranking:
        return ""
    first = " + ".join(diagnosis.ranking[0].effects)
    evidence = "evidence" if other.beside > diagnosis.rules.something_left else "no evidence"
    return (
        f"a cause outside the library: {probability(other.probability)}; {evidence} for one besides {first} "
        f"(logarithm of the Bayes factor {other.beside:+.1f})"
    )


def searched_text(diagnosis: Diagnosis) -> str:
    """State how many of the possible sets of causes were searched."""
    parts = [
        f"{'all' if one.sets == one.possible else f'{one.sets} of'} {one.possible} {SIZES[one.causes]}"
        for one in diagnosis.searched
    ]
    if all(one.sets == one.possible for one in diagnosis.searched):
        return ", ".join(parts)
    return f"{', '.join(parts)}, selected by a score test; the others are not ruled out"


def separated(test: NextTest) -> str:
    """State what a test separates, and how well."""
    what = separates(test)
    if not what:
        return ""
    by = "" if math.isnan(test.expected_sigma) else f" by {number(round(test.expected_sigma))} sigma"
    return f"separates {what}{by}"


def separates(test: NextTest) -> str:
    """State what a test separates: ``E from density``; empty where it is mere advice."""
    if not test.pairs:
        return " from ".join(test.separates)
    firsts = list(dict.fromkeys(a for a, _ in test.pairs))
    seconds = list(dict.fromkeys(b for _, b in test.pairs))
    if test.whole and len(firsts) > 1:
        return "all remaining causes"
    common = [s for s in firsts + seconds if all(s in pair for pair in test.pairs)]
    if common:
        others = list(dict.fromkeys(b if a == common[0] else a for a, b in test.pairs))
        return f"{' + '.join(common[0])} from {_either(others)}"
    every = list(dict.fromkeys(firsts + seconds))
    lacking = [(a, b) for a, b in combinations(every, 2) if not {(a, b), (b, a)} & set(test.pairs)]
    if len(lacking) < len(test.pairs):
        return f"all pairs except {' and '.join(_from(pair) for pair in lacking)}"
    return "; ".join(_from(pair) for pair in test.pairs)


def _from(pair: tuple[tuple[str, ...], tuple[str, ...]]) -> str:
    return " from ".join(" + ".join(names) for names in pair)


def _either(sets: list[tuple[str, ...]]) -> str:
    listed = [" + ".join(names) for names in sets]
    return listed[0] if len(listed) == 1 else f"{', '.join(listed[:-1])} and {listed[-1]}"
