"""How long work took, to state how long it will take: by kind and stage, kept beside the results."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from modalkit.output.whole import write_text

Stages = Sequence[tuple[str, float]]
"""Names of stages with the seconds at which they began."""

DONE = "done"
"""Name of the last entry of what is kept: when the work ended."""


def kept(file: Path, kind: str) -> Stages:
    """Return the stages of the last piece of work of a kind that was finished; none where there is none."""
    try:
        found = json.loads(file.read_text(encoding="utf-8"))[kind]
        return [(str(name), float(at)) for name, at in found]
    except (OSError, ValueError, KeyError, TypeError):
        return []


def keep(file: Path, kind: str, stages: Stages, seconds: float) -> None:
    """Record the stages of a piece of work that is finished, and how long it took [s]."""
    try:
        every = json.loads(file.read_text(encoding="utf-8"))
        every = every if isinstance(every, dict) else {}
    except (OSError, ValueError):
        every = {}
    every[kind] = [*stages, (DONE, seconds)]
    write_text(file, json.dumps(every))


def remaining(now: Stages, seconds: float, before: Stages) -> float | None:
    """Return how long work will go on by what it took before [s]; None where that is not known.

    Parameters
    ----------
    now : sequence of (str, float)
        Stages so far.
    seconds : float
        How long the work has gone on [s].
    before : sequence of (str, float)
        Those of the last time, with its end. The rest is as fast or slow as the stages so far have been.
    """
    if not before:
        return None
    start = dict(before)
    whole = before[-1][1]
    known = [stage for stage in now if stage[0] in start]  # a stage may be new, as the start of a process
    if not known:
        return max(whole - seconds, 0.0)
    name, began = known[-1]
    names = [stage for stage, _ in before]
    ended = start[names[min(names.index(name) + 1, len(names) - 1)]]
    pace = began / start[name] if min(began, start[name]) > 1.0 else 1.0
    rest = pace * (whole - ended)
    return max(pace * (ended - start[name]) - (seconds - began), 0.0) + rest
