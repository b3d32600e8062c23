"""Level dependence: how the frequency of each mode changes with the force of the hits.

A joint that slips or closes makes a structure softer or stiffer the harder it is hit. The poles of each hit alone are
found by a few steps from those identified, its residues free, so that where exactly a hit landed does not matter.
Their shifts are then fitted by a curve common to all points and an offset of each point in each run, which takes up
drift from point to point and what a roving transducer does; its slope is that at the level of the averaged FRFs. Where
modes agree on how hard a hit was than its record shows, that level takes the place of the recorded one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from acquisition import Windows
from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from acquisition.dof import Dof
from acquisition.frfs.frf import FrfSet
from identification.fit.equations.iteration import decaying
from identification.fit.equations.normal_equations import Weights
from identification.fit.equations.projection import Step
from identification.fit.equations.refine import evaluate, fit_at
from identification.fit.equations.residues import uniform_weights
from identification.fit.noise.disagreement import student_widening
from identification.fit.noise.weights import absorbed_by, left_over, noise_weights
from identification.level_dependence import LevelDependence
from identification.levels.effective import effective_levels
from identification.levels.hits import Judged, UsedHits, mean_level, used_hits, why_not
from identification.model import ModalModel

STEPS = 2
"""Steps to the poles of each hit, each held to about a half-power half-width, before the last, free one."""

BENT = 0.3
"""How far the slope may change over the mean level, relative to itself, 1 sigma [-]: what gives way in proportion to
the force moves a mode the less, the softer it is already. Doubled: few levels determine a slope half as well."""

AT_REST = 0.03
"""Part of a half-width that a step may leave before the next is taken: its error goes as the square [-]."""


SURE = 4.0
"""Slope over its standard deviation from which a mode follows the level. Doubled, weak joints go unnamed; halved, every
other test of thirty modes names one by chance [-]."""


def why_no_level_dependence(tests: Sequence[Judged]) -> str | None:
    """Return why these hits show no level dependence, or None if they do; parameters as for `level_dependence`."""
    return why_not(used_hits(tests))


def level_dependence(
    model: ModalModel,
    tests: Sequence[Judged],
    *,
    windows: Windows | None = None,
    slope: FloatArray | None = None,
) -> LevelDependence | None:
    """Return how the modes depend on the level of the hits; None where the hits do not determine them.

    Parameters
    ----------
    model : ModalModel
        Identified from the FRFs of these hits.
    tests : sequence of (HammerTest, verdicts)
        The raw hits and what was decided on them; see `why_no_level_dependence`.
    windows : Windows, optional
        As when the FRFs were estimated.
    slope : (n_modes,) array, optional
        Slopes by which the poles of each hit are expected; left out, they are sought around the common ones [1/N].

    Returns
    -------
    LevelDependence or None
        None if used hits at the same points span less than 2 : 1 in level, or none is repeated.

    Notes
    -----
    The shift of a hit is that of the pole which fits its record best, over all amplitudes through which the
    vibration dies away: a slope is one of this effective frequency. Standard deviations come from the scatter about
    the line, widened for its degrees of freedom so that 1.96 of them are a 95 % interval.
    """
    rows = rows_of(model)
    entries = known_hits(tests, rows)
    if why_not(entries) is not None:
        return None
    levels, common = np.concatenate([e.levels for e in entries]), mean_level(entries)
    expected = np.outer(levels - common, np.zeros(len(model)) if slope is None else slope)
    weights, band = weights_of(model), band_of(model)
    singles = (f for e in entries for f in e.single_frfs(windows=windows, band=band))
    found = [_of_hit(model, f, weights, rows, d) for f, d in zip(singles, expected, strict=True)]
    shifts, variances = (np.array(part) for part in zip(*found, strict=True))
    point = np.repeat(np.arange(len(entries)), [len(e.levels) for e in entries])
    lines = [_slopes(levels, common, point, shifts[:, :, i], variances[:, :, i]) for i in range(2)]
    (by_level, by_level_sigma), (damping_by_level, damping_by_level_sigma) = lines
    recorded = LevelDependence(
        slope=by_level,
        slope_sigma=by_level_sigma,
        damping_slope=damping_by_level,
        damping_slope_sigma=damping_by_level_sigma,
        level=common,
        weakest=float(levels.min()),
        strongest=float(levels.max()),
        levels=levels,
        point=point,
        shifts=shifts[:, :, 0],
        sigmas=np.sqrt(variances[:, :, 0]),
        damping_shifts=shifts[:, :, 1],
        damping_sigmas=np.sqrt(variances[:, :, 1]),
    )
    return _by_effective_levels(recorded)


def follows_level(found: LevelDependence) -> BoolArray:
    """Return which modes follow the level beyond doubt, (n_modes,)."""
    return np.asarray(np.nan_to_num(np.abs(found.slope) / found.slope_sigma) > SURE)


def _by_effective_levels(found: LevelDependence) -> LevelDependence:
    """Return lines over what the modes show of the levels, for those over the recorded ones."""
    follows = follows_level(found)
    if np.count_nonzero(follows) < 2:
        return found
    effective = effective_levels(
        found.levels, found.level, found.point,
        found.shifts[:, follows], found.sigmas[:, follows] ** 2, found.slope[follows], bent=BENT,
    )  # fmt: skip
    lines = [
        _slopes(effective.levels, found.level, found.point, shifts, sigmas**2)
        for shifts, sigmas in ((found.shifts, found.sigmas), (found.damping_shifts, found.damping_sigmas))
    ]
    (slope, own), (damping, its_own) = lines
    return replace(
        found,
        slope=slope,
        slope_sigma=np.hypot(own, slope * effective.scale_sigma),
        damping_slope=damping,
        damping_slope_sigma=np.hypot(its_own, damping * effective.scale_sigma),
        levels=effective.levels,
    )


def rows_of(model: ModalModel) -> dict[tuple[Dof, Dof], int]:
    """Return the row of each response and reference among the FRFs of a model."""
    return {pair: i for i, pair in enumerate(zip(model.frfs.responses, model.frfs.references, strict=True))}


def band_of(model: ModalModel) -> tuple[float, float]:
    """Return the lowest and the highest line that a model was identified from [Hz]."""
    return float(model.frfs.frequency[0]), float(model.frfs.frequency[-1])


def known_hits(tests: Sequence[Judged], rows: dict[tuple[Dof, Dof], int]) -> list[UsedHits]:
    """Return the hits that are used, of the points with FRFs among those identified."""
    return [entry for entry in used_hits(tests) if is_known(entry, rows)]


def is_known(entry: UsedHits, rows: dict[tuple[Dof, Dof], int]) -> bool:
    """Return whether any FRF of these hits is among the rows."""
    return any((response, entry.hits.reference) in rows for response in entry.hits.responses)


def weights_of(model: ModalModel) -> Weights:
    """Return the reciprocal variances of the noise about an identified model."""
    poles, powers = np.concatenate([model.poles, model.background_poles]), model.background.powers
    frfs = model.frfs if model.carried is None else model.carried
    plain = uniform_weights(frfs)
    fit = fit_at(frfs, poles, plain, powers, True)
    residual = left_over(frfs, fit)
    return noise_weights(frfs, residual, absorbed_by(frfs, fit, plain))[0]


def of_single(
    frfs: FrfSet, weights: Weights, rows: dict[tuple[Dof, Dof], int]
) -> tuple[FrfSet, Weights, list[int]]:
    """Return those FRFs of a single hit that a model has, their weights, and which of its responses they are."""
    pairs = list(zip(frfs.responses, frfs.references, strict=True))
    kept = [i for i, pair in enumerate(pairs) if pair in rows]
    stated = np.array([rows[pairs[i]] for i in kept])
    of_lines = weights.lines if len(weights.lines) == 1 else weights.full[stated].mean(axis=0, keepdims=True)
    level = weights.level[stated] if len(weights.lines) == 1 else np.ones(len(stated))
    return frfs.select(kept), Weights(level, of_lines), kept


def _of_hit(
    model: ModalModel,
    frfs: FrfSet,
    weights: Weights,
    rows: dict[tuple[Dof, Dof], int],
    expected: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return shifts of (ln f, zeta) of each mode in one hit, (n_modes, 2), and their variances.

    They are sought around the shifts of ln f (n_modes,) that are expected.
    """
    data, own, _ = of_single(frfs, weights, rows)
    poles = model.poles * np.exp(expected)
    moved, covariance = _moved_poles(model, poles, data, own)
    size = np.abs(poles)
    frequency = np.stack([poles.real, poles.imag], axis=1) / size[:, None] ** 2
    damping = -np.stack([1 / size, np.zeros(len(size))], axis=1) + (poles.real / size)[:, None] * frequency
    turn = np.stack([frequency, damping], axis=1)
    shift = np.einsum("rij,rj->ri", turn, np.stack([moved.real, moved.imag], axis=1))
    shift[:, 0] += expected
    return shift, np.einsum("rij,rjk,rik->ri", turn, covariance, turn)


def _moved_poles(
    model: ModalModel, poles: ComplexArray, data: FrfSet, weights: Weights
) -> tuple[ComplexArray, FloatArray]:
    """Return how far the poles of one hit are from those given, and its (n_modes, 2, 2) covariance [rad/s].

    On the way, poles are held by a prior of a half-width, so that one which this hit does not show stays where it is.
    """
    n, powers, at = len(poles), model.background.powers, poles
    width = np.abs(poles.real)
    prior = np.repeat(1 / width**2, 2)

    def information() -> tuple[FloatArray, FloatArray]:
        step = evaluate(data, np.concatenate([at, model.background_poles]), weights, powers)
        return _information(step, n, data)

    for _ in range(STEPS):
        normal, gradient = information()
        pull = gradient - prior * _flat(at - poles)
        change = _complex(np.asarray(np.linalg.solve(normal + np.diag(prior), pull)))
        at = decaying(np.asarray(at + change), at, data.decay)
        if np.abs(change / width).max() < AT_REST:
            break
    normal, gradient = information()
    covariance = np.asarray(np.linalg.inv(normal + np.diag(1e-8 * prior)), dtype=np.float64)
    blocks = covariance.reshape(n, 2, n, 2)[np.arange(n), :, np.arange(n), :]
    return np.asarray(at - poles + _complex(covariance @ gradient)), blocks


def _information(step: Step, n_modes: int, data: FrfSet) -> tuple[FloatArray, FloatArray]:
    """Return information of the poles and the gradient, for the noise that the misfit of this hit shows."""
    spare = data.values.size - 0.5 * step.solution.size
    scale = 2.0 / max(step.cost / max(spare, 1.0), np.finfo(float).tiny)
    return scale * step.normal[: 2 * n_modes, : 2 * n_modes], scale * step.gradient[: 2 * n_modes]


def _flat(values: ComplexArray) -> FloatArray:
    return np.stack([values.real, values.imag], axis=1).ravel()


def _complex(values: FloatArray) -> ComplexArray:
    return np.asarray(values[0::2] + 1j * values[1::2])


def _slopes(
    levels: FloatArray, common: float, point: IntArray, shifts: FloatArray, variances: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Fit a curve of second degree per mode and an offset per point, weighted; return its slopes at a level.

    Parameters
    ----------
    levels : (n_hits,) array
        Level of each hit [N].
    common : float
        Level at which the slope is wanted [N].
    point : (n_hits,) int array
        Point of each hit.
    shifts, variances : (n_hits, n_modes) arrays
        What is fitted, and its variance up to a factor per mode.

    Returns
    -------
    slope, sigma : (n_modes,) arrays
        Slopes and their standard deviations [1/N].
    """
    member = (point[:, None] == np.arange(point.max() + 1)[None, :]).astype(np.float64)
    weight = 1 / (
        variances + np.median(variances, axis=0)
    )  # what no misfit shows keeps any hit from ruling alone
    total = np.maximum(member.T @ weight, np.finfo(float).tiny)

    def within(values: FloatArray) -> FloatArray:
        return np.asarray(values - member @ ((member.T @ (weight * values)) / total))

    away = (levels - common)[:, None]
    straight, bent = (within(np.broadcast_to(part, shifts.shape)) for part in (away, away**2 / common))
    about = within(shifts)
    power = np.sum(weight * straight**2, axis=0)
    line = np.sum(weight * straight * about, axis=0) / power
    freedom = len(levels) - len(np.unique(point)) - 1
    scale = np.sum(weight * (about - line * straight) ** 2, axis=0) / freedom
    # a bend that may stand for a slope, held by its prior and eliminated
    shared = np.sum(weight * straight * bent, axis=0) / scale
    least = np.finfo(float).tiny ** 0.5
    held = np.sum(weight * bent**2, axis=0) / scale + 1 / np.maximum(np.abs(BENT * line / 2), least) ** 2
    information = power / scale - shared**2 / held
    pull = line * power / scale - shared / held * np.sum(weight * bent * about, axis=0) / scale
    return pull / information, np.sqrt(student_widening(freedom) / information)
