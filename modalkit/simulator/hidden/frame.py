"""What may be hidden in a frame: in its bars, its joints, its feet, or fixed to it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from modalkit.simulator.bodies.frame.frame import STEEL, Frame
from modalkit.simulator.bodies.plate.parts import PlateAttached
from modalkit.simulator.hidden.base import HiddenEffect, Values, log_uniform
from modalkit.simulator.hidden.parts import (
    act_foot,
    act_heavy,
    act_loose,
    act_soft,
    at,
    at_place,
    draw_heavy,
    draw_soft,
    drawn,
    fixed,
    one_of,
)
from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup

LEAST = 0.15
"""Logarithm of a clear change of one part, at the least [-]."""


def _draw_loose(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    body = drawn(setup)
    left = max(float(np.exp(-strength * log_uniform(rng, 1.5, 4.0))), 3e-3)
    return {"joint": one_of(rng, tuple(body.mesh.joints)), "turning": left * body.joint_stiffness[1]}


def _draw_foot(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    body = drawn(setup)
    own = body.E * body.breadth * body.thickness**3 / 12 / setup.length
    return {
        "support": one_of(rng, tuple(body.held)),
        "stiffness": own * log_uniform(rng, 5.0, 40.0) / strength,
    }


def _draw_place(rng: np.random.Generator, setup: Setup) -> Values:
    """Draw a node of the modeller's mesh, off the feet: what sits between nodes is a combination of places."""
    body = replace(drawn(setup), elements=setup.elements[0])
    x, y = body.mesh.places[_one_of_nodes(rng, body)].tolist()
    return {"x": float(x), "y": float(y)}


def _one_of_nodes(rng: np.random.Generator, body: Frame) -> int:
    away = np.flatnonzero(body.mesh.places[:, 0] > body.start + 0.2 * (body.end - body.start))
    return int(rng.choice(away))


def _draw_mass(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    mass = min(strength * log_uniform(rng, 0.02, 0.15), 0.3) * drawn(setup).mass
    return {"mass": float(mass), **_draw_place(rng, setup)}


def _draw_spring(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    body = drawn(setup)
    own = 3 * body.E * body.breadth * body.thickness**3 / 12 / setup.length**3
    return {"stiffness": own * strength * log_uniform(rng, 0.3, 5.0), **_draw_place(rng, setup)}


def _act_mass(scene: Scene, values: Values) -> Scene:
    mass = values["mass"]
    inertia = mass * (mass / STEEL) ** (2 / 3) / 6
    return fixed(scene, PlateAttached(values["x"], values["y"], mass=mass, inertia=inertia))


def _act_spring(scene: Scene, values: Values) -> Scene:
    return fixed(scene, PlateAttached(values["x"], values["y"], stiffness=values["stiffness"]))


OF_FRAMES = tuple(
    replace(effect, kinds=("frame",))
    for effect in (
        HiddenEffect("local_stiffness", draw_soft(LEAST), act_soft, places=at("region")),
        HiddenEffect("local_mass", draw_heavy(LEAST), act_heavy, places=at("region")),
        HiddenEffect(
            "joint",
            _draw_loose,
            act_loose("turning", lambda body: body.joint_stiffness[1]),
            places=at("joint"),
        ),
        HiddenEffect("clamp_rotation", _draw_foot, act_foot, places=at("support")),
        HiddenEffect("lumped_mass", _draw_mass, _act_mass, places=at_place),
        HiddenEffect("ground_spring", _draw_spring, _act_spring, places=at_place),
    )
)
"""In the order in which two at once act."""

SHARED = ("E", "density", "calibration_gain", "time_delay", "polarity", "swapped_points", "oblique_hits")
"""Effects of the whole and of the measurement that a frame has as others have them."""
