"""What may be hidden in a ribbed plate or a bracket of bricks: in its parts, bolts and feet, or fixed to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from modalkit.simulator.bodies.block.block import Block, part_place
from modalkit.simulator.bodies.plate.parts import PlateAttached
from modalkit.simulator.hidden.base import HiddenEffect, Place, Values, either_sign, log_uniform
from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup

KINDS = ("ribbed", "bracket")


def _drawn(setup: Setup) -> Block:
    body = setup.nominal
    assert isinstance(body, Block)
    return body


def _body(scene: Scene) -> Block:
    assert isinstance(scene.body, Block)
    return scene.body


def _one_of(rng: np.random.Generator, names: tuple[str, ...]) -> str:
    return names[int(rng.integers(len(names)))]


def _draw_soft(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    size = min(strength * log_uniform(rng, 0.2, 0.6), 1.5)
    return {"region": _one_of(rng, _drawn(setup).names), "loss": float(-np.expm1(either_sign(rng) * size))}


def _draw_heavy(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    size = min(strength * log_uniform(rng, 0.2, 0.6), 1.2)
    return {"region": _one_of(rng, _drawn(setup).names), "factor": float(np.exp(either_sign(rng) * size))}


def _draw_loose(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    body = _drawn(setup)
    left = max(float(np.exp(-strength * log_uniform(rng, 2.0, 5.0))), 3e-3)
    return {"joint": _one_of(rng, tuple(body.bricks.bolts)), "stiffness": left * body.bolt_stiffness}


def _draw_foot(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    own = setup.mass * (2 * np.pi * setup.nominal_hz[0]) ** 2
    foot = _one_of(rng, tuple(_drawn(setup).bricks.feet))
    return {"support": foot, "stiffness": own * log_uniform(rng, 1.0, 8.0) / strength}


def _draw_mass(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a body at a crossing of the modeller's mesh, off the feet."""
    body = _drawn(setup)
    x, y = (float(rng.choice(line[1:-1])) for line in (body.bricks.mesh.x[2:], body.bricks.mesh.y))
    return {"mass": min(strength * log_uniform(rng, 0.02, 0.1), 0.2) * setup.mass, "x": x, "y": y}


def _act_soft(scene: Scene, values: Values) -> Scene:
    return scene.with_body(stiff=(*_body(scene).stiff, (values["region"], 1 - values["loss"])))


def _act_heavy(scene: Scene, values: Values) -> Scene:
    return scene.with_body(heavy=(*_body(scene).heavy, (values["region"], values["factor"])))


def _act_loose(scene: Scene, values: Values) -> Scene:
    left = values["stiffness"] / _drawn(scene.setup).bolt_stiffness
    return scene.with_body(loose=(*_body(scene).loose, (values["joint"], left)))


def _act_foot(scene: Scene, values: Values) -> Scene:
    return scene.with_body(feet=(*_body(scene).feet, (values["support"], values["stiffness"])))


def _act_mass(scene: Scene, values: Values) -> Scene:
    part = PlateAttached(values["x"], values["y"], mass=values["mass"])
    return scene.with_body(attached=(*_body(scene).attached, part))


def _at(label: str) -> Callable[[Setup, Values], tuple[Place, ...]]:
    """Return what says where a part, a bolt or a foot is."""
    return lambda setup, values: (part_place(_drawn(setup), values[label]),)


OF_BLOCKS = tuple(
    replace(effect, kinds=KINDS)
    for effect in (
        HiddenEffect("local_stiffness", _draw_soft, _act_soft, places=_at("region")),
        HiddenEffect("local_mass", _draw_heavy, _act_heavy, places=_at("region")),
        HiddenEffect(
            "joint",
            _draw_loose,
            _act_loose,
            places=_at("joint"),
            applies=lambda setup: setup.kind == "bracket",
        ),
        HiddenEffect("clamp_translation", _draw_foot, _act_foot, places=_at("support")),
        HiddenEffect(
            "lumped_mass", _draw_mass, _act_mass, places=lambda setup, values: ((values["x"], values["y"]),)
        ),
    )
)
"""In the order in which two at once act."""
