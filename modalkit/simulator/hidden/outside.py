"""What no library described when the rig was made: joints that open and close, and what else a test gets wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.parts import Attached, Stretch
from modalkit.simulator.hidden.base import (
    HiddenEffect,
    Values,
    at_its_place,
    draw_place,
    either_sign,
    is_beam,
    log_uniform,
    with_level,
)
from modalkit.simulator.hidden.build import BUILD
from modalkit.simulator.hidden.chain import point_places
from modalkit.simulator.hidden.known import KNOWN_SINCE
from modalkit.simulator.hidden.local import sensor_places
from modalkit.simulator.hidden.springs import SPRINGS, at_x, cantilever, unit
from modalkit.simulator.hidden.supports import can_show_levels
from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup, hit_points

_CRACK = 0.004


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
        "stiffness": strength * log_uniform(rng, 5, 60) * unit(setup),
        "force": float(setup.peak * rng.uniform(0.3, 0.8)),
    }


def _act_loose(scene: Scene, values: Values) -> Scene:
    """Let the beam rattle against a stop on both sides, once it is hit hard enough."""

    def change(body: Beam, level: float) -> Beam:
        stiffness = values["stiffness"] * gap_share(level / values["force"])
        return replace(body, attached=(*body.attached, Attached(values["x"], stiffness=stiffness)))

    return with_level(scene, change)


def _draw_drift(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"rate": float(either_sign(rng) * min(strength * log_uniform(rng, 0.004, 0.03), 0.08))}


def _from_point_to_point(setup: Setup, values: Values) -> Values:
    """Return the rate from the first point to the last, each by the mean of its hits, for one from hit to hit."""
    points, hits = len(hit_points(setup)), setup.hits
    return {"rate": values["rate"] * (points - 1) * hits / (points * hits - 1)}


def _draw_tilt(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"angle": float(min(strength * rng.uniform(0.25, 0.5), 0.8))}


def _draw_channel_gain(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw the point whose level is off, as by a loose plug or a worn tip."""
    size = min(strength * log_uniform(rng, 0.05, 0.4), 0.6)
    point = int(rng.choice(hit_points(setup)))
    return {"points": [point + 1], "gain": float(np.exp(either_sign(rng) * size))}


def _act_channel_gain(scene: Scene, values: Values) -> Scene:
    gains = {node - 1: values["gain"] for node in values["points"]}
    return scene.with_chain(gains={**scene.chain.gains, **gains})


def _draw_cross_axis(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw the arm at which a sensor sees the slope: sensitive across, high above the surface, tilting in gravity."""
    arm = min(strength * log_uniform(rng, 0.01, 0.05), 0.15) * setup.length
    way = rng.standard_normal(len(setup.size))
    names = ("arm", "arm_y")
    return {n: float(a) for n, a in zip(names, arm * way / np.linalg.norm(way), strict=False)}


def _act_cross_axis(scene: Scene, values: Values) -> Scene:
    return scene.with_chain(arms=tuple(values[name] for name in ("arm", "arm_y") if name in values))


OUTSIDE = tuple(
    replace(hidden_effect, outside=True, known_as=KNOWN_SINCE.get(hidden_effect.name))
    for hidden_effect in (
        *SPRINGS,
        *BUILD,
        HiddenEffect(
            "breathing_crack",
            _draw_breathing,
            _act_breathing,
            applies=is_beam,
            places=at_its_place,
            share=0.67,
        ),
        HiddenEffect(
            "loose_end",
            _draw_loose,
            _act_loose,
            applies=lambda setup: cantilever(setup) and can_show_levels(setup),
            places=at_x,
            share=0.31,
        ),
        HiddenEffect(
            "drift",
            _draw_drift,
            lambda scene, values: scene.with_chain(drift=values["rate"]),
            metric="",
            stated=_from_point_to_point,
            solid=True,
        ),
        HiddenEffect(
            "oblique_hits",
            _draw_tilt,
            lambda scene, values: scene.with_chain(tilt=values["angle"]),
            metric="",
            solid=True,
        ),
        HiddenEffect(
            "channel_gain", _draw_channel_gain, _act_channel_gain, places=point_places, metric="", solid=True
        ),
        HiddenEffect(
            "cross_axis", _draw_cross_axis, _act_cross_axis, places=sensor_places, metric="", solid=True
        ),
    )
)
