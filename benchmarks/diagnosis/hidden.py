"""What may be hidden: each cause draws a severity, changes the body or the measurement, and knows its equals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from diagnosis.body import Box, Patch
from diagnosis.observe import Faults
from diagnosis.specimen import Specimen, shares

Values = dict[str, Any]


@dataclass(frozen=True, eq=False)
class Scene:
    """A specimen with what is wrong with its measurement."""

    specimen: Specimen
    faults: Faults = field(default_factory=Faults)

    def body(self, **changes: Any) -> Scene:
        """Return the scene with another body."""
        return replace(self, specimen=replace(self.specimen, body=self.specimen.body.but(**changes)))

    def fault(self, **changes: Any) -> Scene:
        """Return the scene with another fault of the measurement."""
        return replace(self, faults=replace(self.faults, **changes))


Draw = Callable[[np.random.Generator, Specimen, float], Values]
Act = Callable[[Scene, Values], Scene]


@dataclass(frozen=True)
class Cause:
    """One kind of hidden cause.

    Parameters
    ----------
    name : str
        In the library of the diagnosis, or one of its own.
    draw : callable
        ``draw(rng, specimen, strength)`` returns the parameters, under the library's names [SI].
    act : callable
        ``act(scene, values)`` returns the changed scene.
    shows : str
        Where it shows: frequency, damping, level, phase, shape or slope.
    kinds : tuple of str
        Kinds of specimen.
    clamped : bool, optional
        Whether it needs a clamp, or none.
    level : bool
        Whether it takes calibrated FRFs to be seen.
    equals : tuple of str
        Names that change the data in exactly the same way.
    inside : bool
        Whether the library ought to have it.
    """

    name: str
    draw: Draw
    act: Act
    shows: str = "frequency"
    kinds: tuple[str, ...] = ("beam", "plate")
    clamped: bool | None = None
    level: bool = False
    equals: tuple[str, ...] = ()
    inside: bool = True


FASTEST = 60.0
"""No window decays faster [1/s]."""


def _signed(rng: np.random.Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _log(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _factor(low: float, high: float) -> Draw:
    return lambda rng, s, k: {"factor": float(np.exp(_signed(rng) * k * rng.uniform(low, high)))}


def _scaled(name: str) -> Act:
    return lambda scene, v: scene.body(**{name: getattr(scene.specimen.body, name) * v["factor"]})


def _section(scene: Scene, v: Values) -> Scene:
    body = scene.specimen.body
    masses = tuple((x, y, m, i) for x, y, m, i in body.masses)
    return scene.body(E=body.E * v["factor"], density=body.density * v["factor"], masses=masses)


def _rigidity(s: Specimen) -> float:
    spec = s.spec
    per = spec.material.E * spec.thickness**3 / 12
    return per * spec.width if spec.kind == "beam" else per / (1 - spec.material.poisson**2)


def _spot(rng: np.random.Generator, s: Specimen) -> tuple[float, float]:
    """Draw a place away from the ends [m]; it is stated in the model's axes."""
    x = rng.uniform(0.06, 0.94) * s.spec.length
    return float(x), float(rng.uniform(0.1, 0.9) * s.spec.width)


def _at(s: Specimen, x: float, y: float) -> tuple[float, float]:
    return shares(s.spec, np.array([x, y] if s.spec.kind == "plate" else [x]), s.body)


def _place(s: Specimen, x: float, y: float) -> Values:
    return {"x": x, "y": y} if s.spec.kind == "plate" else {"x": x}


def _box(s: Specimen, v: Values) -> Box:
    x, y = _at(s, v["x"], v.get("y", 0.0))
    half, side = v["extent"] / 2 / s.body.length, v["extent"] / 2 / s.body.width
    if s.spec.kind == "beam":
        return (max(x - half, 0.0), min(x + half, 1.0), 0.0, 1.0)
    return (max(x - half, 0.0), min(x + half, 1.0), max(y - side, 0.0), min(y + side, 1.0))


def _body(rng: np.random.Generator, mass: float) -> Values:
    """Draw a compact body of some mass, of aluminium to steel, that stands on the surface or hangs about it."""
    size = (mass / rng.uniform(2500.0, 8000.0)) ** (1 / 3)
    return {"mass": float(mass), "inertia": float(mass * size**2 * (1 / 6 + rng.uniform(0.0, 0.25)))}


def _draw_sensor(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    return _body(rng, k * _log(rng, 0.01, 0.08) * s.body.mass)


def _act_sensor(scene: Scene, v: Values) -> Scene:
    s = scene.specimen
    at = shares(s.spec, s.rig.points[s.rig.sensor], s.body)
    return scene.body(masses=(*s.body.masses, (*at, v["mass"], v["inertia"])))


def _draw_mass(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    return {**_body(rng, k * _log(rng, 0.02, 0.12) * s.body.mass), **_place(s, *_spot(rng, s))}


def _act_mass(scene: Scene, v: Values) -> Scene:
    s = scene.specimen
    return scene.body(masses=(*s.body.masses, (*_at(s, v["x"], v.get("y", 0.0)), v["mass"], v["inertia"])))


def _draw_soft(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    along = rng.uniform(0.03, 0.1) if s.spec.kind == "beam" else rng.uniform(0.1, 0.2)
    extent = along * s.spec.length
    compliance = k * _log(rng, 0.03, 0.2) * s.spec.length * (1 if s.spec.kind == "beam" else 3)
    loss = float(min(compliance / (compliance + extent), 0.95))
    return {"extent": extent, "loss": loss, **_place(s, *_spot(rng, s))}


def _act_soft(scene: Scene, v: Values) -> Scene:
    return scene.body(soft=(*scene.specimen.body.soft, (_box(scene.specimen, v), v["loss"])))


def _draw_patch(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    extent = rng.uniform(0.1, 0.3) * s.spec.length
    return {
        "extent": extent,
        "loss_factor": float(min(k * _log(rng, 0.05, 0.4), 0.6)),
        **_place(s, *_spot(rng, s)),
    }


def _act_patch(scene: Scene, v: Values) -> Scene:
    patch = Patch(_box(scene.specimen, v), v["loss_factor"])
    return scene.body(patches=(*scene.specimen.body.patches, patch))


def _draw_axial(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    width = 1.0 if s.spec.kind == "beam" else s.spec.width
    buckling = _rigidity(s) * width * (np.pi / s.spec.length) ** 2 * (1 if len(s.spec.clamped) > 1 else 0.25)
    return {"force": float(_signed(rng) * min(k * _log(rng, 0.1, 0.5), 0.6) * buckling)}


def _draw_damping(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    rate = k * _log(rng, 1.0, 4.0) * (s.spec.damping.alpha or 0.0)
    return {"alpha": float(min(rate, 2 * FASTEST)), "beta": 0.0, "loss_factor": 0.0}


def _draw_stiff_damping(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    return {"alpha": 0.0, "beta": k * _log(rng, 2.0, 8.0) * (s.spec.damping.beta or 0.0), "loss_factor": 0.0}


def _draw_loss(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    return {"alpha": 0.0, "beta": 0.0, "loss_factor": k * _log(rng, 0.01, 0.05)}


def _act_damping(scene: Scene, v: Values) -> Scene:
    return scene.body(alpha=v["alpha"], beta=v["beta"], loss=v["loss_factor"])


def _draw_drag(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    """Draw a layer's drag that adds as much to the first mode as the plain damping several times over."""
    first = (
        np.sqrt(
            _rigidity(s) * (1 if s.spec.kind == "beam" else s.spec.width) / s.body.mass / s.spec.length**3
        )
        * 4
    )
    rate = k * _log(rng, 1.0, 4.0) * (s.spec.damping.alpha or 0.0)
    return {"drag": float(rate * s.body.density * s.body.thickness / np.sqrt(first))}


def _draw_fluid(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    stated = s.environment.fluid_density
    return {
        "fluid_density": float(stated * rng.uniform(0.985, 1.015))
        if stated
        else float(rng.choice([780.0, 998.0, 1025.0]))
    }


def _act_fluid(scene: Scene, v: Values) -> Scene:
    """Wet the body; its boundary layer damps a little too."""
    s = scene.specimen
    some = 0.3 * (s.spec.damping.alpha or 0.0) * s.body.density * s.body.thickness
    first = (
        np.sqrt(
            _rigidity(s) * (1 if s.spec.kind == "beam" else s.spec.width) / s.body.mass / s.spec.length**3
        )
        * 4
    )
    return scene.body(fluid=v["fluid_density"], drag=some / np.sqrt(first))


def _draw_gain(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    return {"gain": float(np.exp(_signed(rng) * k * rng.uniform(0.12, 0.5)))}


def _draw_window(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    return {"decay": min(k * _log(rng, 1.0, 4.0) * (s.spec.damping.alpha or 0.0) / 2, FASTEST)}


def _draw_delay(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    top = s.rig.modes
    omega = max(_roughly_highest(s, top), 1.0)
    return {"delay": float(_signed(rng) * min(k * _log(rng, 0.15, 1.2), 1.3) / omega)}


def _roughly_highest(s: Specimen, modes: int) -> float:
    speed = s.spec.thickness * np.sqrt(s.spec.material.E / s.spec.material.density / 12)
    if s.spec.kind == "beam":
        return float(speed * ((modes + 0.5) * np.pi / s.spec.length) ** 2)
    return float(4 * np.pi * modes / (s.spec.length * s.spec.width) * speed)


def _draw_polarity(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    others = [p for p in range(len(s.rig.points)) if p != s.rig.sensor]
    count = 1 if rng.random() < 0.7 else 2
    return {"points": tuple(int(p) + 1 for p in sorted(rng.choice(others, count, replace=False)))}


def _draw_swap(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    return {"points": tuple(int(p) + 1 for p in sorted(rng.choice(len(s.rig.points), 2, replace=False)))}


def _draw_position(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    point = int(rng.integers(len(s.rig.points)))
    size = np.array([s.spec.length, s.spec.width])[: s.spec.dim]
    for _ in range(100):
        away = rng.standard_normal(s.spec.dim)
        away *= k * rng.uniform(0.03, 0.1) * s.spec.length / np.linalg.norm(away)
        if np.all((s.rig.points[point] + away > 0) & (s.rig.points[point] + away < size)):
            break
    return {"point": point + 1, **dict(zip(("dx", "dy"), map(float, away), strict=False))}


def _act_position(scene: Scene, v: Values) -> Scene:
    away = tuple(v[n] for n in ("dx", "dy") if n in v)
    return scene.fault(moved={**scene.faults.moved, v["point"] - 1: away})


def _draw_slope(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    return {"slope": float(-k * _log(rng, 0.01, 0.05) / s.rig.level)}


def _draw_extension(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    return {"extension": float(k * rng.uniform(0.01, 0.05) * s.spec.length)}


def _act_extension(scene: Scene, v: Values) -> Scene:
    """Lengthen the body at its clamp; what sits on it keeps its distance from the free end."""
    s = scene.specimen
    body = s.body.but(length=s.body.length + v["extension"])
    ends = {edge for edge in s.spec.clamped if edge[0] == "x"}
    share = 1.0 if ends == {"x0"} else 0.0 if ends == {"x1"} else 0.5
    masses = tuple(
        ((x * s.body.length + share * v["extension"]) / body.length, y, m, i) for x, y, m, i in body.masses
    )
    return replace(scene, specimen=replace(s, body=body.but(masses=masses)))


def _clamp(name: str, scale: Callable[[Specimen], float], low: float, high: float) -> tuple[Draw, Act]:
    def draw(rng: np.random.Generator, s: Specimen, k: float) -> Values:
        return {"stiffness": float(_log(rng, low, high) / k * scale(s))}

    return draw, lambda scene, v: scene.body(**{name: v["stiffness"]})


def _draw_spring(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    width = 1.0 if s.spec.kind == "beam" else s.spec.width
    stiff = k * _log(rng, 3.0, 40.0) * _rigidity(s) * width / s.spec.length**3
    return {"stiffness": float(stiff), **_place(s, *_spot(rng, s))}


def _act_spring(scene: Scene, v: Values) -> Scene:
    s = scene.specimen
    return scene.body(springs=(*s.body.springs, (*_at(s, v["x"], v.get("y", 0.0)), v["stiffness"])))


def _draw_rib(rng: np.random.Generator, s: Specimen, k: float) -> Values:
    return {
        "factor": 1 + k * _log(rng, 0.5, 4.0),
        "extent": rng.uniform(0.1, 0.25) * s.spec.length,
        **_place(s, *_spot(rng, s)),
    }


def _act_rib(scene: Scene, v: Values) -> Scene:
    return scene.body(ribs=(*scene.specimen.body.ribs, (_box(scene.specimen, v), v["factor"])))


_ROTATION = _clamp("rotation", lambda s: _rigidity(s) / s.spec.length, 5.0, 200.0)
_TRANSLATION = _clamp("translation", lambda s: _rigidity(s) / s.spec.length**3, 500.0, 4e4)

CAUSES: dict[str, Cause] = {
    c.name: c
    for c in (
        Cause("E", _factor(0.05, 0.5), _scaled("E")),
        Cause("density", _factor(0.05, 0.5), _scaled("density")),
        Cause("thickness", _factor(0.03, 0.25), _scaled("thickness")),
        Cause("section_scale", _factor(0.12, 0.5), _section, "level", level=True, equals=("calibration_gain",)),
        Cause("length", _draw_extension, _act_extension, clamped=True),
        Cause("clamp_rotation", *_ROTATION, clamped=True),
        Cause("clamp_translation", *_TRANSLATION, clamped=True),
        Cause("sensor_mass", _draw_sensor, _act_sensor),
        Cause("lumped_mass", _draw_mass, _act_mass),
        Cause("local_stiffness", _draw_soft, _act_soft),
        Cause("shear", lambda rng, s, k: {}, lambda scene, v: scene, kinds=("beam",)),
        Cause(
            "orthotropy",
            lambda rng, s, k: {"ratio": float(np.exp(_signed(rng) * k * rng.uniform(0.05, 0.4)))},
            lambda scene, v: scene.body(across=v["ratio"]),
            kinds=("plate",),
        ),
        Cause("axial_load", _draw_axial, lambda scene, v: scene.body(axial=v["force"]), clamped=True),
        Cause("fluid_added_mass", _draw_fluid, _act_fluid),
        Cause("fluid_damping", _draw_drag, lambda scene, v: scene.body(drag=v["drag"]), "damping"),
        Cause("damping_patch", _draw_patch, _act_patch, "damping"),
        Cause("uniform_damping", _draw_damping, _act_damping, "damping", equals=("exponential_window",)),
        Cause("joint_nonlinearity", _draw_slope, lambda scene, v: scene.fault(slope=v["slope"]), "slope", clamped=True),
        Cause(
            "exponential_window", _draw_window, lambda scene, v: scene.fault(decay=v["decay"]), "damping",
            equals=("uniform_damping",),
        ),
        Cause(
            "calibration_gain", _draw_gain, lambda scene, v: scene.fault(gain=v["gain"]), "level", level=True,
            equals=("section_scale",),
        ),
        Cause("time_delay", _draw_delay, lambda scene, v: scene.fault(delay=v["delay"]), "phase", level=True),
        Cause(
            "polarity", _draw_polarity,
            lambda scene, v: scene.fault(reversed=tuple(p - 1 for p in v["points"])), "shape",
        ),
        Cause(
            "swapped_points", _draw_swap,
            lambda scene, v: scene.fault(exchanged=(tuple(p - 1 for p in v["points"]),)), "shape",
        ),
        Cause("position_error", _draw_position, _act_position, "shape"),
        Cause("ground_spring", _draw_spring, _act_spring, equals=("axial_load",)),
        Cause(
            "taper",
            lambda rng, s, k: {"taper": float(_signed(rng) * k * rng.uniform(0.04, 0.2))},
            lambda scene, v: scene.body(taper=v["taper"]),
            inside=False,
        ),
        Cause("rib", _draw_rib, _act_rib, inside=False),
    )
}  # fmt: skip
"""All causes by name, those outside the library last."""

STIFF = Cause("uniform_damping", _draw_stiff_damping, _act_damping, "damping")
HYSTERETIC = Cause("uniform_damping", _draw_loss, _act_damping, "damping")
"""Other forms of uniform damping, without an equal."""

PAIRS: tuple[tuple[str, str], ...] = (
    ("E", "calibration_gain"),
    ("E", "lumped_mass"),
    ("clamp_rotation", "sensor_mass"),
    ("clamp_rotation", "exponential_window"),
    ("local_stiffness", "sensor_mass"),
    ("local_stiffness", "calibration_gain"),
    ("density", "uniform_damping"),
    ("fluid_added_mass", "calibration_gain"),
    ("fluid_added_mass", "clamp_rotation"),
    ("E", "polarity"),
    ("sensor_mass", "polarity"),
    ("thickness", "damping_patch"),
)
"""Pairs that happen together."""
