"""What can be turned in a model, by the names of the study file: ``E``, ``root.E``, ``length``, ``sensor_mass``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from updating.effects import LIBRARY
from updating.models.damping import WHOLE
from updating.models.deck_states import deck_state
from updating.models.imported.decks import DeckParameter
from updating.models.state import State
from updating.prediction.predict import Predictor


@dataclass(frozen=True, eq=False, kw_only=True)
class ModelParameter:
    """One parameter of one specimen, and how it enters the model.

    The solution runs in a *coordinate*: the logarithm of a factor, the value itself for other parameters,
    its logarithm where the prior range spans more than three decades.

    Parameters
    ----------
    name : str
        Name as the user writes it.
    unit : str
        Unit of the reported value.
    nominal : float
        What a factor multiplies [unit]; 1 for parameters that are no factor.
    start, low, high : float
        Start and bounds of the factor or the value.
    doubt : float
        1-sigma scale of the coordinate, by tolerance or prior range.
    tolerated : bool
        Whether ``doubt`` is a tolerance of the study, and regularises.
    log : bool
        Whether the coordinate is a logarithm.
    factor : str, optional
        Factor of the model that it is; None for an effect and for damping.
    damper : str, optional
        Coefficient of damping that it is.
    regions : tuple of int
        Regions that it acts on, all of one name; empty for the whole structure.
    effect, parameter : str
        Effect and its parameter, empty for a factor.
    reach : float
        How far the stretched length goes per unit of the value, for ``length`` [1/m]; else 0.
    of_deck : DeckParameter, optional
        Number of a deck that it is.
    """

    name: str
    unit: str
    nominal: float
    start: float
    low: float
    high: float
    doubt: float
    tolerated: bool
    log: bool
    factor: str | None = None
    damper: str | None = None
    regions: tuple[int, ...] = ()
    effect: str = ""
    parameter: str = ""
    reach: float = 0.0
    of_deck: DeckParameter | None = None

    @property
    def is_factor(self) -> bool:
        """Whether the value is a nominal value times a factor."""
        if self.of_deck is not None:
            return self.of_deck.relative
        return self.factor is not None and not self.effect

    @property
    def quantity(self) -> str:
        """What is updated, without where or of which effect."""
        if self.of_deck is not None:
            return self.of_deck.kind.partition("_")[0]
        return self.parameter or self.damper or str(self.factor)

    @property
    def damps(self) -> bool:
        """Whether it is a matter of damping alone."""
        effect = LIBRARY.get(self.effect)
        return self.damper is not None or (effect is not None and effect.damps(self.parameter))

    @property
    def competes_with(self) -> str:
        """The modeller's doubt that it takes the place of, empty for none."""
        return LIBRARY[self.effect].competes_with if self.effect in LIBRARY else ""

    def coordinate(self, value: float) -> float:
        """Take a factor or value to its coordinate."""
        return float(np.log(max(value, 1e-300))) if self.log else float(value)

    def value(self, coordinate: float) -> float:
        """Take a coordinate to the factor or value."""
        return float(np.exp(coordinate)) if self.log else float(coordinate)

    def chain(self, value: float) -> float:
        """Return d ln(factor) / d coordinate, for parameters that are a factor of the model."""
        return 1.0 if self.log else self.reach / (1 + self.reach * value)

    def span(self) -> float:
        """Return the width of the bounds in the coordinate."""
        return self.coordinate(self.high) - self.coordinate(self.low)


@dataclass(frozen=True, eq=False)
class ParameterSet:
    """All parameters of one specimen.

    Parameters
    ----------
    model_parameters : tuple of ModelParameter
        The parameters to be updated.
    fixed : mapping of str to mapping
        Values of parameters that stay, by effect: those of effects only some of whose parameters are updated.
    """

    model_parameters: tuple[ModelParameter, ...]
    fixed: Mapping[str, Mapping[str, float]] = field(default_factory=lambda: MappingProxyType({}))

    def state(self, predictor: Predictor, values: Sequence[float]) -> State:
        """Return the departure from the nominal model at given factors and values."""
        state = State()
        effects: dict[str, dict[str, float]] = {}
        for model_parameter, value in zip(self.model_parameters, values, strict=True):
            if model_parameter.of_deck is not None:
                continue
            if model_parameter.effect:
                effects.setdefault(model_parameter.effect, dict(self.fixed.get(model_parameter.effect, {})))[
                    model_parameter.parameter
                ] = value
            elif model_parameter.damper is not None:
                where = model_parameter.regions or (WHOLE,)
                state = state.plus(State(dampers={(i, model_parameter.damper): value for i in where}))
            elif model_parameter.regions:
                state = state.plus(
                    State(regional={(i, str(model_parameter.factor)): value for i in model_parameter.regions})
                )
            else:
                state = state.plus(State(factors={str(model_parameter.factor): value}))
        for name, given in effects.items():
            state = state.plus(LIBRARY[name].state(predictor, given))
        return state.plus(deck_state(predictor.reduced, self._of_deck(values), state))

    def _of_deck(self, values: Sequence[float]) -> dict[DeckParameter, float]:
        """Return the values of the numbers of a deck among the parameters."""
        both = zip(self.model_parameters, values, strict=True)
        return {parameter.of_deck: value for parameter, value in both if parameter.of_deck is not None}

    def effects(self, values: Sequence[float]) -> dict[str, dict[str, float]]:
        """Return the values of the effects among the parameters, by effect."""
        found: dict[str, dict[str, float]] = {}
        for model_parameter, value in zip(self.model_parameters, values, strict=True):
            if model_parameter.effect:
                found.setdefault(model_parameter.effect, dict(self.fixed.get(model_parameter.effect, {})))[
                    model_parameter.parameter
                ] = value
        return found
