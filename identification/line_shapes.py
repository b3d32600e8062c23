"""Whether FRFs carry the line shape of a Hann window, as the FRFs themselves show it or as it is stated."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, squared
from acquisition.errors import EstimationError
from acquisition.frfs.frf import FrfSet
from acquisition.frfs.line_shape import KINDS, Kind, LineShape
from identification.fit.equations.basis import Axis, build
from identification.fit.equations.refine import Fit, refine
from identification.fit.equations.residues import synthesise, uniform_weights
from identification.fit.fit import Fitted, fit_candidates
from identification.fit.noise.lags import contradicted
from identification.fit.noise.leakage import leaked
from identification.fit.noise.weights import absorbed_by, left_over, noise_weights, search_weights
from identification.fit.search.completion import COARSE, SHORT

RESOLVED = 1.5
"""Distance of poles that a Hann window shows as one [lines]: the half-power width of |W|^2 is 1.44. Doubled, close
modes count as one until the completion of the fit adds the second again; halved, the two poles that imitate the line
shape stay."""

STRONG = 10.0
"""By how much Schwarz's criterion must fall for a line shape that is not stated [-]: very strong evidence (Kass and
Raftery, J. Am. Stat. Assoc. 90 (1995) 773-795). Doubled: no change where peaks are narrow; at none, peaks far wider
than lines get a shape by chance, and a damping that is off by more than its sigma."""

LOBE = 4.0
"""Width of the main lobe of a Hann window, from zero to zero [lines]: poles that imitate a peak lie that close.
Doubled, more line shapes are fitted, as fewer modes of plain FRFs are alone; halved, imitations count as modes."""

COSTLY = 100.0
"""By how much Schwarz's criterion must rise with a line shape to exclude it without a fit [-]. Averages over few blocks
err alike at neighbouring lines and in all FRFs of one force: it rises by 50 by chance. Doubled, more line shapes are
fitted; halved, 1 % of tests of 3 to 20 blocks lose theirs."""

BROAD = 100.0
"""Decay of a pole over a block beyond which its line shape is left as it is, to 0.1 % [-]. Doubled: work without
effect."""

ASKED = 96
"""FRFs, evenly spread over those of a test, which are asked whether a line shape is worth a fit of all: where one is
carried, all carry it. Doubled: more work, the same line shapes [-]."""


def fit_shaped(
    frfs: FrfSet, start: ComplexArray, *, band: tuple[float, float], course: FloatArray | None = None
) -> Fitted:
    """Fit candidates with the line shape that explains the FRFs best, no window included unless one is stated.

    A shape that is not stated counts if the fit with it explains more than the one without, each pole, each term and
    each number of the law of the noise at its price (Schwarz, Ann. Stat. 6 (1978) 461-464): two poles under a
    half-power width apart imitate the line shape. The candidates, and the poles of the fit without a shape, start those
    with one, imitations made one. A shape that the lags of the FRFs contradict does not count, however badly they fit
    without.
    Beside a course only a stated window counts: what a course leaves on peaks passes for errors of averages.

    Parameters
    ----------
    frfs, start, band, course
        As of :func:`identification.fit.fit.fit_candidates`.

    Raises
    ------
    EstimationError
        If no candidate is a mode of the band.
    """
    if not _may_have_a_shape(frfs, start) or (course is not None and frfs.window != "hann"):
        return fit_candidates(frfs, start, band=band, course=course)
    stated, possible = frfs.window == "hann", list(KINDS)
    fits: list[Fitted] = []
    failure: EstimationError | None = None
    starts = [_merged(start, np.ones(len(start)), frfs.df)]
    try:
        fits.append(fit_candidates(frfs, start, band=band, course=course))
        fit = fits[0].fit
        possible = [kind for kind in worth_asking(fits[0]) if not contradicted(with_shape(frfs, kind), fit)]
        starts.append(_merged(fit.poles, np.abs(fit.linear.residues).sum(axis=0), frfs.df))
    except EstimationError as error:
        failure = error
    if stated:
        fits = []
    for few in starts:
        for kind in KINDS if stated else _worth_a_fit(frfs, few, possible):
            try:
                fits.append(fit_candidates(with_shape(frfs, kind), few, band=band, course=course))
            except EstimationError as error:
                failure = error
    if not fits:
        raise failure or EstimationError(f"{frfs.source}: no candidate is a mode of the band")
    return min(fits, key=lambda fitted: _price(fitted) - (0.0 if fitted.frfs.line_shape else STRONG))


def _may_have_a_shape(frfs: FrfSet, start: ComplexArray) -> bool:
    """Return whether FRFs may have a line shape: none is excluded, and peaks are not far wider than lines.

    Records under an exponential window, as those of hits, had no Hann window.
    """
    known = frfs.window == "none" or frfs.record is not None or frfs.line_shape is not None or frfs.decay > 0
    return not known and bool(np.any(-start.real < BROAD * frfs.df))


def worth_asking(fitted: Fitted) -> list[Kind]:
    """Return the line shapes that a fit without one does not exclude.

    A small part of a shape would change the FRFs in a direction; what other poles, residues and residual terms can do
    alike is taken from it. How far what the fit leaves goes along that direction needs no second fit (Rao's score test,
    Proc. Camb. Phil. Soc. 44 (1948) 50-57). A shape is excluded if a part of none gains anything, and all of it
    costs much. Only modes alone within the lobe of a window are asked: poles that lie closer may imitate the shape, and
    leave nothing of it. Where these have most of the power, no shape is excluded.

    Parameters
    ----------
    fitted : Fitted
        A fit without a line shape.
    """
    frfs, poles, linear = fitted.frfs, fitted.fit.poles, fitted.fit.linear
    single = (np.abs(poles.imag[:, None] - poles.imag) <= LOBE * 2 * np.pi * frfs.df).sum(axis=1) == 1
    axis, modes = Axis.of(frfs), replace(linear, terms=np.zeros_like(linear.terms))
    alone, others = (replace(modes, residues=linear.residues * part) for part in (single, ~single))
    plain, close = synthesise(axis, poles, alone), synthesise(axis, poles, others)
    if np.sum(squared(plain) / fitted.variance) <= np.sum(squared(close) / fitted.variance):
        return list(KINDS)
    weight = np.exp(-0.5 * np.log(fitted.variance).mean(axis=0))
    columns = build(axis, poles, linear.powers).columns * weight[:, None]
    split = np.vstack([columns.real, columns.imag])
    directions = np.linalg.qr(split / np.linalg.norm(split, axis=0))[0]
    kinds: list[Kind] = []
    for kind in KINDS:
        shaped = synthesise(replace(axis, shape=LineShape(kind, 1.0 / frfs.df)), poles, alone)
        change = _without(directions, (shaped - plain) * weight) / weight
        along = float(np.sum((change.conj() * fitted.residual).real / fitted.variance))
        power = float(np.sum(squared(change) / fitted.variance)) + np.finfo(float).tiny
        if (
            2.0 * along**2 / power > STRONG
        ):  # more than noise is left; no test of this fit identifies its source
            return list(KINDS)
        if 2.0 * (power - 2.0 * along) < COSTLY:
            kinds.append(kind)
    return kinds


def _without(directions: FloatArray, rows: ComplexArray) -> ComplexArray:
    """Return rows less their part in orthonormal directions of real and imaginary parts [unit of the rows]."""
    flat = np.hstack([rows.real, rows.imag])
    flat -= (flat @ directions) @ directions.T
    n_lines = rows.shape[1]
    return np.asarray(flat[:, :n_lines] + 1j * flat[:, n_lines:])


def _worth_a_fit(frfs: FrfSet, few: ComplexArray, possible: list[Kind]) -> list[Kind]:
    """Return the line shapes with which few poles fit better than without, by one measure or the other.

    Those that the lags of the FRFs contradict are left out.
    """
    if not possible:
        return []
    count = len(frfs.values)
    frfs = frfs.select(np.unique(np.linspace(0, count - 1, min(count, ASKED)).round().astype(int)).tolist())
    plain = _of_few(frfs, few)[0]
    best: list[tuple[float, float]] = []
    kinds: list[Kind] = []
    for kind in possible:
        measures, fit = _of_few(with_shape(frfs, kind), few)
        if not contradicted(with_shape(frfs, kind), fit):
            best.append(measures)
            kinds.append(kind)
    table = np.array(best).reshape(-1, 2)
    return [
        k for k, own in zip(kinds, table, strict=True) if np.any((own == table.min(axis=0)) & (own < plain))
    ]


def with_shape(frfs: FrfSet, kind: Kind) -> FrfSet:
    """Return FRFs with a line shape.

    Those smoothed over three lines go without their first and last line, to which a neighbour is missing: what an
    analyser makes of these is known of no file.
    """
    if kind == "smoothed":
        inner = frfs.frequency[[1, -2]] + 0.5 * frfs.df * np.array([-1.0, 1.0])
        frfs = frfs.band(float(inner[0]), float(inner[1]))
    return replace(frfs, line_shape=LineShape(kind, 1.0 / frfs.df))


def _merged(poles: ComplexArray, size: FloatArray, df: float) -> ComplexArray:
    """Return poles with those that a window shows as one replaced by their mean, weighted by their size, rising."""
    order = np.argsort(poles.imag)
    poles, size = poles[order], size[order]
    cuts = np.flatnonzero(np.diff(poles.imag) > RESOLVED * 2 * np.pi * df) + 1
    parts = zip(np.split(poles, cuts), np.split(size, cuts), strict=True)
    return np.array([np.average(part, weights=weight) for part, weight in parts], dtype=np.complex128)


def _of_few(frfs: FrfSet, poles: ComplexArray) -> tuple[tuple[float, float], Fit]:
    """Return two measures of how badly poles fit that are refined, but neither struck off nor completed [-]; the fit.

    The misfit over the power of each FRF, in which a mode that the candidates lack weighs little; and the price, in
    which the error of averages on a narrow peak, of the size of the peak, weighs little.
    """
    fit = refine(frfs, poles, uniform_weights(frfs), iterations=SHORT, tolerance=COARSE)
    weights, misfit = search_weights(frfs, fit), fit.cost
    fit = refine(frfs, fit.poles, weights, iterations=SHORT, tolerance=COARSE)
    price = _criterion(frfs, fit, left_over(frfs, fit), absorbed_by(frfs, fit, weights))
    return (misfit, price), fit


def _price(fitted: Fitted) -> float:
    """Return Schwarz's criterion with the noise that the fit leaves: less is better [-]."""
    return _criterion(fitted.frfs, fitted.fit, fitted.residual, fitted.absorbed)


def _criterion(frfs: FrfSet, fit: Fit, residual: ComplexArray, absorbed: FloatArray) -> float:
    """Return Schwarz's criterion, the noise of all shapes estimated from residuals: coherence would favour some."""
    way = leaked(frfs, fit.poles, fit.linear.residues)
    weights, variance, _ = noise_weights(replace(frfs, coherence=None), residual, absorbed, way)
    n_frf = len(residual)
    smoothed = frfs.line_shape is not None and frfs.line_shape.kind == "smoothed"
    common = slice(None) if smoothed else slice(1, -1)  # the lines that every shape is fitted to
    residual, variance = residual[:, common], variance[:, common]
    lack = float(np.sum(np.log(variance) + np.abs(residual) ** 2 / variance))
    unknowns = len(fit.poles) * (2 * n_frf + 2) + n_frf * len(fit.linear.powers) + weights.unknowns
    return float(2.0 * lack + unknowns * np.log(2 * residual.size))
