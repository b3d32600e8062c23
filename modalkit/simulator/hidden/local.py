"""What sits at one place: masses, local losses of stiffness, layers."""

from __future__ import annotations

import numpy as np

from modalkit.simulator.bodies.parts import Notch, Stretch
from modalkit.simulator.fixing import attached, covered, loaded, softened
from modalkit.simulator.hidden.base import (
    HiddenEffect,
    Place,
    Values,
    at_its_place,
    draw_extents,
    draw_place,
    draw_within,
    log_uniform,
    place_of,
)
from modalkit.simulator.scene import Scene, sensor_place
from modalkit.simulator.setup import Setup

_BESIDE = 0.01
_STRIPS = 64
_AT_EDGE = 0.25
_STIFFER = 0.3
_LEAST = 0.1
"""What a stiffer place keeps of its compliance at least: ten times as stiff, a loss of -9 [-]."""

_FORMS = {"beam": ("cosine", "rectangle", "crack"), "plate": ("cosine", "rectangle"), "solid": ("slot",)}
_EXTENTS = {"cosine": (0.03, 0.33), "rectangle": (0.02, 0.33)}
_NARROW = {"crack": (0.004, 0.01), "slot": (0.01, 0.03)}
_LAYERS = {"beam": (0.1, 0.45), "plate": (0.2, 0.6)}
_SHEETS = {"beam": (0.08, 0.33), "plate": (0.15, 0.33)}
_LOADS = ("sheet", "ice")
_LIGHTER = 0.15
_HOLLOW, _HEAVY = 0.3, 3.8
"""Least and most that a place weighs over what it was drawn as [-]."""

_LAWS = (0.6, 0.2, 0.2)
"""Shares of layers that lose by a loss factor, in proportion to mass, and to stiffness [-]."""


def _draw_sensor(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"mass": min(strength * log_uniform(rng, 0.01, 0.08), 0.2) * setup.mass}


def _act_sensor(scene: Scene, values: Values) -> Scene:
    """Add mass where the sensor sits, its centre as high above the surface as that of the known one."""
    place = tuple(float(x) for x in sensor_place(scene.setup, scene.marks))
    arm = 0.004 + scene.setup.thickness / 2
    return attached(scene, place, mass=values["mass"], inertia=values["mass"] * arm**2)


def sensor_places(setup: Setup, values: Values) -> tuple[Place, ...]:
    """Return the sensor's place."""
    return (setup.points[setup.sensor],)


def _draw_mass(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a mass anywhere, or now and then on a free end or edge."""
    mass = min(strength * log_uniform(rng, 0.015, 0.12), 0.3) * setup.mass
    place = draw_place(rng, setup)
    free = [edge for edge in ("x0", "x1", "y0", "y1")[: 2 * len(setup.size)] if edge not in setup.clamped]
    if free and rng.random() < _AT_EDGE:
        edge = free[int(rng.integers(len(free)))]
        place[edge[0]] = float(edge[1]) * setup.size["xy".index(edge[0])]
    return {"mass": mass, **place}


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
    """Draw a smooth, a rectangular or a crack-like loss, or a gain as of a rib or a repair; what counts is its
    compliance.

    A solid gets a slot. What it costs is more than the section that is left, so no compliance is stated.
    """
    form = _FORMS[setup.kind][int(rng.integers(len(_FORMS[setup.kind])))]
    stiffer = form in _EXTENTS and rng.random() < _STIFFER
    low, high = _EXTENTS.get(form, _NARROW.get(form, (0.0, 0.0)))
    extents = draw_extents(rng, setup, 2 * low if stiffer or setup.kind == "plate" else low, high)
    length = extents["extent"]
    place = draw_within(
        rng, setup, tuple(extents.values()), *((0.05, 0.9) if setup.clamped else (0.12, 0.88))
    )
    wider = 2.0 if setup.kind == "plate" else 1.0
    lost = wider * strength * log_uniform(rng, 0.02, 0.15) * setup.length / length
    power = 2 if form == "cosine" else 1
    relative = max(1.0 - lost, _LEAST ** (1 / power)) if stiffer else 1.0 + lost
    loss = float(min(1.0 - 1.0 / relative**power, 0.97))
    values = {**place, **extents, "loss": loss, "form": form}
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
    """Draw a layer, bare or not, that loses by one of three laws, alike in the second mode."""
    extents = draw_extents(rng, setup, *_LAYERS[setup.kind])
    bare = rng.random() < 0.4
    loss = min(strength * log_uniform(rng, 0.03, 0.3), 0.5)
    omega = 2 * np.pi * setup.nominal_hz[1]
    law = ("loss_factor", "alpha", "beta")[int(rng.choice(3, p=_LAWS))]
    size = {"loss_factor": loss, "alpha": loss * omega, "beta": loss / omega}
    return {
        **draw_within(rng, setup, tuple(extents.values())),
        **extents,
        **{name: float(value) if name == law else 0.0 for name, value in size.items()},
        "mass": 0.0 if bare else float(rng.uniform(0.0, 0.08)),
        "stiffness": 0.0 if bare else float(rng.uniform(0.0, 0.08)),
    }


def _draw_load(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a sheet with sharp edges, ice that runs out to them, or a place that lacks mass; what counts is the mass."""
    extents = draw_extents(rng, setup, *_SHEETS[setup.kind])
    share = float(
        np.prod([extent / size for extent, size in zip(extents.values(), setup.size, strict=False)])
    )
    change = strength * log_uniform(rng, 0.015, 0.12) / share
    lighter = rng.random() < _LIGHTER
    factor = max(1.0 - change, _HOLLOW) if lighter else min(1.0 + change, _HEAVY)
    return {
        **draw_within(rng, setup, tuple(extents.values())),
        **extents,
        "factor": float(factor),
        "mass": float((factor - 1.0) * share * setup.mass),
        "form": "sheet" if lighter else _LOADS[int(rng.integers(len(_LOADS)))],
    }


LOCAL = (
    HiddenEffect(
        "sensor_mass",
        _draw_sensor,
        _act_sensor,
        equals=lambda setup, values: ("lumped_mass",),
        places=sensor_places,
        solid=True,
    ),
    HiddenEffect("lumped_mass", _draw_mass, _act_mass, equals=_mass_equals, places=at_its_place, solid=True),
    HiddenEffect("local_stiffness", _draw_soft, softened, places=at_its_place, solid=True),
    HiddenEffect(
        "local_mass",
        _draw_load,
        loaded,
        applies=lambda setup: setup.kind in _SHEETS,
        places=at_its_place,
    ),
    HiddenEffect("damping_patch", _draw_patch, covered, places=at_its_place, metric="damping"),
)
