"""The library of effects: one family, each sibling a physical cause of a gap between test and model.

To add one, subclass :class:`Effect` in some thirty lines and :func:`register` an instance.
"""

from __future__ import annotations

from updating.effects.base import Channel, Effect, Parameter
from updating.effects.clamp import ClampRotation
from updating.effects.factor import Density, Modulus, SectionScale, Thickness
from updating.effects.fluid import FluidAddedMass
from updating.effects.length import Length
from updating.effects.local_stiffness import LocalStiffness
from updating.effects.mass import SensorMass
from updating.effects.measurement import CalibrationGain, ExponentialWindow
from updating.effects.shear import Shear

LIBRARY: dict[str, Effect] = {
    effect.name: effect
    for effect in (
        Modulus(),
        Density(),
        Thickness(),
        SectionScale(),
        Length(),
        ClampRotation(),
        SensorMass(),
        LocalStiffness(),
        Shear(),
        FluidAddedMass(),
        ExponentialWindow(),
        CalibrationGain(),
    )
}
"""All effects by name."""


def register(effect: Effect) -> None:
    """Add an effect to the library, or replace the one of the same name."""
    LIBRARY[effect.name] = effect


__all__ = ["LIBRARY", "Channel", "Effect", "Parameter", "register"]
