"""What an update starts from: the model it turns, and the test beside that model before anything is turned.

A specimen that is drawn anew, corrected or put on another basis keeps these objects, and with them what they computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.prediction.assignment import match
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction
from updating.test_data.measured import Measured
from updating.update.data.shape_errors import constant_errors
from updating.update.data.whitening import Whitening
from updating.update.parameters.affine import Affine, affine, eligible
from updating.update.parameters.parameters import ParameterSet

BEYOND = 4
"""So many elastic modes beyond the rank of the highest partner are examined for partners [-]."""


@dataclass(frozen=True, eq=False)
class Evaluation:
    """A specimen at one setting of its parameters.

    Parameters
    ----------
    frequency : (n_modes,) array
        Frequencies of the partners of the measured modes [Hz].
    partner : (n_modes,) int array
        Which of the model's elastic modes they are, from 0.
    prediction : Prediction
        The partners.
    """

    frequency: FloatArray
    partner: IntArray
    prediction: Prediction


@dataclass(frozen=True, eq=False)
class UpdatedModel:
    """A model with the parameters that are updated.

    Parameters
    ----------
    predictor : Predictor
        The model, accepted effects included, as seen from the test's points.
    parameter_set : ParameterSet
        The parameters.
    """

    predictor: Predictor
    parameter_set: ParameterSet

    @cached_property
    def affine(self) -> Affine | None:
        """The model as a function of its factors, where all parameters are factors."""
        base = self.predictor.base
        beyond = base.released or base.yielding or base.absorbers or base.theory is not None
        if beyond or not eligible(self.parameter_set.model_parameters):
            return None
        return affine(self.predictor.reduced, self.parameter_set.model_parameters, base)

    @cached_property
    def shape_rows(self) -> FloatArray:
        """Displacement of the basis at the test points, (n_points, r)."""
        if not len(self.predictor.measured.points):
            return np.zeros((0, self.predictor.reduced.basis.shape[1]))
        return self.predictor.nominal_rows["w"]

    @property
    def rigid(self) -> int:
        """Number of rigid-body modes."""
        return self.predictor.reduced.structure.rigid_modes


@dataclass(frozen=True, eq=False)
class Nominal:
    """The test as it was measured beside the model as it was before the update.

    Parameters
    ----------
    model : UpdatedModel
        The model: every factor 1, and no effect that the modeller has not accepted.
    measured : Measured
        The measured modes that have a partner.
    order : (n_modes,) int array
        Rank of each one's partner, for data without shapes.
    level : bool
        Whether the measured constants are data with their level, not up to a factor per mode.
    near : Prediction, optional
        Partners in a model nearer to the test than the nominal one, by which misplaced points and calibration are
        judged.
    discrepancy : (n_modes,) array, optional
        Error of each shape beyond what was stated, over its r.m.s.; None until it is estimated [-].
    """

    model: UpdatedModel
    measured: Measured
    order: IntArray
    level: bool = False
    near: Prediction | None = None
    discrepancy: FloatArray | None = None

    @cached_property
    def modes(self) -> Prediction:
        """The modes of the model."""
        return self.model.predictor.predict()

    @property
    def count(self) -> int:
        """Number of elastic modes among which partners are sought."""
        return max(len(self.modes.frequency), int(self.order.max()) + BEYOND)

    @cached_property
    def evaluation(self) -> Evaluation:
        """The partners of the measured modes."""
        partner = match(self.measured, self.modes, self.order)
        return Evaluation(self.modes.frequency[partner], partner, self.modes.select(partner))

    @cached_property
    def errors(self) -> Whitening:
        """Covariance of the measured constants, calibration included where their level is data."""
        return self.errors_with(self.discrepancy)

    def errors_with(self, discrepancy: FloatArray | None) -> Whitening:
        """Return that covariance with another discrepancy of the shapes (n_modes,) [-]."""
        at = self.evaluation.prediction if self.near is None else self.near
        parameters = self.model.parameter_set.model_parameters
        turned = any(parameter.competes_with == "calibration" for parameter in parameters)
        level_sigma = self.measured.level_sigma if self.level and not turned else 0.0
        return constant_errors(self.measured, at, level_sigma, discrepancy)
