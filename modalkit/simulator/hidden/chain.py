"""What the measurement itself gets wrong."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from modalkit.simulator.hidden.base import HiddenEffect, Place, Values, either_sign, log_uniform, only_level
from modalkit.simulator.scene import Scene
from modalkit.simulator.setup import Setup, hit_points


def _draw_gain(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    size = min(strength * log_uniform(rng, 0.1, 0.5), 0.8)
    return {"gain": float(np.exp(either_sign(rng) * size))}


def _gain_equals(setup: Setup, values: Values) -> tuple[str, ...]:
    return ("section_scale",) if only_level(setup, 1 / values["gain"]) else ()


def _draw_delay(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a delay that turns the highest mode by a tenth of a radian to a whole turn."""
    turn = min(strength * log_uniform(rng, 0.15, 3.0), 6.0)
    return {"delay": float(either_sign(rng) * turn / (2 * np.pi * setup.nominal_hz[setup.modes - 1]))}


def _draw_reversed(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    among = hit_points(setup)
    count = 1 if rng.random() < 0.7 or len(among) < 5 else 2
    return {"points": sorted(int(i) + 1 for i in rng.choice(among, count, replace=False))}


def _draw_exchanged(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    return {"points": sorted(int(i) + 1 for i in rng.choice(hit_points(setup), 2, replace=False))}


def _draw_moved(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a point and how far off it really lies; the place stays on the structure."""
    among, size = hit_points(setup), np.array(setup.size)
    while True:
        point = int(rng.choice(among))
        way = rng.standard_normal(len(size))
        far = min(strength * rng.uniform(0.03, 0.1), 0.14) * setup.length
        away = way / np.linalg.norm(way) * far
        place = np.array(setup.points[point]) + away
        if np.all((place > 0) & (place < size)):
            return {"point": point + 1, **dict(zip(("dx", "dy"), map(float, away), strict=False))}


def _act_moved(scene: Scene, values: Values) -> Scene:
    away = tuple(values[name] for name in ("dx", "dy")[: len(scene.setup.size)])
    return scene.with_chain(moved={**scene.chain.moved, values["point"] - 1: away})


def _moved_places(setup: Setup, values: Values) -> tuple[Place, ...]:
    stated = setup.points[values["point"] - 1]
    return (tuple(x + values[name] for x, name in zip(stated, ("dx", "dy"), strict=False)),)


def point_places(setup: Setup, values: Values) -> tuple[Place, ...]:
    """Return the places of the points that the parameters name."""
    return tuple(setup.points[node - 1] for node in values["points"])


CHAIN = tuple(
    replace(hidden_effect, solid=True)
    for hidden_effect in (
        HiddenEffect(
            "calibration_gain",
            _draw_gain,
            lambda scene, values: scene.with_chain(gain=scene.chain.gain * values["gain"]),
            applies=lambda setup: setup.calibrated or setup.baseline,
            equals=_gain_equals,
            exclusive="level",
            metric="",
            share=0.9,
        ),
        HiddenEffect(
            "time_delay",
            _draw_delay,
            lambda scene, values: scene.with_chain(delay=scene.chain.delay + values["delay"]),
            metric="",
        ),
        HiddenEffect(
            "polarity",
            _draw_reversed,
            lambda scene, values: scene.with_chain(reversed=tuple(n - 1 for n in values["points"])),
            places=point_places,
            graded=False,
            metric="",
        ),
        HiddenEffect(
            "swapped_points",
            _draw_exchanged,
            lambda scene, values: scene.with_chain(exchanged=(tuple(n - 1 for n in values["points"]),)),
            places=point_places,
            graded=False,
            exclusive="labels",
            metric="",
        ),
        HiddenEffect(
            "position_error", _draw_moved, _act_moved, places=_moved_places, exclusive="labels", metric=""
        ),
    )
)
