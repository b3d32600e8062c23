"""What may be hidden in a body of named parts, of bars or bricks: in parts, joints and feet, or fixed to it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from modalkit.simulator.bodies.block.block import Block
from modalkit.simulator.bodies.frame.frame import Frame
from modalkit.simulator.bodies.plate.parts import PlateAttached
from modalkit.simulator.fixing import appended
from modalkit.simulator.hidden.base import Act, Draw, Place, Values, either_sign, log_uniform
from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup

LARGEST = 0.6
"""Logarithm of a change of one part, clear ones at the most [-]."""


def drawn(setup: Setup) -> Any:
    """Return the body as drawn: a frame, or a block."""
    assert isinstance(setup.nominal, Block | Frame)
    return setup.nominal


def one_of(rng: np.random.Generator, names: tuple[str, ...]) -> str:
    """Draw a name."""
    return names[int(rng.integers(len(names)))]


def draw_soft(least: float) -> Draw:
    """Return what draws a part softer or stiffer by a logarithm of ``least`` and more [-]."""

    def draw(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
        size = min(strength * log_uniform(rng, least, LARGEST), 1.5)
        return {"region": one_of(rng, drawn(setup).names), "loss": float(-np.expm1(either_sign(rng) * size))}

    return draw


def draw_heavy(least: float) -> Draw:
    """Return what draws a part heavier or lighter by a logarithm of ``least`` and more [-]."""

    def draw(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
        size = min(strength * log_uniform(rng, least, LARGEST), 1.2)
        return {"region": one_of(rng, drawn(setup).names), "factor": float(np.exp(either_sign(rng) * size))}

    return draw


def act_soft(scene: Scene, values: Values) -> Scene:
    """Change the stiffness of a part."""
    return appended(scene, "stiff", (values["region"], 1 - values["loss"]))


def act_heavy(scene: Scene, values: Values) -> Scene:
    """Change the mass of a part."""
    return appended(scene, "heavy", (values["region"], values["factor"]))


def act_loose(key: str, firm: Callable[[Any], float]) -> Act:
    """Return what leaves a joint a stiffness, stated by ``key``, of what ``firm`` states it had as drawn."""

    def act(scene: Scene, values: Values) -> Scene:
        return appended(scene, "loose", (values["joint"], values[key] / firm(drawn(scene.setup))))

    return act


def act_foot(scene: Scene, values: Values) -> Scene:
    """Put a foot on a spring."""
    return appended(scene, "feet", (values["support"], values["stiffness"]))


def fixed(scene: Scene, part: PlateAttached) -> Scene:
    """Fix something to the body."""
    return appended(scene, "attached", part)


def at(label: str) -> Callable[[Setup, Values], tuple[Place, ...]]:
    """Return the location of a part, a joint or a foot."""
    return lambda setup, values: (drawn(setup).place_of(values[label]),)


def at_place(setup: Setup, values: Values) -> tuple[Place, ...]:
    """Return where something is fixed."""
    return ((values["x"], values["y"]),)
