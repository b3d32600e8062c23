"""Fluids around the structure, and what damps it all over."""

from __future__ import annotations

import numpy as np

from modalkit.simulator.bodies.body import Loss
from modalkit.simulator.drawing.common import draw_tank
from modalkit.simulator.hidden.base import HiddenEffect, Values, log_uniform
from modalkit.simulator.scene import Scene, nominal_scene
from modalkit.simulator.setup import Setup

WATER = 998.0
_WATERY = 1.0e-3
_FASTEST = 60.0
_LESS = 0.25


def _draw_fluid(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    drawn = log_uniform(rng, 700.0, 1300.0)
    stated = setup.environment
    density = float(drawn if stated is None else stated * (1.0 + 0.005 * rng.standard_normal()))
    tank = draw_tank(rng, min(setup.width, setup.length))
    return {"fluid_density": density} | ({} if stated is not None else tank)


def _act_fluid(scene: Scene, values: Values) -> Scene:
    """Wet the body, in the tank that is stated or drawn; the fluid is about as viscous as water and damps a little."""
    density, setup = values["fluid_density"], scene.setup
    stated = {"free_surface": setup.free_surface, "bottom": setup.bottom}
    tank = {name: values.get(name, place) for name, place in stated.items()}
    return scene.with_body(
        fluid_density=density,
        drag=density * _WATERY,
        **{name: np.inf if place is None else place for name, place in tank.items()},
    )


def _layer(setup: Setup) -> tuple[float, Loss]:
    """Return frequency [rad/s] and losses by water, of unit viscosity, in the second mode of the drawing."""
    density = setup.environment or WATER
    body = nominal_scene(setup).with_body(drag=density).body
    number = body.rigid_modes + 1
    omega, shapes = body.real_modes(number + 1)
    (loss,) = body.modal_losses(shapes[:, number:])
    return float(omega[number]), loss


def _draw_viscosity(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a viscosity that damps the second mode so many times more than expected."""
    omega, loss = _layer(setup)
    unit = 0.5 * float(loss.matrix[0, 0]) * omega**loss.power
    wanted = strength * log_uniform(rng, 0.6, 4.0) * float(setup.decays[1])
    return {"viscosity": float(np.clip((wanted / unit) ** 2, 2e-4, 0.8))}


def _act_viscosity(scene: Scene, values: Values) -> Scene:
    """Let the boundary layer damp; what else the fluid moves is in the model already, or comes with it."""
    own = getattr(scene.body, "fluid_density", 0.0)
    density = own or scene.setup.environment or WATER
    return scene.with_body(drag=density * values["viscosity"])


def _draw_uniform(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw one of three laws, each as much as the expected damping of the second mode times a factor; or less.

    Less is a share of what is expected that is not there, of both its laws alike.
    """
    values = {"alpha": 0.0, "beta": 0.0, "loss_factor": 0.0}
    if rng.random() < _LESS:
        lack = float(min(strength * rng.uniform(0.4, 0.8), 0.9))
        return values | {"alpha": -lack * setup.alpha, "beta": -lack * setup.beta}
    rate = strength * log_uniform(rng, 0.7, 4.0) * float(setup.decays[1])
    omega = 2 * np.pi * setup.nominal_hz[1]
    law = ("alpha", "beta", "loss_factor")[int(rng.integers(3))]
    size = {"alpha": 2 * min(rate, _FASTEST), "beta": 2 * rate / omega**2, "loss_factor": 2 * rate / omega}
    return values | {law: float(size[law])}


def _act_uniform(scene: Scene, values: Values) -> Scene:
    """Add damping; what is negative is taken from what each mode has, and never more than that."""
    changes = {"added_loss": values.get("loss_factor", 0.0)}
    for name in ("alpha", "beta"):
        value, own = values.get(name, 0.0), getattr(scene.body, name)
        changes[name if value < 0 else f"added_{name}"] = max(own + value, 0.0) if value < 0 else value
    return scene.with_body(**changes)


def _uniform_equals(setup: Setup, values: Values) -> tuple[str, ...]:
    alone = values["alpha"] > 0 and not values["beta"] and not values["loss_factor"]
    return ("exponential_window",) if alone else ()


def _draw_window(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    rate = strength * log_uniform(rng, 0.7, 4.0) * float(setup.decays[1])
    return {"decay": float(min(rate, _FASTEST))}


LOSSES = (
    HiddenEffect("fluid_added_mass", _draw_fluid, _act_fluid, graded=False, exclusive="fluid"),
    HiddenEffect("fluid_damping", _draw_viscosity, _act_viscosity, metric="damping", exclusive="viscosity"),
    HiddenEffect(
        "uniform_damping",
        _draw_uniform,
        _act_uniform,
        equals=_uniform_equals,
        metric="damping",
        solid=True,
        exclusive="decay",
    ),
    HiddenEffect(
        "exponential_window",
        _draw_window,
        lambda scene, values: scene.with_chain(window=scene.chain.window + values["decay"]),
        equals=lambda setup, values: ("uniform_damping",),
        metric="damping",
        solid=True,
        exclusive="decay",
    ),
)
