"""Right, partly or wrong: the rules by which an answer about a real structure is judged."""

from __future__ import annotations

import math
from dataclasses import dataclass

from modalkit.blind.answer import Answer, Estimate
from modalkit.output.schemas.diagnosis import SOMETHING_ELSE
from modalkit.papers.real.case import Case, Fact

RULES = """\
* right: it names a set of effects that is true, or a class that holds a true set and otherwise only sets
  that these data cannot separate from it; a cause outside the library in the class does not count;
* partly: it answers `unknown` where the library has the effect; or names only a part of the truth (not a
  factor that stands beside it); or holds a true set beside a false one; or is right except for a known
  number outside its 95 % interval, or for the place;
* wrong: it names something else, answers `none` where something is, or anything but `none` where nothing is;
* with the effect left out of the library: `unknown` is right, and so is the same effect under another
  name; the latter beside others, or with something added, is partly right; anything else is wrong.
"""


@dataclass(frozen=True)
class Judgement:
    """How an answer is judged.

    Parameters
    ----------
    grade : {"right", "partly", "wrong"}
        By the rules.
    reason : str
        Which of them.
    """

    grade: str
    reason: str


def judge(case: Case, answer: Answer) -> Judgement:
    """Judge an answer.

    Parameters
    ----------
    case : Case
        What is known.
    answer : Answer
        The answer.

    Returns
    -------
    Judgement
        The grade with its reason.
    """
    if frozenset() in case.accepted:
        return _of_nothing(answer)
    if answer.verdict == "none":
        return Judgement("wrong", "states that nothing is missing")
    if case.removed:
        return _of_left_out(case, answer)
    if answer.verdict == "unknown":
        return Judgement("partly", "sees a gap and names nothing")
    return _of_effects(case, answer)


def _of_nothing(answer: Answer) -> Judgement:
    if answer.verdict == "none":
        return Judgement("right", "nothing is missing, nothing is named")
    return Judgement("wrong", "a false alarm")


def _of_library(answer: Answer) -> list[frozenset[str]]:
    """Return the sets of an answer but that of a cause in no library."""
    return [one for one in answer.sets if one != frozenset({SOMETHING_ELSE})]


def _of_left_out(case: Case, answer: Answer) -> Judgement:
    if answer.verdict == "unknown":
        return Judgement("right", "unknown")
    sets = _of_library(answer)
    if sets and all(s in case.stands_in for s in sets):
        return Judgement("right", "the same under another name")
    if any(stand_in <= s for s in answer.sets for stand_in in case.stands_in):
        return Judgement("partly", "a stand-in beside others, or with something added")
    return Judgement("wrong", "a cause that it is not")


def _of_effects(case: Case, answer: Answer) -> Judgement:
    sets = _of_library(answer)
    true = [s for s in sets if s in case.accepted]
    if not true:
        if any(s & _core(case) for s in sets):
            return Judgement("partly", "a part of the truth")
        return Judgement("wrong", "a cause that it is not")
    if any(s not in case.accepted and s not in case.equivalent for s in sets):
        return Judgement("partly", "the truth beside something else")
    return _of_numbers(case, answer)


def _core(case: Case) -> frozenset[str]:
    """Return the effects in every accepted set; where there is none, those of the sets that hold no other one.

    What only stands beside a cause in some of them is no part of the truth by itself.
    """
    least = [s for s in case.accepted if not any(other < s for other in case.accepted)]
    return frozenset.intersection(*case.accepted) or frozenset().union(*least)


def _of_numbers(case: Case, answer: Answer) -> Judgement:
    missed = [fact.text for fact, estimate in estimates(case, answer) if not covers(estimate, fact)]
    if missed:
        return Judgement("partly", f"not within its interval: {', '.join(missed)}")
    if case.places and not points_to(case, answer):
        return Judgement("partly", "points to another place")
    return Judgement("right", "the cause" if len(answer.sets) == 1 else "in a class of what looks the same")


def estimates(case: Case, answer: Answer) -> list[tuple[Fact, Estimate]]:
    """Return the known numbers with their values in the most probable true set."""
    row = next((row for row in answer.ranking if row.effects in case.accepted), None)
    stated = {} if row is None else row.parameters
    return [(fact, stated[fact.parameter]) for fact in case.facts if fact.parameter in stated]


def covers(estimate: Estimate, fact: Fact) -> bool:
    """Return whether a 95 % interval reaches what is known."""
    if math.isnan(estimate.low) or math.isnan(estimate.high):
        return fact.low <= estimate.value <= fact.high
    return estimate.low <= fact.high and fact.low <= estimate.high


def points_to(case: Case, answer: Answer) -> bool:
    """Return whether one of the places of an answer lies where it should."""
    return any(low <= x <= high for low, high in case.places for x, _ in answer.locations)
