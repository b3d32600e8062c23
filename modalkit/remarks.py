"""What the user ought to know of hits before their FRFs are used."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition import HammerTest, HitVerdict, rejected_points, unstated_window
from acquisition.estimators import kept_hits

NAMED = 8
"""Most points listed in a message."""


def on_hits(judged: Sequence[tuple[HammerTest, Sequence[HitVerdict]]]) -> list[str]:
    """Return remarks on points without hits, with a single one, and on dead responses.

    Parameters
    ----------
    judged : sequence of (HammerTest, verdicts)
        All tests of the files, with what was decided on their hits.
    """
    every = [v for _, verdicts in judged for v in verdicts]
    remarks = []
    lost = [str(point) for point in rejected_points(every)]
    if lost:
        remarks.append(f"no hit is used at {_listed(lost)}: left out; accept hits by hand or hit again")
    remarks += _single(judged)
    return remarks + _dead(judged)


def _single(judged: Sequence[tuple[HammerTest, Sequence[HitVerdict]]]) -> list[str]:
    counts = [
        (str(hits.reference), int(mask.sum()))
        for test, verdicts in judged
        if any(v.used for v in verdicts)
        for hits, mask in kept_hits(test, verdicts)
    ]
    alone = list(dict.fromkeys(name for name, count in counts if count == 1))
    if not alone:
        return []
    where = "every point" if all(count == 1 for _, count in counts) else _listed(alone)
    return [
        f"a single usable hit at {where}: so no coherence and no scatter of hits are known, at no point; hit there "
        "again, or leave the point out"
    ]


def _dead(judged: Sequence[tuple[HammerTest, Sequence[HitVerdict]]]) -> list[str]:
    alive: dict[str, bool] = {}
    for test, _ in judged:
        for hits in test.points:
            for dof, moves in zip(hits.responses, np.ptp(hits.motion, axis=-1).any(axis=0), strict=True):
                alive[str(dof)] = alive.get(str(dof), False) or bool(moves)
    dead = [name for name, moves in alive.items() if not moves]
    return [f"response {_listed(dead)} is dead in every hit: check its channel"] if dead else []


def on_window(test: HammerTest) -> list[str]:
    """Return a remark if the noise of the force shows an exponential window that nobody stated.

    Parameters
    ----------
    test : HammerTest
        Records as they were stored.
    """
    decay = unstated_window(test)
    if decay is None:
        return []
    return [
        f"{test.source}: the noise of the force decays at {decay:.3g} 1/s: an exponential window seems to have been "
        "applied; state it with --decay or exponential_window"
    ]


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more
