"""Which measured modes have a partner in the model, and which."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from acquisition.errors import EstimationError
from acquisition.quantities import hertz, percent
from identification import pair
from updating.prediction.assignment import mac_of_constants, match
from updating.prediction.prediction import Prediction
from updating.prediction.trusted_frfs import left_out, trusted_rows
from updating.test_data.measured import NO_PARTNER, UNSTATED, Measured

WILD = 0.25
"""Standard deviation of the logarithms of the frequency ratios beyond which ranks are doubted."""

DISTANT, NOTHING_IN_COMMON = 2.0, 10.0
"""Typical ratio of frequencies, test to model or back, from which pairs by rank are doubted, and refused."""

FAINT = 0.35
"""Modes whose constants are no better known than this, relative to their r.m.s., are not compared."""

ASTRAY = 0.5
"""A pair whose logarithm of the frequency ratio lies so far from the others' median is no pair..."""

SAME = 0.95
"""...unless the shapes are the same, and it is not `NOTHING_IN_COMMON` times that median or more: on few points a
structure that bounces on its supports looks like a mode far above the band."""

LOWEST_MAC = 0.4
"""Below this MAC a measured mode has no partner, however near; the least MAC rises from here to `SAME` with the
distance of its frequency ratio from the others' up to `ASTRAY`."""


@dataclass(frozen=True, eq=False)
class Paired:
    """Measured modes that have a partner in the model.

    Parameters
    ----------
    measured : Measured
        The test with these modes only, and the rows by which they were paired where some channel spoils the shapes.
    order : (n_modes,) int array
        Rank of each one's partner among the model's modes.
    rows : (n_modes,) int array
        Which of the test's modes they are, from 0.
    warnings : tuple of str
        Which modes have none.
    mostly_alone : bool
        Whether most of the measured modes have none.
    """

    measured: Measured
    order: IntArray
    rows: IntArray
    warnings: tuple[str, ...]
    mostly_alone: bool = False

    @property
    def trusted(self) -> BoolArray | None:
        """Rows by which they were paired, where some points or sensors spoil the shapes of all modes."""
        return self.measured.trusted


def pair_modes(measured: Measured, prediction: Prediction) -> Paired:
    """Find the partner of every measured mode, and leave out those without one.

    Parameters
    ----------
    measured : Measured
        The test.
    prediction : Prediction
        The nominal model's modes, in order of frequency.

    Raises
    ------
    EstimationError
        If no mode has a partner.
    """
    if not measured.has_shapes:
        return _pair_by_order(measured, prediction)
    measured = replace(measured, trusted=None, partner_constants=None)
    clear, lost = _clear(measured)
    measured = measured.modes(clear)
    if len(measured.frequency) > len(prediction.frequency):
        raise EstimationError(
            f"the test has {len(measured.frequency)} modes and the model {len(prediction.frequency)} in its band; "
            "narrow the band of the test"
        )
    trusted = trusted_rows(measured, prediction)
    found = _without_strangers(measured, prediction, trusted)
    order, mac, ratio, keep = found.order, found.mac, found.ratio, found.keep
    if not keep.any():
        best = int(np.argmax(mac))
        raise EstimationError(
            f"{measured.title or 'test'}: no measured mode has a partner in the model (best: MAC {mac[best]:.2f} at "
            f"{hertz(measured.frequency[best])}, frequency ratio {np.exp(ratio[best]):.3g}); check axes, points, "
            "boundary conditions, and the model's size and units (m, Pa, kg/m3)"
        )
    lost += [
        f"mode at {hertz(f)} has no partner in the model (best: MAC {m:.2f}, frequency ratio {np.exp(r):.2f})"
        for f, m, r in zip(measured.frequency[~keep], mac[~keep], ratio[~keep], strict=True)
    ]
    alone = bool(keep.sum() < len(keep) / 2)
    if alone:
        lost.append(MOSTLY_ALONE)
    if trusted is not None:
        lost.append(f"modes are paired without {left_out(measured, trusted)}, which distorts their shapes")
    unpaired = None if keep.all() else replace(measured.modes(~keep), trusted=trusted)
    if measured.partners is not None:
        measured = replace(measured, partner_constants=prediction.constants[:, order])
    paired = replace(measured.modes(keep), trusted=trusted, unpaired=unpaired)
    return Paired(paired, order[keep], np.flatnonzero(clear)[keep], tuple(lost), alone)


@dataclass(frozen=True, eq=False)
class _Tried:
    """Partners of measured modes, those of some sought after the others have theirs.

    Parameters
    ----------
    order : (n_modes,) int array
        Rank of each one's partner.
    mac, ratio : (n_modes,) arrays
        MAC with it, and the logarithm of the frequency ratio, test over model [-].
    keep : (n_modes,) bool array
        Whether it is one.
    """

    order: IntArray
    mac: FloatArray
    ratio: FloatArray
    keep: BoolArray


def _without_strangers(measured: Measured, prediction: Prediction, trusted: BoolArray | None) -> _Tried:
    """Find partners such that no mode without one takes another's.

    Every measured mode is assigned one of the model's. One that the model lacks, as that of a mass on a spring, may so
    take what belongs to a mode that is left with a stranger: where one of those without a partner set aside leaves more
    of the others with one, it is set aside.
    """
    macs = mac_of_constants(measured, prediction, trusted)
    first = np.ones(len(measured.frequency), dtype=bool)
    best = _tried(measured, prediction, macs, trusted, first)
    while not best.keep.all():
        trials = [first & (np.arange(len(first)) != i) for i in np.flatnonzero(first & ~best.keep)]
        found = [
            (_tried(measured, prediction, macs, trusted, trial), trial) for trial in trials if trial.any()
        ]
        better = max(found, key=lambda pair: pair[0].keep.sum(), default=None)
        if better is None or better[0].keep.sum() <= best.keep.sum():
            return best
        best, first = better
    return best


def _tried(
    measured: Measured, prediction: Prediction, macs: FloatArray, trusted: BoolArray | None, first: BoolArray
) -> _Tried:
    """Find partners of some modes (n_modes,) first, and what is most like each of the others."""
    count = len(measured.frequency)
    order = np.argmax(macs, axis=1)
    order[first] = match(measured.modes(first), prediction, np.arange(int(first.sum())), trusted)
    mac = macs[np.arange(count), order]
    ratio = np.log(measured.frequency / prediction.frequency[order])
    beside = np.abs(ratio - np.median(ratio[first]))
    keep = mac >= LOWEST_MAC + (SAME - LOWEST_MAC) * np.minimum(beside / ASTRAY, 1.0)
    keep &= beside < np.log(NOTHING_IN_COMMON)
    return _Tried(order, mac, ratio, _as_stated(measured, prediction, keep & first))


def _as_stated(measured: Measured, prediction: Prediction, keep: BoolArray) -> BoolArray:
    """Return which modes have a partner once the stated pairs stand.

    Raises
    ------
    EstimationError
        If a stated partner is not one of the model's modes.
    """
    if measured.partners is None:
        return keep
    if (measured.partners >= len(prediction.frequency)).any():
        raise EstimationError(
            f"{measured.title or 'test'}: pairs name model mode {int(measured.partners.max()) + 1}; the model has "
            f"{len(prediction.frequency)} modes in the band of the test"
        )
    return np.asarray((keep | (measured.partners >= 0)) & (measured.partners != NO_PARTNER))


MOSTLY_ALONE = (
    "most measured modes have no partner: test and model may not be the same structure, or points or signs are "
    "wrong"
)
"""The warning in that case."""


def _clear(measured: Measured) -> tuple[BoolArray, list[str]]:
    """Return which modes have constants above their own uncertainty, and notes on the others."""
    size = np.sqrt(np.mean(measured.constants**2, axis=0))
    doubt = np.sqrt(np.mean(measured.constants_sigma**2, axis=0)) / np.maximum(size, 1e-300)
    faint = doubt > FAINT
    if faint.all():
        raise EstimationError(
            f"{measured.title or 'test'}: every mode's shape is dominated by noise; average more hits or "
            "narrow the band"
        )
    lost = [
        f"mode at {hertz(f)} is too faint to compare (its constants are uncertain by {percent(100 * d)}) "
        "and is left out"
        for f, d in zip(measured.frequency[faint], doubt[faint], strict=True)
    ]
    return ~faint, lost


def _pair_by_order(measured: Measured, prediction: Prediction) -> Paired:
    """Pair by rank; let modes be skipped only where the ratios of frequencies are wild without."""
    if measured.partners is not None and (measured.partners != UNSTATED).any():
        return _by_statement(measured, prediction)
    above = prediction.frequency[measured.below :]
    count = min(len(measured.frequency), len(above))
    ratio = np.log(measured.frequency[:count] / above[:count])
    if count == len(measured.frequency) and np.std(ratio) < WILD:
        order = measured.below + np.arange(count)
        distance = _distance(measured, float(np.exp(np.median(ratio))))
        return Paired(measured, order, np.arange(count), distance)
    pairs = pair(measured.frequency, prediction.frequency, None)
    rows = np.array([p.test for p in pairs if p.model is not None and p.test is not None], dtype=int)
    order = np.array([p.model for p in pairs if p.model is not None and p.test is not None], dtype=int)
    if not len(rows):
        raise EstimationError(f"{measured.title or 'test'}: no measured frequency has a partner in the model")
    keep = np.zeros(len(measured.frequency), dtype=bool)
    keep[rows] = True
    lost = [f"mode at {hertz(f)} has no partner in the model" for f in measured.frequency[~keep]]
    return Paired(measured.modes(keep), order[np.argsort(rows)], np.flatnonzero(keep), tuple(lost))


def _by_statement(measured: Measured, prediction: Prediction) -> Paired:
    """Pair by rank with the stated pairs in it: the other modes take the model's that are left, in order."""
    assert measured.partners is not None
    keep = _as_stated(measured, prediction, np.ones(len(measured.frequency), dtype=bool))
    stated = measured.partners
    free = [m for m in range(measured.below, len(prediction.frequency)) if m not in set(stated.tolist())]
    rest = np.flatnonzero(keep & (stated == UNSTATED))
    keep[rest[len(free) :]] = False
    order = stated.copy()
    order[rest[: len(free)]] = free[: len(rest)]
    lost = [f"mode at {hertz(f)} has no partner in the model" for f in measured.frequency[~keep]]
    if not keep.any():
        raise EstimationError(f"{measured.title or 'test'}: no measured frequency has a partner in the model")
    return Paired(measured.modes(keep), order[keep], np.flatnonzero(keep), tuple(lost))


MISTAKEN = {
    1e3: "the model's lengths are in mm, or its E in MPa",
    10**4.5: "the model's E is in GPa",
    1e-3: "the model's thickness alone is in mm, or the test's frequencies are in kHz",
    10**-1.5: "the model's density is in g/cm3",
    39.37: "the model's lengths are in inches",
}
"""Ratio of frequencies, test to model, that a unit other than SI makes: frequencies go as thickness over length
squared, and as the root of E over density [-]."""

LIKELY = 2.5
"""How far from such a ratio, as a factor, test and model may be for it to be named: farther off than most gaps [-]."""


def _probable(ratio: float) -> str:
    """Return which unit was probably meant by a ratio of frequencies, test to model; nothing where none fits."""
    off = {other: abs(np.log(ratio / other)) for other in MISTAKEN}
    nearest = min(off, key=lambda other: off[other])
    return f"; probably {MISTAKEN[nearest]}" if off[nearest] < np.log(LIKELY) else ""


def _distance(measured: Measured, ratio: float) -> tuple[str, ...]:
    """State how far test and model are apart where ranks alone pair them.

    Raises
    ------
    EstimationError
        If so far that they have no mode in common.
    """
    times = f"the test's frequencies are {ratio:.3g} times the model's"
    if max(ratio, 1 / ratio) > NOTHING_IN_COMMON:
        raise EstimationError(
            f"{measured.title or 'test'}: no modes in common: {times}; check the units of the model (m, Pa, kg/m3) "
            f"and of the test (Hz){_probable(ratio)}"
        )
    far = max(ratio, 1 / ratio) > DISTANT
    return (f"{times}, and they are paired by their order alone: they may be different modes",) if far else ()
