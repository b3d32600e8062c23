"""What else holds, damps or hangs on the structure: springs to the ground, cords, cables, parts come loose."""

from __future__ import annotations

import numpy as np

from modalkit.simulator.fixing import attached, hung, sprung
from modalkit.simulator.hidden.base import (
    HiddenEffect,
    Place,
    Values,
    at_its_place,
    draw_place,
    draw_within,
    is_beam,
    log_uniform,
    place_of,
)
from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup

_FIRMEST = 0.6


def unit(setup: Setup) -> float:
    """Return E I / L^3, the natural unit of springs [N/m]."""
    return setup.rigidity / setup.length**3


def _draw_ground_spring(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a spring at a point, or a foundation along up to a third of the length, with its own damping."""
    along = setup.kind != "solid" and rng.random() < 0.5
    extent = log_uniform(rng, 0.05, 0.35) * setup.length if along else 0.0
    stiffness = strength * log_uniform(rng, 8, 80) * unit(setup)
    lag = float(rng.uniform(0.0, 0.1)) / (2 * np.pi * setup.nominal_hz[0])
    return {
        **draw_within(rng, setup, (extent,) * len(setup.size), 0.3, 0.85),
        "extent": extent,
        "stiffness": stiffness,
        "damping": lag * stiffness,
    }


def _act_ground_spring(scene: Scene, values: Values) -> Scene:
    sizes = {name: values.get(name, 0.0) for name in ("extent", "stiffness", "damping")}
    return sprung(scene, place_of(scene.setup, values), **sizes)


def _draw_tip_spring(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"x": setup.length, "stiffness": strength * log_uniform(rng, 1.5, 20) * unit(setup)}


def _draw_dashpot(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    rate = strength * log_uniform(rng, 2.0, 10.0) * float(setup.decays[0])
    return {**draw_place(rng, setup, 0.3, 0.95), "damping": rate * setup.mass}


def _act_dashpot(scene: Scene, values: Values) -> Scene:
    return attached(scene, place_of(scene.setup, values), damping=values["damping"])


def _draw_suspension(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw two to four cords, that let the whole bounce at a share of the first frequency."""
    bounce = min(float(np.sqrt(strength)) * log_uniform(rng, 0.2, 0.5), _FIRMEST)
    cords = int(rng.integers(2, 5))
    omega = 2 * np.pi * setup.nominal_hz[0] * bounce
    stiffness = setup.mass * omega**2 / cords
    return {
        "cords": cords,
        "inset": float(rng.uniform(0.03, 0.3)),
        "stiffness": stiffness,
        "damping": 2 * float(rng.uniform(0.02, 0.15)) * stiffness / omega,
    }


def cord_places(setup: Setup, values: Values) -> tuple[Place, ...]:
    """Return where cords are fixed: evenly along a beam, at an inset from the corners of a plate [m]."""
    count, inset = int(values["cords"]), values["inset"]
    if len(setup.size) == 1:
        return tuple((float(x) * setup.length,) for x in np.linspace(inset, 1 - inset, count))
    corners = ((0, 0), (1, 1), (0, 1), (1, 0))[:count]
    shares = [[inset if side == 0 else 1 - inset for side in corner] for corner in corners]
    return tuple((a * setup.length, b * setup.width) for a, b in shares)


def _act_suspension(scene: Scene, values: Values) -> Scene:
    for place in cord_places(scene.setup, values):
        scene = attached(scene, place, stiffness=values["stiffness"], damping=values["damping"])
    return scene


def _draw_cable(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a cable: part of it moves along, part hangs and sways, and it pulls back a little."""
    mass = min(strength * log_uniform(rng, 0.01, 0.06), 0.2) * setup.mass
    return {
        **draw_place(rng, setup, 0.3, 1.0),
        "mass": mass,
        "sway": float(rng.uniform(0.4, 1.6) * setup.nominal_hz[0]),
        "ratio": float(rng.uniform(0.1, 0.4)),
        "stiffness": strength * float(rng.uniform(0.1, 1.0)) * unit(setup),
    }


def _act_cable(scene: Scene, values: Values) -> Scene:
    place = place_of(scene.setup, values)
    fixed = attached(scene, place, mass=0.4 * values["mass"], stiffness=values["stiffness"])
    return hung(fixed, place, mass=0.6 * values["mass"], hertz=values["sway"], ratio=values["ratio"])


def _draw_absorber(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a part that has come loose, and resonates among the first modes."""
    mode = int(rng.integers(min(3, setup.modes)))
    return {
        **draw_place(rng, setup, 0.3, 0.95),
        "mass": min(strength * log_uniform(rng, 0.01, 0.05), 0.15) * setup.mass,
        "frequency": float(rng.uniform(0.75, 1.3) * setup.nominal_hz[mode]),
        "damping": float(rng.uniform(0.005, 0.05)),
    }


def _act_absorber(scene: Scene, values: Values) -> Scene:
    place = place_of(scene.setup, values)
    return hung(scene, place, mass=values["mass"], hertz=values["frequency"], ratio=values["damping"])


def cantilever(setup: Setup) -> bool:
    """Return whether the specimen is a beam that is held at its start alone."""
    return is_beam(setup) and setup.clamped == ("x0",)


def at_x(setup: Setup, values: Values) -> tuple[Place, ...]:
    """Return the place along a beam that the parameters name."""
    return ((values["x"],),)


SPRINGS = (
    HiddenEffect("ground_spring", _draw_ground_spring, _act_ground_spring, places=at_its_place, solid=True),
    HiddenEffect(
        "tip_spring", _draw_tip_spring, _act_ground_spring, applies=cantilever, places=at_x, share=0.62
    ),
    HiddenEffect("dashpot", _draw_dashpot, _act_dashpot, places=at_its_place, metric="damping", solid=True),
    HiddenEffect(
        "suspension",
        _draw_suspension,
        _act_suspension,
        applies=lambda setup: not setup.clamped,
        places=cord_places,
        share=0.24,
    ),
    HiddenEffect("cable", _draw_cable, _act_cable, places=at_its_place),
    HiddenEffect("absorber", _draw_absorber, _act_absorber, places=at_its_place),
)
