"""One test beside one state of the model: residuals, what may explain them, and noise, in blocks by channel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product
from typing import TypeVar

import numpy as np
from scipy.linalg import block_diag

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.prediction.prediction import Prediction
from updating.thresholds import DOUBT_SHARES, UNSEEN_SHARES

CHANNELS = ("frequency", "damping", "frf", "phase", "level", "trend", "unpaired", "noise")
"""Kinds of data: ln f, ln zeta, real modal constants, their phase, dependence on the hammer's force, change over the
test; all that is known of modes without a partner in the nominal model; and how the noise fades along the records."""

SCALED = "frf"
"""The channel whose noise has an unknown scale."""


_Array = TypeVar("_Array", FloatArray, BoolArray)


@dataclass(frozen=True, eq=False, kw_only=True)
class Block:
    """The data of one kind.

    Parameters
    ----------
    channel : str
        Which of ``CHANNELS``.
    residual, variance : (n,) arrays
        Measured minus predicted, and the variance of the independent noise [-].
    factors : (n, n_names) array
        Change of the prediction per unit of what all data doubt alike: the logarithm of a factor with a tolerance
        or of a body's mass [-], a body's place [1/m].
    named, own : (n, p) arrays
        Change per standard deviation of the nuisances of this channel alone: those that bear a name, whose
        stretching is a finding, and the rest [-].
    mode : (n,) int array
        Measured mode each datum belongs to, -1 if to one without a partner.
    source : (n,) int array, optional
        Measuring channel it comes from; left out, none: the test as a whole.
    idealised : (n,) array, optional
        What of the variance a candidate's idealisation adds, mode by mode, at the most [-]; left out, nothing.
    idle : (n,) bool array, optional
        Which data the state does not predict; left out, none.
    unseen : (n,) array, optional
        What of the variance is an error that no scatter shows, at the most [-]; left out, nothing.
    judged : (n,) array, optional
        What of the variance is a doubt of the channel of which only the most is judged [-]; left out, nothing.
    judged_own : bool
        Whether the ``own`` nuisances are of that doubt, too.
    places : (m,) int array, optional
        Which of the ``own`` nuisances are where points lie; left out, none.
    """

    channel: str
    residual: FloatArray
    variance: FloatArray
    factors: FloatArray
    named: FloatArray
    own: FloatArray
    mode: IntArray
    source: IntArray | None = None
    idealised: FloatArray | None = None
    idle: BoolArray | None = None
    unseen: FloatArray | None = None
    judged: FloatArray | None = None
    judged_own: bool = False
    places: IntArray | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Comparison:
    """Measured minus predicted data at one state, with what may explain it.

    Parameters
    ----------
    residual : (n,) array
        ln f, then ln damping ratio, then modal constants over their r.m.s. per mode, their phases [rad], the
        frequencies' dependence on force times its mean, and their change over the test [-].
    nuisance : (n, p) array
        Change of the prediction per standard deviation of each nuisance [-].
    variance : (n,) array
        Variance of the independent noise [-].
    channel : (n,) int array
        Which of ``CHANNELS``.
    mode : (n,) int array
        Measured mode each datum belongs to, -1 if to one without a partner; those of further specimens count on.
    source : (n,) int array
        Measuring channel it comes from, -1 if from the whole test; those of further specimens count on.
    predictions : tuple of Prediction
        The predicted modes of each specimen, in the order of the measured ones.
    scale_prior : tuple of float
        Prior of each of ``SCALES`` on the noise of the shapes [-].
    doubts : (k,) int array
        Which nuisances are named doubts: tolerances, level of damping, calibration.
    tolerances : (t,) int array
        Which of them all data doubt alike: tolerances of the model, masses and places of its bodies.
    linearised : (l,) int array, optional
        Those about whose most probable values the prediction is linearised: these, and where points lie, test by test;
        left out, these alone.
    idealised : (n,) array, optional
        What of the variance the candidate's idealisation adds, at the most [-]; left out, its size is settled.
    idle : (n,) bool array, optional
        Which data the state does not predict, so that none of them fits or does not; left out, none.
    unseen : (n,) array, optional
        What of the variance is an error that no scatter shows, at the most [-]; left out, its size is settled.
    judged : (n,) array, optional
        What of the variance is a doubt of its channel of which only the most is judged [-]; left out, its size is
        settled.
    judged_columns : (p,) bool array, optional
        Which nuisances are of that doubt, too.
    """

    residual: FloatArray
    nuisance: FloatArray
    variance: FloatArray
    channel: IntArray
    mode: IntArray
    source: IntArray
    predictions: tuple[Prediction, ...]
    scale_prior: tuple[float, ...]
    doubts: IntArray
    tolerances: IntArray
    idealised: FloatArray | None = None
    idle: BoolArray | None = None
    unseen: FloatArray | None = None
    judged: FloatArray | None = None
    judged_columns: BoolArray | None = None
    linearised: IntArray | None = None

    @property
    def moving(self) -> IntArray:
        """Which nuisances the prediction is linearised about, (l,)."""
        return self.tolerances if self.linearised is None else self.linearised

    @property
    def prediction(self) -> Prediction:
        """The predicted modes of the first specimen."""
        return self.predictions[0]

    def of(self, channel: str) -> BoolArray:
        """Return which data are of one of ``CHANNELS``, (n,); none where it is no channel."""
        code = CHANNELS.index(channel) if channel in CHANNELS else -1
        return np.asarray(self.channel == code)

    @property
    def scaled(self) -> BoolArray:
        """Which data have noise of an unknown scale, (n,): the shapes."""
        return self.of(SCALED)

    @property
    def of_pairs(self) -> BoolArray:
        """Which data are of modes that have a partner in the nominal model, (n,)."""
        return np.asarray(self.mode >= 0)

    @property
    def stated(self) -> BoolArray:
        """Which data the state predicts, (n,)."""
        return np.ones(len(self.residual), dtype=bool) if self.idle is None else ~self.idle

    def noise(self, scale: float) -> FloatArray:
        """Return the variance with the shapes so many times worse than thought, shape (n,) [-]."""
        return np.where(self.scaled, scale**2, 1.0) * self.variance

    def settled(
        self, share: float, unseen: float = 1.0, judged: Sequence[tuple[int, float]] = ()
    ) -> Comparison:
        """Return the comparison with the doubts of unknown size at shares of the most that they may be [-].

        The doubt in a candidate's idealisation, ``share``, is that which each datum bears by itself. Whether the whole
        shift is a few per cent too large no data show, since the effect's own size makes up for it: that doubt stays.
        ``unseen`` is the share of errors that no scatter of hits shows, ``judged`` that of the doubt of a channel, by
        its number; of those left out it is all.
        """
        one = self.channels_settled(judged)
        if one.idealised is None and one.unseen is None:
            return one
        variance = one.variance
        for part, size in ((one.idealised, share), (one.unseen, unseen)):
            variance = variance if part is None else variance - (1 - size**2) * part
        return replace(one, variance=variance, idealised=None, unseen=None)

    def channels_settled(self, judged: Sequence[tuple[int, float]] = ()) -> Comparison:
        """Return the comparison with the doubt of each channel at a share of the most that it may be, by number [-]."""
        if self.judged is None or self.judged_columns is None:
            return self
        size = np.ones(len(CHANNELS))
        for channel, share in judged:
            size[channel] = share
        each = size[self.channel]
        return replace(
            self,
            variance=self.variance - (1 - each**2) * self.judged,
            nuisance=np.where(self.judged_columns, each[:, None] * self.nuisance, self.nuisance),
            judged=None,
            judged_columns=None,
        )

    def beside(self, before: FloatArray, after: FloatArray) -> Comparison:
        """Return the comparison with further nuisances, (n, k) each, before and after its own [-]."""
        whole, own = np.hstack([before, self.nuisance, after]), self.judged_columns
        if own is not None:
            own = np.pad(own, (before.shape[1], after.shape[1]))
        return replace(self, nuisance=whole, judged_columns=own)

    @property
    def sizes(self) -> tuple[tuple[float, float], ...]:
        """Shares at which the two doubts are tried, each as likely: of the idealisation, of what no scatter shows."""
        idealised = (1.0,) if self.idealised is None else DOUBT_SHARES
        return tuple(product(idealised, (1.0,) if self.unseen is None else UNSEEN_SHARES))


@dataclass(frozen=True, eq=False)
class Layout:
    """Where the data and the nuisances of each block stand, and what they are: the same of all states of one test.

    Parameters
    ----------
    rows, named, own : tuples of slice
        Of each block: its data, its nuisances that bear a name, and its others.
    shape : (int, int)
        Number of data and of nuisances.
    channel, mode, source, doubts, tolerances, linearised, judged_columns
        As in :class:`Comparison`.
    """

    rows: tuple[slice, ...]
    named: tuple[slice, ...]
    own: tuple[slice, ...]
    shape: tuple[int, int]
    channel: IntArray
    mode: IntArray
    source: IntArray
    doubts: IntArray
    tolerances: IntArray
    linearised: IntArray
    judged_columns: BoolArray

    @classmethod
    def of(cls, blocks: Sequence[Block], count: int) -> Layout:
        """Return the layout of blocks behind ``count`` nuisances that all data have in common."""
        sizes = [len(block.residual) for block in blocks]
        rows = np.cumsum([0, *sizes])
        named = np.cumsum([count, *(block.named.shape[1] for block in blocks)])
        own = np.cumsum([named[-1], *(block.own.shape[1] for block in blocks)])
        source = [np.full(len(b.residual), -1) if b.source is None else b.source for b in blocks]
        places = [own[i] + block.places for i, block in enumerate(blocks) if block.places is not None]
        judged = np.zeros(own[-1], dtype=bool)
        judged[named[-1] :] = np.repeat([block.judged_own for block in blocks], np.diff(own))
        return cls(
            rows=_slices(rows),
            named=_slices(named),
            own=_slices(own),
            shape=(int(rows[-1]), int(own[-1])),
            channel=np.repeat([CHANNELS.index(block.channel) for block in blocks], sizes),
            mode=np.concatenate([block.mode for block in blocks]),
            source=np.concatenate(source),
            doubts=np.arange(named[-1]),
            tolerances=np.arange(count),
            linearised=np.concatenate([np.arange(count), *places]),
            judged_columns=judged,
        )

    def filled(self, parts: Sequence[_Array | None], nothing: float) -> _Array | None:
        """Return what all blocks have of a quantity in one, ``nothing`` where one has none; None where none has any."""
        known = [(part, here) for part, here in zip(parts, self.rows, strict=True) if part is not None]
        if not known:
            return None
        whole = np.full(self.shape[0], nothing)
        for part, here in known:
            whole[here] = part
        return whole


def _slices(bounds: IntArray) -> tuple[slice, ...]:
    return tuple(slice(*ends) for ends in pairwise(bounds.tolist()))


def assemble(
    blocks: Sequence[Block],
    layout: Layout,
    sigmas: FloatArray,
    shift: FloatArray,
    prediction: Prediction,
    scale_prior: tuple[float, ...],
) -> Comparison:
    """Put the blocks of one test together: the tolerances common to all, what else is doubted each for itself.

    Parameters
    ----------
    blocks : sequence of Block
        One per channel, in the order of ``CHANNELS``.
    layout : Layout
        Where each goes.
    sigmas : (n_names,) array
        Standard deviations of what all data doubt alike [-, of places m].
    shift : (n_names,) array
        Where they stand in the prediction [standard deviations].
    prediction, scale_prior
        As in :class:`Comparison`.
    """
    count = len(sigmas)
    nuisance, (residual, variance) = np.zeros(layout.shape), np.zeros((2, layout.shape[0]))
    for block, here, named, own in zip(blocks, layout.rows, layout.named, layout.own, strict=True):
        residual[here], variance[here] = block.residual, block.variance
        nuisance[here, :count] = block.factors * sigmas
        nuisance[here, named] = block.named
        nuisance[here, own] = block.own
    return Comparison(
        residual=residual + nuisance[:, :count] @ shift if shift.any() else residual,
        nuisance=nuisance,
        variance=variance,
        channel=layout.channel,
        mode=layout.mode,
        source=layout.source,
        predictions=(prediction,),
        scale_prior=scale_prior,
        doubts=layout.doubts,
        tolerances=layout.tolerances,
        linearised=layout.linearised,
        idealised=layout.filled([block.idealised for block in blocks], 0.0),
        idle=layout.filled([block.idle for block in blocks], False),
        unseen=layout.filled([block.unseen for block in blocks], 0.0),
        judged=layout.filled([block.judged for block in blocks], 0.0),
        judged_columns=layout.judged_columns,
    )


def _filled(parts: Sequence[tuple[_Array | None, int]], nothing: float) -> _Array | None:
    """Return what parts of the data say in one, ``nothing`` where one has no prediction; None where all have.

    Each part comes with the number of its data.
    """
    if all(part is None for part, _ in parts):
        return None
    return np.concatenate([np.full(count, nothing) if part is None else part for part, count in parts])


def join(parts: Sequence[Comparison]) -> Comparison:
    """Put the comparisons of several specimens together, whose nuisances have nothing in common."""
    if len(parts) == 1:
        return parts[0]
    starts = np.cumsum([0, *(part.nuisance.shape[1] for part in parts)])
    modes = np.cumsum([0, *(len(part.prediction.frequency) for part in parts)])
    sources = np.cumsum([0, *(1 + int(part.source.max(initial=-1)) for part in parts)])
    return Comparison(
        residual=np.concatenate([part.residual for part in parts]),
        nuisance=block_diag(*(part.nuisance for part in parts)),
        variance=np.concatenate([part.variance for part in parts]),
        channel=np.concatenate([part.channel for part in parts]),
        mode=np.concatenate(
            [
                np.where(part.mode < 0, -1, part.mode + first)
                for part, first in zip(parts, modes, strict=False)
            ]
        ),
        source=np.concatenate(
            [
                np.where(part.source < 0, -1, part.source + first)
                for part, first in zip(parts, sources, strict=False)
            ]
        ),
        predictions=tuple(p for part in parts for p in part.predictions),
        scale_prior=max((part.scale_prior for part in parts), key=lambda prior: -prior[0]),
        doubts=np.concatenate([part.doubts + first for part, first in zip(parts, starts, strict=False)]),
        tolerances=np.concatenate(
            [part.tolerances + first for part, first in zip(parts, starts, strict=False)]
        ),
        linearised=np.concatenate([part.moving + first for part, first in zip(parts, starts, strict=False)]),
        idealised=_filled([(part.idealised, len(part.residual)) for part in parts], 0.0),
        idle=_filled([(part.idle, len(part.residual)) for part in parts], False),
        unseen=_filled([(part.unseen, len(part.residual)) for part in parts], 0.0),
        judged=_filled([(part.judged, len(part.residual)) for part in parts], 0.0),
        judged_columns=_filled([(part.judged_columns, part.nuisance.shape[1]) for part in parts], False),
    )
