"""What an answer is worth, by the rules of the blind score, and what it says."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from cases.trial import Cause, Trial
from modalkit.blind.scoring.judge import merged
from updating import Diagnosis
from updating.diagnosis.answer.ranked import Ranked

OUTCOMES = ("right", "class", "partly", "wrong", "unknown", "none")
"""The hidden set named, with its place; a class that holds it; a part of it named; another set; and the two verdicts
without a name, where something is hidden."""


def keys_of(names: Sequence[str]) -> list[str]:
    """Return how the parameters of each effect of a set begin: a second of one name is ``name#2``."""
    seen: Counter[str] = Counter()
    keys = []
    for name in names:
        seen[name] += 1
        keys.append(name if seen[name] == 1 else f"{name}#{seen[name]}")
    return keys


def paired(row: Ranked, causes: Sequence[Cause]) -> dict[str, Cause] | None:
    """Return the hidden cause of each effect of a set, by its key; None where one is not among them."""
    left, found = list(causes), {}
    for key, name, form in zip(keys_of(row.effects), row.effects, row.forms, strict=True):
        own = next((c for c in left if name in c.names and fits(c, form)), None)
        if own is None:
            return None
        left.remove(own)
        found[key] = own
    return found


def fits(cause: Cause, form: Mapping[str, Any]) -> bool:
    """Tell whether what an answer names beside the effect is where the cause sits."""
    return not cause.places or any(stated in cause.places for stated in form.values())


def outcome(found: Diagnosis, trial: Trial) -> str:
    """Return one of :data:`OUTCOMES`."""
    if not trial.causes and found.verdict == "none":
        return "right"
    if found.verdict in ("unknown", "none"):
        return str(found.verdict)
    pairs = [paired(row_of(found, names), trial.causes) for names in found.sets]
    whole = [p is not None and len(p) == len(trial.causes) > 0 for p in pairs]
    if any(whole):
        return "right" if len({merged(names) for names in found.sets}) == 1 else "class"
    return "partly" if any(pairs) else "wrong"


def row_of(found: Diagnosis, names: Sequence[str]) -> Ranked:
    """Return the row of one of the sets of an answer."""
    return next(row for row in found.ranking if row.effects == tuple(names))


def holds(found: Diagnosis, trial: Trial) -> bool | None:
    """Tell whether the intervals hold every hidden size; None where there is none, or the answer lacks a cause."""
    sizes = [(cause, size) for cause in trial.causes for size in cause.sizes]
    for names in found.sets if sizes else ():
        row = row_of(found, names)
        pairs = paired(row, trial.causes)
        if pairs and len(pairs) == len(trial.causes):
            return all(inside(row, key, cause) for key, cause in pairs.items())
    return None


def inside(row: Ranked, key: str, cause: Cause) -> bool:
    """Tell whether the intervals of one effect hold what is true of it; what is not stated does not."""
    own = row.of(key)
    return all(
        size in own and own[size].low95 is not None and own[size].low95 <= true <= own[size].high95  # type: ignore[operator]
        for size, true in cause.sizes.items()
    )


def answered(found: Diagnosis, trial: Trial) -> str:
    """Return verdict, first sets with probability, and the sizes that were hidden or, of another set, all it states."""
    rows = [row_of(found, names) for names in found.sets] or list(found.ranking[:1])
    return f"{found.verdict}: " + (" | ".join(in_words(row, trial) for row in rows[:4]) or "-")


def in_words(row: Ranked, trial: Trial) -> str:
    """Return one set with its probability and sizes."""
    pairs = paired(row, trial.causes) or {}
    wanted = {f"{key}.{size}" for key, cause in pairs.items() for size in cause.sizes}
    named = {n: e for n, e in row.parameters.items() if n in wanted or isinstance(e.value, str | tuple)}
    stated = named or {n: e for n, e in row.parameters.items() if not e.aside}
    sizes = "; ".join(f"{name.partition('.')[2]} {estimate}" for name, estimate in stated.items())
    return f"{' + '.join(row.effects)} {row.probability:.2%} ({sizes})"


def lacking(found: Diagnosis) -> str:
    """Return what the first set leaves, and what it lacks where nothing is named."""
    lack = f"lacks {found.lacks}; " if found.lacks else ""
    left = found.remainder
    return lack + ("no remainder stated" if left is None else f"leaves {left._headline()}")
