"""Where a structure is or might be hit and seen, and what the nominal model gives there: the data of a forecast."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from modalkit.planning.own.candidates import Spot
from updating import Measured
from updating.prediction.predict import Predictor

FREQUENCY_SIGMA, DAMPING_SIGMA, SHAPE_SIGMA = 2e-4, 0.05, 0.02
"""Relative standard deviations of identified frequencies and damping ratios, and that of modal constants over each
mode's largest, where no data state it [-]."""

REPEATED = 4
"""Modes that are predicted beyond those needed, so that each finds its partner where some change places [-]."""


@dataclass(frozen=True, eq=False)
class Layout:
    """Stations: the ends that move of all FRFs, the test's own first, then others that might be.

    Parameters
    ----------
    blank : Measured
        Points and FRFs of all stations; its modes are not used, and modes without a partner in the model are
        none of its: the data are the model's own.
    station : (n_frf,) int array
        Station of each FRF.
    own : tuple of int
        Those of the test.
    spots : tuple of Spot
        The others, in the order in which they follow.
    roving : bool
        Whether it is the sensor that moves.
    drive : int or None
        Station where the end that stays sits, where it is not one of the test's.
    """

    blank: Measured
    station: IntArray
    own: tuple[int, ...]
    spots: tuple[Spot, ...]
    roving: bool
    drive: int | None = None


def layout_of(test: Measured, spots: tuple[Spot, ...]) -> Layout:
    """Return the stations of a test and those beside it.

    Parameters
    ----------
    test : Measured
        Points, and which FRFs were or will be taken.
    spots : tuple of Spot
        Where it might be hit, or seen, too.
    """
    if not len(test.seen):
        return _of_spots(test, spots)
    bare = bool((test.hit < 0).all())
    roving = bare or len(np.unique(test.seen)) > len(np.unique(test.hit))
    moving, fixed = (test.seen, test.hit) if roving else (test.hit, test.seen)
    stays = np.unique(fixed)
    mine = np.unique(moving)
    first = len(test.points)
    points = np.vstack([test.points, *[spot.place[None, : test.points.shape[1]] for spot in spots]])
    directions = _directions(test, spots)
    nodes = (*test.nodes, *[max((*test.nodes, 0)) + 1 + i for i in range(len(spots))])
    more = np.arange(first, first + len(spots))
    drive = None
    if not bare and len(stays) == 1 and stays[0] not in mine:
        drive, more = int(stays[0]), np.append(stays, more)
    moves = np.concatenate([moving, np.repeat(more, len(stays))])
    stayed = np.concatenate([fixed, np.tile(stays, len(more))])
    seen, hit = (moves, stayed) if roving else (stayed, moves)
    own = np.arange(len(moves)) < len(moving)
    blank = replace(
        test, points=points, directions=directions, nodes=nodes, seen=seen, hit=hit, rows=None, signs=None,
        trusted=own if own.sum() > 1 else None, phase=None, phase_sigma=None, channel_group=None, slope=None,
        slope_sigma=None, trend=None, trend_sigma=None, noise=None, shared=None, hit_errors=None, quadrature=None,
        partners=None, partner_constants=None, unpaired=None, written=(), warnings=(),
    )  # fmt: skip
    return Layout(blank, moves, tuple(mine.tolist()), spots, roving, drive)


def _of_spots(test: Measured, spots: tuple[Spot, ...]) -> Layout:
    """Return the stations of a test that has frequencies alone: the places that are tried, the sensor at the first."""
    places = [spot.place[None, : test.points.shape[1]] for spot in spots]
    count = len(spots)
    hit = np.arange(count)
    blank = replace(
        test, points=np.vstack([test.points, *places]), directions=_directions(test, spots),
        nodes=tuple(range(1, count + 1)), seen=np.zeros(count, dtype=int), hit=hit,
        constants=np.zeros((count, 0)), constants_sigma=np.zeros((count, 0)), warnings=(), written=(), trusted=None,
        unpaired=None,
    )  # fmt: skip
    return Layout(blank, hit, (), spots, roving=False)


def _directions(test: Measured, spots: tuple[Spot, ...]) -> FloatArray | None:
    if test.directions is None and all(spot.axis == 2 for spot in spots):
        return None
    own = np.tile([0.0, 0.0, 1.0], (len(test.points), 1)) if test.directions is None else test.directions
    return np.vstack([own, *[np.eye(3)[[spot.axis]] for spot in spots]])


@dataclass(frozen=True, eq=False)
class Known:
    """Uncertainty of the data of a test, mode by mode.

    Parameters
    ----------
    frequency, damping, shape : (n_modes,) arrays
        Relative standard deviations of frequencies and damping ratios, and of constants over their mode's largest [-].
    """

    frequency: FloatArray
    damping: FloatArray
    shape: FloatArray

    def of(self, count: int) -> Known:
        """Return it for so many modes, what is above the band taken to be known as the mode below it."""
        each = (self.frequency, self.damping, self.shape)
        return Known(*(np.append(v, np.full(count - len(v), v[-1])) for v in each))


def by_default(count: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the standard deviations of frequencies, damping and constants of so many modes without data [-]."""
    return np.full(count, FREQUENCY_SIGMA), np.full(count, DAMPING_SIGMA), np.full(count, SHAPE_SIGMA)


def imagined(layout: Layout, predictor: Predictor, ranks: IntArray, known: Known) -> Measured:
    """Return what a test at all stations would find if the specimen were as modelled.

    Parameters
    ----------
    layout : Layout
        The stations.
    predictor : Predictor
        The model, seen from all of them.
    ranks : (n_modes,) int array
        Ranks of the modes among the elastic ones, rising.
    known : Known
        How well each datum is known.
    """
    modes = predictor.predict(count=int(ranks.max()) + REPEATED).select(ranks)
    largest = np.abs(modes.constants).max(axis=0, initial=1e-300)
    return replace(
        layout.blank,
        frequency=modes.frequency,
        frequency_sigma=known.frequency * modes.frequency,
        damping=modes.damping,
        damping_sigma=known.damping * modes.damping,
        constants=modes.constants,
        constants_sigma=known.shape * largest * np.ones_like(modes.constants),
        below=0,
    )
