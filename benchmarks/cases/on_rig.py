"""The cases whose bodies the rig has."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from cases.rig import Values, banded, frequencies_alone, hidden_values, on_rig, specimen
from cases.trial import Cause, Make, Trial
from modalkit.simulator.drawing.common import draw_tank, rayleigh
from modalkit.simulator.hidden import HIDDEN_EFFECTS
from modalkit.simulator.hidden.base import draw_within, either_sign
from modalkit.simulator.scene import nominal_scene
from modalkit.simulator.setup import Setup

WATER = 998.0
LARGE = {"local_stiffness": (0.21, 0.37), "damping_patch": (0.28, 0.42)}
"""Sizes of a soft area and of a layer that were met, as shares of length and width [-]."""

HIGHEST = 6000.0
"""Where the bands of the rig's specimens end at most [Hz]."""


def is_free(setup: Setup) -> bool:
    return not setup.clamped


def thick_plate(theory: str) -> Make:
    """Return the case of a plate a sixtieth of its width thick, in which nothing is hidden."""

    def make(rng: np.random.Generator, folder: Path) -> Trial:
        while True:
            thin = specimen(rng, "plate")
            thick = round(thin.width / 60, 5)
            setup = replace(thin, thickness=thick, theory=theory, title=f"Plate, {1e3 * thick:.1f} mm thick")
            hertz = setup.nominal_hz
            alpha, beta = rayleigh(rng, hertz[0], hertz[setup.modes - 1])
            setup = banded(replace(setup, alpha=alpha, beta=beta), hertz)
            if setup.band[1] <= HIGHEST:
                return on_rig(rng, folder, setup, {})

    return make


def tank(rng: np.random.Generator, setup: Setup) -> dict[str, float]:
    """Draw a tank that has a surface and a bottom."""
    while len(drawn := draw_tank(rng, min(setup.size))) < 2:
        pass
    return drawn


def in_water(rng: np.random.Generator, folder: Path, setup: Setup, water: Values) -> Trial:
    """Put a plate into water; whoever tests it there chooses the band for what he sees."""
    wet = HIDDEN_EFFECTS["fluid_added_mass"].act(nominal_scene(setup), dict(water))
    return on_rig(rng, folder, banded(setup, wet.elastic().frequency.tolist()), {"fluid_added_mass": water})


def stated_tank(rng: np.random.Generator, folder: Path) -> Trial:
    """Water, surface and bottom are in the study, and not in the model."""
    setup = specimen(rng, "plate")
    setup = replace(setup, environment=WATER, **tank(rng, setup))
    return in_water(rng, folder, setup, {"fluid_density": WATER})


def unstated_tank(rng: np.random.Generator, folder: Path) -> Trial:
    """The study knows of no fluid at all."""
    setup = replace(specimen(rng, "plate"), environment=None, free_surface=None, bottom=None)
    return in_water(rng, folder, setup, {"fluid_density": WATER, **tank(rng, setup)})


def free_layer(*others: str) -> Make:
    """Return the case of a free beam with a damping layer, and what else is hidden."""

    def make(rng: np.random.Generator, folder: Path) -> Trial:
        setup = specimen(rng, "beam", fits=is_free)
        return on_rig(rng, folder, setup, {name: {} for name in (*others, "damping_patch")})

    return make


def tip_mass(rng: np.random.Generator, folder: Path) -> Trial:
    """A mass at the tip of a cantilever of which frequencies alone are measured."""
    setup = specimen(rng, "beam", fits=lambda setup: setup.clamped == ("x0",))
    tip = {"lumped_mass": {"x": setup.length}}
    return on_rig(rng, folder, setup, tip, measured=frequencies_alone)


def two_constants(rng: np.random.Generator, folder: Path) -> Trial:
    """E across is 0.75 of E along, and the shear modulus a number of its own."""
    shear = float(np.exp(either_sign(rng) * rng.uniform(0.05, 0.25)))
    hidden = {"orthotropy": {"ratio": 0.75, "shear_ratio": shear}}
    return on_rig(rng, folder, specimen(rng, "plate"), hidden)


def rectangle(rng: np.random.Generator, setup: Setup, name: str) -> dict[str, float]:
    """Draw where a rectangle of the size that was met lies [m]."""
    extents = tuple(share * size for share, size in zip(LARGE[name], setup.size, strict=True))
    return draw_within(rng, setup, extents) | dict(zip(("extent", "extent_y"), extents, strict=True))


def soft_area(rng: np.random.Generator, folder: Path) -> Trial:
    """A soft rectangle larger than a place."""
    setup, loss = specimen(rng, "plate"), float(rng.uniform(0.25, 0.6))
    values: dict[str, Any] = rectangle(rng, setup, "local_stiffness") | {"loss": loss, "form": "rectangle"}
    values["compliance"] = values["extent"] * loss / (1 - loss)
    return on_rig(rng, folder, setup, {"local_stiffness": values})


def large_layer(rng: np.random.Generator, folder: Path) -> Trial:
    """A damping layer on a large rectangle, of any of the rig's laws of loss."""
    setup = specimen(rng, "plate")
    return on_rig(rng, folder, setup, {"damping_patch": rectangle(rng, setup, "damping_patch")})


def upside_down(rng: np.random.Generator, folder: Path) -> Trial:
    """The one sensor of a roving hammer is reversed: as if every point were hit from the other side."""
    setup = specimen(rng, "beam", "plate")
    every = {"points": [i + 1 for i in range(len(setup.points))]}
    trial = on_rig(rng, folder, setup, {"polarity": every})
    sensor = tuple(f"{setup.sensor + 1}{sign}Z" for sign in "+-")
    return replace(trial, causes=(Cause(("polarity",), places=sensor),))


def third_of_damping(rng: np.random.Generator, folder: Path) -> Trial:
    """Two thirds of the damping that is expected are not there, of both its laws alike."""
    setup = specimen(rng, "beam", "plate")
    lacking = {"alpha": -2 / 3 * setup.alpha, "beta": -2 / 3 * setup.beta, "loss_factor": 0.0}
    return on_rig(rng, folder, setup, {"uniform_damping": lacking})


def softening_clamp(rng: np.random.Generator, folder: Path) -> Trial:
    """A clamp that turns the more, the harder the hit."""
    setup = specimen(rng, "beam", "plate", fits=HIDDEN_EFFECTS["joint_nonlinearity"].applies)
    drawn = hidden_values(rng, setup, "joint_nonlinearity", {})
    return on_rig(rng, folder, setup, {"joint_nonlinearity": {"slope": -abs(drawn["slope"])}})


def foundation(rng: np.random.Generator, folder: Path) -> Trial:
    """Springs to the ground along a tenth of the length or more of a clamped beam."""
    setup = specimen(rng, "beam", fits=lambda setup: bool(setup.clamped))
    drawn: Values = {"extent": 0.0}
    while drawn["extent"] < 0.1 * setup.length:
        drawn = hidden_values(rng, setup, "ground_spring", {})
    return on_rig(rng, folder, setup, {"ground_spring": drawn})


def heavy_sensor(rng: np.random.Generator, folder: Path) -> Trial:
    """The sensor is heavier than stated; a mass somewhere beside it is another answer."""
    return on_rig(rng, folder, specimen(rng, "plate"), {"sensor_mass": {}}, equals=False)
