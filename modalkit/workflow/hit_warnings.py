"""Warnings on hits before their FRFs are used."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from acquisition import FrfSet, HammerTest, HitVerdict, rejected_points, unstated_window
from acquisition.frfs.estimators import kept_hits
from acquisition.hits.checks import agreement
from acquisition.warned import Consequential

NAMED = 8
"""Most points listed in a message."""

DROP = 0.1
"""Mean coherence by which an FRF falls behind the others of its response before it is named; at half of it points
that simply move little are named as well [-]."""

TIMES = 3.0
"""Times what the others lack of full coherence (the median) that it must lack; doubled, one clipped hit of four
passes [-]."""

OTHERS = 3
"""FRFs of the same response to compare with, at least; of two, it is not clear which is odd [-]."""

MENDED = 0.5
"""Part of the missing coherence that must come back without a hit before that hit is named [-]."""


def on_hits(judged: Sequence[tuple[HammerTest, Sequence[HitVerdict]]]) -> list[str]:
    """Return warnings on points without hits, with a single one, and on dead responses.

    Parameters
    ----------
    judged : sequence of (HammerTest, verdicts)
        All tests of the files, with what was decided on their hits.
    """
    every = [v for _, verdicts in judged for v in verdicts]
    notes = []
    lost = [str(point) for point in rejected_points(every)]
    if lost:
        notes.append(f"no hit is used at {_listed(lost)}: left out; accept hits by hand or hit again")
    notes += _single(judged)
    return notes + _dead(judged)


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
        f"only one usable hit at {where}: coherence and scatter of the hits are therefore unknown at every "
        "point; hit there again, or leave the point out"
    ]


def _dead(judged: Sequence[tuple[HammerTest, Sequence[HitVerdict]]]) -> list[str]:
    alive: dict[str, bool] = {}
    for test, _ in judged:
        for hits in test.points:
            for dof, moves in zip(hits.responses, np.ptp(hits.motion, axis=-1).any(axis=0), strict=True):
                alive[str(dof)] = alive.get(str(dof), False) or bool(moves)
    dead = [name for name, moves in alive.items() if not moves]
    return [f"response {_listed(dead)} is dead in every hit: check its channel"] if dead else []


def on_coherence(frfs: FrfSet, judged: Sequence[tuple[HammerTest, Sequence[HitVerdict]]] = ()) -> list[str]:
    """Return a warning on each FRF whose coherence is far below that of the others of the same response.

    Parameters
    ----------
    frfs : FrfSet
        FRFs of a test.
    judged : sequence of (HammerTest, verdicts)
        The hits they were estimated from, where there are any; a hit that alone spoils the coherence is named.
    """
    if frfs.coherence is None or frfs.averages is None:
        return []
    mean, count = np.asarray(frfs.coherence).mean(axis=1), np.asarray(frfs.averages)
    lacking = (1 - mean) * count / np.maximum(count - 1, 1)  # few averages make coherence too high
    notes: list[str] = []
    for row, response in enumerate(frfs.responses):
        rows = [i for i, dof in enumerate(frfs.responses) if dof == response and i != row]
        if len(rows) < OTHERS or lacking[row] < max(
            TIMES * np.median(lacking[rows]), lacking[rows].max() + DROP
        ):
            continue
        where = f"{response}/{frfs.references[row]}"
        text = (
            f"the mean coherence of {where} is {mean[row]:.2f}, that of the other FRFs of {response} "
            f"{mean[rows].min():.2f} to {mean[rows].max():.2f}: {_culprit(str(frfs.references[row]), judged)}"
        )
        notes.append(Consequential(text))
    return notes


def _culprit(point: str, judged: Sequence[tuple[HammerTest, Sequence[HitVerdict]]]) -> str:
    """Return which hit at a point spoils the coherence of the others, or what else may."""
    for test, verdicts in judged:
        used = [v for v in verdicts if str(v.point) == point and v.used]
        kept = [
            (p, np.flatnonzero(k).tolist()) for p, k in kept_hits(test, verdicts) if str(p.reference) == point
        ]
        if len(kept) != 1 or len(used) < OTHERS or len(used) != len(kept[0][1]):
            continue
        hits, rows = kept[0]
        whole = agreement(hits, rows, 0.5)
        without = [agreement(hits, [r for r in rows if r != row], 0.5) for row in rows]
        best = int(np.argmax(without))
        if without[best] > whole + MENDED * (1 - whole):
            hit = used[best].hit
            return (
                f"hit {hit} disagrees with the others at this point (coherence without it: {without[best]:.2f}), as if "
                f"its force were clipped; check its record, and leave it out with --leave {point}:{hit}"
            )
    return "the hits at this point scatter in place, one of them is clipped, or the response is small"


def on_window(test: HammerTest) -> list[str]:
    """Return a warning if the noise of the force shows an exponential window that is not stated.

    Parameters
    ----------
    test : HammerTest
        Records as they were stored.
    """
    decay = unstated_window(test)
    if decay is None:
        return []
    text = (
        f"{test.source}: the force (its noise, or the tops of clipped hits) decays at {decay:.3g} 1/s: an exponential "
        "window seems to have been applied, which makes every damping too high; state it with --decay or "
        "exponential_window"
    )
    return [Consequential(text)]


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more
