"""Fully automatic identification: from FRFs to a modal model."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from threadpoolctl import threadpool_limits

from acquisition.arrays import ComplexArray, FloatArray
from acquisition.display import counted
from acquisition.errors import EstimationError, InputError
from acquisition.frfs.frf import FrfSet
from acquisition.quantities import hertz
from identification.assembled import PoleErrors, assemble
from identification.band.uninformed import uninformed_modes
from identification.fit.course import course_of, resampled
from identification.fit.drift import blurred_by
from identification.fit.equations import basis
from identification.fit.equations.pruning import inside, located
from identification.fit.equations.residues import synthesise
from identification.fit.fit import Fitted, provisional, with_named
from identification.fit.foreign import Foreign, foreign_frfs
from identification.fit.search.manual_selection import nearest_modes
from identification.line_shapes import fit_shaped, with_shape
from identification.model import ModalModel
from identification.orders import charted
from identification.poles import ESTIMATORS, PoleEstimator
from identification.poles.stabilisation import StabilisationChart

_KEPT = 8  # fits with modes named by the user that are kept: so many picks can be undone without a new fit
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

    def modes(
        self,
        *,
        add: Sequence[float] = (),
        drop: Sequence[float] = (),
        progress: Callable[[str], None] | None = None,
    ) -> ModalModel:
        """Return the modes with the user's word on them: what :func:`identify` returns, to the last digit.

        Parameters
        ----------
        add, drop : sequence of float
            As of :func:`identify` [Hz].
        progress : function, optional
            Called with the name of every stage as it begins.

        Raises
        ------
        InputError
            If no mode can be kept where one is named, or there is none where one is to be dropped.
        EstimationError
            If no mode is left.
        """
        with threadpool_limits(1, user_api="blas"):
            fitted = self._with(tuple(add))
            _begin(progress, "estimating standard deviations")
            return _selected(self, fitted, add, drop)

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
    progress: Callable[[str], None] | None = None,
) -> Prepared:
    """Do all of an identification that does not depend on which modes the user names.

    Parameters
    ----------
    frfs, band, order, method
        As of :func:`identify`.
    progress : function, optional
        Called with the name of every stage as it begins.

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
        return _prepared(frfs, band, order, method, progress)


def _begin(progress: Callable[[str], None] | None, stage: str) -> None:
    if progress is not None:
        progress(stage)


def _prepared(
    frfs: FrfSet,
    band: tuple[float, float] | None,
    order: int | None,
    method: str,
    progress: Callable[[str], None] | None,
) -> Prepared:
    _begin(progress, "estimating poles")
    data, points_rejected = _usable(frfs, band)
    data, course, foreign = _of_one_structure(data)
    limits = band or (float(data.frequency[0]), float(data.frequency[-1]))
    chart, fitted = _fitted(data, course, ESTIMATORS[method], limits, order, progress)
    if course is None and blurred_by(fitted.drift, inside(fitted.fit.poles, limits, data.df)):
        with suppress(EstimationError):  # no pole along it: the course is none, and the first fit stands
            again = _fitted(data, fitted.drift.common, ESTIMATORS[method], limits, order, progress)
            chart, fitted = min((chart, fitted), again, key=lambda one: one[1].left_unexplained())
    if fitted.frfs.line_shape is not None and data.line_shape is None:
        data = with_shape(data, fitted.frfs.line_shape.kind)
    return Prepared(frfs, data, limits, chart, fitted, (*points_rejected, *foreign.reasons), foreign.warnings)


def _fitted(
    data: FrfSet,
    course: FloatArray | None,
    estimate: PoleEstimator,
    band: tuple[float, float],
    order: int | None,
    progress: Callable[[str], None] | None,
) -> tuple[StabilisationChart, Fitted]:
    """Return the stabilisation chart and the fit of the poles that are stable, along the course of the test."""
    even = data if course is None else resampled(data, course)
    chart, start = charted(even, estimate, band=band, order=order)
    if len(start) == 0:
        raise EstimationError(
            f"{data.source}: no pole is stable between {band[0]:g} and {band[1]:g} Hz as the order "
            "rises; widen the band, raise the order or check the FRFs"
        )
    _begin(progress, f"fitting {counted(len(start), 'candidate')} to {counted(len(data.values), 'FRF')}")
    return chart, fit_shaped(data, start, band=band, course=course)


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
    errors = PoleErrors.of(fitted, modes)
    known = located(fitted.fit.poles, errors.poles, modes) | errors.clear(fitted)
    known |= nearest_modes(fitted.fit.poles, add, modes, data.df)
    struck, modes = fitted.fit.poles[modes & ~known], modes & known
    if not modes.any():
        why = "once the modes named are dropped" if drop else "in the band: the pole found is background"
        raise EstimationError(f"{data.source}: no mode is left {why}; widen the band")
    result = assemble(data, fitted, errors, modes, prepared.chart, limits, prepared.points_rejected)
    warnings = (
        *prepared.warnings,
        *_struck(struck),
        *uninformed_modes(prepared.frfs, result.modal.frequency),
    )
    return replace(result, warnings=result.warnings + warnings) if warnings else result


def _usable(frfs: FrfSet, band: tuple[float, float] | None) -> tuple[FrfSet, tuple[str, ...]]:
    """Cut to the band; leave out the line at s = 0 and FRFs that are zero."""
    if band is not None and not band[1] <= _BEYOND * float(frfs.frequency[-1]):
        raise InputError(
            f"{frfs.source}: the band ends at {band[1]:g} Hz, beyond the last line at {frfs.frequency[-1]:g} Hz; "
            "give a band within the lines"
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


def _struck(poles: ComplexArray) -> tuple[str, ...]:
    if not len(poles):
        return ()
    named = ", ".join(hertz(abs(p) / (2 * np.pi)) for p in poles)
    return (
        f"the pole of the fit at {named} was not accepted as a mode: the data determine neither its frequency "
        "nor its damping; if it is a mode, name it with add",
    )
