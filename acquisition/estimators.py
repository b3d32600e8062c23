"""From hits to FRFs: H1, H2 and Hv with coherence and variance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np
import scipy.fft

from acquisition.arrays import BoolArray, ComplexArray, FloatArray
from acquisition.errors import EstimationError, InputError
from acquisition.frf import FrfSet
from acquisition.hammer import HammerTest, Hits
from acquisition.quality import HitVerdict
from acquisition.windows import Windows, apply_windows

Estimator = Literal["H1", "H2", "Hv"]


def estimate_frfs(
    test: HammerTest,
    *,
    estimator: Estimator = "H1",
    verdicts: Sequence[HitVerdict] | None = None,
    windows: Windows | None = None,
) -> FrfSet:
    """Estimate FRFs by linear averages of spectra over the hits at each point.

    Parameters
    ----------
    test : HammerTest
        Raw records.
    estimator : {"H1", "H2", "Hv"}
        H1 trusts the force, H2 the response, Hv neither more than the other (total least squares).
    verdicts : sequence of HitVerdict, optional
        Hits whose verdict is "not used" are left out, and with them points that have no other (see
        `rejected_points`); without verdicts all are used.
    windows : Windows, optional
        Windows applied before; the decay of an exponential one is handed on.

    Returns
    -------
    FrfSet
        From 0 to the Nyquist frequency, with coherence and the variance of the mean where there are two hits
        or more at every point.

    Raises
    ------
    EstimationError
        If no hit is left at any point, or a force is zero.

    Notes
    -----
    Ewins, Modal Testing (2000), section 3.9: H1 = G_xf / G_ff, H2 = G_xx / G_fx, coherence =
    |G_xf|^2 / (G_xx G_ff). Hv as in Rocklin, Crowley and Vold, IMAC 3 (1985), with force and response scaled
    to equal power at each line. The variance is that of H1, see `mean_variance`.
    """
    if estimator not in ("H1", "H2", "Hv"):
        raise InputError(f"unknown estimator {estimator!r}; use H1, H2 or Hv")
    test = test if windows is None else apply_windows(test, windows)
    kept = _kept(test, verdicts)
    parts = [_point(point, keep, estimator, test) for point, keep in kept]
    averages = np.concatenate([np.full(len(point.responses), keep.sum()) for point, keep in kept])
    several = bool(averages.min() > 1)
    return FrfSet(
        frequency=np.asarray(np.fft.rfftfreq(test.samples, 1 / test.rate), dtype=np.float64),
        values=np.concatenate([part[0] for part in parts]),
        responses=tuple(dof for p, _ in kept for dof in p.responses),
        references=tuple(p.reference for p, _ in kept for _ in p.responses),
        form=test.form,
        coherence=np.concatenate([part[1] for part in parts]) if several else None,
        variance=np.concatenate([part[2] for part in parts]) if several else None,
        averages=averages,
        decay=test.decay,
        geometry=test.geometry,
        source=test.source,
    )


def random_error(frfs: FrfSet) -> FloatArray:
    """Return the relative random error of the magnitude at each line, shape (n_frf, n_lines) [-].

    Notes
    -----
    sqrt(variance / 2) / |H| where the scatter of the hits is known; else
    sqrt((1 - coherence) / (2 (n - 1) coherence)): Bendat and Piersol, Random Data (2010), equation 9.90, with
    n - 1 instead of n because the coherence of n hits is itself too high by that.

    Raises
    ------
    EstimationError
        If the set carries neither variance nor coherence and averages.
    """
    size = np.abs(frfs.values)
    if frfs.variance is not None:
        return np.asarray(np.sqrt(frfs.variance / 2) / np.maximum(size, np.finfo(float).tiny))
    if frfs.coherence is None or frfs.averages is None or frfs.averages.min() < 2:
        raise EstimationError(f"{frfs.source}: no coherence with averages, so no random error can be given")
    coherence = np.clip(frfs.coherence, 1e-12, 1.0)
    return np.asarray(np.sqrt((1 - coherence) / (2 * (frfs.averages[:, None] - 1) * coherence)))


def mean_variance(force: ComplexArray, motion: ComplexArray, frf: ComplexArray) -> FloatArray:
    """Return E|dH|^2 of an FRF averaged over hits, from the scatter of the hits about it.

    Parameters
    ----------
    force : (n_hits, n_lines) complex array
        Spectra of the force [any].
    motion : (n_hits, n_responses, n_lines) complex array
        Spectra of the responses [any].
    frf : (n_responses, n_lines) complex array
        H1 over these hits.

    Returns
    -------
    (n_responses, n_lines) array
        Weighted least squares with robust (sandwich, HC2) scatter: the leave-out of a hit is corrected by its
        leverage h_i = |F_i|^2 / sum |F|^2, so that the estimate has no bias for equal noise in all hits
        (MacKinnon and White, Journal of Econometrics 29, 1985).
    """
    power = np.abs(force) ** 2
    total = power.sum(axis=0)
    leverage = power / total
    residual = np.abs(motion - frf * force[:, None]) ** 2
    weight = leverage / np.maximum(1 - leverage, 1e-12)
    return np.asarray(np.einsum("hl,hrl->rl", weight, residual) / total, dtype=np.float64)


def _kept(test: HammerTest, verdicts: Sequence[HitVerdict] | None) -> list[tuple[Hits, BoolArray]]:
    """Return the points that have hits to use, and which."""
    refused = {(v.point, v.hit) for v in verdicts or () if not v.used}
    kept = []
    for point in test.points:
        mask = np.array(
            [(point.reference, hit + 1) not in refused for hit in range(point.count)], dtype=np.bool_
        )
        if mask.any():
            kept.append((point, mask))
    if not kept:
        raise EstimationError(
            f"{test.source}: no usable hit is left at any point; accept some by hand or repeat the test"
        )
    return kept


def _point(
    hits: Hits, keep: BoolArray, estimator: Estimator, test: HammerTest
) -> tuple[ComplexArray, FloatArray, FloatArray]:
    """Return FRFs, coherence and variance of one point, each (n_responses, n_lines)."""
    force = scipy.fft.rfft(hits.force[keep], axis=-1)
    motion = scipy.fft.rfft(hits.motion[keep], axis=-1)
    gff = (np.abs(force) ** 2).sum(axis=0)
    if not np.all(gff > 0):
        raise EstimationError(f"{test.source}: the force at {hits.reference} is zero; check its channel")
    gxx = (np.abs(motion) ** 2).sum(axis=0)
    gxf = np.einsum("hrl,hl->rl", motion, force.conj())
    h1 = gxf / gff
    safe = np.where(gxx > 0, gxx, 1.0)
    coherence = np.clip(np.abs(gxf) ** 2 / (safe * gff), 0.0, 1.0)
    variance = mean_variance(force, motion, h1)
    if estimator == "H1":
        return h1, coherence, variance
    scale = 1 / np.maximum(coherence, 1e-12)
    factor = scale if estimator == "H2" else np.sqrt(scale)
    return h1 * factor, coherence, variance * factor**2
