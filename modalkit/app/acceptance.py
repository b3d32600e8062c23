"""From a row of a diagnosis to the effects that a study puts into its model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from acquisition.errors import InputError
from modalkit.study.stated_effects import BEFORE
from updating import LIBRARY
from updating.effects import names_of
from updating.prediction.predict import Predictor


def acceptable(effects: Sequence[str]) -> bool:
    """Return whether the effects of a row can be put into the model: there are some, and none is a hypothesis."""
    return bool(effects) and all(name in LIBRARY for name in effects)


def accepted_entries(
    row: Mapping[str, Any], predictor: Predictor, *, since_baseline: bool = False
) -> list[dict[str, Any]]:
    """Return the entries of ``[[model.effect]]`` that a row of the ranking is.

    Parameters
    ----------
    row : mapping
        As the document of a diagnosis has it; what only follows from the parameters is left out.
    predictor : Predictor
        The model it was found on.
    since_baseline : bool
        Whether it was found beside a baseline, so that it came afterwards.

    Raises
    ------
    InputError
        If a hypothesis is among them.
    """
    if not acceptable(row["effects"]):
        own = next(name for name in row["effects"] if name not in LIBRARY)
        raise InputError(
            f"{own!r} is a hypothesis of the study, and hypotheses cannot be put into the model; change its deck or "
            "matrices"
        )
    entries = []
    seen: dict[str, int] = {}
    for name in row["effects"]:
        seen[name] = seen.get(name, 0) + 1
        key = name if seen[name] == 1 else f"{name}#{seen[name]}"
        effect = LIBRARY[name]
        takes = {p.name for p in effect.parameters(predictor)} | set(effect.labels) | {"channel"}
        takes |= names_of(effect, predictor.spec)
        values = {
            parameter: estimate["value"]
            for whole, estimate in row["parameters"].items()
            for own, _, parameter in [whole.rpartition(".")]
            if own == key and parameter in takes
        }
        entries.append({"name": name} | values | ({BEFORE: False} if since_baseline else {}))
    return entries
