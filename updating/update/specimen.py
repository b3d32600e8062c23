"""One specimen in an update: its test, its model, its knobs, and what the knobs do to its frequencies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.case import Case
from updating.matching import mac_of_constants, match, pair_modes
from updating.measured import Measured
from updating.models.state import State
from updating.nominal import predictor_of
from updating.prediction import Prediction, Predictor
from updating.update.knobs import Knob, Panel, build_panel
from updating.update.sensitivity import log_frequency_by

STEP = 1e-4
"""Step of the differences, relative to the width of a parameter's range [-]."""


@dataclass(frozen=True, eq=False)
class Look:
    """A specimen at one setting of its knobs.

    Parameters
    ----------
    frequency : (n_modes,) array
        Frequencies of the partners of the measured modes [Hz].
    partner : (n_modes,) int array
        Which of the model's elastic modes they are, from 0.
    prediction : Prediction
        The partners.
    state : State
        The model there.
    """

    frequency: FloatArray
    partner: IntArray
    prediction: Prediction
    state: State


@dataclass(frozen=True, eq=False)
class Specimen:
    """A test, its model and the parameters to be updated.

    Parameters
    ----------
    title : str
        For tables.
    predictor : Predictor
        The model, accepted effects included, as seen from the test's points.
    measured : Measured
        The measured modes that have a partner.
    number : (n_modes,) int array
        Their numbers in the test, from 1.
    order : (n_modes,) int array
        Rank of each one's partner, for data without shapes.
    panel : Panel
        The knobs.
    warnings : tuple of str
        What was left out.
    correction : (n_modes,) array
        Ratio of the full model's frequencies to the reduced model's [-].
    accepted : mapping of str to mapping
        Effects in the model beforehand and the values of their parameters.
    """

    title: str
    predictor: Predictor
    measured: Measured
    number: IntArray
    order: IntArray
    panel: Panel
    warnings: tuple[str, ...]
    correction: FloatArray
    accepted: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def look(self, values: Sequence[float]) -> Look:
        """Evaluate the model, and find the partner of every measured mode by MAC."""
        state = self.panel.state(self.predictor, values)
        prediction = self.predictor.predict(state)
        partner = match(self.measured, prediction, self.order)
        chosen = prediction.select(partner)
        return Look(chosen.frequency * self.correction, partner, chosen, state)

    def slopes(self, values: Sequence[float], at: Look) -> FloatArray:
        """Return d ln f / d coordinate, (n_modes, n_knobs): Eqs. 16 and 17 for factors, differences for the rest."""
        columns = [
            self._analytic(knob, values[i], at) if knob.factor is not None else self._difference(i, values)
            for i, knob in enumerate(self.panel.knobs)
        ]
        return np.stack(columns, axis=1)

    def _analytic(self, knob: Knob, value: float, at: Look) -> FloatArray:
        total = self.predictor.base.plus(at.state)
        by = log_frequency_by(self.predictor.reduced, total, at.prediction, str(knob.factor), knob.regions)
        return by * knob.chain(value)

    def _difference(self, index: int, values: Sequence[float]) -> FloatArray:
        knob = self.panel.knobs[index]
        here, step = knob.coordinate(values[index]), STEP * knob.span()
        ends = [max(here - step, knob.coordinate(knob.low)), min(here + step, knob.coordinate(knob.high))]
        logs = []
        for end in ends:
            moved = list(values)
            moved[index] = knob.value(end)
            logs.append(np.log(self.look(moved).frequency))
        return np.asarray((logs[1] - logs[0]) / (ends[1] - ends[0]))

    @cached_property
    def nominal(self) -> Look:
        """The model before the update: every factor 1, and no effect that the modeller has not accepted."""
        prediction = self.predictor.predict()
        partner = match(self.measured, prediction, self.order)
        return Look(prediction.frequency[partner], partner, prediction.select(partner), State())

    def mac(self, look: Look) -> FloatArray:
        """Return the MAC of every pair, nan where no shapes were measured [-]."""
        if not self.measured.has_shapes:
            return np.full(len(self.number), np.nan)
        return np.diag(mac_of_constants(self.measured, look.prediction)).copy()

    @property
    def relative_variance(self) -> FloatArray:
        """Variance of the measured frequencies, re-mounting scatter included, relative [-]."""
        test = self.measured
        return np.asarray((test.frequency_sigma / test.frequency) ** 2 + test.repeatability**2)


def build_specimen(case: Case, parameters: Sequence[str]) -> Specimen:
    """Pair the modes of a case and find its knobs.

    Raises
    ------
    StudyError
        If a parameter does not exist on this specimen.
    EstimationError
        If no measured mode has a partner in the model.
    """
    predictor = predictor_of(case)
    paired = pair_modes(case.measured, predictor.predict())
    number = 1 + np.flatnonzero(np.isin(case.measured.frequency, paired.measured.frequency))
    accepted = {name: dict(values) for name, values in case.accepted}
    panel = build_panel(parameters, predictor, case.tolerances, accepted)
    updated = {knob.effect for knob in panel.knobs}
    if updated & set(accepted):
        kept = tuple((n, v) for n, v in case.accepted if n not in updated)
        predictor = predictor_of(replace(case, accepted=kept))
    return Specimen(
        case.title,
        predictor.looking(paired.measured),
        paired.measured,
        number,
        paired.order,
        panel,
        (*case.measured.warnings, *paired.warnings),
        np.ones(len(number)),
        {name: values for name, values in accepted.items() if name not in updated},
    )
