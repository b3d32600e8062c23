"""From a row of a diagnosis to the effects that a study puts into its model."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from updating import LIBRARY
from updating.prediction.predict import Predictor


def accepted_entries(row: Mapping[str, Any], predictor: Predictor) -> list[dict[str, Any]]:
    """Return the entries of ``[[model.effect]]`` that a row of the ranking is.

    Parameters
    ----------
    row : mapping
        As the document of a diagnosis has it; what only follows from the parameters is left out.
    predictor : Predictor
        The model it was found on.
    """
    entries = []
    seen: dict[str, int] = {}
    for name in row["effects"]:
        seen[name] = seen.get(name, 0) + 1
        key = name if seen[name] == 1 else f"{name}#{seen[name]}"
        effect = LIBRARY[name]
        takes = {p.name for p in effect.parameters(predictor)} | set(effect.labels) | {"channel"}
        values = {
            parameter: estimate["value"]
            for whole, estimate in row["parameters"].items()
            for own, _, parameter in [whole.rpartition(".")]
            if own == key and parameter in takes
        }
        entries.append({"name": name} | values)
    return entries
