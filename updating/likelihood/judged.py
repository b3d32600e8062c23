"""Doubts of which only the most is judged: how far damping scatters from mounting to mounting, how far filters turn.

Nobody measured how far one test has them. What they may be at the most is judged; beside data that agree to a tenth of
it, that is too large. So each channel has a share of it, the same for all its data, which is summed over. Where the
data of a channel scatter as much as was judged, the share is one and nothing changes.

A channel whose nuisances are its own is integrated by itself, at all shares in one batch. One that shares nuisances
with others keeps the most.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.likelihood.comparison import Comparison
from updating.thresholds import DOUBT_SHARES


@dataclass(frozen=True, eq=False)
class SeparateChannel:
    """A channel beside all sizes of the other doubts and all shares of its own.

    Parameters
    ----------
    channel : int
        Which of ``CHANNELS``.
    columns : (c,) int array
        Its nuisances.
    count : int
        Number of its data.
    log_likelihood, chi2 : (b, s) arrays
        As in :class:`updating.likelihood.gaussian.Marginal`, b sizes of the other doubts, s shares [-].
    shift : (b, s, c) array
        Its most probable nuisances [standard deviations].
    """

    channel: int
    columns: IntArray
    count: int
    log_likelihood: FloatArray
    chi2: FloatArray
    shift: FloatArray

    @property
    def summed(self) -> FloatArray:
        """The log-likelihood summed over the shares, each as likely, (b,) [-]."""
        return np.asarray(
            np.logaddexp.reduce(self.log_likelihood, axis=1) - np.log(self.log_likelihood.shape[1])
        )


def separate_channels(
    comparison: Comparison, keep: BoolArray | None, sizes: Sequence[tuple[float, float]]
) -> list[SeparateChannel]:
    """Return each channel with a judged doubt and nuisances of its own.

    Parameters
    ----------
    comparison : Comparison
        Residual, nuisances and noise.
    keep : (n,) bool array, optional
        Data to use; left out, all.
    sizes : sequence of (float, float)
        Sizes of the two other doubts, see :attr:`Comparison.sizes` [-].
    """
    if comparison.judged is None:
        return []
    found = []
    doubtful = comparison.judged > 0
    used = np.ones(len(doubtful), dtype=bool) if keep is None else keep
    touched = comparison.nuisance != 0
    for channel in np.unique(comparison.channel[doubtful & used]).tolist():
        rows = used & (comparison.channel == channel)
        columns = touched[rows].any(axis=0)
        if not (touched[used & ~rows] & columns).any():
            found.append(
                _integrated(comparison, channel, np.flatnonzero(rows), np.flatnonzero(columns), sizes)
            )
    return found


def _integrated(
    comparison: Comparison,
    channel: int,
    rows: IntArray,
    columns: IntArray,
    sizes: Sequence[tuple[float, float]],
) -> SeparateChannel:
    """Integrate the nuisances of a channel out at all sizes and shares, as in :func:`gaussian`."""
    assert comparison.judged is not None
    assert comparison.judged_columns is not None
    shares = np.array(DOUBT_SHARES)
    less = (1 - shares**2)[:, None] * comparison.judged[rows]
    variance = comparison.variances(sizes)[:, None, rows] - less
    growth = np.where(comparison.judged_columns[columns], shares[:, None], 1.0)
    own = comparison.nuisance[np.ix_(rows, columns)] * growth[:, None, :]
    residual = np.broadcast_to(comparison.residual[rows, None], (len(shares), len(rows), 1))
    data = np.concatenate([own, residual], axis=2)
    whole = np.swapaxes(data / variance[..., None], 2, 3) @ data
    precision = whole[..., :-1, :-1] + np.eye(len(columns))
    pull = whole[..., :-1, -1]
    shift = np.linalg.solve(precision, pull[..., None])[..., 0]
    chi2 = np.maximum(whole[..., -1, -1] - np.sum(pull * shift, axis=-1), 0.0)
    log_det = np.linalg.slogdet(precision)[1] + np.log(variance).sum(axis=-1)
    likelihood = -0.5 * (chi2 + log_det + len(rows) * np.log(2 * np.pi))
    return SeparateChannel(channel, columns, len(rows), likelihood, chi2, shift)
