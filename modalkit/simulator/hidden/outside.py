"""What no effect of the library describes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.parts import Attached, Stretch
from modalkit.simulator.bodies.plate.parts import flat_rib
from modalkit.simulator.fixing import appended, attached, hung
from modalkit.simulator.hidden.base import (
    HiddenEffect,
    Place,
    Values,
    at_its_place,
    draw_place,
    either_sign,
    is_beam,
    is_plate,
    log_uniform,
    place_of,
    with_level,
)
from modalkit.simulator.hidden.supports import can_show_levels
from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup

_CRACK = 0.004


def _unit(setup: Setup) -> float:
    """Return E I / L^3, the natural unit of springs [N/m]."""
    return setup.rigidity / setup.length**3


def _draw_ground_spring(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {
        **draw_place(rng, setup, 0.3, 0.85),
        "stiffness": strength * log_uniform(rng, 8, 80) * _unit(setup),
    }


def _act_ground_spring(scene: Scene, values: Values) -> Scene:
    return attached(scene, place_of(scene.setup, values), stiffness=values["stiffness"])


def _draw_tip_spring(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"x": setup.length, "stiffness": strength * log_uniform(rng, 1.5, 20) * _unit(setup)}


def _draw_dashpot(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    rate = strength * log_uniform(rng, 2.0, 10.0) * float(setup.decays[0])
    return {**draw_place(rng, setup, 0.3, 0.95), "damping": rate * setup.mass}


def _act_dashpot(scene: Scene, values: Values) -> Scene:
    return attached(scene, place_of(scene.setup, values), damping=values["damping"])


def _draw_taper(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"taper": either_sign(rng) * min(strength * rng.uniform(0.05, 0.25), 0.6)}


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


def _draw_cable(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a cable: part of it moves along, part hangs and sways, and it pulls back a little."""
    mass = min(strength * log_uniform(rng, 0.01, 0.06), 0.2) * setup.mass
    return {
        **draw_place(rng, setup, 0.3, 1.0),
        "mass": mass,
        "sway": float(rng.uniform(0.4, 1.6) * setup.nominal_hz[0]),
        "ratio": float(rng.uniform(0.1, 0.4)),
        "stiffness": strength * float(rng.uniform(0.1, 1.0)) * _unit(setup),
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
        "ratio": float(rng.uniform(0.005, 0.05)),
    }


def _act_absorber(scene: Scene, values: Values) -> Scene:
    place = place_of(scene.setup, values)
    return hung(scene, place, mass=values["mass"], hertz=values["frequency"], ratio=values["ratio"])


def _draw_breathing(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {
        **draw_place(rng, setup, 0.05, 0.6 if setup.clamped else 0.8),
        "compliance": strength * log_uniform(rng, 0.03, 0.15) * setup.length,
        "force": float(setup.peak * rng.uniform(0.5, 2.0)),
        "loss_factor": float(rng.uniform(0.0, 0.05)),
    }


def _act_breathing(scene: Scene, values: Values) -> Scene:
    """Open a crack the further, the harder the hit; its faces rub."""
    extent = _CRACK * scene.setup.length

    def change(body: Beam, level: float) -> Beam:
        open_ = values["compliance"] * level / (level + values["force"])
        part = Stretch(values["x"], extent, bending=1 / (1 + open_ / extent), loss=values["loss_factor"])
        return replace(body, stretches=(*body.stretches, part))

    return with_level(scene, change)


def gap_share(amplitude: float) -> float:
    """Return the share of a spring behind a gap that acts at an amplitude, by its describing function.

    Parameters
    ----------
    amplitude : float
        Over the width of the gap [-].

    Returns
    -------
    float
        1 - 2/pi (asin(1/a) + sqrt(1 - 1/a^2) / a) for a > 1, else 0 (Gelb and Vander Velde, Multiple-Input
        Describing Functions, 1968, appendix B) [-].
    """
    if amplitude <= 1.0:
        return 0.0
    inverse = 1.0 / amplitude
    return float(1 - 2 / np.pi * (np.arcsin(inverse) + inverse * np.sqrt(1 - inverse**2)))


def _draw_loose(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {
        "x": float(rng.uniform(0.6, 1.0) * setup.length),
        "stiffness": strength * log_uniform(rng, 5, 60) * _unit(setup),
        "force": float(setup.peak * rng.uniform(0.3, 0.8)),
    }


def _act_loose(scene: Scene, values: Values) -> Scene:
    """Let the beam rattle against a stop on both sides, once it is hit hard enough."""

    def change(body: Beam, level: float) -> Beam:
        stiffness = values["stiffness"] * gap_share(level / values["force"])
        return replace(body, attached=(*body.attached, Attached(values["x"], stiffness=stiffness)))

    return with_level(scene, change)


def _draw_skew(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw how far the clamped edge is off the square [rad]."""
    return {"angle": float(either_sign(rng) * np.deg2rad(min(strength * rng.uniform(2.0, 6.0), 12.0)))}


def _draw_drift(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"change": float(either_sign(rng) * min(strength * log_uniform(rng, 0.004, 0.03), 0.08))}


def _draw_tilt(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"angle": float(min(strength * rng.uniform(0.25, 0.5), 0.8))}


def _cantilever(setup: Setup) -> bool:
    return is_beam(setup) and setup.clamped == ("x0",)


def _at_x(setup: Setup, values: Values) -> tuple[Place, ...]:
    return ((values["x"],),)


OUTSIDE = tuple(
    replace(hidden_effect, in_library=False)
    for hidden_effect in (
        HiddenEffect(
            "ground_spring", _draw_ground_spring, _act_ground_spring, places=at_its_place, solid=True
        ),
        HiddenEffect(
            "tip_spring",
            _draw_tip_spring,
            _act_ground_spring,
            applies=_cantilever,
            places=_at_x,
            share=0.62,
        ),
        HiddenEffect(
            "dashpot", _draw_dashpot, _act_dashpot, places=at_its_place, metric="damping", solid=True
        ),
        HiddenEffect("taper", _draw_taper, lambda scene, values: scene.with_body(taper=values["taper"])),
        HiddenEffect("rib", _draw_rib, _act_rib, places=at_its_place),
        HiddenEffect("step", _draw_step, _act_step, applies=is_beam, places=_at_x),
        HiddenEffect("cable", _draw_cable, _act_cable, places=at_its_place),
        HiddenEffect("tuned_absorber", _draw_absorber, _act_absorber, places=at_its_place),
        HiddenEffect(
            "breathing_crack", _draw_breathing, _act_breathing, applies=is_beam, places=at_its_place
        ),
        HiddenEffect(
            "loose_end",
            _draw_loose,
            _act_loose,
            applies=lambda setup: _cantilever(setup) and can_show_levels(setup),
            places=_at_x,
            share=0.31,
        ),
        HiddenEffect(
            "skew_clamp",
            _draw_skew,
            lambda scene, values: scene.with_body(skew=values["angle"]),
            applies=lambda setup: is_plate(setup) and "x0" in setup.clamped,
            places=lambda setup, values: ((0.0, setup.width / 2),),
            share=0.4,
        ),
        HiddenEffect(
            "drift", _draw_drift, lambda scene, values: scene.with_chain(drift=values["change"]), solid=True
        ),
        HiddenEffect(
            "oblique_hits",
            _draw_tilt,
            lambda scene, values: scene.with_chain(tilt=values["angle"]),
            metric="",
            solid=True,
        ),
    )
)
