"""FRFs of another mounting: a minority whose sharp peaks lie where no other FRF has any.

A drift is a course over the measuring order, and what each point has for itself scatters about it. An FRF whose peaks
lie far beside both was measured on another structure: with a heavy sensor, another clamp, in another file. As part of
the fit it would pull the common poles, so it is found before any pole is, by where its peaks are.

Only FRFs of the same directions are compared, as others may show other modes. Peaks that are no sharper than what is
about them overlap, and are left to the random shifts of :mod:`identification.fit.drift`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy import signal, stats
from scipy.ndimage import uniform_filter1d

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from acquisition.quantities import hertz
from acquisition.warned import Consequential
from identification.arrangement import unsigned
from identification.fit.drift import LARGEST, measuring_order

FEWEST = 4
"""Sets of FRFs under which none is set aside [-]: of three, two may be wrong."""

ABOUT = 0.2
"""Part of its frequency on both sides of a line over which its surroundings are taken [-]. Doubled: an octave counts as
surroundings; halved: peaks of 0.6 % damping go unnoticed."""

CLEAR = 5.0
"""Magnitude of a peak over the geometric mean about it [-]: noise alone exceeds it at one line in a million."""

SHOWN = 0.5
"""Part of a clear peak's height on a logarithmic scale from which another FRF shows it too; peaks are searched down to
it [-]."""

CHANCE = 1e-4
"""Chance by which the scatter of an even test sets an FRF aside [-]. Ten times as much finds contradictions a quarter
smaller among five FRFs, no others among twenty."""


@dataclass(frozen=True, eq=False)
class Foreign:
    """FRFs that contradict the others, and what both show.

    Parameters
    ----------
    rows : (n_frf,) bool array
        Which FRFs contradict the others.
    names : tuple of str
        Response and reference of each of these.
    shown, common : tuple of float
        Clear peaks of these, and of most of the others [Hz].
    """

    rows: BoolArray
    names: tuple[str, ...] = ()
    shown: tuple[float, ...] = ()
    common: tuple[float, ...] = ()

    @property
    def warnings(self) -> tuple[str, ...]:
        """The warning about them; empty where there are none."""
        if not self.names:
            return ()
        text = (
            f"{len(self.names)} of {len(self.rows)} FRFs contradict the others and are set aside: "
            f"{', '.join(self.names)}. They peak at {_listed(self.shown)}, the others at {_listed(self.common)}: "
            "another mounting or another structure. Measure them again, or identify them from a file of their own"
        )
        return (Consequential(text),)

    @property
    def reasons(self) -> tuple[str, ...]:
        """One line per FRF that is set aside."""
        why = f"the FRF contradicts the others; it peaks at {_listed(self.shown)}"
        return tuple(f"{name}: {why}" for name in self.names)


@dataclass(frozen=True, eq=False)
class _Peaks:
    """Peaks of one set of FRFs, or those of them that are clear.

    Parameters
    ----------
    place : (n,) array
        Where they are [ln Hz].
    reach : (n,) array
        How near another must lie to be the same: half of the half-power width [-].
    above : (n,) array
        Logarithm of their magnitude over what is about them [-].
    """

    place: FloatArray
    reach: FloatArray
    above: FloatArray

    @cached_property
    def clear(self) -> _Peaks:
        """Those that no noise makes."""
        kept = self.above >= np.log(CLEAR)
        return _Peaks(self.place[kept], self.reach[kept], self.above[kept])

    def shared(self, other: _Peaks) -> BoolArray:
        """Return which of these peaks the other set has too, half as high on the logarithmic scale or more, (n,)."""
        near = np.abs(self.place[:, None] - other.place) <= np.minimum(self.reach[:, None], other.reach)
        return np.asarray((near & (other.above >= SHOWN * self.above[:, None])).any(axis=1))


def foreign_frfs(frfs: FrfSet) -> Foreign:
    """Return the minority of FRFs that contradicts the others.

    Sets of FRFs that share half of their clear peaks belong together, and so do those that a third set links, as in a
    drift, and those to which a course over measuring order leads by steps like its last. Outside the largest group of
    such sets, which must hold most of them, a set is foreign if fewer than half of its peaks lie where a line over
    measuring order, through those of this group, and the scatter of all modes about such lines allow a further one.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs in the band; those that drift by more than the width of peaks brought together before.
    """
    order, kind = measuring_order(frfs), _directions(frfs)
    foreign = np.zeros(len(frfs.values), dtype=np.bool_)
    shown, common = [], []
    for one in np.unique(kind):
        sets = np.unique(order[kind == one])
        peaks = [_peaks(frfs, np.flatnonzero((order == s) & (kind == one))) for s in sets]
        known = np.flatnonzero([len(p.clear.place) for p in peaks]).tolist()
        together = np.array(known, dtype=np.int64)[_largest([peaks[k] for k in known])]
        main = _along_course(together, known, peaks)
        if len(known) < FEWEST or 2 * len(main) <= len(known):
            continue
        odd = [k for k in known if k not in main and _contradicts(k, peaks, main)]
        foreign |= np.isin(order, sets[odd]) & (kind == one)
        if odd:
            shown += [peaks[k].clear for k in odd]
            common += [peaks[k].clear for k in main]
    names = tuple(f"{frfs.responses[i]}/{frfs.references[i]}" for i in np.flatnonzero(foreign))
    return Foreign(foreign, names, _places(shown), _places(common))


def _directions(frfs: FrfSet) -> IntArray:
    """Return a number for the pair of directions of each FRF, signs left out, (n_frf,)."""
    pairs = [
        (unsigned(r).direction, unsigned(q).direction)
        for r, q in zip(frfs.responses, frfs.references, strict=True)
    ]
    return np.asarray(np.unique(np.array(pairs), axis=0, return_inverse=True)[1]).ravel()


def _peaks(frfs: FrfSet, rows: IntArray) -> _Peaks:
    """Return the clear peaks of FRFs that were measured together."""
    power = np.abs(frfs.values[rows]) ** 2
    size = np.sqrt(np.mean(power / power.mean(axis=1, keepdims=True), axis=0))
    log = np.log(frfs.frequency)
    grid = np.arange(log[0], log[-1], frfs.df / float(frfs.frequency[-1]))
    level = np.interp(grid, log, np.log(np.maximum(size, np.finfo(float).tiny)))
    if len(grid) < 3:
        return _Peaks(*np.zeros((3, 0)))
    step = grid[1] - grid[0]
    above = level - uniform_filter1d(level, 2 * round(ABOUT / step) + 1, mode="nearest")
    at, _ = signal.find_peaks(above, height=0.0, prominence=SHOWN * np.log(CLEAR))
    width = signal.peak_widths(np.exp(above), at, rel_height=1.0 - np.sqrt(0.5))[0] * step
    unit = frfs.values[rows] / np.sqrt(power.mean(axis=1, keepdims=True))
    poles = np.array([_pole(frfs, unit, g, w) for g, w in zip(grid[at], width, strict=True)], complex)
    here = (poles.real < 0) & (np.abs(np.log(np.maximum(poles.imag, 1e-9) / (2 * np.pi)) - grid[at]) <= width)
    poles, kept = poles[here], at[here]
    return _Peaks(np.log(poles.imag / (2 * np.pi)), np.abs(poles.real) / poles.imag, above[kept])


def _pole(frfs: FrfSet, values: ComplexArray, place: float, width: float) -> complex:
    """Return the pole of the lines about a peak [rad/s], found far closer than to a line.

    There s H = p H + a + b s in each FRF: what of H is no straight line over s gives p by least squares.

    Parameters
    ----------
    frfs : FrfSet
        The FRFs.
    values : (n, n_lines) array
        Those of them that share the pole [any].
    place, width : float
        Where the peak is, and its half-power width [ln Hz, -].
    """
    middle = int(np.abs(frfs.frequency - np.exp(place)).argmin())
    reach = max(2, round(width * np.exp(place) / frfs.df))
    lines = slice(max(0, middle - reach), middle + reach + 1)
    s = 2j * np.pi * (frfs.frequency[lines] - frfs.frequency[middle])
    straight = np.linalg.qr(np.stack([np.ones_like(s), s], axis=1))[0]
    bent, moved = (h - (h @ straight.conj()) @ straight.T for h in (values[:, lines], values[:, lines] * s))
    power = max(
        float(np.vdot(bent, bent).real), np.finfo(float).tiny
    )  # none: a peak that is a straight line is none
    return complex(2j * np.pi * frfs.frequency[middle] + np.vdot(bent, moved) / power)


def _largest(peaks: list[_Peaks]) -> IntArray:
    """Return which sets are in the largest group of those that belong together."""
    left, best = set(range(len(peaks))), set[int]()
    while len(left) > len(best):
        group = frontier = {left.pop()}
        while frontier:
            frontier = {k for k in left if any(_alike(peaks[i], peaks[k]) for i in frontier)}
            group, left = group | frontier, left - frontier
        best = max(best, group, key=len)
    return np.array(sorted(best), dtype=np.int64)


def _alike(one: _Peaks, other: _Peaks) -> bool:
    """Return whether the set with fewer clear peaks shares half of them with the other."""
    fewer, more = (one, other) if len(one.clear.place) <= len(other.clear.place) else (other, one)
    shared = fewer.clear.shared(more)
    return 2 * int(shared.sum()) >= len(shared) > 0


def _along_course(main: IntArray, known: list[int], peaks: list[_Peaks]) -> IntArray:
    """Return the largest group with the sets before and after it to which its course over measuring order goes on.

    A course that quickens moves sharp peaks by more than their width from set to set, so that none shares them with
    the set before. A set joins if its peaks are, beside their widths, no more than three times as far from those of its
    neighbour as that one is from the two behind it: past its first, the steps of a course that goes as the cube of time
    grow by less.
    """
    for side in (sorted(known), sorted(known, reverse=True)):
        for one in side:
            behind = main[np.argsort(np.abs(main - one), kind="stable")][: FEWEST - 1]
            beyond = not main.min() <= one <= main.max() and len(behind) == FEWEST - 1
            if beyond and _leads_to(peaks[one].clear, [peaks[k].clear for k in behind]):
                main = np.sort(np.append(main, one))
    return main


def _leads_to(ahead: _Peaks, behind: list[_Peaks]) -> bool:
    """Return whether the steps between sets, the nearest first, lead to the peaks of the one ahead of them."""
    nearest = [np.abs(p.place - ahead.place[:, None]).argmin(axis=1) for p in behind]
    place = np.stack([p.place[i] for p, i in zip(behind, nearest, strict=True)])
    steps = np.abs(np.diff(place, axis=0)).max(axis=0)
    led = np.abs(ahead.place - place[0]) <= behind[0].reach[nearest[0]] + ahead.reach + 3.0 * steps
    return bool(led.all())


def _contradicts(own: int, peaks: list[_Peaks], main: IntArray) -> bool:
    """Return whether most peaks of a set lie beyond what the course and the scatter of the main group allow."""
    here = peaks[own].clear
    courses = [
        _course(place, reach, peaks, main) for place, reach in zip(here.place, here.reach, strict=True)
    ]
    left = np.stack([course.left for course in courses], axis=1)
    freedom = np.array([max(len(course.at) - 2, 0) for course in courses])
    product = left.T @ left  # what modes have in common counts once (Satterthwaite 1946)
    alike = np.sum(product**2) / max(np.trace(product) ** 2, np.finfo(float).tiny)
    sigma = np.sqrt(np.trace(product) / max(freedom.sum(), 1))
    widening = sigma * stats.t.isf(
        CHANCE / 2 / len(peaks), max(freedom.max() / max(alike, 1 / len(here.place)), 1.0)
    )
    beside = [
        abs(place - course.foretold(own)) > reach + (course.leverage(own) * widening if n else LARGEST)
        for place, reach, course, n in zip(here.place, here.reach, courses, freedom, strict=True)
    ]
    return bool(2 * sum(beside) > len(beside))


@dataclass(frozen=True, eq=False)
class _Course:
    """Where the main group has the peak nearest to one, over measuring order.

    Parameters
    ----------
    at : (n,) int array
        Sets that have it, as ranks in measuring order; too few for a line: the nearest one alone.
    middle, rate : float
        The line through them: its height in their middle [ln Hz], and its slope [1].
    left : (n_main,) array
        What it leaves in each set of the group, 0 in those that lack the peak [-].
    """

    at: IntArray
    middle: float
    rate: float
    left: FloatArray

    def foretold(self, rank: int) -> float:
        """Return where the line is at a rank [ln Hz]."""
        return float(self.middle + self.rate * (rank - self.at.mean()))

    def leverage(self, rank: int) -> float:
        """Return the standard deviation of a further peak at a rank, over that of one about the line [-]."""
        away = self.at - self.at.mean()
        return float(np.sqrt(1.0 + 1.0 / len(away) + (rank - self.at.mean()) ** 2 / np.sum(away**2)))


def _course(place: float, reach: float, peaks: list[_Peaks], main: IntArray) -> _Course:
    """Fit a line over measuring order through the peaks nearest to a place.

    Where too few sets have the mode, the nearest place alone is compared.
    """
    nearest = np.array([p[np.abs(p - place).argmin()] for p in (peaks[k].clear.place for k in main)])
    distance = np.abs(nearest - place)
    same = distance <= 2.0 * distance.min() + reach  # sets that lack this mode offer another one
    left = np.zeros(len(main))
    if np.sum(same) < FEWEST:
        first = [distance.argmin()]
        return _Course(main[first], float(nearest[first][0]), 0.0, left)
    at, there = main[same], nearest[same]
    away = at - at.mean()
    rate = np.sum(away * there) / np.sum(away**2)
    left[same] = there - there.mean() - rate * away
    return _Course(at, float(there.mean()), float(rate), left)


def _places(sets: list[_Peaks]) -> tuple[float, ...]:
    """Return where most of these sets peak [Hz]."""
    if not sets:
        return ()
    every, reach = (np.concatenate([getattr(p, name) for p in sets]) for name in ("place", "reach"))
    order = np.argsort(every)
    apart = np.diff(every[order]) > reach[order][1:]
    runs = np.split(every[order], np.flatnonzero(apart) + 1)
    return tuple(float(np.exp(np.median(run))) for run in runs if 2 * len(run) > len(sets))


def _listed(frequency: tuple[float, ...]) -> str:
    return ", ".join(hertz(f) for f in frequency) or "other frequencies"
