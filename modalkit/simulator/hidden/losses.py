"""Fluids around the structure, and what damps it all over."""

from __future__ import annotations

import numpy as np

from modalkit.simulator.bodies.body import Loss
from modalkit.simulator.hidden.base import HiddenEffect, Values, log_uniform
from modalkit.simulator.scene import Scene, nominal_scene
from modalkit.simulator.setup import Setup

WATER = 998.0
_WATERY = 1.0e-3
_FASTEST = 60.0


def _draw_fluid(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    drawn = log_uniform(rng, 700.0, 1300.0)
    stated = setup.environment
    return {
        "fluid_density": float(drawn if stated is None else stated * (1.0 + 0.005 * rng.standard_normal()))
    }


def _act_fluid(scene: Scene, values: Values) -> Scene:
    """Wet the body; the fluid is about as viscous as water and damps a little."""
    density = values["fluid_density"]
    return scene.with_body(fluid_density=density, drag=density * _WATERY)


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
    """Draw one of three laws, each as much as the expected damping of the second mode times a factor."""
    values = {"alpha": 0.0, "beta": 0.0, "loss_factor": 0.0}
    rate = strength * log_uniform(rng, 0.7, 4.0) * float(setup.decays[1])
    omega = 2 * np.pi * setup.nominal_hz[1]
    law = ("alpha", "beta", "loss_factor")[int(rng.integers(3))]
    size = {"alpha": 2 * min(rate, _FASTEST), "beta": 2 * rate / omega**2, "loss_factor": 2 * rate / omega}
    return values | {law: float(size[law])}


def _act_uniform(scene: Scene, values: Values) -> Scene:
    return scene.with_body(
        added_alpha=values.get("alpha", 0.0),
        added_beta=values.get("beta", 0.0),
        added_loss=values.get("loss_factor", 0.0),
    )


def _uniform_equals(setup: Setup, values: Values) -> tuple[str, ...]:
    return ("exponential_window",) if not values["beta"] and not values["loss_factor"] else ()


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
