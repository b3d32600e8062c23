"""A modal model: what identification hands on."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from acquisition.arrays import ComplexArray, FloatArray, frozen_array
from acquisition.display import Animated, Shown
from acquisition.dof import Dof
from acquisition.frfs.frf import FrfSet
from acquisition.modal_data import ModalData
from identification.arrangement import signs
from identification.fading import Fading
from identification.fit.equations import basis
from identification.fit.equations.residues import Residues, synthesise
from identification.hit_errors import HitErrors
from identification.level_dependence import LevelDependence
from identification.poles.stabilisation import StabilisationChart
from identification.trend import Trend


@dataclass(frozen=True, eq=False)
class ModalModel(Shown, Animated):
    """Modes of a structure with their uncertainty, and the fit they come from.

    The receptance between two degrees of freedom is
    H(s) = sum_r A_r / (2 i w_r) [1/(s - p_r) - 1/(s - conj p_r)] with w_r = Im p_r if the modes are real;
    in general A_r = 2 i w_r R_r with the residue R_r, so that A_r is real for real modes.

    Parameters
    ----------
    modal : ModalData
        Frequencies, damping ratios, shapes, and their standard deviations.
    poles : (n_modes,) complex array
        Poles of the structure, the decay of an exponential window removed, Im > 0 [rad/s].
    pole_covariance : (n_modes, 2, 2) array
        Covariance of (ln frequency, damping ratio) [-].
    constants : (n_frf, n_modes) complex array
        Modal constants A = phi_i phi_j, signs of the transducers' directions applied [1/kg].
    constant_sigma : (n_frf, n_modes) array
        Standard deviation of their real part; that of the imaginary part is about the same [1/kg].
    constant_noise : (n_frf, n_modes) array
        Standard deviation of the real part that is each constant's own, as if the poles were known [1/kg].
    constant_shared : (n_frf, n_modes, k) array
        The rest: what one standard deviation of each of k independent causes, errors of the poles, does to the
        real parts of all constants. An error common to a mode's constants leaves its shape as it is [1/kg].
    responses, references : tuple of Dof, length n_frf
        Degrees of freedom, directions positive.
    lower, upper : (n_frf,) arrays
        Residual terms lower / s^2 + upper of the receptance, signs applied [1/kg, m/N].
    background : Residues
        All that is not a mode of the band: residues of poles outside it and all residual terms, signs
        not applied.
    background_poles : (n_background,) complex array
        Those poles [rad/s].
    band : tuple of float
        The band identified in [Hz].
    frfs : FrfSet
        The data in the band.
    chart : StabilisationChart
        Where the candidates came from.
    warnings : tuple of str
        What the user should know.
    points_rejected : tuple of str
        Points whose FRFs were left out, with the reason.
    carried : FrfSet, optional
        The data as they were fitted, carried over to common poles, where frequencies differ from FRF to FRF.
    levels : LevelDependence, optional
        How the modes follow the force of the hits, where it is known that they do.
    trend : Trend, optional
        How frequencies change from the first point to the last; None where a test does not rove over enough points.
    hit_errors : HitErrors, optional
        What each hit adds to the errors of the constants; None where no hits are known.
    fading : Fading, optional
        How the noise fades along the records; None where no hits are known.
    """

    modal: ModalData
    poles: ComplexArray
    pole_covariance: FloatArray
    constants: ComplexArray
    constant_sigma: FloatArray
    constant_noise: FloatArray
    constant_shared: FloatArray
    responses: tuple[Dof, ...]
    references: tuple[Dof, ...]
    lower: FloatArray
    upper: FloatArray
    background: Residues
    background_poles: ComplexArray
    band: tuple[float, float]
    frfs: FrfSet
    chart: StabilisationChart
    warnings: tuple[str, ...] = ()
    points_rejected: tuple[str, ...] = ()
    carried: FrfSet | None = None
    levels: LevelDependence | None = None
    trend: Trend | None = None
    hit_errors: HitErrors | None = None
    fading: Fading | None = None

    def __post_init__(self) -> None:
        """Freeze the arrays."""
        for name in ("poles", "constants", "background_poles"):
            object.__setattr__(self, name, frozen_array(getattr(self, name), np.complex128))
        for name in (
            "pole_covariance",
            "constant_sigma",
            "constant_noise",
            "constant_shared",
            "lower",
            "upper",
        ):
            object.__setattr__(self, name, frozen_array(getattr(self, name)))

    def __len__(self) -> int:
        """Return the number of modes."""
        return len(self.poles)

    def synthesise(self, frequency: FloatArray | None = None) -> FrfSet:
        """Return the fitted FRFs in the form of the data, with the data's decay and direction signs.

        Parameters
        ----------
        frequency : (n_lines,) array, optional
            Where to evaluate; default the lines of the data [Hz].

        Returns
        -------
        FrfSet
            Same degrees of freedom and form as ``frfs``; at 0 Hz without a window the value next to it.
        """
        lines = self.frfs.frequency if frequency is None else np.asarray(frequency, dtype=float)
        moved = np.where((lines == 0) & (self.frfs.decay == 0), 1e-3 * self.frfs.df, lines)
        laplace: ComplexArray = np.asarray(2j * np.pi * moved + self.frfs.decay, complex)
        residues = self.constants * signs(self.frfs)[:, None] / (2j * self.poles.imag)
        linear = replace(self.background, residues=np.hstack([residues, self.background.residues]))
        poles = np.concatenate([self.poles, self.background_poles])
        values = synthesise(replace(basis.Axis.of(self.frfs), laplace=laplace), poles, linear)
        return replace(
            self.frfs, frequency=lines, values=values, coherence=None, variance=None, averages=None
        )

    def table(self) -> pd.DataFrame:
        """Return one row per mode: frequency [Hz], damping ratio [%], their standard deviations, MPC [-]."""
        from identification.mac import modes_table

        return modes_table(self.modal)

    def _headline(self) -> str:
        return f"{self.modal._headline()}; band {self.band[0]:g} to {self.band[1]:g} Hz"
