"""One specimen in an update: its test, its model, its parameters, and what the parameters do to its frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.models.reduced import Reduced
from updating.models.structure import FieldStructure
from updating.prediction.assignment import mac_of_constants, match
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction
from updating.test_data.chain import level_of
from updating.test_data.measured import Measured
from updating.update.data.nominal import Evaluation, Nominal, UpdatedModel
from updating.update.data.whitening import Whitening
from updating.update.parameters.affine import Affine
from updating.update.parameters.basis import WIDE, extended, update_basis
from updating.update.parameters.parameters import ModelParameter, ParameterSet
from updating.update.parameters.sensitivity import log_frequency_by

STEP = 1e-4
"""Step of the differences, relative to the width of a parameter's range [-]."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Specimen:
    """A test, its model and the parameters to be updated.

    Parameters
    ----------
    title : str
        For tables.
    model : UpdatedModel
        The model and its parameters, as seen from the test's points.
    nominal : Nominal
        The test as it was measured beside the model before the update; what is drawn anew is still judged by it.
    measured : Measured
        The measured modes that have a partner.
    number : (n_modes,) int array
        Their numbers in the test, from 1.
    order : (n_modes,) int array
        Rank of each one's partner, for data without shapes.
    warnings : tuple of str
        What was left out.
    correction : (n_modes,) array
        Ratio of the full model's frequencies to the reduced model's [-].
    """

    title: str
    model: UpdatedModel
    nominal: Nominal
    measured: Measured
    number: IntArray
    order: IntArray
    warnings: tuple[str, ...]
    correction: FloatArray

    @property
    def predictor(self) -> Predictor:
        """The model, accepted effects included, as seen from the test's points."""
        return self.model.predictor

    @property
    def parameter_set(self) -> ParameterSet:
        """The parameters."""
        return self.model.parameter_set

    @property
    def affine(self) -> Affine | None:
        """The model as a function of its factors, where all parameters are factors."""
        return self.model.affine

    @property
    def level(self) -> bool:
        """Whether the measured constants are data with their level, not up to a factor per mode."""
        return self.nominal.level

    @property
    def errors(self) -> Whitening:
        """Covariance of the measured constants, calibration included where their level is data."""
        return self.nominal.errors

    def evaluate(self, values: Sequence[float]) -> Evaluation:
        """Evaluate the model, and find the partner of every measured mode by MAC."""
        if self.affine is None:
            prediction = self.predictor.predict(self.parameter_set.state(self.predictor, values))
        else:
            prediction = self._quick(self.affine, np.log(values))
        partner = match(self.measured, prediction, self.order)
        chosen = prediction.select(partner)
        return Evaluation(chosen.frequency * self.correction, partner, chosen)

    def _quick(self, model: Affine, logs: FloatArray) -> Prediction:
        """Predict the lowest modes with no more than an update by factors needs."""
        values, vectors = model.eigen(logs, self.model.rigid + self.nominal.count)
        vectors = vectors[:, self.model.rigid :]
        frequency = np.sqrt(np.maximum(values[self.model.rigid :], 0.0)) / (2 * np.pi)
        shape = self.model.shape_rows[:, : len(vectors)] @ vectors
        hit = np.where(self.measured.hit[:, None] < 0, 1.0, shape[self.measured.hit])
        seen = shape[self.measured.seen]
        constants = self._gain * seen * hit
        nothing = np.zeros((0, *constants.shape))
        return Prediction(
            frequency=frequency, damping=np.full(len(frequency), np.nan), constants=constants, seen=seen, hit=hit,
            seen_slopes=nothing, hit_slopes=nothing,
            log_frequency_by=np.zeros((len(frequency), 0)), constants_by=np.zeros((*constants.shape, 0)),
            vectors=vectors,
            slope=np.zeros(len(frequency)), gain=np.broadcast_to(self._gain, constants.shape),
        )  # fmt: skip

    def slopes(self, values: Sequence[float], at: Evaluation) -> FloatArray:
        """Return d ln f / d coordinate, (n_modes, n_parameters): Eqs. 16, 17 for factors, else differences."""
        if self.affine is not None:
            eigenvalue = (2 * np.pi * at.prediction.frequency) ** 2
            return self.affine.slopes(np.log(values), eigenvalue, at.prediction.vectors)
        parameters = self.parameter_set.model_parameters
        alone = all(
            k.of_deck is None for k in parameters
        )  # what a deck's number adds goes with a factor, too
        columns = [
            self._analytic(model_parameter, values, i, at)
            if alone and model_parameter.factor is not None
            else self._difference(i, values)
            for i, model_parameter in enumerate(parameters)
        ]
        return np.stack(columns, axis=1)

    def _analytic(
        self, model_parameter: ModelParameter, values: Sequence[float], index: int, at: Evaluation
    ) -> FloatArray:
        total = self.predictor.base.plus(self.parameter_set.state(self.predictor, values))
        by = log_frequency_by(
            self.predictor.reduced, total, at.prediction, str(model_parameter.factor), model_parameter.regions
        )
        return by * model_parameter.chain(values[index])

    def _ends(self, index: int, values: Sequence[float]) -> tuple[Evaluation, Evaluation, float]:
        """Evaluate on both sides of a parameter's value; return how far apart in its coordinate."""
        model_parameter = self.parameter_set.model_parameters[index]
        here, step = model_parameter.coordinate(values[index]), STEP * model_parameter.span()
        ends = [
            max(here - step, model_parameter.coordinate(model_parameter.low)),
            min(here + step, model_parameter.coordinate(model_parameter.high)),
        ]
        moved = [[*values[:index], model_parameter.value(end), *values[index + 1 :]] for end in ends]
        return self.evaluate(moved[0]), self.evaluate(moved[1]), ends[1] - ends[0]

    def _difference(self, index: int, values: Sequence[float]) -> FloatArray:
        low, high, spacing = self._ends(index, values)
        return np.asarray((np.log(high.frequency) - np.log(low.frequency)) / spacing)

    def _shape_difference(self, index: int, values: Sequence[float], at: Evaluation) -> FloatArray:
        low, high, spacing = self._ends(index, values)
        here = at.prediction.constants
        # shapes without a reference come with the solver's sign
        ends = [
            k.prediction.constants * np.sign(np.sum(k.prediction.constants * here, axis=0))
            for k in (low, high)
        ]
        return np.asarray((ends[1] - ends[0]) / spacing)

    def mac(self, evaluation: Evaluation) -> FloatArray:
        """Return the MAC of every pair, nan where no shapes were measured [-]."""
        if not self.measured.has_shapes:
            return np.full(len(self.number), np.nan)
        return np.diag(mac_of_constants(self.measured, evaluation.prediction)).copy()

    def shape_slopes(self, values: Sequence[float], at: Evaluation) -> FloatArray:
        """Return the slopes of the partners' constants by the coordinates, (n_frf, n_modes, n_parameters) [1/kg]."""
        model = self.affine
        if model is None:
            columns = [
                self._shape_difference(i, values, at) for i in range(len(self.parameter_set.model_parameters))
            ]
            return np.stack(columns, axis=-1)
        turned, shape = model.turns(np.log(values), at.partner, self.model.rigid)
        here, change = self.model.shape_rows @ at.prediction.vectors, self.model.shape_rows @ turned
        # the solver's sign of a shape is of no account in a product of two components of the same solution
        change = change * np.sign(np.sum(shape * at.prediction.vectors, axis=0))
        seen, hit, bare = self.measured.seen, self.measured.hit, self.measured.hit < 0
        both = change[:, seen] * here[hit] + here[seen] * change[:, hit]
        slopes = np.where(bare[:, None], change[:, seen], both)
        return np.asarray(np.moveaxis(self._gain * slopes, 0, -1))

    @property
    def _gain(self) -> float:
        """Factor by which the measured level is off in what the model has accepted [-]."""
        return level_of(self.predictor.base.gain, self.measured)

    def settled(self, values: Sequence[float], evaluation: Evaluation) -> Specimen:
        """Return the same specimen with its errors judged by the model at some values of its parameters."""
        count = int(evaluation.partner.max()) + 1
        near = self.predictor.predict(self.parameter_set.state(self.predictor, values), count=count)
        return replace(self, nominal=replace(self.nominal, near=near.select(evaluation.partner)))

    def discrepant(self, size: FloatArray) -> Specimen:
        """Return the same specimen with shapes that err by so much more (n_modes,), over their r.m.s. [-]."""
        return replace(self, nominal=replace(self.nominal, discrepancy=size))

    @property
    def shape_sigma(self) -> FloatArray:
        """R.m.s. error that each mode's shape is taken to have, over its r.m.s. (n_modes,) [-]."""
        test = self.measured
        error = np.mean(self.errors.sigma.reshape(test.constants.shape) ** 2, axis=0)
        return np.asarray(np.sqrt(error / np.maximum(np.mean(test.constants**2, axis=0), 1e-300)))

    def corrected(self, factor: FloatArray) -> Specimen:
        """Return the same specimen with other corrections of the reduced model's frequencies (n_modes,) [-]."""
        return replace(self, correction=factor)

    def enriched(self, modes: FloatArray) -> Specimen | None:
        """Return the same specimen with modes of the full model (n_dofs, n) in its basis, or None if it has no own."""
        structure, numbers = self.predictor.reduced.structure, self.parameter_set.model_parameters
        of_deck = all(not k.effect for k in numbers) and any(k.of_deck is not None for k in numbers)
        if (self.affine is None and not of_deck) or self.predictor.reduced.basis.shape[
            1
        ] >= structure.unknowns:
            return None
        return self._on(extended(self.predictor.reduced, modes))

    def around(self, values: Sequence[float]) -> Specimen:
        """Return the same specimen on a basis that is good far around some values of its parameters."""
        structure = self.predictor.reduced.structure
        plain = self.affine is not None and self.affine.rank < structure.unknowns
        if not plain or self.predictor.additions or not isinstance(structure, FieldStructure):
            return self
        highest, count = float(self.measured.frequency.max()), len(self.measured.frequency)
        state = self.parameter_set.state(self.predictor, values)
        return self._on(
            update_basis(
                structure,
                self.parameter_set.model_parameters,
                highest=highest,
                count=count,
                state=state,
                answers=WIDE,
            )
        )

    def _on(self, reduced: Reduced) -> Specimen:
        """Return the same specimen on another basis."""
        model = replace(self.model, predictor=self.predictor.on(reduced))
        return replace(self, model=model, correction=np.ones(len(self.number)))

    def redrawn(self, frequency: FloatArray, constants: FloatArray | None = None) -> Specimen:
        """Return the same specimen with other measured frequencies [Hz] and constants [1/kg]."""
        own = self.measured.constants if constants is None else constants
        return replace(self, measured=replace(self.measured, frequency=frequency, constants=own))

    @property
    def relative_variance(self) -> FloatArray:
        """Variance of the measured frequencies, re-mounting scatter included, relative [-]."""
        test = self.measured
        return np.asarray((test.frequency_sigma / test.frequency) ** 2 + test.repeatability**2)
