"""Spectra of hits, the FRFs averaged from them, and what each hit adds to their errors."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import scipy.fft

from acquisition.arrays import BoolArray, ComplexArray, FloatArray
from acquisition.display import Displayed
from acquisition.errors import EstimationError
from acquisition.hits.hammer import HammerTest, Hits

Estimator = Literal["H1", "H2", "Hv"]
ESTIMATORS: tuple[Estimator, ...] = ("H1", "H2", "Hv")
ALONE = 1e-9  # part of the power of a line that the other hits have, if one hit has it alone


@dataclass(frozen=True, eq=False)
class Spectra(Displayed):
    """Spectra of the hits at one point.

    Parameters
    ----------
    force : (n_hits, n_lines) complex array
        Of the forces [any].
    motion : (n_hits, n_responses, n_lines) complex array
        Of the responses [any].
    """

    force: ComplexArray
    motion: ComplexArray

    @classmethod
    def of(cls, hits: Hits, keep: BoolArray, test: HammerTest, lines: slice) -> Spectra:
        """Transform the hits to be used.

        Raises
        ------
        EstimationError
            If the force is zero.
        """
        force = scipy.fft.rfft(np.asarray(hits.force[keep], dtype=np.float64), axis=-1)[:, lines]
        if not np.any(force):
            raise EstimationError(f"{test.source}: the force at {hits.reference} is zero; check its channel")
        motion = scipy.fft.rfft(np.asarray(hits.motion[keep], dtype=np.float64), axis=-1)[..., lines]
        return cls(force, motion)

    def powers(self) -> tuple[FloatArray, FloatArray, ComplexArray]:
        """Return |F|^2, |X|^2 and X conj(F) of each hit, (n_hits, n_lines), (n_hits, n_responses, n_lines)."""
        return squared(self.force), squared(self.motion), self.motion * self.force.conj()[:, None]

    def sums(self) -> tuple[FloatArray, FloatArray, ComplexArray]:
        """Return the same summed over the hits, (1, n_lines) and twice (n_responses, n_lines)."""
        cross = np.einsum("hrl,hl->rl", self.motion, self.force.conj())
        return squared(self.force).sum(axis=0)[None], squared(self.motion).sum(axis=0), np.asarray(cross)


def squared(values: ComplexArray) -> FloatArray:
    """Return |values|^2, without the root in between."""
    return np.asarray(values.real**2 + values.imag**2, dtype=np.float64)


def combine(gff: FloatArray, gxx: FloatArray, gxf: ComplexArray, estimator: Estimator) -> ComplexArray:
    """Return the FRF from averaged spectra; 0 at lines where there is no force.

    Parameters
    ----------
    gff : (..., 1, n_lines) array
        Auto-spectrum of the force [any].
    gxx : (..., n_responses, n_lines) array
        Auto-spectra of the responses [any].
    gxf : (..., n_responses, n_lines) complex array
        Cross-spectra X conj(F) [any].
    estimator : {"H1", "H2", "Hv"}
        Which.
    """
    h1 = np.asarray(gxf / np.where(gff > 0, gff, 1.0), dtype=np.complex128)
    if estimator == "H1":
        return h1
    scale = 1 / np.maximum(coherence_of(gff, gxx, gxf), 1e-12)
    return np.asarray(h1 * (scale if estimator == "H2" else np.sqrt(scale)))


def coherence_of(gff: FloatArray, gxx: FloatArray, gxf: ComplexArray) -> FloatArray:
    """Return |G_xf|^2 / (G_xx G_ff), 0 where there is no power [-]; arguments as for `combine`."""
    power = gxx * gff
    return np.asarray(np.clip(squared(gxf) / np.where(power > 0, power, 1.0), 0.0, 1.0), dtype=np.float64)


def deviations(spectra: Spectra, frf: ComplexArray, estimator: Estimator = "H1") -> ComplexArray:
    """Return what each hit adds to the error of an averaged FRF, see `HitScatter`.

    Parameters
    ----------
    spectra : Spectra
        Of two hits or more at one point.
    frf : (n_responses, n_lines) complex array
        The average over these hits.
    estimator : {"H1", "H2", "Hv"}
        How it was averaged.

    Returns
    -------
    (n_hits, n_responses, n_lines) complex array
        sqrt(1 - h_k) (H - H without hit k), with the leverage h_k = |F_k|^2 / sum |F|^2: the weighted
        jackknife, without bias for noise equal in all hits (Wu, Annals of Statistics 14, 1986, section 5).
        For H1 this is conj(F_k) (X_k - H F_k) / (sum |F|^2 sqrt(1 - h_k)), the least-squares residuals of
        hit k in the form HC2 of MacKinnon and White, Journal of Econometrics 29 (1985). A line with
        force in one hit at most gives no information on the scatter: the error there is taken for as large as the FRF
        is at the other lines.
    """
    moved = _moved(spectra, frf, estimator)
    power = squared(spectra.force)
    silent = power.max(axis=0) >= (1 - ALONE) * power.sum(axis=0)
    if silent.any() and not silent.all():
        moved[..., silent] = np.sqrt(squared(frf[:, ~silent]).mean(axis=-1) / len(moved))[:, None]
    return moved


def _moved(spectra: Spectra, frf: ComplexArray, estimator: Estimator) -> ComplexArray:
    power = squared(spectra.force)
    total = power.sum(axis=0)
    total = np.where(total > 0, total, 1.0)
    root = np.sqrt(np.maximum(1 - power / total, 1e-12))[:, None]
    if estimator == "H1":
        weight = spectra.force.conj() / total
        return np.asarray((spectra.motion - frf * spectra.force[:, None]) * (weight[:, None] / root))
    gff, gxx, gxf = spectra.powers()
    left = np.maximum(gff.sum(axis=0) - gff, np.finfo(float).tiny)[:, None]
    without = combine(left, np.maximum(gxx.sum(axis=0) - gxx, 0.0), gxf.sum(axis=0) - gxf, estimator)
    return np.asarray(root * (frf - without))
