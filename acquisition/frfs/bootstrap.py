"""FRFs of tests that might have been: hits drawn anew from those at hand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import EstimationError, InputError
from acquisition.frfs.estimators import estimate_frfs, kept_hits
from acquisition.frfs.frf import FrfSet
from acquisition.frfs.spectra import ESTIMATORS, Estimator, Spectra, combine
from acquisition.hits.hammer import HammerTest
from acquisition.hits.verdicts import HitVerdict
from acquisition.hits.windows import Windows, windowed


def bootstrap_frfs(
    test: HammerTest,
    *,
    rng: np.random.Generator,
    n: int = 200,
    estimator: Estimator = "H1",
    verdicts: Sequence[HitVerdict] | None = None,
    windows: Windows | None = None,
    band: tuple[float, float] | None = None,
) -> Iterator[FrfSet]:
    """Draw hits with replacement at each point, all responses of a hit together, and average them.

    Of the m hits at a point m - 1 are drawn: the scatter of the averages is then, without bias, that of the
    average of all m (Rao and Wu, J. Am. Stat. Assoc. 83, 1988, section 2; m draws give (m - 1) / m of it).

    Parameters
    ----------
    test : HammerTest
        Raw records.
    rng : numpy.random.Generator
        Source of the draws.
    n : int
        Number of sets [-].
    estimator, verdicts, windows, band
        As for `estimate_frfs`.

    Yields
    ------
    FrfSet
        Without coherence and variance; ``averages`` states how many hits were drawn.

    Raises
    ------
    EstimationError
        If a point has a single hit to use, or none has any.
    InputError
        If ``n`` is not positive, the estimator is unknown or the band empty.
    """
    if n < 1 or estimator not in ESTIMATORS:
        raise InputError(
            f"bootstrap: {n} sets by estimator {estimator!r}; ask for at least 1, by {', '.join(ESTIMATORS)}"
        )
    plain = estimate_frfs(
        test, estimator=estimator, verdicts=verdicts, windows=windows, band=band, keep_scatter=False
    )
    kept = kept_hits(test, verdicts)
    single = [str(hits.reference) for hits, keep in kept if keep.sum() < 2]
    if single:
        raise EstimationError(
            f"{test.source}: only one usable hit at {', '.join(single)}, which cannot be resampled: hit again "
            "or leave these points out"
        )
    first = int(np.rint(plain.frequency[0] * test.samples / test.rate))
    lines = slice(first, first + len(plain.frequency))
    points = [Spectra.of(windowed(hits, windows, test.rate), keep, test, lines) for hits, keep in kept]
    return _draws(plain, points, estimator, n, rng)


def _draws(
    plain: FrfSet, points: Sequence[Spectra], estimator: Estimator, n: int, rng: np.random.Generator
) -> Iterator[FrfSet]:
    powers = [spectra.powers() for spectra in points]
    averages = np.concatenate([np.full(s.motion.shape[1], len(s.force) - 1) for s in points])
    for _ in range(n):
        values = []
        for gff, gxx, gxf in powers:
            weight = _times_drawn(len(gff), rng)
            used = weight > 0
            w, gff_k, gxx_k, gxf_k = weight[used], gff[used], gxx[used], gxf[used]
            sums = ((w @ gff_k)[None], np.tensordot(w, gxx_k, axes=1), np.tensordot(w, gxf_k, axes=1))
            values.append(combine(*sums, estimator))
        yield FrfSet(
            frequency=plain.frequency,
            values=np.concatenate(values),
            responses=plain.responses,
            references=plain.references,
            form=plain.form,
            averages=averages,
            decay=plain.decay,
            geometry=plain.geometry,
            source=f"{plain.source}, hits resampled",
        )


def _times_drawn(count: int, rng: np.random.Generator) -> FloatArray:
    """Return how often each of ``count`` hits is among ``count`` - 1 draws, shape (count,) [-]."""
    return np.bincount(rng.integers(count, size=count - 1), minlength=count).astype(np.float64)
