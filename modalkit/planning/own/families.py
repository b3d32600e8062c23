"""Effects of the library on a study's own model as families: each region, joint, support and node set by its name.

What a severity is, where it begins and what is asked about stands here; what it does to the model, the effect itself
states, as in a diagnosis.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from acquisition.arrays import FloatArray
from acquisition.quantities import UNSPOKEN, quantity, severity
from modalkit.planning.family import Family
from modalkit.planning.own.overall import OVERALL
from modalkit.planning.own.parts import PARTS
from modalkit.planning.own.spots import SPOTS
from updating.effects.base import Effect
from updating.effects.hypothesis import Supposed
from updating.prediction.predict import Predictor


def families_of(effect: Effect, predictor: Predictor, points: FloatArray) -> list[Family]:
    """Return the families of an effect.

    Parameters
    ----------
    effect : Effect
        The effect, which applies to the model.
    predictor : Predictor
        The model.
    points : (n, dim) array
        Points of the test [m].
    """
    if isinstance(effect, Supposed):
        return list(_supposed(effect))
    if effect.name in SPOTS:
        return list(SPOTS[effect.name](effect, predictor, points))
    makers = {**PARTS, **OVERALL}
    return list(makers[effect.name](effect, predictor)) if effect.name in makers else []


def _supposed(effect: Supposed) -> Iterator[Family]:
    """How far it is as the study supposes, in full asked about; of a parameter its value."""
    own = effect.hypothesis
    if not own.of_parameter:
        most = min(1.0, own.high)
        yield Family(
            name=effect.name, values=lambda q, _: {"amount": q}, low=min(own.low, 0.0), high=own.high,
            clear=most, words=f"{effect.name}, by more than", amount=lambda q: f"{severity(100 * abs(q))} %",
            both=False,
        )  # fmt: skip
        return
    stands = own.as_modelled
    sign = -1.0 if own.high <= stands else 1.0
    ends = sorted(sign * (end - stands) for end in (own.low, own.high))
    yield Family(
        name=effect.name, values=lambda q, _: {"value": stands + sign * q}, low=min(ends[0], 0.0),
        high=ends[1], clear=ends[1], words=f"{effect.name}: away from the model's value by more than",
        amount=_in_its_unit(own.unit), both=False,
    )  # fmt: skip


def _in_its_unit(unit: str) -> Callable[[float], str]:
    """Return what writes how far a parameter is off: in its unit, that of a factor in per cent."""
    if unit in UNSPOKEN:
        return lambda q: f"{severity(100 * abs(q))} %"
    return lambda q: quantity(float(severity(abs(q))), unit)
