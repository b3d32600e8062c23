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

from acquisition.arrays import FloatArray
from updating.likelihood.bordered import Bordered, bordered
from updating.likelihood.stack import OwnChannel, Stack
from updating.thresholds import DOUBT_SHARES


@dataclass(frozen=True, eq=False)
class SeparateChannel:
    """A channel of comparisons beside all sizes of the other doubts and all shares of its own.

    Parameters
    ----------
    own : OwnChannel
        Its data and nuisances.
    parts : Bordered
        Its nuisances integrated out, (a, b, s): comparisons, sizes of the other doubts, shares.
    log_likelihood : (a, b, s) array
        As in :class:`updating.likelihood.gaussian.Marginal` [-].
    """

    own: OwnChannel
    parts: Bordered
    log_likelihood: FloatArray

    @property
    def summed(self) -> FloatArray:
        """The log-likelihood summed over the shares, each as likely, (a, b) [-]."""
        return np.asarray(
            np.logaddexp.reduce(self.log_likelihood, axis=-1) - np.log(self.log_likelihood.shape[-1])
        )


def separate_channels(
    stack: Stack, channels: Sequence[OwnChannel], variance: FloatArray
) -> list[SeparateChannel]:
    """Integrate the nuisances of channels out, at all sizes of the other doubts and all shares of their own.

    Parameters
    ----------
    stack : Stack
        Residuals, nuisances and noise.
    channels : sequence of OwnChannel
        What is integrated by itself.
    variance : (a, b, n) array
        Variance at all sizes of the other doubts [-].
    """
    return [_integrated(stack, own, variance[..., own.rows]) for own in channels]


def _integrated(stack: Stack, own: OwnChannel, variance: FloatArray) -> SeparateChannel:
    """Integrate the nuisances of a channel out, whose data have so much variance at all sizes (a, b, n) [-]."""
    assert stack.judged is not None
    assert stack.first.judged_columns is not None
    shares = np.array(DOUBT_SHARES)
    less = (1 - shares**2)[:, None] * stack.judged[:, None, own.rows]
    variance = variance[:, :, None] - less[:, None]
    growth = np.where(stack.first.judged_columns[own.columns], shares[:, None], 1.0)
    data = np.empty((len(less), len(shares), len(own.rows), len(own.columns) + 1))
    nuisance = stack.nuisance[:, own.rows[:, None], own.columns]
    data[..., :-1] = nuisance[:, None] * growth[:, None, :]
    data[..., -1] = stack.residual[:, None, own.rows]
    data = data[:, None]
    parts = bordered(np.swapaxes(data / variance[..., None], -1, -2) @ data)
    log_det = parts.log_det + np.log(variance).sum(axis=-1)
    return SeparateChannel(own, parts, -0.5 * (parts.chi2 + log_det + len(own.rows) * np.log(2 * np.pi)))
