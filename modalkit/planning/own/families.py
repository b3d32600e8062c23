"""Effects of the library on a study's own model as families: each region, joint, support and node set by its name.

What a severity is, where it begins and what is asked about stands here; what it does to the model, the effect itself
says, as in a diagnosis.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from itertools import product

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.quantities import severity
from modalkit.planning.family import Family, Values, factor, per_cent
from modalkit.planning.whole import CLEAR_LOAD, MOST_LOAD, NEAR
from updating.effects.base import Effect, total_mass
from updating.effects.hypothesis import Supposed
from updating.effects.regions import WAYS, heavy_regions, stiff_regions
from updating.effects.structure.spring import own_stiffness
from updating.models.imported.groups import Joint, Support
from updating.prediction.predict import Predictor

Maker = Callable[[Effect, Predictor], Iterator[Family]]
"""Makes the families of an effect on a model, none where it has no place there."""

SOFTER = float(np.log(1 / 0.8))
"""A region of 80 % of its stiffness is asked about: a crack, a seam that opens, a sheet 8 % thin [-]."""

HEAVIER = float(np.log(1.2))
"""A region a fifth heavier: a cable, a cover, a filling [-]."""

LOOSE = float(np.log(10.0))
"""A joint with a tenth of its stiffness: a bolt that lost its preload [-]."""

SOFTEST = float(np.log(1e3))
"""Softest joint, stiffest of the other sign: as the diagnosis has them [-]."""

HEAVIEST, BODY = 0.3, 0.05
"""Largest body and the one that is asked about, of the structure's mass [-]: as on the rig's beams."""

STIFFEST, SPRING = 100.0, 0.3
"""Stiffest spring to the ground and the one that is asked about, over the structure's own stiffness [-]: the latter
raises a cantilever's lowest frequency by a twentieth."""

SOFT_SUPPORT = 20.0
"""A support that is asked about, over the softest that is believed [-]: as the clamps of the rig's beams."""

BELIEVED_LOAD = 0.8
"""Largest pressure that the effect believes, of that at which the plate buckles [-]."""

FAINTEST = 1e-5
"""Smallest severity that is solved where it ranges over many decades, of the largest [-]."""

LOSSY, LAYER = 0.5, 0.1
"""Largest loss factor of a layer, and the one that is asked about [-]."""


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
    local = {
        "lumped_mass": _bodies,
        "ground_spring": _springs,
        "channel_gain": _channels,
        "position_error": _strayed,
    }
    if effect.name in local:
        return list(local[effect.name](effect, predictor, points))
    return list(MAKERS[effect.name](effect, predictor)) if effect.name in MAKERS else []


def _whole(noun: str, *, most: float, clear: float) -> Maker:
    return lambda effect, predictor: iter([factor(effect.name, noun, most=most, clear=clear)])


def _soft(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """Each region softer or stiffer; of a plate, all its zones as places of one effect."""
    if predictor.spec.imported is None:
        yield _zones(effect, predictor)
        return
    for name in stiff_regions(predictor):
        yield Family(
            f"{effect.name} of {name}", _regional(name, "loss", lambda q: 1 - float(np.exp(-q))), -float(np.log(4.0)),
            float(np.log(10.0)), SOFTER, f"a stiffness of {name} off by more than", _lost, effect=effect.name, at=name,
        )  # fmt: skip


def _regional(name: str, parameter: str, value: Callable[[float], float]) -> Callable[[float, float], Values]:
    return lambda q, _: {"region": name, parameter: value(q)}


def _lost(q: float) -> str:
    return f"{severity(100 * (1 - np.exp(-abs(q))))} %"


def _zones(effect: Effect, predictor: Predictor) -> Family:
    """A soft spot as large as a zone, at the middle of each."""
    spec = predictor.spec
    zones = spec.regions
    sizes = [(r.x[1] - r.x[0], (r.y or (0.0, spec.width))[1] - (r.y or (0.0, spec.width))[0]) for r in zones]
    middles = [(sum(r.x) / 2, sum(r.y or (0.0, spec.width)) / 2) for r in zones]

    def values(q: float, zone: float) -> Values:
        (x, y), (along, across) = middles[int(zone)], sizes[int(zone)]
        return {"x": x, "y": y, "extent": along, "extent_y": across, "loss": 1 - float(np.exp(-q))}

    return Family(
        effect.name, values, -float(np.log(4.0)), float(np.log(10.0)), SOFTER, "a zone's stiffness off by more than",
        _lost, np.arange(float(len(zones))), separately=True,
    )  # fmt: skip


def _heavy(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    end = float(np.log(4.0))
    for name in heavy_regions(predictor):
        yield Family(
            f"{effect.name} of {name}", _regional(name, "factor", lambda q: float(np.exp(q))), -end, end, HEAVIER,
            f"a mass of {name} off by more than", per_cent, effect=effect.name, at=name,
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
                    name, _springs_of(joint, parameter, own), -float(np.log(10.0)), SOFTEST, LOOSE,
                    f"a joint {joint.name} that {way} with less than",
                    lambda q: f"{severity(100 * float(np.exp(-abs(q))))} % of its stiffness", effect=effect.name,
                    at=joint.name, both=False,
                )  # fmt: skip
            else:
                unit = own_stiffness(predictor) * (predictor.spec.imported.reach**2 if i else 1.0)
                yield Family(
                    name, _springs_of(joint, parameter, 0.0), 0.0, 1e3 * unit, unit,
                    f"a joint {joint.name} held by more than", _unit("N m/rad" if i else "N/m"), effect=effect.name,
                    at=joint.name, finest=FAINTEST,
                )  # fmt: skip


def _springs_of(joint: Joint, parameter: str, own: float) -> Callable[[float, float], Values]:
    modelled = {"stiffness": joint.stiffness[0], "turning": joint.stiffness[1]}

    def values(q: float, _: float) -> Values:
        size = own * float(np.exp(-q)) if own else q
        return {"joint": joint.name, **modelled, "damping": 0.0, parameter: size}

    return values


def _unit(unit: str) -> Callable[[float], str]:
    return lambda q: f"{severity(q)} {unit}"


def _clamps(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """Each support in each direction in which it holds; the severity is its compliance."""
    (stiffness,) = effect.parameters(predictor)
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
            name, _given(support, axis), 0.0, 1 / stiffness.low, 1 / (soft * stiffness.low),
            "a clamp softer than" if support is None else f"a support {support.name} softer than",
            lambda q: f"{severity(1 / q)} {stiffness.unit}", effect=effect.name,
            at="" if support is None else support.name,            finest=max(stiffness.low / stiffness.high, FAINTEST),
        )  # fmt: skip


def _given(support: Support | None, axis: int) -> Callable[[float, float], Values]:
    there = {} if support is None else {"support": support.name, "direction": WAYS[axis]}
    return lambda q, _: {**there, "stiffness": 1 / q if q else np.inf}


def _sensor(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    mass = total_mass(predictor.spec)
    yield Family(
        effect.name, lambda q, _: {"mass": q, "bulk": 0.0}, 0.0, HEAVIEST * mass, BODY * mass,
        "a sensor heavier than stated by", _in_g,
    )  # fmt: skip


def _in_g(q: float) -> str:
    return f"{severity(1e3 * q)} g"


def _bodies(effect: Effect, predictor: Predictor, points: FloatArray) -> Iterator[Family]:
    """A body at each node set, and at any of the test's points."""
    mass = total_mass(predictor.spec)
    for name, place in _places(predictor, points):
        more: Values = {"bulk": 1.0}
        yield _body(effect.name, name, place, more, mass)


def _body(cause: str, name: str, places: list[Values], more: Values, mass: float) -> Family:
    return Family(
        f"{cause} at {name}" if name else cause,
        lambda q, i: {**places[int(i)], **more, "mass": q}, 0.0, HEAVIEST * mass, BODY * mass,
        f"a body at {name} heavier than" if name else "a body at a point heavier than", _in_g,
        np.arange(float(len(places))) if len(places) > 1 else np.zeros(0), separately=True, effect=cause, at=name,
    )  # fmt: skip


def _places(predictor: Predictor, points: FloatArray) -> Iterator[tuple[str, list[Values]]]:
    """Give each node set by its name, and all points of the test together under none."""
    imported = predictor.spec.imported
    for group in () if imported is None else imported.groups:
        yield group.name, [{"at": group.name}]
    if len(points):
        yield "", [dict(zip("xyz", map(float, at), strict=False)) for at in np.unique(points, axis=0)]


def _springs(effect: Effect, predictor: Predictor, points: FloatArray) -> Iterator[Family]:
    """A spring at each node set along each axis, and at any of the test's points."""
    own, imported = own_stiffness(predictor), predictor.spec.imported
    still: Values = {"damping": 0.0, "extent": 0.0}

    def family(name: str, at: str, places: list[Values]) -> Family:
        return Family(
            name, lambda q, i: {**places[int(i)], **still, "stiffness": q}, 0.0, STIFFEST * own, SPRING * own,
            f"a spring to the ground at {at or 'a point'} stiffer than", _unit("N/m"),
            np.arange(float(len(places))) if len(places) > 1 else np.zeros(0), separately=True, effect=effect.name,
            at=at, finest=FAINTEST,
        )  # fmt: skip

    for name, places in _places(predictor, points):
        if not name:
            yield family(effect.name, "", places)
            continue
        assert imported is not None
        (group,) = (one for one in imported.groups if one.name == name)
        for axis in (axis for axis in range(3) if group.moves(axis)):
            yield family(
                f"{effect.name} at {name} along {WAYS[axis]}", name, [{**places[0], "along": WAYS[axis]}]
            )


def _channels(effect: Effect, predictor: Predictor, points: FloatArray) -> Iterator[Family]:
    """Any of the points by a gain of its own."""
    nodes = predictor.measured.nodes[: len(points)]
    end = float(np.log(2.5))
    yield Family(
        effect.name, lambda q, i: {"points": (nodes[int(i)],), "gain": float(np.exp(q))}, -end, end, 0.2,
        "a point's level off by more than", per_cent, np.arange(float(len(points))), separately=True,
    )  # fmt: skip


def _strayed(effect: Effect, predictor: Predictor, points: FloatArray) -> Iterator[Family]:
    """Any of the points beside its place, along x."""
    nodes, length = predictor.measured.nodes, predictor.spec.length
    yield Family(
        effect.name, lambda q, i: {"point": nodes[int(i)], "dx": q, "dy": 0.0}, -0.12 * length, 0.12 * length,
        0.05 * length, "a point off by more than", lambda q: f"{severity(1e3 * abs(q))} mm",
        np.arange(float(len(points))), separately=True,
    )  # fmt: skip


def _gain(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    end = float(np.log(2.5))
    yield Family(
        effect.name,
        lambda q, _: {"gain": float(np.exp(q))},
        -end,
        end,
        0.2,
        "a level off by more than",
        per_cent,
    )


def _middle(predictor: Predictor) -> tuple[float, float]:
    """Return angular frequency [rad/s] and expected decay [1/s] of the second mode."""
    modes = predictor.predict(count=2)
    omega = 2 * np.pi * float(modes.frequency[-1])
    return omega, float(modes.damping[-1]) * omega


def _window(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    _, decay = _middle(predictor)
    yield Family(
        effect.name, lambda q, _: {"decay": q}, 0.0, max(70.0, 20 * decay), 1.5 * decay, "a window of more than",
        _unit("1/s"),
    )  # fmt: skip


def _uniform(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """Three laws, each as much as the second mode's expected decay at ``q`` = 1."""
    omega, decay = _middle(predictor)
    unit = {"alpha": 2 * decay, "beta": 2 * decay / omega**2, "loss_factor": 2 * decay / omega}
    laws = tuple(unit)
    yield Family(
        effect.name, lambda q, law: {name: q * unit[name] * (name == laws[int(law)]) for name in laws}, 0.0, 20.0, 1.5,
        "damping", lambda q: f"{severity(1 + q)} times that expected in the middle", np.arange(3.0), separately=True,
    )  # fmt: skip


def _layers(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """A layer on each region."""
    nothing = {"alpha": 0.0, "beta": 0.0, "mass": 0.0, "stiffness": 0.0}
    for name in stiff_regions(predictor):
        yield Family(
            f"{effect.name} on {name}", _layer(name, nothing), 0.0, LOSSY, LAYER,
            f"a layer on {name} with a loss factor above", severity, effect=effect.name, at=name,
        )  # fmt: skip


def _layer(name: str, nothing: Mapping[str, float]) -> Callable[[float, float], Values]:
    return lambda q, _: {"region": name, **nothing, "loss_factor": q}


def _length(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    size = predictor.spec.length
    yield Family(
        effect.name, lambda q, _: {"extension": q}, -0.06 * size, 0.12 * size, 0.03 * size,
        "a free length off by more than", lambda q: f"{severity(1e3 * abs(q))} mm", always=True,
    )  # fmt: skip


def _taper(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    yield Family(
        effect.name, lambda q, _: {"slope": q}, -0.8, 0.8, 0.1, "a thickness that changes along x by more than",
        lambda q: f"{severity(100 * abs(q))} %", always=True,
    )  # fmt: skip


def _orthotropy(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    end = float(np.log(2.0))
    yield Family(
        effect.name, lambda q, _: {"ratio": float(np.exp(q)), "shear_ratio": 1.0}, -end, end, 0.1,
        "a modulus along over that across off by more than", per_cent, always=True,
    )  # fmt: skip


def _load(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """A load along x, over that at which the plate buckles: the end of what the effect believes."""
    (force,) = effect.parameters(predictor)
    buckling = -force.low / BELIEVED_LOAD
    yield Family(
        effect.name, lambda q, _: {"force": q}, -MOST_LOAD * buckling, 2 * buckling, CLEAR_LOAD * buckling,
        "an axial load above", lambda q: f"{severity(abs(q))} {force.unit}",
    )  # fmt: skip


def _fluid(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """Of its surface and bottom those that the study does not state are far off or near: forms of the effect."""
    around, spec = predictor.environment, predictor.spec
    near = NEAR * min(spec.length, spec.width)
    unstated = [name for name in ("free_surface", "bottom") if getattr(around, name) is None]
    tanks = [dict(zip(unstated, at, strict=True)) for at in product((np.inf, near), repeat=len(unstated))]
    known = around.fluid_density
    yield Family(
        effect.name, lambda q, form: {"fluid_density": q, **tanks[int(form)]}, 0.0, known or 2000.0, known or 998.0,
        "a fluid denser than", _unit("kg/m3"), np.arange(float(len(tanks))), separately=True,
    )  # fmt: skip


def _viscous(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """Severity is the root of the viscosity, in proportion to which a boundary layer damps."""
    yield Family(
        effect.name, lambda q, _: {"viscosity": q**2}, 0.0, 1.0, 0.1, "a fluid more viscous than",
        lambda q: f"{severity(1e3 * q**2)} mPa s",
    )  # fmt: skip


def _supposed(effect: Supposed) -> Iterator[Family]:
    """How far it is as the study supposes, in full asked about; of a parameter its value."""
    own = effect.hypothesis
    if not own.factor:
        most = min(1.0, own.high)
        yield Family(
            effect.name, lambda q, _: {"amount": q}, min(own.low, 0.0), own.high, most, f"{effect.name}, by more than",
            lambda q: f"{severity(100 * abs(q))} %", both=False,
        )  # fmt: skip
        return
    sign = -1.0 if own.high <= own.nominal else 1.0
    ends = sorted(sign * (end - own.nominal) for end in (own.low, own.high))
    yield Family(
        effect.name, lambda q, _: {"value": own.nominal + sign * q}, min(ends[0], 0.0), ends[1], ends[1],
        f"{effect.name}: away from the model's value by more than", _unit(own.unit.strip("-")), both=False,
    )  # fmt: skip


MAKERS: dict[str, Maker] = {
    "E": _whole("a modulus", most=2.5, clear=0.1),
    "density": _whole("a density", most=2.5, clear=0.1),
    "thickness": _whole("a thickness", most=1.6, clear=0.05),
    "section_scale": _whole("stiffness and mass together", most=2.5, clear=0.15),
    "length": _length,
    "taper": _taper,
    "orthotropy": _orthotropy,
    "axial_load": _load,
    "fluid_added_mass": _fluid,
    "fluid_damping": _viscous,
    "clamp_rotation": _clamps,
    "clamp_translation": _clamps,
    "sensor_mass": _sensor,
    "local_stiffness": _soft,
    "local_mass": _heavy,
    "joint": _joints,
    "damping_patch": _layers,
    "uniform_damping": _uniform,
    "exponential_window": _window,
    "calibration_gain": _gain,
}
"""By effect; those at points of the test are beside it."""
