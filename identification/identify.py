"""Fully automatic identification: from FRFs to a modal model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from threadpoolctl import threadpool_limits

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from acquisition.errors import EstimationError, InputError
from acquisition.frfs.frf import FrfSet
from acquisition.modal_data import ModalData
from acquisition.quantities import hertz, percent
from acquisition.warned import Consequential
from identification.arrangement import signs, unsigned
from identification.band.uninformed import uninformed_modes
from identification.fading import noise_fading
from identification.fit.course import course_of, resampled
from identification.fit.equations import basis
from identification.fit.equations.pruning import inside, located
from identification.fit.equations.residues import Residues, synthesise
from identification.fit.fit import Fitted, provisional, with_named
from identification.fit.foreign import Foreign, foreign_frfs
from identification.fit.noise.disagreement import Disagreement
from identification.fit.poly_reference import sorted_frfs
from identification.fit.search.manual_selection import nearest_modes
from identification.line_shapes import fit_shaped, with_shape
from identification.model import ModalModel
from identification.orders import charted
from identification.poles import ESTIMATORS
from identification.poles.stabilisation import StabilisationChart
from identification.scaling import Shapes, mode_shapes
from identification.trend import Trend, frequency_trend
from identification.uncertainty import covariance, doubts
from identification.uncertainty.hit_scatter import NoiseFactors

_POOR_FIT = 4.0  # power left over that of the noise that is worth a word
_KEPT = 8  # fits with modes named by the user that are kept: so many picks can be undone without a new fit
# Standard deviations by which constants of a mode exceed their noise, in r.m.s. over the FRFs, where it is one even
# if the damping is not resolved, as between lines far apart. Noise fitted by a pole has 1 to 2, such modes above 70.
_CLEAR = 5.0
# Damping ratios by which frequencies must differ for a word: a peak that moves by less looks the same.
_DRIFT = 0.05
_TREND = (
    4.0  # standard deviations of a trend that is worth a word: as of other courses that are sought unasked
)
_BEYOND = 2.0  # a band may end beyond the lines, but not at a number that scales their background to nothing


def identify(
    frfs: FrfSet,
    *,
    band: tuple[float, float] | None = None,
    order: int | None = None,
    method: str = "lscf",
    add: Sequence[float] = (),
    drop: Sequence[float] = (),
) -> ModalModel:
    """Identify the modes of a band, without asking.

    Poles are estimated at many orders, those that stay are fitted by maximum likelihood together with their
    residues, and what the data do not bear out is struck off.

    Parameters
    ----------
    frfs : FrfSet
        FRFs of one or several references; one response with many references is a roving hammer.
    band : tuple of float, optional
        Lowest and highest frequency; default all lines [Hz].
    order : int, optional
        Largest number of poles tried; default 60, more if modes crowd it, fewer if there are few lines [-].
    method : str
        Pole estimator that supplies the candidates, one of `ESTIMATORS`: lscf, lsce, or one of your own.
    add, drop : sequence of float
        The user's word against the automatic choice: frequencies at which a mode is kept that the data
        alone would not bear out, and modes that are none, hum of the mains for instance. What is dropped stays
        in the fit, as background, and out of the result [Hz].

    Returns
    -------
    ModalModel
        Modes with their uncertainty.

    Raises
    ------
    InputError
        If the band is empty, the method unknown, or there is no mode where one is to be dropped.
    EstimationError
        If no mode stands out.
    """
    return prepare(frfs, band=band, order=order, method=method).modes(add=add, drop=drop)


@dataclass(frozen=True, eq=False)
class Prepared:
    """All of an identification that does not depend on which modes the user names.

    Parameters
    ----------
    frfs, data : FrfSet
        What was given, and that of it which lies in the band.
    band : tuple of float
        The band [Hz].
    chart : StabilisationChart
        Where the candidates came from.
    fitted : Fitted
        Their fit.
    points_rejected : tuple of str
        Points whose FRFs were left out, with the reason.
    warnings : tuple of str
        Warnings and notes on these.
    """

    frfs: FrfSet
    data: FrfSet
    band: tuple[float, float]
    chart: StabilisationChart
    fitted: Fitted
    points_rejected: tuple[str, ...]
    warnings: tuple[str, ...] = ()

    def modes(self, *, add: Sequence[float] = (), drop: Sequence[float] = ()) -> ModalModel:
        """Return the modes with the user's word on them: what :func:`identify` returns, to the last digit.

        Parameters
        ----------
        add, drop : sequence of float
            As of :func:`identify` [Hz].

        Raises
        ------
        InputError
            If no mode can be kept where one is named, or there is none where one is to be dropped.
        EstimationError
            If no mode is left.
        """
        with threadpool_limits(1, user_api="blas"):
            return _selected(self, self._with(tuple(add)), add, drop)

    def _with(self, add: tuple[float, ...]) -> Fitted:
        """Return the fit with the modes named, kept for the next call with the same."""
        if add not in self._kept:
            if len(self._kept) >= _KEPT:
                self._kept.pop(next(iter(self._kept)))
            self._kept[add] = with_named(self.fitted, add, band=self.band)
        return self._kept[add]

    @cached_property
    def _kept(self) -> dict[tuple[float, ...], Fitted]:
        return {}

    def provisional(self, hertz: float, *, add: Sequence[float] = ()) -> Provisional:
        """Return the fit with one more mode as far as a picture needs it; :meth:`modes` gives the last digits.

        Parameters
        ----------
        hertz : float
            Where the mode is [Hz].
        add : sequence of float
            Modes that were named before [Hz].

        Raises
        ------
        InputError
            If it is not among the lines.
        """
        with threadpool_limits(1, user_api="blas"):
            fitted = self._with(tuple(add))
            fit = provisional(fitted, hertz)
            modes = inside(fit.poles, self.band, self.data.df)
            values = synthesise(basis.Axis.of(fitted.frfs), fit.poles, fit.linear)
            frfs = replace(fitted.frfs, values=values, coherence=None, variance=None, averages=None)
            return Provisional(fit.poles[modes], frfs)


@dataclass(frozen=True, eq=False)
class Provisional:
    """What a picture needs of modes whose last digits are still being worked out.

    Parameters
    ----------
    poles : (n_modes,) complex array
        Poles in the band [rad/s].
    frfs : FrfSet
        The FRFs of the fit, as measured in form and signs.
    """

    poles: ComplexArray
    frfs: FrfSet


def prepare(
    frfs: FrfSet,
    *,
    band: tuple[float, float] | None = None,
    order: int | None = None,
    method: str = "lscf",
) -> Prepared:
    """Do all of an identification that does not depend on which modes the user names.

    Parameters
    ----------
    frfs, band, order, method
        As of :func:`identify`.

    Raises
    ------
    InputError
        If the band is empty, or the method unknown.
    EstimationError
        If no pole stands out.
    """
    if method not in ESTIMATORS:
        raise InputError(f"unknown pole estimator {method!r}; use one of {', '.join(ESTIMATORS)}")
    with threadpool_limits(1, user_api="blas"):  # on small matrices a second thread only costs
        return _prepared(frfs, band, order, method)


def _prepared(frfs: FrfSet, band: tuple[float, float] | None, order: int | None, method: str) -> Prepared:
    data, points_rejected = _usable(frfs, band)
    data, course, foreign = _of_one_structure(data)
    limits = band or (float(data.frequency[0]), float(data.frequency[-1]))
    even = data if course is None else resampled(data, course)
    chart, start = charted(even, ESTIMATORS[method], band=limits, order=order)
    if len(start) == 0:
        raise EstimationError(
            f"{frfs.source}: no pole is stable between {limits[0]:g} and {limits[1]:g} Hz as the order "
            "rises; widen the band, raise the order or check the FRFs"
        )
    fitted = fit_shaped(data, start, band=limits, course=course)
    if fitted.frfs.line_shape is not None and data.line_shape is None:
        data = with_shape(data, fitted.frfs.line_shape.kind)
    return Prepared(frfs, data, limits, chart, fitted, (*points_rejected, *foreign.reasons), foreign.warnings)


def _of_one_structure(data: FrfSet) -> tuple[FrfSet, FloatArray | None, Foreign]:
    """Return the FRFs that do not contradict the others, their course over the test, and those set aside."""
    course = course_of(data)
    foreign = foreign_frfs(data if course is None else resampled(data, course))
    if not foreign.rows.any():
        return data, course, foreign
    data = data.select(np.flatnonzero(~foreign.rows))
    return data, course_of(data), foreign


def _selected(prepared: Prepared, fitted: Fitted, add: Sequence[float], drop: Sequence[float]) -> ModalModel:
    """Return the modes of a fit that the data bear out or the user names, with their uncertainty."""
    data, limits = prepared.data, prepared.band
    modes = inside(fitted.fit.poles, limits, data.df)
    modes &= ~nearest_modes(fitted.fit.poles, drop, modes, data.df)
    errors = _Errors.of(fitted, modes)
    known = located(fitted.fit.poles, errors.poles, modes) | errors.clear(fitted)
    known |= nearest_modes(fitted.fit.poles, add, modes, data.df)
    struck, modes = fitted.fit.poles[modes & ~known], modes & known
    if not modes.any():
        why = "once the modes named are dropped" if drop else "in the band: the pole found is background"
        raise EstimationError(f"{data.source}: no mode is left {why}; widen the band")
    result = _assemble(data, fitted, errors, modes, prepared.chart, limits, prepared.points_rejected)
    statement = (
        *prepared.warnings,
        *_struck(struck),
        *uninformed_modes(prepared.frfs, result.modal.frequency),
    )
    return replace(result, warnings=result.warnings + statement) if statement else result


def _usable(frfs: FrfSet, band: tuple[float, float] | None) -> tuple[FrfSet, tuple[str, ...]]:
    """Cut to the band; leave out the line at s = 0 and FRFs that are zero."""
    if band is not None and not band[1] <= _BEYOND * float(frfs.frequency[-1]):
        raise InputError(
            f"{frfs.source}: the band is to end at {band[1]:g} Hz, the lines do at {frfs.frequency[-1]:g} Hz; "
            "give a band that they reach"
        )
    data = frfs if band is None else frfs.band(*band)
    data = data.double()
    first = float(data.frequency[0])
    if first < 1e-6 * data.df and len(data.frequency) > 2:
        data = data.band(0.5 * data.df, float(data.frequency[-1]))
    power = np.mean(np.abs(data.values) ** 2, axis=1)
    dead = power <= 1e-24 * power.max()
    if dead.all():
        raise EstimationError(f"{frfs.source}: all FRFs are zero in the band; there is nothing to identify")
    names = tuple(f"{data.responses[i]}/{data.references[i]}: the FRF is zero" for i in np.flatnonzero(dead))
    return (data.select(np.flatnonzero(~dead)) if dead.any() else data), names


@dataclass(frozen=True, eq=False)
class _Errors:
    """How far the poles of a fit may err: (n_poles, 2, 2) of (ln frequency, damping ratio)."""

    factors: NoiseFactors
    separation: Disagreement
    poles: FloatArray

    @classmethod
    def of(cls, fitted: Fitted, modes: BoolArray) -> _Errors:
        factors = covariance.noise_factors(fitted.frfs, fitted, modes)
        separation = covariance.disagreement(fitted, factors)
        return cls(factors, separation, covariance.pole_statistics(fitted, factors, separation))

    def clear(self, fitted: Fitted) -> BoolArray:
        """Return which poles have constants that no noise makes, (n_poles,), even if their damping is uncertain."""
        size = np.abs(fitted.fit.linear.residues * 2.0 * fitted.fit.poles.imag)
        own = covariance.own_errors(fitted, self.factors, self.separation)
        return np.asarray(np.mean((size / own) ** 2, axis=0) > _CLEAR**2)


def _assemble(
    data: FrfSet,
    fitted: Fitted,
    errors: _Errors,
    modes: BoolArray,
    chart: StabilisationChart,
    band: tuple[float, float],
    points_rejected: tuple[str, ...],
) -> ModalModel:
    fit = fitted.fit
    own, rest = np.flatnonzero(modes), np.flatnonzero(~modes)
    sign = signs(data)
    poles: ComplexArray = fit.poles[own]
    constants = sign[:, None] * fit.linear.residues[:, own] * 2j * poles.imag
    factors, separation, spread = errors.factors, errors.separation, errors.poles[own]
    sigma = covariance.constant_statistics(fitted, factors, separation)[:, own]
    alone = _alone(data, fitted, own, sigma) * np.sqrt(factors.shapes[own])
    shared = covariance.shared_errors(fitted, factors)[:, own]
    noise = covariance.own_errors(fitted, factors, separation)[:, own]
    if fitted.held is not None:
        noise = np.sqrt(np.maximum(alone**2 - np.sum(shared**2, axis=2), noise**2))
    shapes = mode_shapes(data, constants, alone, poles=poles)
    scatter = np.sqrt(separation.scatter[own, 1, 1])
    statement = doubts.about(data, poles, fit.poles[rest], constants, sigma, scatter)
    trend = frequency_trend(data, fitted.drift.at(poles), constants)
    terms = dict(zip(fit.linear.powers, fit.linear.terms.T, strict=True))
    return ModalModel(
        modal=_modal_data(data, poles, spread, shapes),
        poles=poles,
        pole_covariance=spread,
        constants=constants,
        constant_sigma=sigma,
        constant_noise=noise,
        constant_shared=sign[:, None, None] * shared,
        responses=tuple(unsigned(d) for d in data.responses),
        references=tuple(unsigned(d) for d in data.references),
        lower=sign * terms[-2],
        upper=sign * terms[0],
        background=Residues(fit.linear.residues[:, rest], fit.linear.terms, fit.linear.powers),
        background_poles=fit.poles[rest],
        band=band,
        frfs=data,
        chart=chart,
        warnings=shapes.warnings + _warnings(fitted, poles, trend) + statement,
        points_rejected=points_rejected,
        carried=None if np.shares_memory(fitted.frfs.values, data.values) else fitted.frfs,
        trend=trend,
        hit_errors=covariance.hit_errors(fitted, factors, own),
        fading=noise_fading(fitted),
    )


def _alone(data: FrfSet, fitted: Fitted, own: IntArray, sigma: FloatArray) -> FloatArray:
    """Return standard deviations of the constants as if each were measured by itself.

    Constants held to rank one share the uncertainty of their shape. What is returned gives that uncertainty
    back when the constants of all references are averaged with the square of the participations as weights.
    """
    held, places = fitted.held, sorted_frfs(data)
    if held is None or places is None or held.fit.residue_variance is None:
        return sigma
    total = np.zeros((places.shape[0], len(held.fit.poles)))
    np.add.at(total, places.row, np.abs(held.participation[places.column]) ** 2)
    raw = np.sqrt(held.long_variance * total)[places.row][:, own] * 2.0 * held.fit.poles.imag[own]
    plain = np.sqrt(held.fit.residue_variance[:, own]) * 2.0 * held.fit.poles.imag[own]
    return np.asarray(np.maximum(sigma, raw * sigma / np.maximum(plain, np.finfo(float).tiny)))


def _modal_data(data: FrfSet, poles: ComplexArray, spread: np.ndarray, shapes: Shapes) -> ModalData:
    frequency = np.abs(poles) / (2 * np.pi)
    return ModalData(
        frequency=frequency,
        frequency_sigma=frequency * np.sqrt(spread[:, 0, 0]),
        damping=-poles.real / np.abs(poles),
        damping_sigma=np.sqrt(spread[:, 1, 1]),
        dofs=shapes.dofs,
        shapes=shapes.shapes,
        shape_sigma=shapes.sigma,
        scaled=shapes.scaled,
        geometry=data.geometry,
    )


def _struck(poles: ComplexArray) -> tuple[str, ...]:
    if not len(poles):
        return ()
    named = ", ".join(hertz(abs(p) / (2 * np.pi)) for p in poles)
    return (
        f"what the fit has at {named} was not accepted as a mode: the data determine neither its frequency "
        "nor its damping; if it is a mode, name it with add",
    )


def _warnings(fitted: Fitted, poles: ComplexArray, trend: Trend | None) -> tuple[str, ...]:
    notes = []
    shift = np.sqrt(fitted.drift.at(poles).variance)
    if np.any(shift > _DRIFT * -poles.real / np.abs(poles)):
        notes.append(
            f"the frequencies differ from FRF to FRF by {percent(100 * shift.max())} (one standard deviation): a "
            "sensor or hammer that roves and loads the structure, or temperature; the FRFs are carried over to common "
            "poles, and what that leaves in doubt is in the standard deviations"
        )
        if trend is not None and abs(trend.rate) > _TREND * trend.rate_sigma:
            notes.append(
                f"the frequencies drift: from the first of {trend.setups} points to the last, in the order of the "
                f"file, by {100 * trend.rate:+.2g} % (sigma {percent(100 * trend.rate_sigma)}); what is identified "
                "is the structure in the middle of the test"
            )
    if fitted.frfs.line_shape is not None:
        notes.append(fitted.frfs.line_shape.statement(stated=fitted.frfs.window is not None))
    if not fitted.fit.converged:
        notes.append(doubts.not_at_rest(fitted.fit, poles))
    left = fitted.excess()
    if fitted.measured and left > _POOR_FIT:
        poor = (
            f"the fit leaves {left:.2g} times the power of the noise: modes are missing in it, or the FRFs do not "
            "belong together; narrow the band or raise the order"
        )
        notes.append(Consequential(poor))
    if fitted.rank_excess > 1.0:
        notes.append(
            "the references do not agree on the shapes: holding each mode to one shape raises the misfit "
            f"to {fitted.rank_excess:.2g} times what noise allows; check that nothing was moved between "
            "them, and whether the structure is symmetric: two modes at the same frequency have the same "
            "effect"
        )
    return tuple(notes)
