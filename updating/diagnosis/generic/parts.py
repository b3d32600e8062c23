"""What a cause in no library does: in which channels, where, and how large, from the posterior of its field."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.sparse.csgraph import connected_components

from acquisition.arrays import BoolArray, FloatArray, IntArray
from updating.diagnosis.answer.mechanism import Component, Quantity
from updating.diagnosis.answer.quantiles import quantiles
from updating.diagnosis.generic.columns import PROPERTIES
from updating.diagnosis.generic.field import Field
from updating.effects.base import ALL_OVER, total_mass
from updating.effects.mechanism import (
    ADDED_MASS,
    INTEGRAL_COMPLIANCE,
    MASS_RATIO,
    STIFFNESS_RATIO,
    Channel,
)
from updating.localisation import areas, boxes, centres
from updating.models.spec import Spec
from updating.models.terms import modelled_mass
from updating.problem.specimen import SpecimenProblem

CHANNELS: Mapping[str, Channel] = {
    "E": "stiffness",
    "density": "mass",
    "loss": "damping",
    "gain": "measurement",
}
"""Where each thing that a field changes acts."""


def channels(found: Field) -> dict[str, float]:
    """Return the probability that a field changes each channel, given that there is one [-]."""
    return {channel: found.changes_of(name) for name, channel in CHANNELS.items()}


def parts(
    problem: SpecimenProblem, found: Field, *, least: float = 2.0, likely: float = 0.5, draws: int = 400
) -> tuple[Component, ...]:
    """Return what a field changes, what is surest first.

    Changes of which it is not sure that they are an increase, or a decrease, stand only where there is no other, and
    have no size. Damping and gain, which may take up what regions do not resolve, stand where no region changes.

    Parameters
    ----------
    problem : SpecimenProblem
        Test and model.
    found : Field
        A cause in no library, beside none.
    least : float
        A region counts as changed from so many standard deviations on [-].
    likely : float
        A channel is listed from this probability on that it is changed, and a change is smooth from it on [-].
    draws : int
        Samples of the posterior.
    """
    shares, rng = channels(found), np.random.default_rng(0)
    fields = rng.multivariate_normal(found.changes.ravel(), found.spread, size=draws, method="svd")
    fields = fields.reshape(draws, *found.changes.shape)[:, :, :-1]
    sure = np.abs(found.changes / np.maximum(found.sigma, 1e-12))[:, :-1]
    touch = _touching(problem.predictor.spec)
    listed: list[tuple[float, Component]] = []
    for k, name in enumerate(PROPERTIES):
        if shares[CHANNELS[name]] < likely or sure[k].max(initial=0.0) < least:
            continue
        smooth = found.smooth(name) >= likely
        places = [] if smooth else _places(found.changes[k, :-1], sure[k] * (sure[k] >= least), touch)
        whole = smooth or any(areas(problem)[place].sum() >= ALL_OVER for place in places)
        if whole:
            part = _everywhere(problem, CHANNELS[name], fields[:, k])
            listed.append((float(sure[k].max()), part))
            continue
        for place in places:
            part = _part(problem, found, k, fields[:, k], place, touch, rng)
            listed.append((float(sure[k, place].max()), part))
    listed.sort(key=lambda one: -one[0])
    every = [one for _, one in listed]
    structure = [one for one in every if _directed(one)] or [replace(one, sizes={}) for one in every[:1]]
    others = (_nowhere(name) for name in ("loss", "gain") if shares[CHANNELS[name]] >= likely)
    return tuple(structure) or tuple(others)


def _nowhere(name: str) -> Component:
    """Return a change that has neither a place nor a size."""
    channel = CHANNELS[name]
    return Component(channel, "chain" if channel == "measurement" else "global", np.ones(1), {})


def _touching(spec: Spec) -> BoolArray:
    """Return which regions touch each other or are one, (r, r); those of unknown limits touch none."""
    limits = boxes(spec)
    low, high = limits[..., 0], limits[..., 1]
    gap = np.maximum(low[:, None] - high[None], low[None] - high[:, None])
    near = np.nan_to_num(gap, nan=np.inf).max(axis=2) <= 1e-6 * spec.length
    return np.asarray(near | np.eye(len(limits), dtype=bool))


def _places(
    changes: FloatArray, sure: FloatArray, touch: BoolArray, *, notable: float = 0.5
) -> list[IntArray]:
    """Return regions that touch and change in one direction, the surest first.

    What few modes resolve of a place has side lobes about it: what is beside a surer change, or less than ``notable``
    as sure as the surest, is none of its own.

    Parameters
    ----------
    changes : (r,) array
        Most probable logarithms of the factors [-].
    sure : (r,) array
        By how many standard deviations each is sure, 0 of one that does not count [-].
    touch : (r, r) bool array
        Which regions touch.
    notable : float
        Share of the surest [-].
    """
    found, free = list[IntArray](), sure > 0
    while (sure * free).max(initial=0.0) > notable * sure.max(initial=0.0):
        peak = int((sure * free).argmax())
        alike = np.flatnonzero(free & (np.sign(changes) == np.sign(changes[peak])))
        _, label = connected_components(touch[np.ix_(alike, alike)], directed=False)
        place = alike[label == label[int(np.flatnonzero(alike == peak)[0])]]
        found.append(place)
        inside = np.isin(np.arange(len(sure)), place)
        free &= ~(touch @ (touch @ inside))
    return found


def _everywhere(problem: SpecimenProblem, channel: Channel, fields: FloatArray) -> Component:
    """Return a change of the whole structure by samples of the logarithms of all regions' factors (n, r)."""
    weights = np.full(len(fields), 1 / len(fields))
    relative = np.expm1(fields) @ areas(problem)
    quantity = STIFFNESS_RATIO if channel == "stiffness" else MASS_RATIO
    return Component(channel, "global", weights, {(quantity, "-"): relative})


def _directed(part: Component) -> bool:
    """Return whether it is sure that a change is an increase, or that it is a decrease."""
    ends = [quantiles(values, part.weights) for values in part.sizes.values()]
    return all(low * high > 0 for low, _, high in ends)


def _part(
    problem: SpecimenProblem,
    found: Field,
    k: int,
    fields: FloatArray,
    place: IntArray,
    touch: BoolArray,
    rng: np.random.Generator,
) -> Component:
    """Return a change of one of ``PROPERTIES`` at a place, by samples of the logarithms of all factors (n, r).

    Of the regions of the place each sample takes one, as often as it is sure. The size is the sum over the place and
    what touches it, and half of what is beside that: it holds the side lobes of few modes, which have either sign. A
    region counts as far as the data determine it, by what they take off the variance of its prior.
    """
    weights = np.full(len(fields), 1 / len(fields))
    sure = np.abs(found.changes[k, place] / np.maximum(found.sigma[k, place], 1e-12))
    peak = rng.choice(len(place), size=len(fields), p=sure / sure.sum())
    limits = boxes(problem.predictor.spec)[place]
    at = limits[peak, :, 0] + rng.uniform(size=(len(fields), 3)) * (limits[peak, :, 1] - limits[peak, :, 0])
    at = np.where(np.isfinite(at), at, centres(problem)[place][peak])
    quantity, sizes = _sizes(problem, CHANNELS[PROPERTIES[k]], fields)
    inside = np.isin(np.arange(sizes.shape[1]), place)
    beside = touch @ inside
    known = 1 - (found.sigma[k, :-1] / max(found.kind.amplitude, 1e-12)) ** 2
    counts = (0.5 * beside + 0.5 * (touch @ beside)) * np.clip(known, 0.0, 1.0)
    return Component(CHANNELS[PROPERTIES[k]], "local", weights, {quantity: sizes @ counts}, at)


def _sizes(problem: SpecimenProblem, channel: Channel, fields: FloatArray) -> tuple[Quantity, FloatArray]:
    """Return the mass that each region gains [kg], or its compliance [m], by samples of the logarithms (n, r).

    Of imported matrices, whose regions have no length, the compliance over the region's own [-].
    """
    spec = problem.predictor.spec
    if channel == "mass":
        return (ADDED_MASS, "kg"), np.expm1(fields) * _masses(problem)
    lost = np.expm1(-fields)
    if not spec.outlined:
        return (f"relative {INTEGRAL_COMPLIANCE}", "-"), lost
    sides = boxes(spec)
    return (INTEGRAL_COMPLIANCE, "m"), lost * (sides[:, 0, 1] - sides[:, 0, 0])


def _masses(problem: SpecimenProblem) -> FloatArray:
    """Return what each region weighs as modelled, (r,) [kg]."""
    spec = problem.predictor.spec
    if not spec.outlined:
        return areas(problem) * total_mass(spec)
    sides = boxes(spec)
    size = sides[:, 0, 1] - sides[:, 0, 0]
    if spec.kind == "plate":
        size = size * (sides[:, 1, 1] - sides[:, 1, 0])
    return modelled_mass(spec, np.arange(len(size))) * size
