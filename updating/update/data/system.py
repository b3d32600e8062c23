"""Several specimens with shared parameters as one weighted least-squares problem, paper A Eqs. 18-25."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.update.data.nominal import Evaluation
from updating.update.data.shapes import shape_residual, shape_slopes
from updating.update.data.specimen import Specimen
from updating.update.parameters.parameters import ModelParameter

Weights = Literal["covariance", "relative", "eigenvalue"] | Sequence[float]
Quantity = Literal["frequency", "eigenvalue"]


@dataclass(frozen=True, eq=False)
class Linear:
    """The problem at one setting: residuals, weights and sensitivities, Eq. 19.

    Parameters
    ----------
    residual : (n,) array
        Measured minus computed: 1 - f / f_e, or eigenvalues [- or rad^2/s^2].
    sensitivity : (n, p) array
        Derivatives of the computed quantity by the coordinates.
    weight : (n,) array
        Diagonal of W_s.
    evaluations : tuple of Evaluation
        The specimens.
    """

    residual: FloatArray
    sensitivity: FloatArray
    weight: FloatArray
    evaluations: tuple[Evaluation, ...]


@dataclass(frozen=True, eq=False)
class System:
    """What is to be solved.

    Parameters
    ----------
    specimens : tuple of Specimen
        The specimens.
    index : tuple of int arrays
        For every specimen, which unknown each of its parameters is.
    model_parameters : tuple of ModelParameter
        One parameter for each unknown; a shared one stands for all specimens that have it.
    owner : tuple of int
        Specimen of each unknown, -1 where it is shared.
    weights : tuple of arrays
        W_s of each specimen, for relative frequencies.
    quantity : {"frequency", "eigenvalue"}
        What is compared.
    regularised : bool
        Whether the tolerances hold the parameters near ``centre``, Eq. 25.
    drawn : (p,) array, optional
        Coordinates near which they are held, where these were drawn anew; left out, those of the nominal model.
    shapes : bool
        Whether the shapes, or the constants where a specimen states so, are data behind the frequencies; their
        residuals are whitened.
    """

    specimens: tuple[Specimen, ...]
    index: tuple[IntArray, ...]
    model_parameters: tuple[ModelParameter, ...]
    owner: tuple[int, ...]
    weights: tuple[FloatArray, ...]
    quantity: Quantity
    regularised: bool
    drawn: FloatArray | None = None
    shapes: bool = False

    @property
    def centre(self) -> FloatArray:
        """Coordinates near which the parameters are held, theta_0 of Eq. 25."""
        return self.start if self.drawn is None else self.drawn

    @cached_property
    def low(self) -> FloatArray:
        """Lower bounds of the coordinates."""
        return np.array([k.coordinate(k.low) for k in self.model_parameters])

    @cached_property
    def high(self) -> FloatArray:
        """Upper bounds of the coordinates."""
        return np.array([k.coordinate(k.high) for k in self.model_parameters])

    @cached_property
    def start(self) -> FloatArray:
        """Coordinates of the nominal model."""
        return np.array([k.coordinate(k.start) for k in self.model_parameters])

    @cached_property
    def doubt(self) -> FloatArray:
        """1-sigma scales of the coordinates."""
        return np.array([k.doubt for k in self.model_parameters])

    @cached_property
    def prior(self) -> FloatArray:
        """Diagonal of W_theta: inverse variances of the parameters, 0 where none is stated."""
        tolerated = np.array([k.tolerated for k in self.model_parameters]) & self.regularised
        return np.where(tolerated, 1 / self.doubt**2, 0.0)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns, with their study where there are several."""
        alone = len(self.specimens) == 1
        pairs = zip(self.model_parameters, self.owner, strict=True)
        return tuple(
            k.name if owner < 0 or alone else f"{k.name} ({self.specimens[owner].title})"
            for k, owner in pairs
        )

    @property
    def count(self) -> int:
        """Number of data that weigh anything, less the factors that shapes are free of."""
        sizes = [(s.measured.constants.shape, s.level) for s in self.specimens if s.measured.has_shapes]
        free = [rows * modes - (0 if level else modes) for (rows, modes), level in sizes]
        return int(sum(np.sum(w > 0) for w in self.weights)) + (sum(free) if self.shapes else 0)

    def values(self, theta: FloatArray, specimen: int) -> list[float]:
        """Return the factors and values of one specimen's parameters."""
        return [self.model_parameters[i].value(theta[i]) for i in self.index[specimen]]

    def evaluations(self, theta: FloatArray) -> tuple[Evaluation, ...]:
        """Evaluate every specimen."""
        return tuple(s.evaluate(self.values(theta, i)) for i, s in enumerate(self.specimens))

    def residual(self, evaluations: tuple[Evaluation, ...]) -> FloatArray:
        """Return measured minus computed, shape (n,)."""
        parts = []
        for specimen, evaluation in zip(self.specimens, evaluations, strict=True):
            test = specimen.measured.frequency
            if self.quantity == "frequency":
                parts.append(1 - evaluation.frequency / test)
            else:
                parts.append((2 * np.pi) ** 2 * (test**2 - evaluation.frequency**2))
        if self.shapes:
            both = zip(self.specimens, evaluations, strict=True)
            parts += [shape_residual(s, k) for s, k in both if s.measured.has_shapes]
        return np.concatenate(parts)

    @cached_property
    def weight(self) -> FloatArray:
        """Diagonal of W_s for the residuals, shape (n,)."""
        if self.shapes:
            own = [np.ones(s.measured.constants.size) for s in self.specimens if s.measured.has_shapes]
            return np.concatenate([*self.weights, *own])
        if self.quantity == "frequency":
            return np.concatenate(self.weights)
        both = zip(self.weights, self.specimens, strict=True)
        per = [w / (2 * (2 * np.pi * s.measured.frequency) ** 2) ** 2 for w, s in both]
        return np.concatenate(per)

    def cost(self, theta: FloatArray, evaluations: tuple[Evaluation, ...]) -> float:
        """Return what Eq. 25 makes least."""
        residual = self.residual(evaluations)
        return float(self.weight @ residual**2 + self.prior @ (theta - self.centre) ** 2)

    def linear(self, theta: FloatArray, evaluations: tuple[Evaluation, ...]) -> Linear:
        """Return residuals and sensitivities, Eqs. 18 and 19."""
        blocks = []
        for i, (specimen, evaluation) in enumerate(zip(self.specimens, evaluations, strict=True)):
            slopes = specimen.slopes(self.values(theta, i), evaluation)
            block = np.zeros((len(slopes), len(self.model_parameters)))
            block[:, self.index[i]] = slopes * self._per_log(specimen, evaluation)[:, None]
            blocks.append(block)
        blocks += self._shape_blocks(theta, evaluations) if self.shapes else []
        return Linear(self.residual(evaluations), np.vstack(blocks), self.weight, evaluations)

    def _shape_blocks(self, theta: FloatArray, evaluations: tuple[Evaluation, ...]) -> list[FloatArray]:
        blocks = []
        for i, (specimen, evaluation) in enumerate(zip(self.specimens, evaluations, strict=True)):
            if specimen.measured.has_shapes:
                slopes = shape_slopes(specimen, self.values(theta, i), evaluation)
                block = np.zeros((len(slopes), len(self.model_parameters)))
                block[:, self.index[i]] = slopes
                blocks.append(block)
        return blocks

    @property
    def count_of_frequencies(self) -> int:
        """Number of paired modes."""
        return sum(len(s.number) for s in self.specimens)

    def _per_log(self, specimen: Specimen, evaluation: Evaluation) -> FloatArray:
        if self.quantity == "frequency":
            return evaluation.frequency / specimen.measured.frequency
        return 2 * (2 * np.pi * evaluation.frequency) ** 2

    def whitened(self, linear: Linear) -> FloatArray:
        """Return the sensitivities of ln f over what the measurement is good for, used modes only, (n, p) [-]."""
        rows = []
        end = 0
        for specimen, evaluation in zip(self.specimens, linear.evaluations, strict=True):
            begin, end = end, end + len(evaluation.frequency)
            per_log = self._per_log(specimen, evaluation)[:, None]
            rows.append(
                linear.sensitivity[begin:end] / per_log / np.sqrt(specimen.relative_variance)[:, None]
            )
        whitened = np.vstack(rows)[self.used]
        behind = self.count_of_frequencies
        shapes = np.sqrt(linear.weight[behind:, None]) * linear.sensitivity[behind:]
        return np.vstack([whitened, shapes])

    @cached_property
    def used(self) -> BoolArray:
        """Which modes' frequencies weigh anything, shape (n_modes,)."""
        return np.concatenate(self.weights) > 0

    def corrected(self, factors: Sequence[FloatArray]) -> System:
        """Return the problem with the reduced models' frequencies multiplied by factors (n_modes,) [-]."""
        both = zip(self.specimens, factors, strict=True)
        return replace(self, specimens=tuple(s.corrected(s.correction * f) for s, f in both))

    def settled(self, theta: FloatArray, evaluations: tuple[Evaluation, ...]) -> System:
        """Return the problem with the errors of points and calibration judged at a solution."""
        both = enumerate(zip(self.specimens, evaluations, strict=True))
        own = [s.settled(self.values(theta, i), k) if s.measured.has_shapes else s for i, (s, k) in both]
        return replace(self, specimens=tuple(own))

    def discrepant(self, sizes: Sequence[FloatArray]) -> System:
        """Return the problem with shapes that err by so much more, (n_modes,) of each specimen [-]."""
        both = zip(self.specimens, sizes, strict=True)
        return replace(
            self, specimens=tuple(s.discrepant(d) if s.measured.has_shapes else s for s, d in both)
        )

    def frequency_misfit(self, evaluations: tuple[Evaluation, ...]) -> float:
        """Return the squares of the frequencies' residuals over what the measurement is good for, summed [-]."""
        both = zip(self.specimens, evaluations, strict=True)
        parts = [(1 - k.frequency / s.measured.frequency) ** 2 / s.relative_variance for s, k in both]
        return float(np.sum(np.concatenate(parts)[self.used]))

    def nearer(self, modes: Sequence[FloatArray], factors: Sequence[FloatArray]) -> System:
        """Return the problem with the full models' modes (n_dofs, n) in the bases; with factors where none fits."""
        parts = zip(self.specimens, modes, factors, strict=True)
        return replace(
            self, specimens=tuple(s.enriched(m) or s.corrected(s.correction * f) for s, m, f in parts)
        )

    def around(self, theta: FloatArray) -> System:
        """Return the problem on bases that are good far around a solution."""
        both = enumerate(self.specimens)
        return replace(self, specimens=tuple(s.around(self.values(theta, i)) for i, s in both))

    def redrawn(
        self,
        frequencies: Sequence[FloatArray],
        centre: FloatArray,
        constants: Sequence[FloatArray] | None = None,
    ) -> System:
        """Return the problem with other measured frequencies [Hz] and constants [1/kg], and another centre (p,)."""
        shapes = [None] * len(frequencies) if constants is None else constants
        both = zip(self.specimens, frequencies, shapes, strict=True)
        return replace(self, specimens=tuple(s.redrawn(f, c) for s, f, c in both), drawn=centre)
