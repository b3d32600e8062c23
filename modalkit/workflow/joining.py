"""Several FRF sets as one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from acquisition import FrfSet, HitScatter, InputError
from acquisition.frfs.frf import Record

MAX_UNCOMMON = 1e-6
"""Frequency axes that differ by more than this, relative to their end, do not go together."""


def together(sets: Sequence[FrfSet]) -> FrfSet:
    """Join FRF sets on one frequency axis.

    Raises
    ------
    InputError
        If their axes, forms or windows differ.
    """
    first = sets[0]
    for other in sets[1:]:
        _check(first, other)
    if len(sets) == 1:
        return first
    joined = {
        name: None
        if any(getattr(s, name) is None for s in sets)
        else np.concatenate([getattr(s, name) for s in sets])
        for name in ("values", "coherence", "variance", "averages")
    }
    return replace(
        first,
        responses=tuple(d for s in sets for d in s.responses),
        references=tuple(d for s in sets for d in s.references),
        scatter=HitScatter.joined([s.scatter for s in sets], [len(s.responses) for s in sets]),
        record=_record(sets),
        **joined,  # type: ignore[arg-type]
    )


def _record(sets: Sequence[FrfSet]) -> Record | None:
    """Return what the records have in common, hits at their mean place over the FRFs."""
    records = [s.record for s in sets if s.record is not None]
    if len(records) < len(sets):
        return None
    place = np.average([r.trigger for r in records], weights=[len(s.responses) for s in sets])
    return replace(records[0], trigger=float(place))


def _check(first: FrfSet, other: FrfSet) -> None:
    same = len(other.frequency) == len(first.frequency) and np.allclose(
        other.frequency, first.frequency, rtol=MAX_UNCOMMON, atol=0
    )
    durations = [1 / s.df if s.record is None else s.record.duration for s in (first, other)]
    same &= abs(durations[0] - durations[1]) <= MAX_UNCOMMON * durations[0]
    if not same or other.form != first.form or other.decay != first.decay:
        raise InputError(
            f"{first.source}: the hits were recorded with different rates, lengths, quantities or windows "
            f"({_stated(first, durations[0])}; {_stated(other, durations[1])}); process them as separate tests"
        )


def _stated(one: FrfSet, duration: float) -> str:
    window = f", window of {one.decay:g} 1/s" if one.decay else ""
    points = list(dict.fromkeys(map(str, one.references)))
    where = ", ".join(points[:3]) + (", ..." if len(points) > 3 else "")
    return f"{one.source}, {where}: {one.form} to {one.frequency[-1]:g} Hz from {duration:g} s{window}"
