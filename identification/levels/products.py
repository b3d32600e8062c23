"""Intermodulation: peaks that a nonlinear joint makes at sums and differences of natural frequencies.

A joint that slips or closes answers two modes with their products, and an average over hits shows these as peaks of
their own. A modal constant does not depend on the level; the response of a product of order n grows with the n-th power
of the force, so that its constant in an FRF grows with the power n - 1 (Worden and Tomlinson, Nonlinearity in
Structural Dynamics, 2001, chapter 3). Both follow from the hits. A frequency alone is no proof: modes may lie there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from acquisition import Windows
from acquisition.arrays import BoolArray, ComplexArray, FloatArray
from identification.fit.noise.disagreement import student_widening
from identification.level_dependence import LevelDependence
from identification.levels.hits import Judged, why_not
from identification.levels.one_level import hit_poles, hit_residues, hit_shifts
from identification.levels.slopes import band_of, known_hits, of_single, rows_of, weights_of
from identification.model import ModalModel

HALF = 0.5
"""Power of the force with which a constant grows: halfway between a mode, 0, and the lowest product, 1 [-]."""

SURE = 3.0
"""Growth over its standard deviation from which it is no chance [-]. Doubled: products that single hits hardly show
stay among the modes; at 2, one faint mode in forty passes for a product."""


@dataclass(frozen=True, eq=False)
class Growth:
    """How the modal constants follow the level of the hits.

    Parameters
    ----------
    power, sigma : (n_modes,) arrays
        d ln A / d ln F of each mode over all FRFs at the level of the averages, and its standard deviation [-].
    """

    power: FloatArray
    sigma: FloatArray

    @property
    def products(self) -> BoolArray:
        """Which modes are products of others: their constants grow with the force, (n_modes,)."""
        return np.asarray((self.power > HALF) & (self.power > SURE * self.sigma))

    @property
    def _falls(self) -> BoolArray:
        """Of which modes the constants fall with the force by more than chance, (n_modes,)."""
        return np.asarray((self.power < -HALF) & (self.power < -SURE * self.sigma))

    def surer(self, other: Growth) -> Growth:
        """Return of each mode the power that is determined better: of one fit or another of the same hits.

        The constants of neither a mode nor a product fall with the force. Where they do, the poles of the fit are not
        those of each hit, and the other fit stands.
        """
        better = np.where(self._falls == other._falls, self.sigma <= other.sigma, other._falls)
        return Growth(np.where(better, self.power, other.power), np.where(better, self.sigma, other.sigma))


def growth(
    model: ModalModel,
    tests: Sequence[Judged],
    found: LevelDependence | None = None,
    *,
    windows: Windows | None = None,
) -> Growth | None:
    """Return how modal constants follow the level of the hits; None where the hits show no level dependence.

    Parameters
    ----------
    model : ModalModel
        Identified from the FRFs of these hits.
    tests : sequence of (HammerTest, verdicts)
        The raw hits and what was decided on them.
    found : LevelDependence, optional
        How the poles follow the level; left out, those of the model hold for every hit.
    windows : Windows, optional
        As when the FRFs were estimated.

    Notes
    -----
    The constants of the hits at one point are fitted by A (1 + b (F / F0 - 1)) with one b for all points and responses,
    each hit weighted by its power and each FRF by its noise. The standard deviation comes from the scatter of the hits,
    corrected for the mean of each point and for b (MacKinnon and White, J. Econometrics 29 (1985) 305-325, HC1).
    """
    rows = rows_of(model)
    entries = known_hits(tests, rows)
    if why_not(entries) is not None:
        return None
    weights, first = weights_of(model), 0
    shifts = (
        np.zeros((sum(len(e.levels) for e in entries), len(model), 2))
        if found is None
        else hit_shifts(found)[0]
    )
    points = []
    for entry in entries:
        constants, noise = [], np.ones((1, 1))
        for frfs in entry.single_frfs(windows=windows, band=band_of(model)):
            data, own, _ = of_single(frfs, weights, rows)
            poles = hit_poles(model, shifts[first])
            constants.append(hit_residues(model, data, poles, own) * 2j * poles.imag)
            stated = [rows[pair] for pair in zip(data.responses, data.references, strict=True)]
            noise, first = model.constant_noise[stated], first + 1
        points.append(_Point.of(np.array(constants), entry.levels, noise))
    return _fitted(points)


def _fitted(points: Sequence[_Point]) -> Growth:
    """Return the power that all points have in common, and its standard deviation by the scatter of the hits."""
    tiny = np.finfo(float).tiny
    information = np.maximum(np.sum([point.information for point in points], axis=0), tiny)
    power = np.sum([point.pull for point in points], axis=0) / information
    squares = np.sum([np.sum(point.scores(power) ** 2, axis=0) for point in points], axis=0)
    hits = sum(len(point.weight) for point in points)
    freedom = max(hits - len(points) - 1, 1)
    variance = student_widening(freedom) * squares * hits / freedom
    return Growth(power, np.sqrt(variance) / information)


@dataclass(frozen=True, eq=False)
class _Point:
    """Constants of the hits at one point, and their fit by a line over the level.

    Parameters
    ----------
    constants : (n_hits, n_rows, n_modes) complex array
        Constants over the noise of their FRF [-].
    mean : (n_rows, n_modes) complex array
        Their weighted mean [-].
    beyond : (n_hits,) array
        Level over the weighted mean level, less 1 [-].
    weight : (n_hits,) array
        Share of each hit in the point's power [-].
    """

    constants: ComplexArray
    mean: ComplexArray
    beyond: FloatArray
    weight: FloatArray

    @classmethod
    def of(cls, constants: ComplexArray, levels: FloatArray, noise: FloatArray) -> _Point:
        weight = levels**2 / np.sum(levels**2)
        scaled = constants / np.maximum(noise, np.finfo(float).tiny)
        return cls(scaled, np.tensordot(weight, scaled, axes=1), levels / (weight @ levels) - 1, weight)

    def scores(self, power: FloatArray) -> FloatArray:
        """Return what each hit pulls the power by, less what the line explains, (n_hits, n_modes)."""
        line = self.mean * (1 + power * self.beyond[:, None, None])
        along = np.einsum("hrn,rn->hn", self.constants - line, self.mean.conj()).real
        return np.asarray((self.weight * self.beyond)[:, None] * along)

    @property
    def pull(self) -> FloatArray:
        """What all hits pull the power by, from 0, (n_modes,)."""
        return np.asarray(self.scores(np.zeros(self.mean.shape[1])).sum(axis=0))

    @property
    def information(self) -> FloatArray:
        """By how much a unit of power changes the pull, (n_modes,)."""
        return np.asarray((self.weight @ self.beyond**2) * np.sum(np.abs(self.mean) ** 2, axis=0))
