"""Hits as though all had been equally hard.

Where modes follow the force, an average over hits of different levels is that of several structures: peaks are smeared,
or look like two. What the modes do at a hit's own level is therefore replaced by what they do at a common one. That
takes modes to begin with, which :mod:`identification.levels.stretched` gives.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.fft

from acquisition import HammerTest, Windows
from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from acquisition.hits.hammer import Hits
from identification.fit.equations import basis
from identification.fit.equations.normal_equations import Weights
from identification.fit.equations.residues import Residues, fit_residues, synthesise
from identification.fit.noise.disagreement import student_widening
from identification.level_dependence import LevelDependence
from identification.levels.hits import Judged, UsedHits, used_hits
from identification.levels.slopes import (
    SURE,
    band_of,
    follows_level,
    is_known,
    of_single,
    rows_of,
    weights_of,
)
from identification.model import ModalModel

SMEARED = 0.1
"""Scatter of a mode's frequency over the hits at a point, over its half-power half-width, from which averages are not
those of one structure: they broaden the peak by the square of it, 1 %. Doubled: by 4 %, a third of what repeated tests
scatter in damping [-]."""

PADDED = 4
"""Length of the transform over that of the record, so that what rings at its end does not come round again [-]."""


def is_smeared(model: ModalModel, found: LevelDependence) -> bool:
    """Return whether averages over the hits at a point are those of several structures.

    Parameters
    ----------
    model : ModalModel
        Identified from averages.
    found : LevelDependence
        How its modes follow the level.
    """
    levels = found.levels[:, None]
    about = levels - _means(levels, found.point, np.ones_like(levels))
    damping = -model.poles.real / np.abs(model.poles)
    scatter = np.abs(found.slope) * np.sqrt(np.mean(about**2)) / np.maximum(damping, 1e-12)
    return bool(np.any(scatter[follows_level(found)] > SMEARED))


def at_one_level(
    model: ModalModel, tests: Sequence[Judged], found: LevelDependence, *, windows: Windows | None = None
) -> tuple[HammerTest, ...]:
    """Return tests of the used hits as though all had had the level that the averages stand for.

    Parameters
    ----------
    model : ModalModel
        Its modes, distinguished from each other at any one level.
    tests : sequence of (HammerTest, verdicts)
        The raw hits and what was decided on them.
    found : LevelDependence
        How the modes follow the level.
    windows : Windows, optional
        As when the FRFs were estimated.

    Notes
    -----
    A hit's FRFs are fitted by the poles that its level gives, the residues free; what these modes add to its records is
    then exchanged for what the same residues add at the poles of the common level. Noise, and all that is no mode of
    the model, stays as it is.
    """
    rows, weights, shifts = rows_of(model), weights_of(model), hit_shifts(found)
    first, moved = 0, []
    for entry in used_hits(tests):
        force, motion = _records(entry)
        if is_known(entry, rows):
            singles = entry.single_frfs(windows=windows, band=band_of(model))
            for hit, frfs in enumerate(singles):
                data, own, which = of_single(frfs, weights, rows)
                here, there = (hit_poles(model, shift[first + hit]) for shift in shifts)
                residues = hit_residues(model, data, here, own)
                motion[hit, which] += _exchanged(entry.test, force[hit], residues, here, there)
            first += len(force)
        moved.append((entry, force, motion))
    return _tests(moved)


def with_line_doubt(model: ModalModel, found: LevelDependence) -> ModalModel:
    """Return modes of one level whose standard deviations hold the error of the lines that brought the hits to it.

    Hits are about their own mean level, from where a line leads to the common one. What it errs by is the same at all
    points, so that no difference between FRFs shows it. All hits have the damping that they show in common, so that the
    error of this is in no difference between hits either.

    Parameters
    ----------
    model : ModalModel
        Identified from hits brought to one level.
    found : LevelDependence
        How its modes follow the level.
    """
    levels = found.levels[:, None]
    moved = found.level - np.mean(_means(levels, found.point, np.ones_like(levels)))
    spread = np.array(model.pole_covariance)
    spread[:, 0, 0] += np.where(follows_level(found), moved * found.slope_sigma, 0.0) ** 2
    spread[:, 1, 1] = np.where(
        follows_level(found), np.maximum(spread[:, 1, 1], hits_damping(found)[1] ** 2), spread[:, 1, 1]
    )
    modal = replace(
        model.modal,
        frequency_sigma=model.modal.frequency * np.sqrt(spread[:, 0, 0]),
        damping_sigma=np.sqrt(spread[:, 1, 1]),
    )
    return replace(model, pole_covariance=spread, modal=modal)


def hits_damping(found: LevelDependence) -> tuple[FloatArray, FloatArray]:
    """Return the damping that hits show at the common level, less the model's, and its standard deviation.

    Averages that are smeared have broader peaks than any hit has. The hits are weighted by
    their own errors; the standard deviation is that of leaving out one point after the other (MacKinnon and
    White, J. Econometrics 29 (1985) 305-325, HC3), as hits at one point have errors in common, and widened for the
    number of points that count, so that 1.96 of it are a 95 % interval.

    Returns
    -------
    damping, sigma : (n_modes,) arrays [-]
    """
    shifts = found.damping_shifts - _damping_by_level(found)
    variance = np.maximum(found.damping_sigmas**2, np.finfo(float).tiny)
    # what no misfit shows keeps any hit from ruling alone: hits that do not show a mode are no measure of it
    weight = 1 / (variance + len(variance) / np.sum(1 / variance, axis=0))
    several = found.point.max() > 0
    group = found.point if several else np.arange(len(shifts))
    member = (group[:, None] == np.arange(group.max() + 1)).astype(np.float64)
    share = member.T @ (weight / weight.sum(axis=0))
    damping = np.sum(weight * shifts, axis=0) / weight.sum(axis=0)
    pull = member.T @ (weight / weight.sum(axis=0) * (shifts - damping))
    counted = 1 / np.sum(share**2, axis=0)
    scatter = np.sum((pull / np.maximum(1 - share, np.finfo(float).eps)) ** 2, axis=0)
    return damping, np.sqrt(student_widening(counted - 1) * scatter)


def _damping_by_level(found: LevelDependence) -> FloatArray:
    """Return by how much the damping of each hit differs from that at the common level, (n_hits, n_modes) [-]."""
    sure = np.nan_to_num(np.abs(found.damping_slope) / found.damping_slope_sigma) > SURE
    return np.outer(found.levels - found.level, np.where(sure, found.damping_slope, 0.0))


def hit_residues(model: ModalModel, data: FrfSet, poles: ComplexArray, weights: Weights) -> ComplexArray:
    """Return the residues of a hit's modes at its own poles, beside the model's background, (n_frf, n_modes)."""
    every, powers = np.concatenate([poles, model.background_poles]), model.background.powers
    return fit_residues(data, every, powers=powers, weights=weights).residues[:, : len(poles)]


def hit_shifts(found: LevelDependence) -> tuple[FloatArray, FloatArray]:
    """Return (ln f, zeta) of the hits less those of the model, at their levels and at the common one.

    What a point has of its own, a roving mass, stays. Modes that do not follow the level beyond doubt stay as well. No
    joint follows a line for ever: a hit that shows a mode better than the line holds determines its own place.

    Returns
    -------
    here, there : (n_hits, n_modes, 2) arrays
    """
    moved = found.levels - found.level
    line = np.outer(moved, np.where(follows_level(found), found.slope, 0.0))
    weight = 1 / (found.sigmas**2 + np.median(found.sigmas, axis=0) ** 2)
    offset = _means(found.shifts - line, found.point, weight)
    beside = found.shifts - line - offset
    scatter = np.maximum(np.median(np.abs(beside), axis=0) ** 2, np.finfo(float).tiny)
    beside = np.where(follows_level(found), beside * scatter / (scatter + found.sigmas**2), 0.0)
    damping = np.broadcast_to(hits_damping(found)[0], line.shape)
    here = np.stack([offset + line + beside, damping + _damping_by_level(found)], axis=-1)
    return here, np.stack([offset, damping], axis=-1)


def hit_poles(model: ModalModel, shift: FloatArray) -> ComplexArray:
    """Return the poles of a model moved by (ln f, zeta), (n_modes, 2) [rad/s]."""
    size = np.abs(model.poles) * np.exp(shift[:, 0])
    ratio = np.clip(-model.poles.real / np.abs(model.poles) + shift[:, 1], 1e-6, 0.9)
    return np.asarray(size * (-ratio + 1j * np.sqrt(1 - ratio**2)))


def _exchanged(
    test: HammerTest, force: FloatArray, residues: ComplexArray, here: ComplexArray, there: ComplexArray
) -> FloatArray:
    """Return what a hit's records change by as modes move from poles to others, (n_frf, n_samples) [by the form].

    Modal constants stay, so that residues go as one over the damped frequency.
    """
    pulse = scipy.fft.rfft(force, PADDED * len(force))
    omega = 2 * np.pi * np.fft.rfftfreq(PADDED * len(force), 1 / test.rate)
    # at rest in the mean, no mode is of any account
    laplace = np.asarray(np.where(omega > 0, 1j * omega, 1e-3j * omega[1]) + test.decay, complex)
    axis = basis.Axis(laplace, test.form, test.decay)
    nothing = np.zeros((len(residues), 0))
    before, after = (
        synthesise(axis, poles, Residues(residues * here.imag / poles.imag, nothing, ()))
        for poles in (here, there)
    )
    return np.asarray(scipy.fft.irfft((after - before) * pulse, PADDED * len(force))[..., : len(force)])


def _records(entry: UsedHits) -> tuple[FloatArray, FloatArray]:
    """Return force and motion of the used hits, (n_hits, n_samples) and (n_hits, n_responses, n_samples)."""
    force, motion = entry.hits.force[entry.numbers], entry.hits.motion[entry.numbers]
    return np.array(force, dtype=np.float64), np.array(motion, dtype=np.float64)


def _means(values: FloatArray, group: IntArray, weight: FloatArray) -> FloatArray:
    """Return each value's weighted mean over its group, (n, n_modes)."""
    member = (group[:, None] == np.arange(group.max() + 1)).astype(np.float64)
    total = np.maximum(member.T @ weight, np.finfo(float).tiny)
    return np.asarray(member @ ((member.T @ (weight * values)) / total))


def _tests(entries: Sequence[tuple[UsedHits, FloatArray, FloatArray]]) -> tuple[HammerTest, ...]:
    """Return the tests that entries are from, with these forces and motions only."""
    points: dict[int, list[Hits]] = {}
    tests = {id(entry.test): entry.test for entry, _, _ in entries}
    for entry, force, motion in entries:
        points.setdefault(id(entry.test), []).append(
            Hits(entry.hits.reference, entry.hits.responses, force, motion)
        )
    return tuple(replace(tests[key], points=tuple(hits)) for key, hits in points.items())
