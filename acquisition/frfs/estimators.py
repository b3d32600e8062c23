"""From hits to FRFs: H1, H2 and Hv with coherence, variance and covariance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, FloatArray
from acquisition.errors import EstimationError, InputError
from acquisition.frfs.frf import FrfSet, Record
from acquisition.frfs.scatter import HitGroup, HitScatter
from acquisition.frfs.spectra import (
    ESTIMATORS,
    Estimator,
    Spectra,
    coherence_of,
    combine,
    deviations,
    squared,
)
from acquisition.hits.hammer import HammerTest, Hits
from acquisition.hits.impulse import impulse_places
from acquisition.hits.verdicts import HitVerdict, usual_fault, verdicts_of
from acquisition.hits.windows import Windows, windowed


def estimate_frfs(
    test: HammerTest,
    *,
    estimator: Estimator = "H1",
    verdicts: Sequence[HitVerdict] | None = None,
    windows: Windows | None = None,
    band: tuple[float, float] | None = None,
    keep_scatter: bool = True,
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
    band : tuple of float, optional
        Lowest and highest line kept; default from 0 to the Nyquist frequency [Hz].
    keep_scatter : bool
        Whether the covariance from the repeated hits is handed on as ``FrfSet.scatter``. In single precision
        it takes as much memory as the records of the hits do, or, with ``band``, that part of it.

    Returns
    -------
    FrfSet
        With coherence, variance and scatter of the mean where there are two hits or more at every point.

    Raises
    ------
    EstimationError
        If no hit is left at any point, or a force is zero.
    InputError
        If the estimator is unknown or the band empty.

    Notes
    -----
    Ewins, Modal Testing (2000), section 3.9: H1 = G_xf / G_ff, H2 = G_xx / G_fx, coherence =
    |G_xf|^2 / (G_xx G_ff). Hv as in Rocklin, Crowley and Vold, IMAC 3 (1985), with force and response scaled
    to equal power at each line. For the variance see `acquisition.frfs.spectra.deviations`.
    """
    if estimator not in ESTIMATORS:
        raise InputError(f"unknown estimator {estimator!r}; use {', '.join(ESTIMATORS)}")
    frequency = np.asarray(np.fft.rfftfreq(test.samples, 1 / test.rate), dtype=np.float64)
    lines = _lines(frequency, band, test)
    kept = kept_hits(test, verdicts)
    several = min(int(keep.sum()) for _, keep in kept) > 1
    parts, places = [], []
    for raw, keep in kept:
        hits = windowed(raw, windows, test.rate)
        places.append(impulse_places(hits.force[keep]))
        parts.append(_average(Spectra.of(hits, keep, test, lines), estimator, several, keep_scatter))
    record = Record(test.duration, float(np.concatenate(places).mean()) / test.rate, test.form, test.rate)
    decay = test.decay + (0.0 if windows is None else windows.decay)
    return _joined(test, kept, frequency[lines], parts, record, decay, several, keep_scatter)


def _joined(
    test: HammerTest,
    kept: Sequence[tuple[Hits, BoolArray]],
    frequency: FloatArray,
    parts: Sequence[_Average],
    record: Record,
    decay: float,
    several: bool,
    keep_scatter: bool,
) -> FrfSet:
    """Return the averages of all points as one set at lines (n_lines,) [Hz]."""
    return FrfSet(
        frequency=frequency,
        values=np.concatenate([part.values for part in parts]),
        responses=tuple(dof for hits, _ in kept for dof in hits.responses),
        references=tuple(hits.reference for hits, _ in kept for _ in hits.responses),
        form=test.form,
        coherence=np.concatenate([part.coherence for part in parts]) if several else None,
        variance=np.concatenate([part.variance for part in parts]) if several else None,
        averages=np.concatenate([np.full(len(hits.responses), keep.sum()) for hits, keep in kept]),
        decay=decay,
        geometry=test.geometry,
        source=test.source,
        record=record,
        scatter=_scatter(parts) if several and keep_scatter else None,
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


@dataclass(frozen=True, eq=False)
class _Average:
    """FRFs of one point with what is known of their errors."""

    values: ComplexArray
    coherence: FloatArray
    variance: FloatArray
    deviations: ComplexArray | None


def _average(spectra: Spectra, estimator: Estimator, several: bool, keep_scatter: bool) -> _Average:
    sums = spectra.sums()
    values = combine(*sums, estimator)
    if not several:
        nothing = np.zeros(values.shape)
        return _Average(values, nothing, nothing, None)
    moved = deviations(spectra, values, estimator)
    variance = squared(moved).sum(axis=0)
    return _Average(
        values, coherence_of(*sums), variance, moved.astype(np.complex64) if keep_scatter else None
    )


def _scatter(parts: Sequence[_Average]) -> HitScatter:
    """Number the FRFs of all points through."""
    first = np.cumsum([0, *(len(part.values) for part in parts)])
    groups = []
    for part, start in zip(parts, first[:-1], strict=True):
        assert part.deviations is not None
        part.deviations.setflags(write=False)
        groups.append(HitGroup(start + np.arange(len(part.values)), part.deviations))
    return HitScatter(tuple(groups))


def _lines(frequency: FloatArray, band: tuple[float, float] | None, test: HammerTest) -> slice:
    if band is None:
        return slice(0, len(frequency))
    kept = np.flatnonzero((frequency >= band[0] - 1e-9) & (frequency <= band[1] + 1e-9))
    if len(kept) < 2:
        raise InputError(
            f"{test.source}: the band {band[0]:g}-{band[1]:g} Hz holds {len(kept)} lines; the records give "
            f"lines from 0 to {frequency[-1]:g} Hz, {frequency[1]:g} Hz apart"
        )
    return slice(int(kept[0]), int(kept[-1]) + 1)


def kept_hits(test: HammerTest, verdicts: Sequence[HitVerdict] | None = None) -> list[tuple[Hits, BoolArray]]:
    """Return the points that have hits to use, and which hits those are.

    Parameters
    ----------
    test : HammerTest
        Raw records.
    verdicts : sequence of HitVerdict, optional
        Which hits to use; for a point hit in several runs see `acquisition.hits.verdicts.verdicts_of`.

    Raises
    ------
    EstimationError
        If no hit is left at any point.
    """
    kept = []
    for point, stated in zip(test.points, verdicts_of(test, verdicts or ()), strict=True):
        mask = np.array([verdict is None or verdict.used for verdict in stated], dtype=np.bool_)
        if mask.any():
            kept.append((point, mask))
    if not kept:
        raise EstimationError(
            f"{test.source}: no usable hit is left at any point{_most(verdicts or ())}; accept some by hand or repeat "
            "the test"
        )
    return kept


def _most(verdicts: Sequence[HitVerdict]) -> str:
    """Return the fault that most hits have."""
    usual = usual_fault(verdicts)
    return "" if usual is None else f" (most frequent reason, {usual[0]} of {len(verdicts)} hits: {usual[1]})"
