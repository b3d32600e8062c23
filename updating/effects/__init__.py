"""The library of effects: one family, each sibling a physical cause of a gap between test and model.

To add one, subclass :class:`Effect` in some thirty lines and :func:`register` an instance.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from acquisition.errors import StudyError
from updating.effects.base import Effect, Parameter, Twin, Variant
from updating.effects.hypothesis import hypotheses_of
from updating.effects.limits import PLACES, check_values
from updating.effects.measurement.channel_gain import ChannelGain
from updating.effects.measurement.delay import TimeDelay
from updating.effects.measurement.drift import Drift
from updating.effects.measurement.gain import CalibrationGain
from updating.effects.measurement.polarity import Polarity
from updating.effects.measurement.position_error import PositionError
from updating.effects.measurement.swapped_points import SwappedPoints
from updating.effects.measurement.window import ExponentialWindow
from updating.effects.mechanism import Channel
from updating.effects.obstacles import Lack, Obstacle
from updating.effects.structure.absorber import Absorber
from updating.effects.structure.axial_load import AxialLoad
from updating.effects.structure.clamp import ClampRotation, ClampTranslation
from updating.effects.structure.damping import UniformDamping
from updating.effects.structure.factor import Density, Modulus, SectionScale, Thickness
from updating.effects.structure.fluid import FluidAddedMass, FluidDamping
from updating.effects.structure.joint import Joint
from updating.effects.structure.joint_nonlinearity import JointNonlinearity
from updating.effects.structure.length import Length
from updating.effects.structure.local_mass import LocalMass
from updating.effects.structure.local_stiffness import LocalStiffness
from updating.effects.structure.mass import LumpedMass, SensorMass
from updating.effects.structure.orthotropy import Orthotropy
from updating.effects.structure.patch import DampingPatch
from updating.effects.structure.shear import Shear
from updating.effects.structure.spring import GroundSpring
from updating.effects.structure.suspension import Suspension
from updating.effects.structure.taper import Taper
from updating.models.spec import Spec
from updating.models.state import State
from updating.prediction.predict import Predictor

LIBRARY: dict[str, Effect] = {
    effect.name: effect
    for effect in (
        Modulus(),
        Density(),
        Thickness(),
        SectionScale(),
        Taper(),
        Length(),
        ClampRotation(),
        ClampTranslation(),
        SensorMass(),
        LumpedMass(),
        LocalStiffness(),
        LocalMass(),
        Absorber(),
        Joint(),
        GroundSpring(),
        Suspension(),
        Shear(),
        Orthotropy(),
        AxialLoad(),
        JointNonlinearity(),
        FluidAddedMass(),
        FluidDamping(),
        DampingPatch(),
        UniformDamping(),
        ExponentialWindow(),
        CalibrationGain(),
        ChannelGain(),
        TimeDelay(),
        Polarity(),
        SwappedPoints(),
        PositionError(),
        Drift(),
    )
}
"""All effects by name."""


def register(effect: Effect) -> None:
    """Add an effect to the library, or replace the one of the same name."""
    LIBRARY[effect.name] = effect


def in_a_set(names: Sequence[str], own: Mapping[str, Effect] = LIBRARY) -> tuple[Effect, ...]:
    """Return the effects of a set of causes by their names; one that is named twice is there twice.

    ``own`` has them, left out the library.
    """
    found: list[Effect] = []
    for name in names:
        before = [effect for effect in found if effect.name == name]
        found.append(before[-1].again() if before else own[name])
    return tuple(found)


def twin_of(names: Collection[str]) -> Twin | None:
    """Return what one of two effects states about the other where both make one and the same change."""
    twins = (LIBRARY[name].twin for name in names if name in LIBRARY)
    return next((twin for twin in twins if twin and len(names) == 2 and twin.name in names), None)


def labels_of(effect: Effect, values: Mapping[str, Any]) -> set[str]:
    """Return the labels that an effect takes beside its parameters: its own, or ``channel`` where that is stated."""
    return {"channel"} if effect.of_sensor and "channel" in values else set(effect.labels)


def names_of(effect: Effect, spec: Spec) -> set[str]:
    """Return what an effect takes beside its parameters that is a name of the user's own model."""
    return effect.names_in(spec)


def optional_values(
    effect: Effect, parameters: Sequence[Parameter], values: Mapping[str, Any], spec: Spec
) -> set[str]:
    """Return what may be left out where an effect is stated: what has a default; of one at a node set its place."""
    placed = PLACES if "at" in values else frozenset()
    return {p.name for p in parameters if not p.needed} | names_of(effect, spec) | placed


def accepted_state(predictor: Predictor, name: str, values: Mapping[str, Any]) -> State:
    """Return the departure that an accepted effect makes at stated values.

    Raises
    ------
    StudyError
        If the effect is unknown, cannot act on this specimen, or takes other parameters.
    """
    if name not in LIBRARY:
        raise StudyError(f"[[model.effect]] unknown effect {name!r}; `modalkit effects` lists them")
    effect = LIBRARY[name]
    there_already = effect.fuller and predictor.spec.fuller is None and predictor.spec.outlined
    if not there_already and (obstacle := effect.why_not(predictor)) is not None:
        raise StudyError(f"[[model.effect]] {name}: {obstacle}")
    parameters = effect.parameters(predictor)
    takes = (
        {parameter.name for parameter in parameters}
        | labels_of(effect, values)
        | names_of(effect, predictor.spec)
    )
    optional = optional_values(effect, parameters, values, predictor.spec)
    if not takes - optional <= set(values) <= takes:
        wanted = ", ".join(sorted({p.name for p in parameters} | set(effect.labels))) or "no parameters"
        instead = f' (or channel = "5+Z", a sensor that stayed{", in place of points" * bool(effect.labels)})'
        raise StudyError(
            f"[[model.effect]] {name}: it takes {wanted}{instead * effect.of_sensor}, "
            f"found {', '.join(sorted(values)) or 'none'}"
        )
    check_values(parameters, values, f"[[model.effect]] {name}")
    return effect.state(predictor, predictor.unstretched(values))


__all__ = [
    "LIBRARY",
    "Channel",
    "Effect",
    "Lack",
    "Obstacle",
    "Parameter",
    "Twin",
    "Variant",
    "accepted_state",
    "check_values",
    "hypotheses_of",
    "in_a_set",
    "labels_of",
    "names_of",
    "optional_values",
    "register",
    "twin_of",
]
