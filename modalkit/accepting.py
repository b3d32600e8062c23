"""Effects as a study or the command line states them: numbers for parameters, node numbers for points."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from acquisition.errors import StudyError
from updating import LIBRARY

SOME = "points"
"""The label that takes several node numbers; any other takes one."""


def accepted_values(entry: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return name and values of one ``[[model.effect]]``.

    Parameters
    ----------
    entry : mapping
        ``name``, and a value for each parameter and each label of the effect: ``points = [3]``, ``point = 3``.

    Raises
    ------
    StudyError
        If the effect is unknown, or a value is not what it takes.
    """
    values = {key: value for key, value in entry.items() if key != "name"}
    name = entry.get("name")
    if not isinstance(name, str) or name not in LIBRARY:
        raise StudyError(f"[[model.effect]] knows no effect {name!r}; `modalkit effects` lists them")
    labels = LIBRARY[name].labels
    try:
        return name, {k: nodes(k, v) if k in labels else _number(k, v) for k, v in values.items()}
    except StudyError as error:
        raise StudyError(f"[[model.effect]] {name}: {error}") from error


def nodes(label: str, value: Any) -> int | tuple[int, ...]:
    """Return the node numbers that a label speaks of: a tuple for ``points``, one number for ``point``.

    Raises
    ------
    StudyError
        If the value is something else, or a node stands twice.
    """
    several = label == SOME
    given = list(value) if several and isinstance(value, list | tuple) else [value]
    if not given or not all(isinstance(v, int) and not isinstance(v, bool) for v in given):
        wanted = "a list of node numbers, as [3, 4]" if several else "one node number, as 3"
        raise StudyError(f"{label} = {value!r} is not {wanted}")
    if len(set(given)) < len(given):
        raise StudyError(f"{label} = {value!r} names a point twice")
    return tuple(given) if several else int(given[0])


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise StudyError(f"{name} = {value!r} must be a number")
    return float(value)
