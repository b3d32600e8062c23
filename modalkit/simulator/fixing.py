"""Fix something to a body, cut into it or stick something on it, be it a beam or a plate."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from modalkit.simulator.bodies.parts import Absorber, Attached, Notch, Stretch
from modalkit.simulator.bodies.plate.parts import Patch, PlateAbsorber, PlateAttached, SoftSpot
from modalkit.simulator.bodies.solid.solid import Cut, Solid
from modalkit.simulator.scene import Scene

_SPRINGS = 9
"""Springs that stand for a foundation along a stretch; twice as many move no frequency by more than 1e-4 [-]."""

_STEPS = 3
"""Steps in which what runs out to its edges does; twice as many move no frequency by more than 1e-3 [-]."""


def appended(scene: Scene, name: str, part: Any) -> Scene:
    """Return the scene with one more part in a tuple of its body's.

    Parameters
    ----------
    scene : Scene
        The rig.
    name : str
        Of the tuple.
    part : object
        What is added.
    """
    return scene.with_body(**{name: (*getattr(scene.body, name), part)})


def attached(scene: Scene, place: tuple[float, ...], **properties: float) -> Scene:
    """Return the scene with a mass, a spring or a dashpot at a place.

    Parameters
    ----------
    scene : Scene
        The rig.
    place : (x,) or (x, y)
        [m].
    **properties : float
        Of mass [kg], inertia [kg m2], stiffness [N/m] and damping [N s/m].
    """
    part: Any = PlateAttached if len(place) == 2 else Attached
    return appended(scene, "attached", part(*place, **properties))


def hung(scene: Scene, place: tuple[float, ...], *, mass: float, hertz: float, ratio: float) -> Scene:
    """Return the scene with a mass that hangs by a spring and a dashpot.

    Parameters
    ----------
    scene : Scene
        The rig.
    place : (x,) or (x, y)
        [m].
    mass, hertz, ratio : float
        Of the mass on its spring alone [kg], [Hz], [-].
    """
    part: Any = PlateAbsorber if len(place) == 2 else Absorber
    omega = 2 * np.pi * hertz
    stiffness, damping = mass * omega**2, 2 * ratio * mass * omega
    return appended(scene, "absorbers", part(*place, mass=mass, stiffness=stiffness, damping=damping))


def sprung(
    scene: Scene, place: tuple[float, ...], *, extent: float, stiffness: float, damping: float = 0.0
) -> Scene:
    """Return the scene with springs and dashpots to the ground, at a place or evenly over some length.

    Parameters
    ----------
    scene : Scene
        The rig.
    place : (x,) or (x, y)
        Their middle [m].
    extent : float
        How far they reach along x, 0 at a place [m].
    stiffness, damping : float
        Of all together [N/m], [N s/m].
    """
    count = _SPRINGS if extent else 1
    for offset in extent * ((np.arange(count) + 0.5) / count - 0.5):
        at = (place[0] + float(offset), *place[1:])
        scene = attached(scene, at, stiffness=stiffness / count, damping=damping / count)
    return scene


def softened(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """Return the scene with a local loss, or gain, of bending stiffness.

    Parameters
    ----------
    scene : Scene
        The rig.
    values : mapping
        x, on plates y, extent and extent_y [m], loss, negative where it is stiffer [-], and ``form``: cosine where
        it is left out. A solid gets a slot of the depth that leaves as much of the section's stiffness.
    """
    if isinstance(scene.body, Solid):
        depth = scene.body.thickness * (1.0 - (1.0 - values["loss"]) ** (1 / 3))
        return appended(scene, "cuts", Cut(values["x"], values["extent"], depth))
    smooth = values.get("form", "cosine") == "cosine"
    if "y" in values:
        at, along, loss = (values["x"], values["y"]), values["extent"], values["loss"]
        across = values.get("extent_y", along)
        return appended(scene, "spots", SoftSpot(*at, along, across, loss=loss, smooth=smooth))
    if smooth:
        return appended(scene, "notches", Notch(values["x"], values["extent"], values["loss"]))
    return appended(scene, "stretches", Stretch(values["x"], values["extent"], bending=1 - values["loss"]))


def loaded(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """Return the scene with another mass per area, and no other stiffness, over a stretch or a rectangle.

    Parameters
    ----------
    scene : Scene
        The rig.
    values : mapping
        x, on plates y, extent and extent_y [m]; ``factor``, of the mass per area in its mean; and ``form``: ``sheet``
        with sharp edges where it is left out, or ``ice``, thickest in the middle, that runs out in steps.
    """
    sizes = (np.arange(_STEPS) + 1.0) / _STEPS if values.get("form") == "ice" else np.ones(1)
    across = values.get("extent_y", values["extent"])
    power = 2 if "y" in values else 1
    added = (values["factor"] - 1.0) * len(sizes) / np.sum(sizes**power)  # of all steps, one on the other
    before = 1.0
    for step, size in enumerate(sizes[::-1]):
        now = 1.0 + added * (step + 1) / len(sizes)
        thicker, before = now / before, now
        if "y" in values:
            at = values["x"], values["y"], size * values["extent"], size * across
            scene = appended(scene, "patches", Patch(*at, mass=thicker - 1.0))
        else:
            part = Stretch(values["x"], size * values["extent"], line=thicker)
            scene = appended(scene, "stretches", part)
    return scene


def covered(scene: Scene, values: Mapping[str, Any]) -> Scene:
    """Return the scene with a layer on a stretch of a beam or on a rectangle of a plate.

    Parameters
    ----------
    scene : Scene
        The rig.
    values : mapping
        x, on plates y, extent and extent_y [m]; loss_factor [-], alpha [1/s] and beta [s]; and what it adds:
        mass and stiffness [-].
    """
    extent, loss = values["extent"], values.get("loss_factor", 0.0)
    viscous = {name: values.get(name, 0.0) for name in ("alpha", "beta")}
    mass, stiffness = values.get("mass", 0.0), values.get("stiffness", 0.0)
    if "y" in values:
        at = values["x"], values["y"]
        across = values.get("extent_y", extent)
        layer = Patch(*at, extent, across, loss_factor=loss, mass=mass, stiffness=stiffness, **viscous)
        return appended(scene, "patches", layer)
    part = Stretch(values["x"], extent, bending=1 + stiffness, line=1 + mass, loss=loss, **viscous)
    return appended(scene, "stretches", part)
