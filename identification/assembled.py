"""From a fit and its covariance to an identified model: modes with standard deviations, and what to know of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from acquisition.frfs.frf import FrfSet
from acquisition.modal_data import ModalData
from acquisition.quantities import percent
from acquisition.warned import Consequential
from identification.arrangement import signs, unsigned
from identification.fading import noise_fading
from identification.fit.equations.residues import Residues
from identification.fit.fit import Fitted
from identification.fit.noise.disagreement import Disagreement
from identification.fit.poly_reference import sorted_frfs
from identification.model import ModalModel
from identification.poles.stabilisation import StabilisationChart
from identification.scaling import Shapes, mode_shapes
from identification.trend import Trend, frequency_trend
from identification.uncertainty import covariance, doubts
from identification.uncertainty.hit_scatter import NoiseFactors

_POOR_FIT = 4.0  # power left over that of the noise that is worth a word

# Standard deviations by which constants of a mode exceed their noise, in r.m.s. over the FRFs, where it is one even
# if the damping is not resolved, as between lines far apart. Noise fitted by a pole has 1 to 2, such modes above 70.
_CLEAR = 5.0

# Damping ratios by which frequencies must differ for a word: a peak that moves by less looks the same.
_DRIFT = 0.05

_TREND = (
    4.0  # standard deviations of a trend that is worth a word: as of other courses that are sought unasked
)


@dataclass(frozen=True, eq=False)
class PoleErrors:
    """How far the poles of a fit may err.

    Parameters
    ----------
    factors : NoiseFactors
        Noise of the fit over what is stated.
    separation : Disagreement
        How far the FRFs disagree on each pole.
    poles : (n_poles, 2, 2) array
        Covariance of ln frequency and damping ratio [-].
    """

    factors: NoiseFactors
    separation: Disagreement
    poles: FloatArray

    @classmethod
    def of(cls, fitted: Fitted, modes: BoolArray) -> PoleErrors:
        """Return the errors of a fit whose poles that are modes are marked, (n_poles,)."""
        factors = covariance.noise_factors(fitted.frfs, fitted, modes)
        separation = covariance.disagreement(fitted, factors)
        return cls(factors, separation, covariance.pole_statistics(fitted, factors, separation))

    def clear(self, fitted: Fitted) -> BoolArray:
        """Return which poles have constants that no noise makes, (n_poles,), even if their damping is uncertain."""
        size = np.abs(fitted.fit.linear.residues * 2.0 * fitted.fit.poles.imag)
        own = covariance.own_errors(fitted, self.factors, self.separation)
        return np.asarray(np.mean((size / own) ** 2, axis=0) > _CLEAR**2)


def assemble(
    data: FrfSet,
    fitted: Fitted,
    errors: PoleErrors,
    modes: BoolArray,
    chart: StabilisationChart,
    band: tuple[float, float],
    points_rejected: tuple[str, ...],
) -> ModalModel:
    """Return the modes of a fit, marked (n_poles,), with the rest as background [band in Hz]."""
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
    doubted = doubts.about(data, poles, fit.poles[rest], constants, sigma, scatter)
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
        warnings=shapes.warnings + _warnings(fitted, poles, trend) + doubted,
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


def _warnings(fitted: Fitted, poles: ComplexArray, trend: Trend | None) -> tuple[str, ...]:
    notes = []
    shift = np.sqrt(fitted.drift.at(poles).variance)
    if np.any(shift > _DRIFT * -poles.real / np.abs(poles)):
        notes.append(
            f"the frequencies differ from FRF to FRF by {percent(100 * shift.max())} (one standard deviation): a "
            "roving sensor or hammer loads the structure, or the temperature changed. The FRFs are corrected to common "
            "poles; the standard deviations include the remaining uncertainty"
        )
        if trend is not None and abs(trend.rate) > _TREND * trend.rate_sigma:
            notes.append(
                f"the frequencies drift by {100 * trend.rate:+.2g} % (sigma {percent(100 * trend.rate_sigma)}) from "
                f"the first to the last of {trend.setups} points, in the order of the file; the modes are those in the "
                "middle of the test"
            )
    if fitted.frfs.line_shape is not None:
        notes.append(fitted.frfs.line_shape.note(stated=fitted.frfs.window is not None))
    if not fitted.fit.converged:
        notes.append(doubts.not_at_rest(fitted.fit, poles))
    left = fitted.excess()
    if fitted.measured and left > _POOR_FIT:
        poor = (
            f"the residual of the fit has {left:.2g} times the power of the noise: modes are missing in the fit, or "
            "the FRFs do not belong together; narrow the band or raise the order"
        )
        notes.append(Consequential(poor))
    if fitted.rank_excess > 1.0:
        notes.append(
            "the references do not agree on the shapes: with one shape per mode the misfit is "
            f"{fitted.rank_excess:.2g} times what noise allows; check that nothing was moved between the "
            "references. Two modes at one frequency, as in a symmetric structure, have the same effect"
        )
    return tuple(notes)
