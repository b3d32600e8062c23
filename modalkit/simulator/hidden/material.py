"""What the modeller believes of material and section, and what is so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from modalkit.simulator.drawing.specimen import lacks_shear
from modalkit.simulator.hidden.base import (
    HiddenEffect,
    Values,
    clamped_places,
    either_sign,
    factor,
    is_clamped,
    is_plate,
    log_uniform,
    nothing,
    only_level,
    scaled,
)
from modalkit.simulator.scene import Scene, lengthened
from modalkit.simulator.setup import Setup


def _draw_extension(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw a beam that bends inside its clamp, or now and then one pushed too deep into it."""
    size = min(strength * rng.uniform(0.02, 0.06), 0.1) * setup.length
    return {"extension": float(size if rng.random() < 0.75 else -0.4 * size)}


def _act_section(scene: Scene, values: Values) -> Scene:
    """Scale stiffness and mass of the body together, and not what is fixed to it."""
    body = scene.body
    return scene.with_body(
        E=body.E * values["factor"],  # type: ignore[attr-defined]
        density=body.density * values["factor"],  # type: ignore[attr-defined]
    )


def _draw_ratio(rng: np.random.Generator, setup: Setup, strength: float) -> Values:
    """Draw two elastic constants, each of its own."""

    def one(low: float, high: float, most: float) -> float:
        return float(np.exp(either_sign(rng) * min(strength * log_uniform(rng, low, high), most)))

    return {"ratio": one(0.06, 0.5, 1.0), "shear_ratio": one(0.02, 0.25, 0.5)}


def _section_equals(setup: Setup, values: Values) -> tuple[str, ...]:
    return ("calibration_gain",) if only_level(setup, values["factor"]) else ()


def _with_level(setup: Setup) -> bool:
    return setup.calibrated or setup.baseline


MATERIAL = (
    HiddenEffect("E", factor(0.07, 0.5, most=0.8), scaled("E"), solid=True),
    HiddenEffect("density", factor(0.07, 0.5, most=0.8), scaled("density"), solid=True),
    HiddenEffect("thickness", factor(0.035, 0.25, most=0.4), scaled("thickness"), solid=True),
    HiddenEffect(
        "section_scale",
        factor(0.1, 0.5, most=0.8),
        _act_section,
        applies=_with_level,
        equals=_section_equals,
        exclusive="level",
        metric="",
        solid=True,
        share=0.9,
    ),
    HiddenEffect(
        "length",
        _draw_extension,
        lambda scene, values: lengthened_scene(scene, values["extension"]),
        applies=is_clamped,
        places=clamped_places,
        solid=True,
        share=0.74,
    ),
    HiddenEffect(
        "orthotropy",
        _draw_ratio,
        lambda scene, values: scene.with_body(
            ratio=values["ratio"], shear_ratio=values.get("shear_ratio", 1.0)
        ),
        applies=is_plate,
        share=0.4,
    ),
    HiddenEffect(
        "shear", nothing, lambda scene, values: scene, applies=lacks_shear, graded=False, share=0.05
    ),
)


def lengthened_scene(scene: Scene, extension: float) -> Scene:
    """Return the scene with a body longer at its clamped ends [m]."""
    return replace(scene, body=lengthened(scene.body, extension))
