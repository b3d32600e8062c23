"""Regions, joints and supports as families, each by its name in the study's own model."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from acquisition.quantities import place, severity
from modalkit.planning.family import Family, Values, per_cent
from modalkit.planning.own.sizes import FAINTEST, Maker, in_unit
from updating.effects.base import Effect
from updating.effects.regions import WAYS, heavy_regions, stiff_regions
from updating.effects.structure.spring import own_stiffness
from updating.models.imported.groups import NUMBERED, Joint, Support
from updating.prediction.predict import Predictor

SOFTER = float(np.log(1 / 0.8))
"""A region of 80 % of its stiffness is asked about: a crack, a seam that opens, a sheet 8 % thin [-]."""

HEAVIER = float(np.log(1.2))
"""A region a fifth heavier: a cable, a cover, a filling [-]."""

LOOSE = float(np.log(10.0))
"""A joint with a tenth of its stiffness: a bolt that lost its preload [-]."""

SOFTEST = float(np.log(1e3))
"""Softest joint, stiffest of the other sign: as the diagnosis has them [-]."""

SOFT_SUPPORT = 20.0
"""A support that is asked about, over the softest that is believed [-]."""

LOSSY, LAYER = 0.5, 0.1
"""Largest loss factor of a layer, and the one that is asked about [-]."""


def _soft(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """Each region softer or stiffer; of a plate, all its zones as places of one effect."""
    if predictor.spec.imported is None:
        yield _zones(
            effect, predictor, lambda q: {"loss": 1 - float(np.exp(-q))},
            (-float(np.log(4.0)), float(np.log(10.0)), SOFTER), "stiffness", _lost,
        )  # fmt: skip
        return
    for name in stiff_regions(predictor):
        yield Family(
            name=f"{effect.name} of {name}", values=_regional(name, "loss", lambda q: 1 - float(np.exp(-q))),
            low=-float(np.log(4.0)), high=float(np.log(10.0)), clear=SOFTER,
            words=f"a stiffness of {name} off by more than", amount=_lost, effect=effect.name, at=name,
        )  # fmt: skip


def _regional(name: str, parameter: str, value: Callable[[float], float]) -> Callable[[float, float], Values]:
    return lambda q, _: {"region": name, parameter: value(q)}


def _lost(q: float) -> str:
    return f"{severity(100 * (1 - np.exp(-abs(q))))} %"


def _zones(
    effect: Effect,
    predictor: Predictor,
    value: Callable[[float], Mapping[str, float]],
    sizes: tuple[float, float, float],
    what: str,
    words: Callable[[float], str],
) -> Family:
    """A place as large as a zone, at the middle of each; ``sizes`` are the least, the most and the one asked about."""
    spec = predictor.spec
    zones = spec.regions
    spans = [(r.x[1] - r.x[0], (r.y or (0.0, spec.width))[1] - (r.y or (0.0, spec.width))[0]) for r in zones]
    middles = [(sum(r.x) / 2, sum(r.y or (0.0, spec.width)) / 2) for r in zones]

    def values(q: float, zone: float) -> Values:
        (x, y), (along, across) = middles[int(zone)], spans[int(zone)]
        return {"x": x, "y": y, "extent": along, "extent_y": across, **value(q)}

    places = np.arange(float(len(zones)))
    low, high, clear = sizes
    return Family(
        name=effect.name, values=values, low=low, high=high, clear=clear,
        words=f"a zone's {what} off by more than", amount=words, places=places,
    )  # fmt: skip


def _heavy(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    end = float(np.log(4.0))
    if predictor.spec.imported is None:
        sizes = (-end, end, HEAVIER)
        yield _zones(effect, predictor, lambda q: {"factor": float(np.exp(q))}, sizes, "mass", per_cent)
        return
    for name in heavy_regions(predictor):
        yield Family(
            name=f"{effect.name} of {name}", values=_regional(name, "factor", lambda q: float(np.exp(q))),
            low=-end, high=end, clear=HEAVIER, words=f"a mass of {name} off by more than", amount=per_cent,
            effect=effect.name, at=name,
        )  # fmt: skip


def _joints(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """Each joint in shifting and in turning: softer is asked about, stiffer may stand in for others."""
    assert predictor.spec.imported is not None
    for joint in predictor.spec.imported.joints:
        for i, (parameter, way) in enumerate((("stiffness", "shifts"), ("turning", "turns"))):
            if not joint.springs[i].nnz:
                continue
            name, own = f"{effect.name} {joint.name} {way}", joint.stiffness[i]
            if own:
                yield Family(
                    name=name, values=_springs_of(joint, parameter, own), low=-float(np.log(10.0)),
                    high=SOFTEST, clear=LOOSE, words=f"a joint {joint.name} that {way} with less than",
                    amount=lambda q: f"{severity(100 * float(np.exp(-abs(q))))} % of its stiffness",
                    effect=effect.name, at=joint.name, both=False,
                )  # fmt: skip
            else:
                unit = own_stiffness(predictor) * (predictor.spec.imported.reach**2 if i else 1.0)
                yield Family(
                    name=name, values=_springs_of(joint, parameter, 0.0), low=0.0, high=1e3 * unit,
                    clear=unit, words=f"a joint {joint.name} held by more than",
                    amount=in_unit("N m/rad" if i else "N/m"), effect=effect.name, at=joint.name,
                    finest=FAINTEST,
                )  # fmt: skip


def _springs_of(joint: Joint, parameter: str, own: float) -> Callable[[float, float], Values]:
    modelled = {"stiffness": joint.stiffness[0], "turning": joint.stiffness[1]}

    def values(q: float, _: float) -> Values:
        size = own * float(np.exp(-q)) if own else q
        return {"joint": joint.name, **modelled, "damping": 0.0, parameter: size}

    return values


def _clamps(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """Each support in each direction in which it holds; the severity is its compliance."""
    stiffness = next(p for p in effect.parameters(predictor) if p.name == "stiffness")
    imported = predictor.spec.imported
    turns = effect.name == "clamp_rotation"
    ways: list[tuple[str, Support | None, int]] = [(effect.name, None, 0)]
    if imported is not None:
        axes = range(3, 6) if turns else range(3)
        ways = [
            (
                f"{effect.name} of {support.name} {'about' if turns else 'along'} {WAYS[axis].strip('r')}",
                support,
                axis,
            )
            for support in imported.supports
            for axis in axes
            if support.holds(axis)
        ]
    soft = SOFT_SUPPORT * (1.0 if turns else 5.0)
    for name, support, axis in ways:
        yield Family(
            name=name, values=_given(support, axis), low=0.0, high=1 / stiffness.low, clear=1 / (soft * stiffness.low),
            words="a clamp softer than" if support is None else f"{_spoken(support)} softer than",
            amount=lambda q: f"{severity(1 / q)} {stiffness.unit}", effect=effect.name,
            at="" if support is None else support.name, finest=max(stiffness.low / stiffness.high, FAINTEST),
        )  # fmt: skip


def _spoken(support: Support) -> str:
    """Return what a support is called in a sentence: one without a node set bears its number already."""
    return support.name if support.name.startswith(NUMBERED) else f"support {support.name}"


def where_supports_are(predictor: Predictor) -> list[str]:
    """Return the place of each support: names that a model numbers mean nothing by themselves."""
    imported = predictor.spec.imported
    supports = () if imported is None else imported.supports
    return [f"{_spoken(one)} is about {place(one.centre.tolist())}" for one in supports]


def _given(support: Support | None, axis: int) -> Callable[[float, float], Values]:
    there = {} if support is None else {"support": support.name, "direction": WAYS[axis]}
    return lambda q, _: {**there, "stiffness": 1 / q if q else np.inf}


def _layers(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """A layer on each region; on a beam or a plate, all its zones as places of one effect."""
    nothing = {"alpha": 0.0, "beta": 0.0, "mass": 0.0, "stiffness": 0.0}
    if predictor.spec.imported is None:
        yield _zones(
            effect, predictor, lambda q: {**nothing, "loss_factor": q}, (0.0, LOSSY, LAYER), "loss factor", severity
        )  # fmt: skip
        return
    for name in stiff_regions(predictor):
        yield Family(
            name=f"{effect.name} on {name}", values=_layer(name, nothing), low=0.0, high=LOSSY, clear=LAYER,
            words=f"a layer on {name} with a loss factor above", amount=severity, effect=effect.name, at=name,
        )  # fmt: skip


def _layer(name: str, nothing: Mapping[str, float]) -> Callable[[float, float], Values]:
    return lambda q, _: {"region": name, **nothing, "loss_factor": q}


PARTS: dict[str, Maker] = {
    "local_stiffness": _soft,
    "local_mass": _heavy,
    "joint": _joints,
    "clamp_rotation": _clamps,
    "clamp_translation": _clamps,
    "damping_patch": _layers,
}
"""By effect."""
