"""Which responses belong to which force."""

from __future__ import annotations

from bisect import bisect
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from acquisition.dof import Dof
from acquisition.uff.functions.measurements import Measurement

_Label = Callable[[Measurement], object]


@dataclass(frozen=True, eq=False)
class Hit:
    """A force and the responses that belong to it, by their degree of freedom."""

    number: int
    force: Measurement
    motion: dict[Dof, Measurement]


def pair_up(forces: Sequence[Measurement], answers: dict[Dof, list[Measurement]]) -> tuple[list[Hit], str]:
    """Return the hits at one place, and what was uncertain about them.

    Numbers of hits in the ID lines decide where they tell all records of a place apart. Else the n-th force
    belongs to the n-th responses, if there are equally many of all, with a word if their order in the file is
    neither hit by hit nor channel by channel. If not, the times of day in the ID lines
    decide, or the order in the file where each force stands right before (or right behind) its responses.
    What remains is ambiguous, and left out.
    """
    counts = {len(list_) for list_ in answers.values()}
    even = counts == {len(forces)}
    for label in (_number, _file_and_number):
        hits = _by_label(forces, answers, label)
        if hits is not None:
            return hits, "" if even else "; they are paired by the hit numbers in their ID lines"
    if even and _regular(forces, answers):
        return _by_place(forces, answers), ""
    hits = _by_label(forces, answers, lambda m: m.stamp)
    if hits is not None and sum(bool(hit.motion) for hit in hits) > len(hits) / 2:
        return hits, "; they are paired by the times in their ID lines"
    if even:
        return _by_place(forces, answers), "; the n-th force is paired with the n-th responses: check it"
    hits = _by_order(forces, answers)
    if hits is not None:
        return hits, "; they are paired by their order in the file"
    return [], "; hit numbers, times and order do not show which belong together: all are left out"


def _by_place(forces: Sequence[Measurement], answers: dict[Dof, list[Measurement]]) -> list[Hit]:
    """Pair the n-th force with the n-th responses."""
    return [
        Hit(n, force, {dof: list_[n - 1] for dof, list_ in answers.items()})
        for n, force in enumerate(forces, start=1)
    ]


def _regular(forces: Sequence[Measurement], answers: dict[Dof, list[Measurement]]) -> bool:
    """Return whether all forces stand together, or equally many responses as there are channels between them."""
    motions = sorted(m.order for list_ in answers.values() for m in list_)
    between = {b - a for a, b in pairwise(bisect(motions, m.order) for m in forces)}
    return between <= {0} or between == {len(answers)}


def _number(record: Measurement) -> object:
    return record.hit.lstrip("0")


def _file_and_number(record: Measurement) -> object:
    return (record.file, record.hit) if record.hit else ""


def _by_label(
    forces: Sequence[Measurement], answers: dict[Dof, list[Measurement]], label: _Label
) -> list[Hit] | None:
    """Pair records of the same label; None if a label is missing, is given twice, or never matches."""
    lists = [list(forces), *answers.values()]
    labels = [[label(m) for m in list_] for list_ in lists]
    if any("" in names or len(set(names)) < len(names) for names in labels):
        return None
    if any(not set(names) & set(labels[0]) for names in labels[1:]):
        return None
    tables = {
        dof: dict(zip(names, answers[dof], strict=True))
        for dof, names in zip(answers, labels[1:], strict=True)
    }
    return [
        Hit(n, force, {dof: table[name] for dof, table in tables.items() if name in table})
        for n, (name, force) in enumerate(zip(labels[0], forces, strict=True), start=1)
    ]


def _by_order(forces: Sequence[Measurement], answers: dict[Dof, list[Measurement]]) -> list[Hit] | None:
    """Pair each force with the responses next to it; None unless that works out for most forces."""
    motions = [m for list_ in answers.values() for m in list_]
    ordered = sorted([*forces, *motions], key=lambda m: m.order)
    is_force = {id(m) for m in forces}
    if id(ordered[0]) not in is_force:
        ordered.reverse()
        if id(ordered[0]) not in is_force:
            return None
    groups: dict[int, list[Measurement]] = defaultdict(list)
    current = ordered[0]
    for record in ordered:
        if id(record) in is_force:
            current = record
        elif record.file == current.file:
            groups[id(current)].append(record)
    hits = []
    for number, force in enumerate(forces, start=1):
        group = groups[id(force)]
        twice = max(Counter(m.response for m in group).values(), default=0) > 1
        hits.append(Hit(number, force, {} if twice else {m.response: m for m in group}))
    return hits if sum(bool(hit.motion) for hit in hits) > len(hits) / 2 else None
