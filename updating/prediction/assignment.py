"""Which of a model's predicted modes belongs to each measured mode, fast enough for every evaluation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import linear_sum_assignment

from acquisition.arrays import BoolArray, FloatArray, IntArray
from identification.pairing import counterparts, unlikeness
from updating.models.absorbers import Absorber
from updating.prediction.prediction import Prediction
from updating.test_data.measured import NO_PARTNER, UNSTATED, Measured

UNSEEN = 1e-6
"""Motion of a predicted mode where the test roves, over that of the others, under which no test sees it [-]: rounding
leaves 1e-12 of a mode that does not move along any direction there, 1e-7 where an iterative solver found it."""


def mac_of_constants(
    measured: Measured, prediction: Prediction, trusted: BoolArray | None = None
) -> FloatArray:
    """Return the MAC between measured and predicted modal constants, (n_measured, n_predicted) [-].

    A predicted mode that does not move where the test roves, one across the directions there, is like none: what is
    left of it is rounding, and of any shape. One with a node at the fixed end keeps its shape.

    Parameters
    ----------
    measured, prediction
        Test and model.
    trusted : (n_frf,) bool array, optional
        Rows to use; left out, all.
    """
    rows = slice(None) if trusted is None else trusted
    a, b = measured.constants[rows], prediction.constants[rows]
    moves = np.sum(getattr(prediction, measured.roving)[rows] ** 2, axis=0)
    unseen = moves < UNSEEN**2 * np.max(moves, initial=0.0, where=np.isfinite(moves))
    power = np.maximum(np.outer(np.sum(a**2, axis=0), np.sum(b**2, axis=0)), 1e-300)
    return np.where(unseen, 0.0, (a.T @ b) ** 2 / power)


def frac_of_constants(measured: Measured, prediction: Prediction) -> FloatArray:
    """Return FRAC of the constants over paired modes, per FRF; none where the level of each mode is its own.

    Parameters
    ----------
    measured, prediction : Measured, Prediction
        Test and model, of the same modes in the same order.

    Returns
    -------
    (n_frf,) or (0,) array
        Between 0 and 1 [-].
    """
    if not measured.absolute:
        return np.zeros(0)
    a, b = measured.constants, prediction.constants * measured.same_signs(prediction.constants)
    power = np.sum(a**2, axis=1) * np.sum(b**2, axis=1)
    return np.asarray(np.sum(a * b, axis=1) ** 2 / np.maximum(power, 1e-300))


AS_STATED = 1e3
"""What a stated pair gains over any other: more than all other pairs of any test cost together [-]."""


def match(
    measured: Measured, prediction: Prediction, order: IntArray, trusted: BoolArray | None = None
) -> IntArray:
    """Assign a predicted mode to every measured mode.

    Parameters
    ----------
    measured : Measured
        The test.
    prediction : Prediction
        The model's modes.
    order : (n_measured,) int array
        Rank of the model mode that belongs to each measured one where shapes do not decide: the i-th entry
        counts model modes from the lowest.
    trusted : (n_frf,) bool array, optional
        Rows whose shapes are compared; left out, those that the test trusts.

    Returns
    -------
    (n_measured,) int array
        Index of the predicted mode of each measured mode.
    """
    if not measured.has_shapes:
        return np.asarray(np.argsort(prediction.frequency)[order])
    trusted = measured.trusted if trusted is None else trusted
    away = np.log(measured.frequency[:, None] / prediction.frequency[None, :])
    cost = unlikeness(mac_of_constants(measured, prediction, trusted), away)
    if measured.partners is not None:
        columns = _stated(measured, prediction)
        rows = np.flatnonzero((columns >= 0) & (columns < cost.shape[1]))
        cost[rows, columns[rows]] = -AS_STATED
    return counterparts(cost)


NEAR = 0.3
"""Farthest that a measured mode without a partner in the nominal model may lie, in ln f, from the mode that it is
assigned to, of a model that has one more [-]: beyond, it is not assigned. Doubled: a search finds its way from further
off, and takes for its own what is not."""


def match_with_unpaired(
    measured: Measured, unpaired: Measured, prediction: Prediction, order: IntArray, added: int
) -> tuple[IntArray, IntArray]:
    """Assign a predicted mode to every measured mode, and to as many unpaired ones as the model has modes more.

    Parameters
    ----------
    measured, unpaired : Measured
        The modes with a partner in the nominal model, and those without.
    prediction : Prediction
        Modes of a model that has some more.
    order : (n_measured,) int array
        As of :func:`match`.
    added : int
        How many more.

    Returns
    -------
    order : (n_measured,) int array
        Predicted mode of each measured mode.
    claims : (n_unpaired,) int array
        Of each unpaired one, -1 where it is none of them.
    """
    claims = np.full(len(unpaired.frequency), -1, dtype=np.int64)
    found = match(measured, prediction, order)
    for _ in range(min(added, len(claims))):
        left = np.flatnonzero(claims < 0)
        trials = [np.append(np.flatnonzero(claims >= 0), i) for i in left]
        tried = [match(_beside(measured, unpaired, rows), prediction, order) for rows in trials]
        last = np.array([unpaired.frequency[i] for i in left]) / prediction.frequency[[t[-1] for t in tried]]
        best = int(np.argmin(np.nan_to_num(np.abs(np.log(last)), nan=np.inf)))
        if not abs(np.log(last[best])) < NEAR:
            break
        count = len(measured.frequency)
        found, claims[trials[best]] = tried[best][:count], tried[best][count:]
    return found, claims


ALIKE = 0.9
"""Least MAC of a measured mode without a partner in the nominal model with the mode of a state that may be it [-]: on
few points, modes of other shapes come near to that. It only offers: data decide. At 0.7, a mode that is none is
explained by chance more often."""


def offers(unpaired: Measured, prediction: Prediction, taken: IntArray) -> IntArray:
    """Return which predicted mode each unpaired measured one may be, (n_unpaired,), -1 where none is like it.

    A state that changes the model far enough may have what the nominal model has not. One that is stated to have no
    partner has none.

    Parameters
    ----------
    unpaired : Measured
        The measured modes that have no partner in the nominal model.
    prediction : Prediction
        Modes of a state.
    taken : (n,) int array
        Those that are others' partners.
    """
    alike = np.nan_to_num(mac_of_constants(unpaired, prediction, unpaired.trusted))
    away = np.abs(np.log(unpaired.frequency[:, None] / prediction.frequency))
    alike = np.where(np.nan_to_num(away, nan=np.inf) < NEAR, alike, 0.0)
    alike[:, taken] = 0.0
    rows, columns = linear_sum_assignment(-alike)
    found = np.full(len(unpaired.frequency), -1, dtype=np.int64)
    found[rows] = np.where(alike[rows, columns] > ALIKE, columns, -1)
    return found if unpaired.partners is None else np.where(unpaired.partners == NO_PARTNER, -1, found)


def _beside(measured: Measured, unpaired: Measured, rows: IntArray) -> Measured:
    """Return a test with some of its unpaired modes behind the others, as far as a match asks for them."""
    extra = unpaired.modes(rows)
    partners = measured.partners
    if partners is not None:
        partners = np.append(partners, np.full(len(rows), UNSTATED))
    own = measured.partner_constants
    if own is not None:
        own = np.hstack([own, np.zeros((len(own), len(rows)))])
    return replace(
        measured,
        frequency=np.append(measured.frequency, extra.frequency),
        constants=np.hstack([measured.constants, extra.constants]),
        partners=partners,
        partner_constants=own,
    )


def _stated(measured: Measured, prediction: Prediction) -> IntArray:
    """Return the predicted mode that each measured one is stated to be (n_measured,), negative where none is.

    Pairs are stated of the nominal model; in one that has changed its modes are known again by their shapes, since two
    may have changed places.
    """
    assert measured.partners is not None
    if measured.partner_constants is None:
        return measured.partners
    own, now = measured.partner_constants, prediction.constants
    power = np.sum(own**2, axis=0)[:, None] * np.sum(now**2, axis=0)
    alike = np.nan_to_num((own.T @ now) ** 2 / np.maximum(power, 1e-300))
    return np.where(measured.partners < 0, measured.partners, alike.argmax(axis=1))


def partners(
    measured: Measured, prediction: Prediction, order: IntArray, added: int
) -> tuple[IntArray, IntArray, IntArray]:
    """Return the predicted mode of each measured one, of unpaired ones where a state adds modes, and may be.

    Parameters
    ----------
    measured : Measured
        The test; its unpaired modes are compared, too.
    prediction : Prediction
        All modes predicted.
    order : (n_modes,) int array
        As of :func:`match`.
    added : int
        How many modes the state adds to those of the structure.
    """
    unpaired = measured.unpaired
    if unpaired is None:
        nothing = np.zeros(0, dtype=np.int64)
        return match(measured, prediction, order), nothing, nothing
    if added:
        found, claims = match_with_unpaired(measured, unpaired, prediction, order, added)
    else:
        found, claims = match(measured, prediction, order), np.full(len(unpaired.frequency), -1)
    return found, claims, offers(unpaired, prediction, np.append(found, claims[claims >= 0]))


def undisturbed(now: Prediction, plain: Prediction, absorbers: Sequence[Absorber]) -> FloatArray:
    """Return from where absorbers moved each mode: the structure's most like it, or one of theirs, (n_modes,) [Hz].

    Paired by modal overlap; what finds no mode of the structure is the mode of the absorber that swings nearest.
    """
    alike = now.overlap(plain)
    # what no mode of the structure has of it is the absorbers'
    theirs = np.repeat(1 - alike.sum(axis=1, keepdims=True), len(absorbers), axis=1)
    columns = counterparts(-np.hstack([alike, theirs]))
    alone = np.array([np.sqrt(one.stiffness / one.mass) / (2 * np.pi) for one in absorbers])
    nearest = alone[np.argmin(np.abs(np.log(now.frequency[:, None] / alone)), axis=1)]
    known = np.append(plain.frequency, np.full(len(absorbers), np.nan))[columns]
    return np.asarray(np.where(np.isnan(known), nearest, known))
