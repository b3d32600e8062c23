"""Whether an answer is true, and what it is worth where it is a class."""

from __future__ import annotations

from collections.abc import Collection

from modalkit.blind.answer import Answer
from modalkit.blind.trial import Truth
from modalkit.output.schemas.diagnosis import SOMETHING_ELSE

SAME = (
    frozenset({"calibration_gain", "section_scale"}),
    frozenset({"exponential_window", "uniform_damping"}),
)
"""Names of one and the same change of the data: to give all of a group is to give one answer."""

_FIRST = {name: min(group) for group in SAME for name in group}


def sort_of(truth: Truth) -> str:
    """Return what kind of question a trial asks: none, effect, pair, outside or left out."""
    if not truth.effects:
        return "none"
    if truth.without:
        return "left out"
    if not truth.in_library:
        return "outside"
    return "effect" if len(truth.effects) == 1 else "pair"


def label(effects: Collection[str]) -> str:
    """Return the name of a set of effects: ``a + b``, and ``none`` for the empty one."""
    return " + ".join(sorted(effects)) or "none"


def merged(effects: Collection[str]) -> frozenset[str]:
    """Return a set with names of the same change replaced by one of them."""
    return frozenset(_FIRST.get(name, name) for name in effects)


def accepted(effects: Collection[str], truth: Truth) -> bool:
    """Return whether a set is a right answer; it must be the whole set, and a cause in no library where it is that."""
    if tuple(effects) == (SOMETHING_ELSE,):
        return sort_of(truth) in ("outside", "left out")
    return tuple(sorted(effects)) in truth.accepted


def holds(answer: Answer, truth: Truth) -> bool:
    """Return whether the named set or one of the class is a right answer."""
    return answer.verdict in ("named", "class") and any(accepted(s, truth) for s in answer.sets)


def credit(answer: Answer, truth: Truth) -> float:
    """Return the chance that one set picked blindly from the answer is right.

    A class that lists everything that was compared is not informative, and gets no credit.
    """
    if answer.verdict in ("unknown", "none"):
        return float(is_right(answer, truth))
    if not answer.sets or (1 < len(answer.ranking) <= len(answer.sets)):
        return 0.0
    return sum(accepted(s, truth) for s in answer.sets) / len(answer.sets)


def is_right(answer: Answer, truth: Truth) -> bool:
    """Return whether the answer is true.

    That is: the effect named or in the class; ``none`` for none; for effects that the diagnosis cannot know,
    ``unknown`` or an honest equivalent.
    """
    if not truth.effects:
        return answer.verdict == "none"
    if sort_of(truth) in ("outside", "left out") and answer.verdict == "unknown":
        return True
    return holds(answer, truth)


def top_is_right(answer: Answer, truth: Truth) -> bool:
    """Return whether the most probable answer is the truth: none, unknown, or the first set of the ranking."""
    best = answer.best
    return is_right(answer, truth) if best is None else accepted(best.effects, truth)


def commits(answer: Answer) -> bool:
    """Return whether the answer is a single one: one set, or several that are the same change of the data."""
    return answer.verdict in ("named", "class") and len({merged(s) for s in answer.sets}) == 1
