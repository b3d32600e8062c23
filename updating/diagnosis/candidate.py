"""A set of effects, as one function from prior quantiles to a state of the model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from acquisition.arrays import FloatArray
from updating.effects import Effect, Parameter
from updating.models.spec import Theory
from updating.models.state import State, combine
from updating.prediction import Predictor


@dataclass(frozen=True, eq=False)
class Candidate:
    """One explanation: no effect, a single one, or several at once.

    Parameters
    ----------
    effects : tuple of Effect
        The effects; empty is 'only the tolerances'.
    theory : str, optional
        Theory the model is put on because the nominal one is known to fall short.
    """

    effects: tuple[Effect, ...] = ()
    theory: Theory | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(effect.name for effect in self.effects)

    @property
    def fidelity(self) -> float:
        """How far the idealisations may be off, relative to the shift they make [-]."""
        return max((effect.fidelity for effect in self.effects), default=0.0)

    def stage(self, predictor: Predictor) -> Predictor:
        """Return the predictor the effects act on."""
        theory = self.theory
        if theory is None and "shear" in self.names:
            theory = "timoshenko"
        return predictor if theory is None else predictor.under(theory)

    def parameters(self, predictor: Predictor) -> tuple[tuple[str, Parameter], ...]:
        """Return all parameters as (effect.parameter, prior)."""
        return tuple((f"{e.name}.{p.name}", p) for e in self.effects for p in e.parameters(predictor))

    def values(self, predictor: Predictor, coordinates: Sequence[float]) -> dict[str, float]:
        """Take prior quantiles to values, by effect.parameter."""
        return {
            f"{e.name}.{n}": v for e, part in self._split(predictor, coordinates) for n, v in part.items()
        }

    def _split(
        self, predictor: Predictor, coordinates: Sequence[float]
    ) -> list[tuple[Effect, dict[str, float]]]:
        parts, start = [], 0
        stage = self.stage(predictor)
        for effect in self.effects:
            end = start + len(effect.parameters(stage))
            parts.append((effect, effect.values(stage, coordinates[start:end])))
            start = end
        return parts

    def state(self, predictor: Predictor, coordinates: Sequence[float]) -> State:
        """Return the state of the model at prior quantiles."""
        stage = self.stage(predictor)
        states = [effect.state(stage, values) for effect, values in self._split(predictor, coordinates)]
        return combine([*states, State(theory=self.theory)])

    def locations(
        self, predictor: Predictor, coordinates: Sequence[float], *, channel: str | None = None
    ) -> tuple[tuple[float, float, float], ...]:
        """Return where the effects sit, those of one channel or all [m]."""
        stage = self.stage(predictor)
        parts = self._split(predictor, coordinates)
        acting = [(e, v) for e, v in parts if channel in (None, e.channel)]
        return tuple(place for effect, values in acting for place in effect.locations(stage, values))

    def derived(self, predictor: Predictor, coordinates: Sequence[float]) -> dict[str, tuple[float, str]]:
        """Return derived quantities by effect.name, as (value, unit)."""
        stage = self.stage(predictor)
        parts = self._split(predictor, coordinates)
        return {
            f"{effect.name}.{n}": v
            for effect, values in parts
            for n, v in effect.derived(stage, values).items()
        }

    def starts(self, predictor: Predictor) -> list[FloatArray]:
        """Return prior quantiles to start a search from: every combination of the effects' own."""
        import numpy as np

        stage = self.stage(predictor)
        return [
            np.concatenate([*map(np.asarray, s), []])
            for s in product(*(e.starts(stage) for e in self.effects))
        ]
