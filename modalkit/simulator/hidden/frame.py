"""What may be hidden in a frame: in its bars, its joints, its feet, or fixed to it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from modalkit.simulator.bodies.frame.frame import STEEL, Frame, part_place
from modalkit.simulator.bodies.plate.parts import PlateAttached
from modalkit.simulator.hidden.base import HiddenEffect, Place, Values, either_sign, log_uniform
from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup


def _drawn(setup: Setup) -> Frame:
    body = setup.nominal
    assert isinstance(body, Frame)
    return body


def _one_of(rng: np.random.Generator, names: tuple[str, ...]) -> str:
    return names[int(rng.integers(len(names)))]


def _draw_soft(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    size = min(strength * log_uniform(rng, 0.15, 0.6), 1.5)
    return {"region": _one_of(rng, _drawn(setup).names), "loss": float(-np.expm1(either_sign(rng) * size))}


def _draw_heavy(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    size = min(strength * log_uniform(rng, 0.15, 0.6), 1.2)
    return {"region": _one_of(rng, _drawn(setup).names), "factor": float(np.exp(either_sign(rng) * size))}


def _draw_loose(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    body = _drawn(setup)
    left = max(float(np.exp(-strength * log_uniform(rng, 1.5, 4.0))), 3e-3)
    return {"joint": _one_of(rng, tuple(body.mesh.joints)), "turning": left * body.joint_stiffness[1]}


def _draw_foot(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    body = _drawn(setup)
    own = body.E * body.breadth * body.thickness**3 / 12 / setup.length
    return {
        "support": _one_of(rng, tuple(body.held)),
        "stiffness": own * log_uniform(rng, 5.0, 40.0) / strength,
    }


def _draw_place(rng: np.random.Generator, setup: Setup) -> Values:
    """Draw a node of the modeller's mesh, off the feet: what sits between nodes is a combination of places."""
    body = replace(_drawn(setup), elements=setup.elements[0])
    x, y = body.mesh.places[_one_of_nodes(rng, body)].tolist()
    return {"x": float(x), "y": float(y)}


def _one_of_nodes(rng: np.random.Generator, body: Frame) -> int:
    away = np.flatnonzero(body.mesh.places[:, 0] > body.start + 0.2 * (body.end - body.start))
    return int(rng.choice(away))


def _draw_mass(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    mass = min(strength * log_uniform(rng, 0.02, 0.15), 0.3) * _drawn(setup).mass
    return {"mass": float(mass), **_draw_place(rng, setup)}


def _draw_spring(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    body = _drawn(setup)
    own = 3 * body.E * body.breadth * body.thickness**3 / 12 / setup.length**3
    return {"stiffness": own * strength * log_uniform(rng, 0.3, 5.0), **_draw_place(rng, setup)}


def _body(scene: Scene) -> Frame:
    assert isinstance(scene.body, Frame)
    return scene.body


def _act_soft(scene: Scene, values: Values) -> Scene:
    return scene.with_body(stiff=(*_body(scene).stiff, (values["region"], 1 - values["loss"])))


def _act_heavy(scene: Scene, values: Values) -> Scene:
    return scene.with_body(heavy=(*_body(scene).heavy, (values["region"], values["factor"])))


def _act_loose(scene: Scene, values: Values) -> Scene:
    left = values["turning"] / _drawn(scene.setup).joint_stiffness[1]
    return scene.with_body(loose=(*_body(scene).loose, (values["joint"], left)))


def _act_foot(scene: Scene, values: Values) -> Scene:
    return scene.with_body(feet=(*_body(scene).feet, (values["support"], values["stiffness"])))


def _fixed(scene: Scene, part: PlateAttached) -> Scene:
    return scene.with_body(attached=(*_body(scene).attached, part))


def _act_mass(scene: Scene, values: Values) -> Scene:
    mass = values["mass"]
    inertia = mass * (mass / STEEL) ** (2 / 3) / 6
    return _fixed(scene, PlateAttached(values["x"], values["y"], mass=mass, inertia=inertia))


def _act_spring(scene: Scene, values: Values) -> Scene:
    return _fixed(scene, PlateAttached(values["x"], values["y"], stiffness=values["stiffness"]))


def _at(label: str) -> Callable[[Setup, Values], tuple[Place, ...]]:
    """Return what says where a part, a joint or a foot is."""
    return lambda setup, values: (part_place(_drawn(setup), values[label]),)


def _at_place(setup: Setup, values: Values) -> tuple[Place, ...]:
    return ((values["x"], values["y"]),)


OF_FRAMES = tuple(
    replace(effect, kinds=("frame",))
    for effect in (
        HiddenEffect("local_stiffness", _draw_soft, _act_soft, places=_at("region")),
        HiddenEffect("local_mass", _draw_heavy, _act_heavy, places=_at("region")),
        HiddenEffect("joint", _draw_loose, _act_loose, places=_at("joint")),
        HiddenEffect("clamp_rotation", _draw_foot, _act_foot, places=_at("support")),
        HiddenEffect("lumped_mass", _draw_mass, _act_mass, places=_at_place),
        HiddenEffect("ground_spring", _draw_spring, _act_spring, places=_at_place),
    )
)
"""In the order in which two at once act."""

SHARED = ("E", "density", "calibration_gain", "time_delay", "polarity", "swapped_points", "oblique_hits")
"""Effects of the whole and of the measurement that a frame has as others have them."""
