"""What may be hidden in a ribbed plate or a bracket of bricks: in its parts, bolts and feet, or fixed to it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

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

KINDS = ("ribbed", "bracket")

LEAST = 0.2
"""Logarithm of a clear change of one part, at the least [-]."""


def _draw_loose(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    body = drawn(setup)
    left = max(float(np.exp(-strength * log_uniform(rng, 2.0, 5.0))), 3e-3)
    return {"joint": one_of(rng, tuple(body.bricks.bolts)), "stiffness": left * body.bolt_stiffness}


def _draw_foot(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    own = setup.mass * (2 * np.pi * setup.nominal_hz[0]) ** 2
    foot = one_of(rng, tuple(drawn(setup).bricks.feet))
    return {"support": foot, "stiffness": own * log_uniform(rng, 1.0, 8.0) / strength}


def _draw_mass(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a body at a crossing of the modeller's mesh, off the feet."""
    body = drawn(setup)
    x, y = (float(rng.choice(line[1:-1])) for line in (body.bricks.mesh.x[2:], body.bricks.mesh.y))
    return {"mass": min(strength * log_uniform(rng, 0.02, 0.1), 0.2) * setup.mass, "x": x, "y": y}


def _act_mass(scene: Scene, values: Values) -> Scene:
    return fixed(scene, PlateAttached(values["x"], values["y"], mass=values["mass"]))


OF_BLOCKS = tuple(
    replace(effect, kinds=KINDS)
    for effect in (
        HiddenEffect("local_stiffness", draw_soft(LEAST), act_soft, places=at("region")),
        HiddenEffect("local_mass", draw_heavy(LEAST), act_heavy, places=at("region")),
        HiddenEffect(
            "joint",
            _draw_loose,
            act_loose("stiffness", lambda body: body.bolt_stiffness),
            places=at("joint"),
            applies=lambda setup: setup.kind == "bracket",
        ),
        HiddenEffect("clamp_translation", _draw_foot, act_foot, places=at("support")),
        HiddenEffect("lumped_mass", _draw_mass, _act_mass, places=at_place),
    )
)
"""In the order in which two at once act."""
