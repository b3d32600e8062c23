"""Comparisons of many states with the same data, one behind the other, and what of them no state changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.likelihood.comparison import CHANNELS, SCALED, Comparison
from updating.likelihood.separate import Separate, separate


@dataclass(frozen=True, eq=False)
class OwnChannel:
    """A channel with a judged doubt whose nuisances change its own data alone.

    Parameters
    ----------
    channel : int
        Which of ``CHANNELS``.
    rows, columns : (n,) and (c,) int arrays
        Its data, and its nuisances.
    """

    channel: int
    rows: IntArray
    columns: IntArray


@dataclass(frozen=True, eq=False)
class Pattern:
    """Which nuisances change which data: how they are integrated out.

    Parameters
    ----------
    channels : tuple of OwnChannel
        What is integrated by itself.
    rows : (n,) int array
        All other data that are used.
    scaled : (n,) bool array
        Which of them have noise of an unknown scale.
    groups : Separate
        Nuisances that change data of their own among these.
    shapes : bool
        Whether any datum that is used has noise of an unknown scale.
    """

    channels: tuple[OwnChannel, ...]
    rows: IntArray
    scaled: BoolArray
    groups: Separate
    shapes: bool


def pattern_of(comparison: Comparison, keep: BoolArray | None, *, judged: bool = True) -> Pattern:
    """Return the pattern of a comparison, the same object of all that are alike.

    Parameters
    ----------
    comparison : Comparison
        Residual, nuisances and noise.
    keep : (n,) bool array, optional
        Data to use; left out, all.
    judged : bool
        Whether channels with a judged doubt are integrated by themselves.
    """
    doubtful = comparison.judged if judged else None
    return _pattern(
        comparison.nuisance.shape,
        np.packbits(comparison.nuisance != 0).tobytes(),
        comparison.channel.tobytes(),
        None if keep is None else keep.tobytes(),
        None if doubtful is None else (doubtful > 0).tobytes(),
    )


@lru_cache(maxsize=64)
def _pattern(
    shape: tuple[int, int], touched: bytes, channel: bytes, keep: bytes | None, doubtful: bytes | None
) -> Pattern:
    """Return the pattern of arrays as bytes, one bit for each element of the first."""
    count = shape[0] * shape[1]
    bits = np.unpackbits(np.frombuffer(touched, dtype=np.uint8), count=count)
    touches = bits.reshape(shape).astype(bool)
    kind = np.frombuffer(channel, dtype=np.int64)
    used = np.ones(shape[0], dtype=bool) if keep is None else np.frombuffer(keep, dtype=bool)
    own = [] if doubtful is None else _own_channels(touches, kind, used, np.frombuffer(doubtful, dtype=bool))
    scaled = used & (kind == CHANNELS.index(SCALED))
    rows = np.flatnonzero(used & ~np.isin(kind, [one.channel for one in own]))
    return Pattern(tuple(own), rows, scaled[rows], separate(touches[rows], scaled[rows]), bool(scaled.any()))


def _own_channels(
    touched: BoolArray, channel: IntArray, used: BoolArray, doubtful: BoolArray
) -> list[OwnChannel]:
    """Return each channel with a judged doubt and nuisances of its own."""
    found = []
    for code in np.unique(channel[doubtful & used]).tolist():
        rows = used & (channel == code)
        columns = touched[rows].any(axis=0)
        if not (touched[used & ~rows] & columns).any():
            found.append(OwnChannel(code, np.flatnonzero(rows), np.flatnonzero(columns)))
    return found


@dataclass(frozen=True, eq=False)
class Stack:
    """Comparisons with one pattern.

    Parameters
    ----------
    first : Comparison
        The first of them, which states what each datum is.
    residual, variance : (a, n) arrays
        As in :class:`Comparison`, those of each [-].
    nuisance : (a, n, p) array
        As in :class:`Comparison` [-].
    idealised, unseen, judged : (a, n) arrays, optional
        As in :class:`Comparison` [-].
    """

    first: Comparison
    residual: FloatArray
    variance: FloatArray
    nuisance: FloatArray
    idealised: FloatArray | None
    unseen: FloatArray | None
    judged: FloatArray | None

    @classmethod
    def of(cls, comparisons: Sequence[Comparison]) -> Stack:
        """Return some comparisons as a stack."""
        return cls(
            comparisons[0],
            np.array([one.residual for one in comparisons]),
            np.array([one.variance for one in comparisons]),
            np.array([one.nuisance for one in comparisons]),
            _stacked([one.idealised for one in comparisons]),
            _stacked([one.unseen for one in comparisons]),
            _stacked([one.judged for one in comparisons]),
        )

    def variances(self, sizes: Sequence[tuple[float, float]]) -> FloatArray:
        """Return the variance at ``sizes`` of the two doubts, see :attr:`Comparison.sizes`, (a, n_sizes, n) [-]."""
        left = 1 - np.array(sizes) ** 2
        found = np.repeat(self.variance[:, None], len(sizes), axis=1)
        for part, of in zip((self.idealised, self.unseen), left.T, strict=True):
            if part is not None:
                found -= of[:, None] * part[:, None]
        return found


def _stacked(parts: Sequence[FloatArray | None]) -> FloatArray | None:
    known = [part for part in parts if part is not None]
    return np.array(known) if known else None
