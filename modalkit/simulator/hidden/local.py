"""What sits at one place: masses, local losses of stiffness, layers."""

from __future__ import annotations

import numpy as np

from modalkit.simulator.bodies.parts import Notch, Stretch
from modalkit.simulator.fixing import attached, covered, softened
from modalkit.simulator.hidden.base import (
    HiddenEffect,
    Place,
    Values,
    at_its_place,
    draw_place,
    log_uniform,
    place_of,
)
from modalkit.simulator.scene import Scene, sensor_place
from modalkit.simulator.setup import Setup

_BESIDE = 0.01
_STRIPS = 64


def _draw_sensor(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"mass": min(strength * log_uniform(rng, 0.01, 0.08), 0.2) * setup.mass}


def _act_sensor(scene: Scene, values: Values) -> Scene:
    """Add mass where the sensor sits, its centre as high above the surface as that of the known one."""
    place = tuple(float(x) for x in sensor_place(scene.setup, scene.marks))
    arm = 0.004 + scene.setup.thickness / 2
    return attached(scene, place, mass=values["mass"], inertia=values["mass"] * arm**2)


def _sensor_places(setup: Setup, values: Values) -> tuple[Place, ...]:
    return (setup.points[setup.sensor],)


def _draw_mass(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"mass": min(strength * log_uniform(rng, 0.015, 0.12), 0.3) * setup.mass, **draw_place(rng, setup)}


def _act_mass(scene: Scene, values: Values) -> Scene:
    """Add a compact body of 5000 kg/m3 that stands on the surface."""
    size = (values["mass"] / 5000.0) ** (1 / 3)
    inertia = values["mass"] * size**2 * (1 / 6 + 1 / 8)
    return attached(scene, place_of(scene.setup, values), mass=values["mass"], inertia=inertia)


def _mass_equals(setup: Setup, values: Values) -> tuple[str, ...]:
    """A mass beside the sensor is a mass of the sensor."""
    away = np.array(place_of(setup, values)) - setup.points[setup.sensor]
    beside = np.linalg.norm(away) < _BESIDE * setup.length
    return ("sensor_mass",) if beside else ()


def _draw_soft(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a smooth, a rectangular or a crack-like loss; what counts is its compliance.

    A solid gets a slot. What it costs is more than the section that is left, so no compliance is told.
    """
    forms = {"beam": ("cosine", "rectangle", "crack"), "plate": ("cosine", "rectangle"), "solid": ("slot",)}[
        setup.kind
    ]
    form = forms[int(rng.integers(len(forms)))]
    extent = {"cosine": (0.03, 0.1), "rectangle": (0.02, 0.1), "crack": (0.004, 0.01), "slot": (0.01, 0.03)}[
        form
    ]
    wider = 2.0 if setup.kind == "plate" else 1.0
    place = draw_place(rng, setup, *((0.05, 0.9) if setup.clamped else (0.12, 0.88)))
    length = float(wider * rng.uniform(*extent) * setup.length)
    relative = 1.0 + wider * strength * log_uniform(rng, 0.02, 0.15) * setup.length / length
    loss = 1.0 - 1.0 / relative ** (2 if form == "cosine" else 1)
    values = {**place, "extent": length, "loss": float(min(loss, 0.97)), "form": form}
    return values if form == "slot" else values | {"compliance": _compliance(values)}


def _compliance(values: Values) -> float:
    """Return the integral of EI0/EI - 1 along x, on plates its mean over the spot's width [m]."""
    extent, loss = values["extent"], values["loss"]
    if values["form"] != "cosine":
        return Stretch(values["x"], extent, bending=1.0 - loss).compliance
    if "y" not in values:
        return Notch(values["x"], extent, loss).compliance
    across = np.cos(np.pi * (np.arange(_STRIPS) + 0.5) / _STRIPS) ** 2
    return float(np.mean([Notch(values["x"], extent, loss * c).compliance for c in across]))


def _draw_patch(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    extent = float(rng.uniform(0.1, 0.35) * setup.length)
    extent = extent if setup.kind == "beam" else min(1.5 * extent, 0.9 * min(setup.size))
    half = extent / 2 / setup.length
    bare = rng.random() < 0.4
    return {
        **draw_place(rng, setup, half, 1 - half),
        "extent": extent,
        "loss_factor": min(strength * log_uniform(rng, 0.03, 0.3), 0.5),
        "mass": 0.0 if bare else float(rng.uniform(0.0, 0.08)),
        "stiffness": 0.0 if bare else float(rng.uniform(0.0, 0.08)),
    }


LOCAL = (
    HiddenEffect(
        "sensor_mass",
        _draw_sensor,
        _act_sensor,
        equals=lambda setup, values: ("lumped_mass",),
        places=_sensor_places,
        solid=True,
    ),
    HiddenEffect("lumped_mass", _draw_mass, _act_mass, equals=_mass_equals, places=at_its_place, solid=True),
    HiddenEffect("local_stiffness", _draw_soft, softened, places=at_its_place, solid=True),
    HiddenEffect("damping_patch", _draw_patch, covered, places=at_its_place, metric="damping"),
)
