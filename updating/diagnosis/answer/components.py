"""What each effect of a set does, from the posterior samples of the set in all its forms."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating.diagnosis.answer.clusters import SEARCHED
from updating.diagnosis.answer.mechanism import Component, Quantity
from updating.diagnosis.search.compared import Compared
from updating.diagnosis.search.evidence import Explanation
from updating.effects.base import Effect, Values
from updating.effects.box import Place
from updating.effects.mechanism import Channel, Extent, Size
from updating.prediction.predict import Predictor
from updating.problem.specimen import SpecimenProblem


@dataclass(frozen=True)
class Drawn:
    """What one effect does at one posterior sample.

    Parameters
    ----------
    weight : float
        Posterior weight [-].
    channel, extent : str
        As of :class:`updating.diagnosis.answer.mechanism.Component`.
    sizes : tuple of Size
        How large it is.
    places : tuple of tuple of float
        Where it is [m].
    together : bool
        Whether it is in all of the places at the same time, and not in one of them.
    """

    weight: float
    channel: Channel
    extent: Extent
    sizes: tuple[Size, ...]
    places: tuple[Place, ...]
    together: bool


def components(
    problem: SpecimenProblem, row: Compared, *, apart: float, most: int = 300
) -> tuple[Component, ...]:
    """Return what each effect of a set does, in the order of the effects.

    Parameters
    ----------
    problem : SpecimenProblem
        Test and model.
    row : Compared
        The set, with its forms.
    apart : float
        Samples further than this from the best place belong to other places [m].
    most : int
        How many of the heaviest samples of each form are taken.
    """
    forms = [form for form in row.forms if form[0].names == row.names] or [(row.explanation, 1.0)]
    drawn = [one for form, share in forms for one in _samples(problem, form, share, most)]
    return tuple(_component([one[i] for one in drawn], apart) for i in range(len(row.names)))


def _samples(
    problem: SpecimenProblem, form: Explanation, share: float, most: int
) -> Iterator[tuple[Drawn, ...]]:
    """Yield what the effects of a form do at its heaviest samples, the heaviest first, weighing ``share`` together."""
    candidate = form.candidate
    stage = candidate.stage(problem.predictor)
    heavy = np.argsort(form.weights)[::-1][:most]
    weights = share * form.weights[heavy] / form.weights[heavy].sum()
    for weight, i in zip(weights.tolist(), heavy.tolist(), strict=True):
        parts = candidate.split(stage, form.samples[i].tolist())
        yield tuple(_drawn(effect, stage, values, weight) for effect, values in parts)


def _drawn(effect: Effect, stage: Predictor, values: Values, weight: float) -> Drawn:
    searches = bool(SEARCHED & {parameter.name for parameter in effect.parameters(stage)})
    places = tuple(effect.locations(stage, values))
    return Drawn(
        weight,
        effect.acts_in(stage, values),
        effect.extent(stage, values),
        effect.sizes(stage, values),
        places,
        together=not searches,
    )


def _component(drawn: list[Drawn], apart: float) -> Component:
    """Gather the samples of one effect; those of another channel or extent than most of them are left out."""
    kinds: Counter[tuple[Channel, Extent]] = Counter()
    for one in drawn:
        kinds[one.channel, one.extent] += one.weight  # type: ignore[assignment]
    channel, extent = kinds.most_common(1)[0][0]
    kept = [one for one in drawn if (one.channel, one.extent) == (channel, extent)]
    weights = np.array([one.weight for one in kept])
    common = [
        size
        for size in kept[0].sizes
        if all(size.quantity in {s.quantity for s in one.sizes} for one in kept)
    ]
    sizes: dict[Quantity, FloatArray] = {
        (size.quantity, size.unit): np.array(
            [next(s.value for s in one.sizes if s.quantity == size.quantity) for one in kept]
        )
        for size in common
    }
    placed = all(one.places for one in kept) and extent in ("local", "edge", "chain")
    count = len(kept[0].places) if placed and kept[0].together else 1
    return Component(
        channel,
        extent,
        np.asarray(weights / weights.sum()),
        sizes,
        _nearest(kept, apart) if placed else None,
        count,
        {(size.quantity, size.unit): size.doubt for size in common if size.doubt},
    )


def _nearest(drawn: list[Drawn], apart: float) -> FloatArray:
    """Return the place of each sample that is nearest to that of the heaviest, (n, 3) [m]; nan of one at another."""
    heaviest = max(drawn, key=lambda one: one.weight)
    about = np.asarray(heaviest.places[0])
    found = np.full((len(drawn), 3), np.nan)
    for at, one in zip(found, drawn, strict=True):
        every = np.asarray(one.places)
        away = np.linalg.norm(every - about, axis=1)
        if away.min() <= apart:
            at[:] = every[away.argmin()]
    return found
