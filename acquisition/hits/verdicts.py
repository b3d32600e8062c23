"""Verdicts on hits: what was proposed, what the user decided, and which hits are used in the end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from acquisition.dof import Dof
from acquisition.errors import InputError
from acquisition.hits.hammer import HammerTest
from acquisition.quantities import hertz


@dataclass(frozen=True, kw_only=True)
class HitVerdict:
    """What is thought of a hit.

    Parameters
    ----------
    point : Dof
        Where the hammer hit.
    hit : int
        Number of the hit at this point, from 1; numbered through where the point was hit in several runs.
    used : bool
        Whether it should be used: the program's proposal, or the user's decision (see `decide`).
    reasons : tuple of str
        Why not, and other notes on it.
    peak : float
        Largest force [N].
    width : float
        Length of the pulse above a tenth of its peak [s].
    band10, band20 : float
        Frequencies at which the force spectrum is 10 and 20 dB down [Hz].
    kind : str
        Kind of the first fault found in it; empty if none does.
    """

    point: Dof
    hit: int
    used: bool
    reasons: tuple[str, ...]
    peak: float
    width: float
    band10: float
    band20: float
    kind: str = ""


@dataclass(frozen=True)
class ForceRange:
    """What the forces of the used hits have in common.

    Parameters
    ----------
    weakest, strongest : float
        Peaks [N].
    width : float
        Median length of the pulses above a tenth of their peak [s].
    band10, band20 : float
        Median frequencies at which the force spectrum is 10 and 20 dB down [Hz].
    """

    weakest: float
    strongest: float
    width: float
    band10: float
    band20: float

    def __str__(self) -> str:
        """Return it in one line."""
        return (
            f"peaks of {self.weakest:.3g} to {self.strongest:.3g} N, pulses of {1e3 * self.width:.3g} ms, "
            f"10 dB down at {hertz(self.band10)}, 20 dB down at {hertz(self.band20)}"
        )


def force_range(verdicts: Iterable[HitVerdict]) -> ForceRange | None:
    """Return what the forces of the used hits have in common; None if no hit is used."""
    used = [v for v in verdicts if v.used]
    if not used:
        return None
    peaks = [v.peak for v in used]
    width, band10, band20 = np.median([(v.width, v.band10, v.band20) for v in used], axis=0)
    return ForceRange(min(peaks), max(peaks), float(width), float(band10), float(band20))


def usual_fault(verdicts: Iterable[HitVerdict]) -> tuple[int, str] | None:
    """Return how many hits are refused for the most frequent kind of fault, and the first of their reasons."""
    refused = [v for v in verdicts if not v.used and v.reasons]
    if not refused:
        return None
    ((kind, count),) = Counter(v.kind for v in refused).most_common(1)
    return count, next(v.reasons[0] for v in refused if v.kind == kind)


def verdicts_of(test: HammerTest, verdicts: Sequence[HitVerdict]) -> list[list[HitVerdict | None]]:
    """Return the verdict on each hit of each entry of ``test.points``; None where there is none.

    Where there are as many verdicts at a point as hits, they go to its runs in order; else a hit finds its
    verdict by its number, runs of the same point numbered through.

    Parameters
    ----------
    test : HammerTest
        The records.
    verdicts : sequence of HitVerdict
        On all of its hits, or on some.
    """
    stated: dict[Dof, list[HitVerdict]] = {}
    for verdict in verdicts:
        stated.setdefault(verdict.point, []).append(verdict)
    count = dict.fromkeys((p.reference for p in test.points), 0)
    for point in test.points:
        count[point.reference] += point.count
    seen = dict.fromkeys(count, 0)
    answer: list[list[HitVerdict | None]] = []
    for point in test.points:
        there, first = stated.get(point.reference, []), seen[point.reference]
        numbers = {v.hit: v for v in there}
        if len(there) == count[point.reference]:
            ordered = sorted(there, key=lambda v: v.hit) if len(numbers) == len(there) else there
            answer.append([ordered[first + k] for k in range(point.count)])
        else:
            answer.append([numbers.get(first + k + 1) for k in range(point.count)])
        seen[point.reference] += point.count
    return answer


def decide(
    verdicts: Iterable[HitVerdict],
    *,
    use: Iterable[tuple[Dof | str, int]] = (),
    leave: Iterable[tuple[Dof | str, int]] = (),
) -> tuple[HitVerdict, ...]:
    """Return the verdicts with the user's decisions in place of the program's proposals.

    Parameters
    ----------
    verdicts : iterable of HitVerdict
        The proposals.
    use, leave : iterables of (Dof or str, int)
        Hits to use or to leave out whatever was proposed: the point, as a degree of freedom or as printed
        (``"12+Z"``), and the number of the hit at it, from 1. The reasons stay listed.

    Raises
    ------
    InputError
        If there is no such hit, or one is named in both lists.
    """
    proposals = tuple(verdicts)
    known = {(str(v.point), v.hit) for v in proposals}
    wanted, unwanted = _named(use, known), _named(leave, known)
    if wanted & unwanted:
        point, hit = min(wanted & unwanted)
        raise InputError(f"hit {hit} at {point} is listed under both use and leave; remove it from one")
    decided = []
    for v in proposals:
        name = (str(v.point), v.hit)
        if name in wanted:
            reasons = v.reasons if v.used else (*v.reasons, "used by the user's decision")
            decided.append(replace(v, used=True, reasons=reasons))
        elif name in unwanted:
            reason = "left out by the user" + ("" if v.used else ", who agrees")
            decided.append(replace(v, used=False, reasons=(*v.reasons, reason)))
        else:
            decided.append(v)
    return tuple(decided)


def _named(hits: Iterable[tuple[Dof | str, int]], known: set[tuple[str, int]]) -> set[tuple[str, int]]:
    names = {(str(point).strip().upper(), int(hit)) for point, hit in hits}
    for point, hit in sorted(names - known):
        numbers = sorted(h for p, h in known if p == point)
        points = ", ".join(sorted({p for p, _ in known})[:8])
        there = f"hits there: 1 to {numbers[-1]}" if numbers else f"points hit are {points}"
        raise InputError(f"there is no hit {hit} at {point}; {there}; write a point like 12+Z or 3-X")
    return names


def hits_table(verdicts: Iterable[HitVerdict]) -> pd.DataFrame:
    """Return one row per hit: point, used, reasons, peak [N], width [ms], 10 and 20 dB bands [Hz]."""
    return pd.DataFrame(
        [
            [str(v.point), v.hit, v.used, "; ".join(v.reasons), v.peak, 1e3 * v.width, v.band10, v.band20]
            for v in verdicts
        ],
        columns=[
            "point",
            "hit",
            "used",
            "reasons",
            "peak [N]",
            "width [ms]",
            "band 10 dB [Hz]",
            "band 20 dB [Hz]",
        ],
    )


def rejected_points(verdicts: Sequence[HitVerdict]) -> tuple[Dof, ...]:
    """Return the points at which no hit is used."""
    used = {v.point for v in verdicts if v.used}
    return tuple(dict.fromkeys(v.point for v in verdicts if v.point not in used))
