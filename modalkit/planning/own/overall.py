"""What is off on the whole specimen, around it, or in the measurement, as families of a study's own model."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import numpy as np

from acquisition.quantities import severity
from modalkit.planning.family import Family, factor, per_cent
from modalkit.planning.own.sizes import BODY, HEAVIEST, Maker, in_g, in_unit
from updating.effects.base import Effect, total_mass
from updating.prediction.predict import Predictor

CLEAR_LOAD, MOST_LOAD = 0.25, 0.7
"""Axial load that is asked about, and the largest, of that at which the specimen buckles [-]."""

NEAR = 0.3
"""A near surface or bottom of a fluid over the shorter side [-]: of a slender beam the one takes an eighth of the added
mass, the other adds a sixth; nearer than a tenth none is believed, beyond three none is felt."""

BELIEVED_LOAD = 0.8
"""Largest pressure that the effect believes, of that at which the plate buckles [-]."""


def _whole(noun: str, *, most: float, clear: float) -> Maker:
    return lambda effect, predictor: iter([factor(effect.name, noun, most=most, clear=clear)])


def _sensor(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    mass = total_mass(predictor.spec)
    yield Family(
        name=effect.name, values=lambda q, _: {"mass": q, "bulk": 0.0}, low=0.0, high=HEAVIEST * mass,
        clear=BODY * mass, words="a sensor heavier than stated by", amount=in_g,
    )  # fmt: skip


def _gain(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    end = float(np.log(2.5))
    yield Family(
        name=effect.name,
        values=lambda q, _: {"gain": float(np.exp(q))},
        low=-end,
        high=end,
        clear=0.2,
        words="a level off by more than",
        amount=per_cent,
    )


def _middle(predictor: Predictor) -> tuple[float, float]:
    """Return angular frequency [rad/s] and expected decay [1/s] of the second mode."""
    modes = predictor.predict(count=2)
    omega = 2 * np.pi * float(modes.frequency[-1])
    return omega, float(modes.damping[-1]) * omega


def _window(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    _, decay = _middle(predictor)
    yield Family(
        name=effect.name, values=lambda q, _: {"decay": q}, low=0.0, high=max(70.0, 20 * decay),
        clear=1.5 * decay, words="a window of more than", amount=in_unit("1/s"),
    )  # fmt: skip


def _uniform(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """Three laws, each as much as the second mode's expected decay at ``q`` = 1."""
    omega, decay = _middle(predictor)
    unit = {"alpha": 2 * decay, "beta": 2 * decay / omega**2, "loss_factor": 2 * decay / omega}
    laws = tuple(unit)
    yield Family(
        name=effect.name,
        values=lambda q, law: {name: q * unit[name] * (name == laws[int(law)]) for name in laws}, low=0.0,
        high=20.0, clear=1.5, words="damping",
        amount=lambda q: f"{severity(1 + q)} times that expected in the middle", places=np.arange(3.0),
    )  # fmt: skip


def _length(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    size = predictor.spec.length
    yield Family(
        name=effect.name, values=lambda q, _: {"extension": q}, low=-0.06 * size, high=0.12 * size, clear=0.03 * size,
        words="a free length off by more than", amount=lambda q: f"{severity(1e3 * abs(q))} mm", always=True,
    )  # fmt: skip


def _taper(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    yield Family(
        name=effect.name, values=lambda q, _: {"slope": q}, low=-0.8, high=0.8, clear=0.1,
        words="a thickness that changes along x by more than",
        amount=lambda q: f"{severity(100 * abs(q))} %", always=True,
    )  # fmt: skip


def _orthotropy(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    end = float(np.log(2.0))
    yield Family(
        name=effect.name, values=lambda q, _: {"ratio": float(np.exp(q)), "shear_ratio": 1.0}, low=-end,
        high=end, clear=0.1, words="a ratio of moduli, along to across, off by more than", amount=per_cent,
        always=True,
    )  # fmt: skip


def _load(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """A load along x, over that at which the plate buckles: the end of what the effect believes."""
    (force,) = effect.parameters(predictor)
    buckling = -force.low / BELIEVED_LOAD
    yield Family(
        name=effect.name, values=lambda q, _: {"force": q}, low=-MOST_LOAD * buckling, high=2 * buckling,
        clear=CLEAR_LOAD * buckling, words="an axial load above",
        amount=lambda q: f"{severity(abs(q))} {force.unit}",
    )  # fmt: skip


def _fluid(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """Of its surface and bottom those that the study does not state are far off or near: forms of the effect."""
    around, spec = predictor.environment, predictor.spec
    near = NEAR * min(spec.length, spec.width)
    unstated = [name for name in ("free_surface", "bottom") if getattr(around, name) is None]
    tanks = [dict(zip(unstated, at, strict=True)) for at in product((np.inf, near), repeat=len(unstated))]
    known = around.fluid_density
    yield Family(
        name=effect.name, values=lambda q, form: {"fluid_density": q, **tanks[int(form)]}, low=0.0,
        high=known or 2000.0, clear=known or 998.0, words="a fluid denser than", amount=in_unit("kg/m3"),
        places=np.arange(float(len(tanks))),
    )  # fmt: skip


def _viscous(effect: Effect, predictor: Predictor) -> Iterator[Family]:
    """Severity is the root of the viscosity, in proportion to which a boundary layer damps."""
    yield Family(
        name=effect.name, values=lambda q, _: {"viscosity": q**2}, low=0.0, high=1.0, clear=0.1,
        words="a fluid more viscous than", amount=lambda q: f"{severity(1e3 * q**2)} mPa s",
    )  # fmt: skip


OVERALL: dict[str, Maker] = {
    "E": _whole("a modulus", most=2.5, clear=0.1),
    "density": _whole("a density", most=2.5, clear=0.1),
    "thickness": _whole("a thickness", most=1.6, clear=0.05),
    "section_scale": _whole("stiffness and mass together", most=2.5, clear=0.15),
    "length": _length,
    "taper": _taper,
    "orthotropy": _orthotropy,
    "axial_load": _load,
    "fluid_added_mass": _fluid,
    "fluid_damping": _viscous,
    "sensor_mass": _sensor,
    "uniform_damping": _uniform,
    "exponential_window": _window,
    "calibration_gain": _gain,
}
"""By effect."""
