"""Effects on the whole specimen, its supports and the measurement."""

from __future__ import annotations

from itertools import product
from math import inf

import numpy as np

from acquisition.quantities import severity
from modalkit.planning.family import Family, Maker, factor, per_cent
from modalkit.simulator.setup import Setup

_SOFTEST_CLAMP, _SOFT_CLAMP = 1.5, 20.0
_SOFTEST_SLIDE, _SOFT_SLIDE = 60.0, 2000.0
CLEAR_LOAD, MOST_LOAD = 0.25, 0.7
"""Axial load that is asked about, and the largest, of that at which the specimen buckles [-]."""
_STEEPEST = 0.8
_MIDDLE = 1

NEAR = 0.3
"""A near surface or bottom of a fluid over the shorter side [-]: of a slender beam the one takes an eighth of the added
mass, the other adds a sixth; nearer than a tenth none is believed, beyond three none is felt."""


def _factor(name: str, noun: str, *, most: float, clear: float) -> Maker:
    """A property of the whole specimen, off by exp(q)."""
    return lambda setup: factor(name, noun, most=most, clear=clear)


def _length(setup: Setup) -> Family | None:
    if not setup.clamped:
        return None
    return Family(
        "length",
        lambda q, _: {"extension": q},
        -0.06 * setup.length,
        0.12 * setup.length,
        0.03 * setup.length,
        "a free length off by more than",
        lambda q: f"{severity(1e3 * abs(q))} mm",
        always=True,
    )


def _taper(setup: Setup) -> Family:
    return Family(
        "taper",
        lambda q, _: {"slope": q},
        -_STEEPEST,
        _STEEPEST,
        0.1,
        "a thickness that changes along the beam by more than",
        lambda q: f"{severity(100 * abs(q))} %",
        always=True,
    )


def _clamp(setup: Setup) -> Family | None:
    if not setup.clamped:
        return None
    unit = setup.rigidity / setup.length
    return Family(
        "clamp_rotation",
        lambda q, _: {"stiffness": 1 / q if q else inf},
        0.0,
        1 / (_SOFTEST_CLAMP * unit),
        1 / (_SOFT_CLAMP * unit),
        "a clamp softer than",
        lambda q: f"{severity(1 / q)} N m/rad ({severity(1 / q / unit)} EI/L)",
    )


def _slide(setup: Setup) -> Family | None:
    if not setup.clamped:
        return None
    unit = setup.rigidity / setup.length**3
    return Family(
        "clamp_translation",
        lambda q, _: {"stiffness": 1 / q if q else inf},
        0.0,
        1 / (_SOFTEST_SLIDE * unit),
        1 / (_SOFT_SLIDE * unit),
        "a clamp that shifts, softer than",
        lambda q: f"{severity(1 / q)} N/m",
    )


def _load(setup: Setup) -> Family | None:
    if not setup.clamped:
        return None
    ends = 4.0 if len(setup.clamped) == 2 else 0.25
    buckling = ends * setup.rigidity * (np.pi / setup.length) ** 2
    return Family(
        "axial_load",
        lambda q, _: {"force": q},
        -MOST_LOAD * buckling,
        2 * buckling,
        CLEAR_LOAD * buckling,
        "an axial load above",
        lambda q: f"{severity(abs(q))} N",
    )


def _gain(setup: Setup) -> Family:
    return Family(
        "calibration_gain",
        lambda q, _: {"gain": float(np.exp(q))},
        -float(np.log(2.5)),
        float(np.log(2.5)),
        0.2,
        "a level off by more than",
        per_cent,
    )


def _fluid(setup: Setup) -> Family:
    """Of its surface and bottom those that the study does not state are far off or near: forms of the effect."""
    known_test = setup.environment
    unstated = [name for name in ("free_surface", "bottom") if getattr(setup, name) is None]
    near = NEAR * min(setup.length, setup.width)
    tanks = [
        dict(zip(unstated, places, strict=True)) for places in product((inf, near), repeat=len(unstated))
    ]
    return Family(
        "fluid_added_mass",
        lambda q, form: {"fluid_density": q, **tanks[int(form)]},
        0.0,
        2000.0 if known_test is None else known_test,
        known_test or 998.0,
        "a fluid denser than",
        lambda q: f"{severity(q)} kg/m3",
        np.arange(float(len(tanks))),
        separately=True,
    )


def _viscous(setup: Setup) -> Family:
    """Severity is the root of the viscosity, in proportion to which a boundary layer damps."""
    return Family(
        "fluid_damping",
        lambda q, _: {"viscosity": q**2},
        0.0,
        1.0,
        0.1,
        "a fluid more viscous than",
        lambda q: f"{severity(1e3 * q**2)} mPa s",
    )


def _middle(setup: Setup) -> tuple[float, float]:
    """Return angular frequency [rad/s] and expected decay [1/s] of the second mode."""
    mode = min(_MIDDLE, setup.modes - 1)
    return 2 * np.pi * setup.nominal_hz[mode], float(setup.decays[mode])


def _window(setup: Setup) -> Family:
    _, decay = _middle(setup)
    return Family(
        "exponential_window",
        lambda q, _: {"decay": q},
        0.0,
        max(70.0, 20 * decay),
        1.5 * decay,
        "a window of more than",
        lambda q: f"{severity(q)} 1/s",
    )


def _uniform(setup: Setup) -> Family:
    """Three laws, each as much as the second mode's expected decay at ``q`` = 1."""
    omega, decay = _middle(setup)
    unit = {"alpha": 2 * decay, "beta": 2 * decay / omega**2, "loss_factor": 2 * decay / omega}
    laws = tuple(unit)

    def values(q: float, law: float) -> dict[str, float]:
        return {name: q * unit[name] * (name == laws[int(law)]) for name in laws}

    return Family(
        "uniform_damping",
        values,
        0.0,
        20.0,
        1.5,
        "damping",
        lambda q: f"{severity(1 + q)} times that expected in the middle",
        np.arange(3.0),
        separately=True,
    )


WHOLE: tuple[Maker, ...] = (
    _factor("E", "a modulus", most=2.5, clear=0.1),
    _factor("density", "a density", most=2.5, clear=0.1),
    _factor("thickness", "a thickness", most=1.6, clear=0.05),
    _factor("section_scale", "a width", most=2.5, clear=0.15),
    _length,
    _taper,
    _clamp,
    _slide,
    _load,
    _gain,
    _fluid,
)
"""What needs no damping to be known."""

DAMPING: tuple[Maker, ...] = (_viscous, _window, _uniform)
"""What shows in damping alone."""
