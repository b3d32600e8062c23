"""Clamps that give, and loads along the structure."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from modalkit.simulator.bodies.body import Body
from modalkit.simulator.hidden.base import (
    HiddenEffect,
    Values,
    clamped_places,
    either_sign,
    is_clamped,
    log_uniform,
    with_level,
)
from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup

_PROBE = 300.0
_TENSION = 0.02
_HARDENS = 0.4


def edge_length(setup: Setup) -> float:
    """Return what stiffnesses per metre of edge are taken per: a beam has none, so 1 [m or -]."""
    if setup.kind == "beam":
        return 1.0
    return setup.width if setup.clamped[0][0] == "x" else setup.length


def _span(setup: Setup) -> float:
    """Return the distance that the clamps look across [m]."""
    return setup.width if setup.clamped and setup.clamped[0][0] == "y" else setup.length


def _draw_rotation(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    relative = max(log_uniform(rng, 5.0, 150.0) / strength, 1.5)
    return {"stiffness": relative * _rigidity(setup) / _span(setup) / edge_length(setup)}


def _rigidity(setup: Setup) -> float:
    """Return the bending stiffness of the whole section across the clamps [N m2]."""
    across_y = bool(setup.clamped) and setup.clamped[0][0] == "y"
    return setup.rigidity * (setup.length / setup.width if across_y else 1.0)


def _draw_translation(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    relative = max(log_uniform(rng, 300.0, 2e4) / strength, 60.0)
    return {"stiffness": relative * _rigidity(setup) / _span(setup) ** 3 / edge_length(setup)}


def _draw_slope(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a joint that softens, or between two clamps now and then one that hardens."""
    size = min(strength * log_uniform(rng, 0.008, 0.05), 0.08) / setup.peak
    return {"slope": size if clamped_at_both_ends(setup) and rng.random() < _HARDENS else -size}


def clamped_at_both_ends(setup: Setup) -> bool:
    """Return whether both ends along x are clamped, so that they cannot approach each other."""
    return {"x0", "x1"} <= set(setup.clamped)


def _act_slope(scene: Scene, values: Values) -> Scene:
    """Let the clamp turn the more, the harder the hit; the slope is the mean over the modes of the band.

    At rest the clamp is as it was. Its compliance grows in proportion to the force, and to first order each
    mode falls in proportion to the compliance. Where it hardens, the ends do not approach each other, and bending
    stretches: a tension grows with the force.
    """
    setup, rest = scene.setup, scene.body
    if values["slope"] > 0:
        return _hardening(scene, values["slope"])
    probe = _PROBE * _rigidity(setup) / _span(setup) / edge_length(setup)
    chosen = slice(rest.rigid_modes, rest.rigid_modes + setup.modes)
    held, _ = rest.real_modes(chosen.stop)
    loose, _ = _turning(rest, probe).real_modes(chosen.stop)
    share = float(np.mean(1.0 - loose[chosen] / held[chosen]))

    def change(body: Body, level: float) -> Body:
        return _turning(body, probe * share / (abs(values["slope"]) * level))

    return with_level(scene, change)


def _hardening(scene: Scene, slope: float) -> Scene:
    """Return the scene with a tension that grows with the force, the slope again the mean over the modes."""
    setup, rest = scene.setup, scene.body
    probe = _TENSION * buckling(setup)
    chosen = slice(rest.rigid_modes, rest.rigid_modes + setup.modes)
    slack, _ = rest.real_modes(chosen.stop)
    tight, _ = replace(rest, axial=rest.axial + probe).real_modes(chosen.stop)  # type: ignore
    share = float(np.mean(tight[chosen] / slack[chosen] - 1.0))

    def change(body: Any, level: float) -> Any:
        return replace(body, axial=body.axial + probe * slope * level / share)

    return with_level(scene, change)


def buckling(setup: Setup) -> float:
    """Return the load along x that buckles the structure as drawn [N]."""
    return (4.0 if clamped_at_both_ends(setup) else 0.25) * setup.rigidity * (np.pi / setup.length) ** 2


def _turning(body: Body, stiffness: float) -> Body:
    return replace(body, clamp_rotation=stiffness)  # type: ignore[type-var]


def _stretch(values: Values) -> Values:
    """Return from where to where along the edges of a plate they give way, where the values say so [m]."""
    return {f"clamp_{name}": values[name] for name in ("from", "to") if name in values}


def can_show_levels(setup: Setup) -> bool:
    """Return whether hits of one point span some two to one in force."""
    return setup.level_scatter >= 0.3 and setup.hits >= 4


def _draw_load(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    size = min(strength * log_uniform(rng, 0.08, 0.5), 0.7)
    return {"force": float(either_sign(rng) * size * buckling(setup))}


SUPPORTS = (
    HiddenEffect(
        "clamp_rotation",
        _draw_rotation,
        lambda scene, values: scene.with_body(clamp_rotation=values["stiffness"], **_stretch(values)),
        applies=is_clamped,
        places=clamped_places,
        exclusive="clamp",
        share=0.74,
    ),
    HiddenEffect(
        "clamp_translation",
        _draw_translation,
        lambda scene, values: scene.with_body(clamp_translation=values["stiffness"], **_stretch(values)),
        applies=is_clamped,
        places=clamped_places,
        share=0.74,
    ),
    HiddenEffect(
        "joint_nonlinearity",
        _draw_slope,
        _act_slope,
        applies=lambda setup: is_clamped(setup) and can_show_levels(setup),
        places=clamped_places,
        exclusive="clamp",
        share=0.37,
    ),
    HiddenEffect(
        "axial_load",
        _draw_load,
        lambda scene, values: scene.with_body(axial=values["force"]),
        applies=lambda setup: "x0" in setup.clamped,
        share=0.74,
    ),
)
