"""A set of effects, as one function from prior quantiles to a state of the model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from acquisition.arrays import FloatArray
from updating.effects import Effect, Parameter, Variant
from updating.effects.base import Values
from updating.likelihood.base import Doubt
from updating.likelihood.outliers import Outlier, log_price
from updating.models.spec import FULLER
from updating.models.state import NOMINAL, State, combine
from updating.prediction.predict import Predictor
from updating.prediction.stretch import is_placed

MIDDLE = 0.5
"""Quantile that stands in for a parameter that a variant fixes."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """One explanation: no effect, a single one, or several at once.

    Parameters
    ----------
    effects : tuple of Effect
        The effects; empty is 'only the tolerances'.
    fuller : bool
        Whether the model is put on the fuller theory because the nominal one is known to fall short.
    chosen : tuple of Variant
        The form of each effect; empty is the plain form of all.
    outliers : tuple of Outlier
        Data taken to be worse than stated.
    """

    effects: tuple[Effect, ...] = ()
    fuller: bool = False
    chosen: tuple[Variant, ...] = ()
    outliers: tuple[Outlier, ...] = ()

    @property
    def forms(self) -> tuple[Variant, ...]:
        """The form of each effect."""
        return self.chosen or (Variant(),) * len(self.effects)

    @property
    def log_weight(self) -> float:
        """Logarithm of the prior share of these forms, and of these outliers [-]."""
        forms = float(np.sum(np.log([form.weight for form in self.forms]))) if self.effects else 0.0
        return forms + log_price(self.outliers)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the effects."""
        return tuple(effect.name for effect in self.effects)

    def doubt_on(self, predictor: Predictor, parts: Sequence[tuple[Effect, Values]] = ()) -> Doubt:
        """Return what they leave in doubt on a specimen and its test; ``parts`` are those acting, with their values."""
        fidelity = [effect.fidelity_on(predictor) for effect in self.effects]
        structure = [part for part in parts if part[0].channel in ("stiffness", "mass")]
        exact = [(effect, values) for effect, values in structure if not effect.fidelity_on(predictor)]
        shared = exact and len(exact) < len(structure)
        return Doubt(
            fidelity=max(fidelity, default=0.0),
            damping=max((effect.damping_doubt for effect in self.effects), default=0.0),
            uneven=max((f for f, e in zip(fidelity, self.effects, strict=True) if e.uneven), default=0.0),
            exact=self.assemble(self.stage(predictor), exact) if shared else NOMINAL,
        )

    def stage(self, predictor: Predictor) -> Predictor:
        """Return the predictor the effects act on."""
        theory = predictor.spec.fuller
        wanted = self.fuller or any(effect.fuller for effect in self.effects)
        stage = predictor.under(theory) if wanted and theory is not None else predictor
        return stage.clamped if all(effect.keeps_clamps for effect in self.effects) else stage

    def parameters(self, predictor: Predictor) -> tuple[tuple[str, Parameter], ...]:
        """Return the parameters that are searched, as (effect.parameter, prior)."""
        return tuple(
            (f"{effect.key}.{p.name}", p)
            for effect, form in zip(self.effects, self.forms, strict=True)
            for p in _free(effect, form, predictor)
        )

    def values(self, predictor: Predictor, coordinates: Sequence[float]) -> dict[str, float]:
        """Take prior quantiles to values, by effect.parameter."""
        stage = self.stage(predictor)
        return {f"{e.key}.{n}": v for e, part in self.split(stage, coordinates) for n, v in part.items()}

    def split(self, stage: Predictor, coordinates: Sequence[float]) -> list[tuple[Effect, Values]]:
        """Return the values of each effect's parameters at prior quantiles, on the predictor they act on."""
        parts: list[tuple[Effect, Values]] = []
        start = 0
        for effect, form in zip(self.effects, self.forms, strict=True):
            quantiles = []
            for parameter in effect.priors(stage):
                fixed = parameter.name in form.values
                quantiles.append(MIDDLE if fixed else form.quantile(parameter.name, coordinates[start]))
                start += not fixed
            parts.append((effect, effect.settled(stage, {**effect.values(stage, quantiles), **form.values})))
        return parts

    def coordinates(self, predictor: Predictor, values: Mapping[str, float]) -> FloatArray:
        """Take values by effect.parameter to prior quantiles (k,), half the range where one is not given."""
        stage = self.stage(predictor)
        found = []
        for effect, form in zip(self.effects, self.forms, strict=True):
            head = f"{effect.key}."
            own = {n.removeprefix(head): v for n, v in values.items() if n.startswith(head)}
            known = zip(effect.priors(stage), effect.quantiles(stage, own), strict=True)
            found += [form.coordinate(p.name, u) for p, u in known if p.name not in form.values]
        return np.asarray(np.clip(np.array(found, dtype=float), 0.0, 1.0))

    def state(self, predictor: Predictor, coordinates: Sequence[float]) -> State:
        """Return the state of the model at prior quantiles."""
        stage = self.stage(predictor)
        return self.assemble(stage, self.split(stage, coordinates))

    def assemble(self, stage: Predictor, parts: Sequence[tuple[Effect, Values]]) -> State:
        """Return the state of the model at values of the effects, places those on the stretched structure."""
        fuller = FULLER.get(stage.spec.kind) if self.fuller else None
        theory = NOMINAL if fuller is None else State(theory=fuller)
        spread = combine([effect.state(stage, v) for effect, v in parts if not is_placed(v)])
        placed = [effect.state(stage, stage.unstretched(v, spread)) for effect, v in parts if is_placed(v)]
        return combine([spread, *placed, theory])

    def locations(
        self, predictor: Predictor, coordinates: Sequence[float], *, channel: str | None = None
    ) -> tuple[tuple[float, float, float], ...]:
        """Return where the effects sit, those of one channel or all [m]."""
        stage = self.stage(predictor)
        acting = [(e, v) for e, v in self.split(stage, coordinates) if channel in (None, e.channel)]
        return tuple(place for effect, values in acting for place in effect.locations(stage, values))

    def derived(self, predictor: Predictor, coordinates: Sequence[float]) -> dict[str, tuple[float, str]]:
        """Return derived quantities by effect.name, as (value, unit)."""
        stage = self.stage(predictor)
        return {
            f"{effect.key}.{n}": v
            for effect, values in self.split(stage, coordinates)
            for n, v in effect.derived(stage, values).items()
        }

    def starts(self, predictor: Predictor) -> list[FloatArray]:
        """Return prior quantiles to start a search from: every combination of the effects' own."""
        stage = self.stage(predictor)
        own = [_starts(e, form, stage) for e, form in zip(self.effects, self.forms, strict=True)]
        return [np.concatenate([*map(np.asarray, s), []]) for s in product(*own)]


def _free(effect: Effect, form: Variant, predictor: Predictor) -> list[Parameter]:
    return [p for p in effect.priors(predictor) if p.name not in form.values]


def _starts(effect: Effect, form: Variant, stage: Predictor) -> list[tuple[float, ...]]:
    names = [p.name for p in effect.priors(stage)]
    own = [
        tuple(form.coordinate(n, u) for n, u in zip(names, start, strict=True) if n not in form.values)
        for start in effect.starts(stage)
    ]
    return list(dict.fromkeys(start for start in own if all(0 <= u <= 1 for u in start)))
