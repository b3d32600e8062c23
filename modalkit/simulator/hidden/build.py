"""What the structure itself is, and no study states: taper, rib, gradient, arch, stress locked in, air behind it."""

from __future__ import annotations

import numpy as np

from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.parts import Stretch
from modalkit.simulator.bodies.plate.parts import Cavity, flat_rib
from modalkit.simulator.fixing import appended
from modalkit.simulator.hidden.base import (
    HiddenEffect,
    Values,
    at_its_place,
    draw_place,
    either_sign,
    is_beam,
    is_plate,
    log_uniform,
)
from modalkit.simulator.hidden.springs import at_x
from modalkit.simulator.hidden.supports import buckling, clamped_at_both_ends
from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup

_PISTON = 0.2
"""Squared volume that a first mode displaces, over area^2 / mass: of a cantilever 0.15 to 0.4 [-]."""


def _draw_taper(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"slope": either_sign(rng) * min(strength * rng.uniform(0.05, 0.25), 0.6)}


def _draw_gradient(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"slope": either_sign(rng) * min(strength * rng.uniform(0.1, 0.5), 1.2)}


def _draw_rib(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    extent = float(rng.uniform(0.08, 0.25) * setup.length)
    half = extent / 2 / setup.length
    height = min(strength * rng.uniform(0.1, 0.5), 1.5)
    return {**draw_place(rng, setup, half, 1 - half), "extent": extent, "height": float(height)}


def _act_rib(scene: Scene, values: Values) -> Scene:
    """Thicken a stretch of a beam on one side; weld a bar across a plate."""
    thicker, setup = 1.0 + values["height"], scene.setup
    if setup.kind == "beam":
        part = Stretch(values["x"], values["extent"], bending=thicker**3, line=thicker)
        return appended(scene, "stretches", part)
    half = min(values["extent"], 1.9 * min(values["y"], setup.width - values["y"])) / 2
    bar = flat_rib(
        (values["x"], values["y"] - half),
        (values["x"], values["y"] + half),
        width=3 * setup.thickness,
        height=4 * values["height"] * setup.thickness,
        thickness=setup.thickness,
        E=setup.E,
        density=setup.density,
        poisson=setup.poisson,
    )
    return appended(scene, "ribs", bar)


def _draw_step(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    change = either_sign(rng) * min(strength * log_uniform(rng, 0.03, 0.15), 0.3)
    return {"x": float(rng.uniform(0.3, 0.7) * setup.length), "factor": float(np.exp(change))}


def _act_step(scene: Scene, values: Values) -> Scene:
    """Let the section change from a place to the end."""
    body, thicker = scene.body, values["factor"]
    assert isinstance(body, Beam)
    middle, extent = 0.5 * (values["x"] + body.end), body.end - values["x"]
    return appended(scene, "stretches", Stretch(middle, extent, bending=thicker**3, line=thicker))


def _draw_rise(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"rise": float(np.sqrt(strength)) * log_uniform(rng, 0.15, 1.0) * setup.thickness}


def _draw_thermal(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a load that is not the same everywhere: along a beam that sticks in between, across a plate.

    On plates the middle of the width is pushed or pulled more than the edges, which are cooler or warmer
    (Timoshenko and Goodier, Theory of Elasticity, 3rd ed., section 150).
    """
    size = either_sign(rng) * min(strength * log_uniform(rng, 0.08, 0.4), 0.6)
    name = "bow" if setup.kind == "plate" else "lean"
    return {"force": float(size * buckling(setup)), name: float(either_sign(rng) * rng.uniform(0.5, 0.9))}


def _draw_cavity(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw air behind the plate that stiffens its first mode, and a neck that resonates among the first three."""
    first = 2 * np.pi * setup.nominal_hz[0]
    own = 2 * np.pi * float(rng.uniform(0.75, 1.3)) * setup.nominal_hz[int(rng.integers(3))]
    area = setup.length * setup.width
    share = min(strength * log_uniform(rng, 0.02, 0.15), 0.4)
    stiffness = share * first**2 * setup.mass / (_PISTON * area**2)
    inertance = stiffness / own**2
    return {
        "stiffness": stiffness,
        "inertance": inertance,
        "resistance": 2 * float(rng.uniform(0.01, 0.05)) * own * inertance,
    }


def _draw_skew(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw how far the clamped edge is off the square [rad]."""
    return {"angle": float(either_sign(rng) * np.deg2rad(min(strength * rng.uniform(2.0, 6.0), 12.0)))}


BUILD = (
    HiddenEffect("taper", _draw_taper, lambda scene, values: scene.with_body(taper=values["slope"])),
    HiddenEffect(
        "density_gradient",
        _draw_gradient,
        lambda scene, values: scene.with_body(density_slope=values["slope"]),
    ),
    HiddenEffect("rib", _draw_rib, _act_rib, places=at_its_place),
    HiddenEffect("step", _draw_step, _act_step, applies=is_beam, places=at_x, share=0.67),
    HiddenEffect(
        "initial_curvature",
        _draw_rise,
        lambda scene, values: scene.with_body(rise=values["rise"]),
        applies=clamped_at_both_ends,
        share=0.15,
    ),
    HiddenEffect(
        "thermal_prestress",
        _draw_thermal,
        lambda scene, values: scene.with_body(
            axial=values["force"],
            **{f"axial_{name}": values[name] for name in ("lean", "bow") if name in values},
        ),
        applies=clamped_at_both_ends,
        share=0.15,
    ),
    HiddenEffect(
        "cavity",
        _draw_cavity,
        lambda scene, values: scene.with_body(cavity=Cavity(**values)),
        applies=is_plate,
        share=0.33,
    ),
    HiddenEffect(
        "skew_clamp",
        _draw_skew,
        lambda scene, values: scene.with_body(skew=values["angle"]),
        applies=lambda setup: is_plate(setup) and "x0" in setup.clamped,
        places=lambda setup, values: ((0.0, setup.width / 2),),
        share=0.27,
    ),
)
