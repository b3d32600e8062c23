"""A set of effects with its probability, and the sizes that the data give to them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from acquisition.display import Displayed
from acquisition.quantities import estimate, probability, quantity
from updating.diagnosis.answer.set_aside import without


@dataclass(frozen=True)
class ParameterEstimate:
    """A parameter of an effect with its 95 % interval [unit], or what its form fixes: points, which have none.

    One that is ``aside`` matters little by itself and takes a default elsewhere, as the rotary inertia of a mass.
    """

    value: float | str | tuple[int, ...]
    unit: str
    low95: float | None
    high95: float | None
    at_bound: bool
    aside: bool = False

    def __str__(self) -> str:
        if isinstance(self.value, str):
            return self.value
        if isinstance(self.value, tuple):
            return ", ".join(map(str, self.value))
        if self.low95 is None or self.high95 is None:
            return quantity(self.value, self.unit)
        return estimate(self.value, self.unit, self.low95, self.high95)

    @property
    def whole(self) -> str:
        """Value and interval, with its level, as text."""
        if isinstance(self.value, str | tuple) or self.low95 is None or self.high95 is None:
            return str(self)
        return estimate(self.value, self.unit, self.low95, self.high95, level="95 %")

    @property
    def bare(self) -> str:
        """The value alone, as text."""
        return quantity(self.value, self.unit) if isinstance(self.value, float) else str(self)


@dataclass(frozen=True, eq=False, kw_only=True)
class Ranked(Displayed):
    """One set of effects with its probability.

    Parameters
    ----------
    effects : tuple of str
        Their names.
    probability : float
        Of the set, in all its forms [-].
    equivalents : tuple of tuple of str
        Other sets that fit as well.
    parameters : dict of str to ParameterEstimate
        Of its best form.
    plausible : bool
        Whether no parameter is at an end of its range that is a judgement.
    p_value : float
        How well it fits [-].
    forms : tuple of mapping
        What the best form fixes of each effect: the points, the region, which parameters act.
    other_forms : tuple of tuple of mapping
        The same of the other probable forms, a mirrored region for instance, the best first.
    set_aside : tuple of str
        Data that it takes to be worse than stated.
    """

    effects: tuple[str, ...]
    probability: float
    equivalents: tuple[tuple[str, ...], ...]
    parameters: dict[str, ParameterEstimate]
    plausible: bool
    p_value: float
    forms: tuple[Mapping[str, Any], ...] = ()
    other_forms: tuple[tuple[Mapping[str, Any], ...], ...] = ()
    set_aside: tuple[str, ...] = ()

    def of(self, effect: str) -> dict[str, ParameterEstimate]:
        """Return the parameters of one of the effects by their own names."""
        start = f"{effect}."
        return {n.removeprefix(start): e for n, e in self.parameters.items() if n.startswith(start)}

    @property
    def stated(self) -> tuple[str, ...]:
        """Its parameters with their sizes, and without which data it fits."""
        sizes = [f"{n} = {e}" for n, e in self.parameters.items()]
        return (*sizes, *[without(self.set_aside)] * bool(self.set_aside))

    def _headline(self) -> str:
        sizes = "; ".join(self.stated)
        return f"{' + '.join(self.effects) or '(tolerances alone)'}, {probability(self.probability)}: {sizes}"
