"""What may be hidden: each secret draws its severity, changes the rig, and knows what answers are right."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from modalkit.blind.bodies.parts import Attached, Notch
from modalkit.blind.scene import Scene
from modalkit.blind.setup import Setup

Parameters = dict[str, float]


@dataclass(frozen=True)
class Secret:
    """One kind of hidden effect.

    Parameters
    ----------
    name : str
        Its name in the contract; ``none`` for no effect; for one that the library lacks, a name of the rig's.
    draw : callable
        ``draw(rng, setup, strength)`` returns the parameters, under the contract's names and in SI units.
    act : callable
        ``act(scene, parameters)`` returns the changed scene.
    applies : callable
        Tells whether a setup can have it.
    also : tuple of str
        Other names that describe exactly the same change of the data.
    in_library : bool
        Whether the diagnosis is expected to know it.
    graded : bool
        Whether a mild form exists.
    """

    name: str
    draw: Callable[[np.random.Generator, Setup, float], Parameters]
    act: Callable[[Scene, Parameters], Scene]
    applies: Callable[[Setup], bool] = field(default=lambda setup: True)
    also: tuple[str, ...] = ()
    in_library: bool = True
    graded: bool = True

    @property
    def accepted(self) -> tuple[str, ...]:
        """Names that are right answers."""
        return (self.name, *self.also) if self.in_library and self.name != "none" else ()


def _either_sign(rng: np.random.Generator) -> float:
    return float(rng.choice([-1.0, 1.0]))


def _factor(low: float, high: float) -> Callable[[np.random.Generator, Setup, float], Parameters]:
    """Draw a factor exp(+-u), u between two bounds times the strength."""

    def draw(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
        return {"factor": float(np.exp(_either_sign(rng) * strength * rng.uniform(low, high)))}

    return draw


def _scale(name: str) -> Callable[[Scene, Parameters], Scene]:
    def act(scene: Scene, parameters: Parameters) -> Scene:
        return scene.with_beam(**{name: getattr(scene.beam, name) * parameters["factor"]})

    return act


def _attach(scene: Scene, part: Attached) -> Scene:
    return scene.with_beam(attached=(*scene.beam.attached, part))


def _draw_extension(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
    return {"extension": strength * rng.uniform(0.015, 0.05) * setup.length}


def _draw_clamp(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
    relative = np.exp(rng.uniform(np.log(8), np.log(60))) / strength
    return {"stiffness": relative * setup.nominal.bending_stiffness / setup.length}


def _draw_sensor(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
    return {"mass": strength * rng.uniform(0.02, 0.08) * setup.nominal.mass}


def _act_sensor(scene: Scene, parameters: Parameters) -> Scene:
    return _attach(scene, Attached(scene.setup.points[scene.setup.sensor], mass=parameters["mass"]))


def _draw_notch(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
    low, high = (0.04, 0.75) if setup.clamped else (0.15, 0.85)
    notch = Notch(
        x=rng.uniform(low, high) * setup.length,
        extent=rng.uniform(0.015, 0.05) * setup.length,
        loss=1.0 - (1.0 - rng.uniform(0.5, 0.9)) ** strength,
    )
    return {"x": notch.x, "extent": notch.extent, "loss": notch.loss, "compliance": notch.compliance}


def _act_notch(scene: Scene, parameters: Parameters) -> Scene:
    notch = Notch(parameters["x"], parameters["extent"], parameters["loss"])
    return scene.with_beam(notches=(*scene.beam.notches, notch))


def _draw_fluid(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
    drawn = rng.uniform(780.0, 1100.0)
    return {"fluid_density": drawn if setup.environment is None else setup.environment}


def _draw_window(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
    middle = 2 * np.pi * setup.nominal_hz[1]
    return {"decay": strength * rng.uniform(0.7, 3.0) * 0.5 * (setup.alpha + setup.beta * middle**2)}


def _draw_gain(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
    least = max(0.08, 4 * setup.calibration)
    return {"gain": float(np.exp(_either_sign(rng) * strength * rng.uniform(least, 0.5)))}


def _draw_ground_spring(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
    unit = setup.nominal.bending_stiffness / setup.length**3
    return {"x": rng.uniform(0.35, 0.7) * setup.length, "stiffness": strength * rng.uniform(10, 60) * unit}


def _act_ground_spring(scene: Scene, parameters: Parameters) -> Scene:
    return _attach(scene, Attached(parameters["x"], stiffness=parameters["stiffness"]))


def _draw_tip_spring(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
    unit = setup.nominal.bending_stiffness / setup.length**3
    return {"x": setup.length, "stiffness": strength * rng.uniform(2, 15) * unit}


def _draw_taper(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
    return {"taper": _either_sign(rng) * strength * rng.uniform(0.08, 0.3)}


def _nothing(rng: np.random.Generator, setup: Setup, strength: float) -> Parameters:
    return {}


def _is_cantilever(setup: Setup) -> bool:
    return setup.clamped


def _model_lacks_shear(setup: Setup) -> bool:
    """Shear is there in every test of a specimen, so it cannot have been added after a baseline."""
    return setup.theory == "euler-bernoulli" and not setup.baseline and setup.shear_shift > 0.02


SECRETS: tuple[Secret, ...] = (
    Secret("none", _nothing, lambda scene, _: scene, graded=False),
    Secret("E", _factor(0.05, 0.2), _scale("E")),
    Secret("density", _factor(0.03, 0.15), _scale("density")),
    Secret("thickness", _factor(0.025, 0.1), _scale("thickness")),
    Secret(
        "length",
        _draw_extension,
        lambda scene, p: scene.with_beam(start=scene.beam.start - p["extension"]),
        applies=_is_cantilever,
    ),
    Secret(
        "clamp_rotation",
        _draw_clamp,
        lambda scene, p: scene.with_beam(clamp_rotation=p["stiffness"]),
        applies=_is_cantilever,
    ),
    Secret("sensor_mass", _draw_sensor, _act_sensor, also=("lumped_mass",)),
    Secret("local_stiffness", _draw_notch, _act_notch),
    Secret("shear", _nothing, lambda scene, _: scene, applies=_model_lacks_shear, graded=False),
    Secret(
        "fluid_added_mass",
        _draw_fluid,
        lambda scene, p: scene.with_beam(fluid_density=p["fluid_density"]),
        graded=False,
    ),
    Secret(
        "exponential_window",
        _draw_window,
        lambda scene, p: replace(scene, window=scene.window + p["decay"]),
        also=("uniform_damping",),
    ),
    Secret(
        "calibration_gain",
        _draw_gain,
        lambda scene, p: replace(scene, gain=scene.gain * p["gain"]),
        also=("section_scale",),
    ),
    Secret("ground_spring", _draw_ground_spring, _act_ground_spring, in_library=False),
    Secret("tip_spring", _draw_tip_spring, _act_ground_spring, applies=_is_cantilever, in_library=False),
    Secret("taper", _draw_taper, lambda scene, p: scene.with_beam(taper=p["taper"]), in_library=False),
)

MILD = 0.3
"""Strength of a mild effect relative to a clear one [-]."""


def theory_is_fit(setup: Setup, secret: Secret) -> bool:
    """Tell whether the study's beam theory carries no second gap beside the hidden effect.

    Parameters
    ----------
    setup : Setup
        With the theory and the repeatability.
    secret : Secret
        What is hidden.

    Returns
    -------
    bool
        True where shear is modelled, is the secret, or is under half the repeatability.
    """
    modelled = setup.theory == "timoshenko"
    return modelled or secret.name == "shear" or setup.shear_shift < 0.5 * setup.repeatability
