"""What every kind of data defines beside a state of the model: residual, noise, and what may explain the residual."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.likelihood.baseline_prior import Before
from updating.likelihood.comparison import Block
from updating.likelihood.hit_scatter import HitScatter, hit_scatter
from updating.models.state import NOMINAL, State
from updating.prediction.predict import Predictor
from updating.prediction.prediction import Prediction
from updating.test_data.measured import Measured
from updating.tolerances import Tolerances


@dataclass(frozen=True)
class Doubt:
    """What a candidate leaves in doubt beside its parameters.

    Parameters
    ----------
    fidelity : float
        How far its idealisation may be off, relative to the shift it makes [-].
    damping : float
        How far it leaves damping in doubt: 1 sigma of ln zeta [-].
    uneven : float
        How far its idealisation may be off in each mode by another amount, relative to the shift it makes [-].
    exact : State
        What of it is no idealisation: what idealisations shift, they shift from there.
    """

    fidelity: float = 0.0
    damping: float = 0.0
    uneven: float = 0.0
    exact: State = NOMINAL


NO_DOUBT = Doubt()
"""Of a state that is no candidate's."""


@dataclass(frozen=True, eq=False)
class Setting:
    """A test beside a model, as every kind of data needs the two.

    Parameters
    ----------
    predictor : Predictor
        The model as seen from the test's points.
    measured : Measured
        The test, with the modes that have a partner.
    tolerances : Tolerances
        The modeller's doubts.
    names : tuple of str
        What all data doubt alike: factors with a tolerance that the model has, masses and places of bodies.
    sigmas : (n_names,) array
        Their standard deviations [-, of places m].
    nominal : Prediction
        The nominal prediction of the measured modes.
    missed : Prediction
        That of the modes that the model has and the test has not.
    before : Before, optional
        What a baseline has already determined.
    """

    predictor: Predictor
    measured: Measured
    tolerances: Tolerances
    names: tuple[str, ...]
    sigmas: FloatArray
    nominal: Prediction
    missed: Prediction
    before: Before | None = None

    @cached_property
    def scatter(self) -> HitScatter | None:
        """What the scatter of the hits is made of; None where they do not determine it."""
        return hit_scatter(self.measured, self.nominal)


@dataclass(frozen=True, eq=False)
class View:
    """A state of the model as data are compared with it.

    Parameters
    ----------
    now : Prediction
        Its modes, in the order of the measured ones.
    state : State
        Its whole departure from the bare nominal model, what was put in beforehand included.
    doubt : Doubt
        What it leaves in doubt.
    whole : Prediction, optional
        All its modes, where some of them may be the unpaired measured ones.
    claims : (n_unpaired,) int array
        Which of these each unpaired measured mode is, -1 where none of them; empty where the state adds no modes.
    offers : (n_unpaired,) int array
        Which of these each of the others may be, -1 where none of them.
    places : (m,) array
        How far the points moved lie from where they are stated in it; empty where they do not [standard deviations].
    exact : Prediction, optional
        The modes under what of the state is no idealisation; left out, the nominal ones.
    """

    now: Prediction
    state: State
    doubt: Doubt
    whole: Prediction | None = None
    claims: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    offers: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    places: FloatArray = field(default_factory=lambda: np.zeros(0))
    exact: Prediction | None = None

    def unidealised(self, setting: Setting) -> Prediction:
        """Return the modes from which idealisations shift."""
        return setting.nominal if self.exact is None else self.exact


@dataclass(frozen=True, eq=False)
class Quantity(ABC):
    """One kind of data: the rows that it adds to a comparison, and no others.

    Parameters
    ----------
    setting : Setting
        Test and model.
    """

    setting: Setting

    @property
    @abstractmethod
    def present(self) -> bool:
        """Whether the test has such data."""

    @abstractmethod
    def block(self, view: View) -> Block:
        """Return residual, noise and nuisances of these data beside a state."""


@dataclass(frozen=True, eq=False)
class Nuisances(ABC):
    """Doubts of one kind in predicted constants, each a column.

    Parameters
    ----------
    setting : Setting
        Test and model.
    """

    setting: Setting

    @abstractmethod
    def columns(self, now: Prediction, level: FloatArray) -> FloatArray:
        """Return the change of the constants per standard deviation, (n_frf n_modes, k) [-].

        Parameters
        ----------
        now : Prediction
            The modes.
        level : (n_frf, n_modes) array
            What predicted constants are multiplied by [kg].
        """
