"""One stage of an update by FRFs: which parameters move, what is compared, and how well it must agree.

The residual is paper B's difference of receptances (Eqs. 9 and 10), whitened. To the noise of the measurement a
*discrepancy* is added, relative to the size of the FRFs: what the model cannot follow however it is turned. It
starts large, so that peaks that do not overlap yet cannot dominate, and is then estimated from what is left.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq
from scipy.stats import chi2

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from updating.frf_update.columns import Columns
from updating.frf_update.evaluation import Evaluation, changes, evaluate, sensitivity
from updating.frf_update.expansion import expand
from updating.models.state import State
from updating.prediction.predict import Predictor
from updating.test_data.measured_frfs import MeasuredFrfs
from updating.update.parameters.parameters import ModelParameter, ParameterSet

CHANCE = 1e-3
"""A misfit less probable than this is the model's, not the noise's [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Stage:
    """What one stage solves.

    Parameters
    ----------
    predictor : Predictor
        The specimen's model.
    frfs : MeasuredFrfs
        Measured FRFs on the lines of this stage.
    ends : Columns
        Their points.
    parameter_set : ParameterSet
        The parameters of this stage.
    earlier : State
        What the stages before have settled.
    resonances, widths : (n,) arrays
        Where resonances are left alone [Hz], and how wide [-]: all measured ones and the model's own where nothing is
        known of the damping and this stage does not settle it, and where it settles nothing else those of the
        model that the identification lacks.
    warp : (n_lines,) array
        Factor on the frequency of each line at which the model is evaluated, so that measured and computed
        peaks fall together where only damping is asked for [-].
    all_resonances : (n,) array
        Measured natural frequencies, whatever the stage [Hz].
    """

    predictor: Predictor
    frfs: MeasuredFrfs
    ends: Columns
    parameter_set: ParameterSet
    earlier: State
    resonances: FloatArray
    widths: FloatArray
    warp: FloatArray
    all_resonances: FloatArray

    @property
    def model_parameters(self) -> tuple[ModelParameter, ...]:
        """The parameters."""
        return self.parameter_set.model_parameters

    @property
    def damps_alone(self) -> bool:
        """Whether nothing but damping is turned."""
        return all(k.damps for k in self.model_parameters)

    @property
    def doubt(self) -> FloatArray:
        """1-sigma scales of the coordinates."""
        return np.array([k.doubt for k in self.model_parameters])

    @property
    def low(self) -> FloatArray:
        """Lower bounds of the coordinates."""
        return np.array([k.coordinate(k.low) for k in self.model_parameters])

    @property
    def high(self) -> FloatArray:
        """Upper bounds of the coordinates."""
        return np.array([k.coordinate(k.high) for k in self.model_parameters])

    def lines(self, keep: IntArray) -> Stage:
        """Return the same stage on some of its lines."""
        return replace(self, frfs=self.frfs.lines(keep), warp=self.warp[keep])

    def values(self, theta: FloatArray) -> list[float]:
        """Take coordinates to factors and values."""
        return [k.value(t) for k, t in zip(self.model_parameters, theta, strict=True)]

    def state(self, theta: FloatArray) -> State:
        """Return the model at given coordinates, earlier stages included."""
        return self.earlier.plus(self.parameter_set.state(self.predictor, self.values(theta)))

    def evaluate(self, theta: FloatArray) -> Evaluation:
        """Evaluate the model."""
        laplace = self.frfs.laplace.real + 1j * self.frfs.laplace.imag * self.warp
        return evaluate(self.predictor, self.state(theta), self.ends, laplace, order=self.frfs.order)

    def slopes(self, theta: FloatArray, at: Evaluation, *, measured: bool) -> ComplexArray:
        """Return the sensitivities of Eq. 10, shape (p, n_frf, n_lines) [m/N].

        Parameters
        ----------
        theta : (p,) array
            Coordinates.
        at : Evaluation
            The model there.
        measured : bool
            With the measured column expanded (Eq. 9 as it stands) or with the model's own.
        """
        excited = expand(at, self.ends, self.frfs.values) if measured else None
        by = changes(self.predictor, self.parameter_set, self.values(theta), self.ends, self.earlier)
        return np.stack([sensitivity(at, change, self.ends, excited) for change in by])

    def power(self, at: Evaluation) -> FloatArray:
        """Return the mean of the measured FRF's square and of its modes' squares in the model, (n_frf, n_lines).

        A model that is off by some per cent is so in each of its modes. Between them, where their shares cancel,
        what is left of the FRF is no measure of the error [m^2/N^2].
        """
        return np.asarray((np.abs(self.frfs.values) ** 2 + modal_power(at, self.ends)) / 2)

    def variance(self, at: Evaluation, discrepancy: float) -> FloatArray:
        """Return noise, discrepancy, and what a later stage will settle, (n_frf, n_lines) [m^2/N^2]."""
        share = self._resonant(at)
        return np.asarray(self.frfs.variance + (discrepancy**2 + share**2) * self.power(at))

    def _resonant(self, at: Evaluation) -> FloatArray:
        """Return how much of the dynamic stiffness at each line is damping, by the nearest resonance (n_lines,)."""
        if not len(self.resonances):
            return np.zeros(len(at.laplace))
        centres, widths = self.resonances, self.widths
        if not self.damps_alone:
            own = self._own_resonances(at.state)
            centres = np.concatenate([self.resonances, own])
            widths = np.concatenate([self.widths, np.interp(own, self.resonances, self.widths)])
        f = self.frfs.frequency[:, None]
        damper = 2 * widths * centres * f
        return np.asarray((damper / np.hypot(centres**2 - f**2, damper)).max(axis=1))

    def _own_resonances(self, state: State) -> FloatArray:
        total = self.predictor.base.plus(state)
        values = self.predictor.reduced.eigen(total)[0][self.predictor.reduced.structure.rigid_modes :]
        frequency = np.sqrt(np.maximum(values, 0.0)) / (2 * np.pi)
        return np.asarray(frequency[frequency < 1.5 * self.frfs.frequency.max()])

    def residual(self, at: Evaluation) -> ComplexArray:
        """Return measured minus computed, (n_frf, n_lines) [m/N]."""
        return np.asarray(self.frfs.values - at.receptance)

    def misfit(self, at: Evaluation, variance: FloatArray) -> float:
        """Return the mean square of the whitened residual [-]."""
        return float(np.mean(np.abs(self.residual(at)) ** 2 / variance))

    def discrepancy(self, at: Evaluation) -> float:
        """Return the relative discrepancy that explains what is left: the whitened mean square is then 1 [-].

        It is 0 where noise alone may well leave so much.
        """
        dof = max(2 * self.frfs.values.size - len(self.model_parameters), 1)
        wanted = dof / (2 * self.frfs.values.size)
        if self.misfit(at, self.variance(at, 0.0)) * 2 * self.frfs.values.size < chi2.isf(CHANCE, dof):
            return 0.0

        def excess(size: float) -> float:
            return self.misfit(at, self.variance(at, size)) - wanted

        return float(brentq(excess, 0.0, 2.0)) if excess(2.0) < 0 else 2.0


def modal_power(at: Evaluation, ends: Columns) -> FloatArray:
    """Return the sum of the squares of all modes' shares in every FRF, shape (n_frf, n_lines) [m^2/N^2]."""
    constants, poles = modal_shares(at, ends)
    return np.asarray(np.abs(at.gain) ** 2 * (constants**2 @ np.abs(poles) ** 2))


def modal_shares(at: Evaluation, ends: Columns) -> tuple[FloatArray, ComplexArray]:
    """Return constants (n_frf, r) [1/kg] and dynamic factors (r, n_lines) [s^2] whose product is each mode's share.

    The damping that couples modes is left out: shares state how large an error may be, not what it is.
    """
    values, vectors = at.matrices.undamped
    viscous = np.einsum("ir,ij,jr->r", vectors, at.matrices.viscous, vectors, optimize=True)
    structural = np.einsum("ir,ij,jr->r", vectors, at.matrices.structural, vectors, optimize=True)
    s = at.laplace
    shapes = at.rows @ vectors
    dynamic = s**2 + viscous[:, None] * s + (values + 1j * structural)[:, None]
    return np.asarray(shapes[ends.response] * shapes[ends.excitation]), np.asarray(1 / dynamic)


def whitened(
    stage: Stage, slopes: ComplexArray, at: Evaluation, variance: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return sensitivities (2 n, p) and residuals (2 n,) in standard deviations, real parts first [-]."""
    scale = np.sqrt(2 / variance)
    rows = (slopes * scale).reshape(len(slopes), -1)
    load = (stage.residual(at) * scale).ravel()
    return np.hstack([rows.real, rows.imag]).T, np.concatenate([load.real, load.imag])


def nominal(model_parameters: Sequence[ModelParameter]) -> FloatArray:
    """Return the coordinates of the nominal model."""
    return np.array([k.coordinate(k.start) for k in model_parameters])
