"""Random specimens and tests, drawn without knowledge of the hidden effect."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from acquisition.errors import StudyError
from modalkit.simulator.bodies.beam.beam import Beam
from modalkit.simulator.bodies.solid.solid import available
from modalkit.simulator.drawing.block import draw_bracket, draw_ribbed
from modalkit.simulator.drawing.common import (
    MATERIAL_SHARES,
    MATERIALS,
    draw_tank,
    draw_test,
    near_a_node,
    rayleigh,
    two_digits,
)
from modalkit.simulator.drawing.frame import draw_frame
from modalkit.simulator.drawing.plate import draw_plate
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.simulator.setup import Setup, Tolerances

BRICKS = ("solid", "ribbed", "bracket")
"""Kinds of specimen made of bricks, which need CalculiX."""

_CLAMPS: tuple[tuple[str, ...], ...] = (("x0",), ("x0", "x1"), ())
_CLAMP_SHARES = (0.62, 0.12, 0.26)
_THIN_SHEAR = 0.5
_SHEAR_SHOWS = 0.02
_SHEAR_KEPT = 0.55
_EVERYTHING = DrawRanges()


def draw_setup(rng: np.random.Generator, *, plan: DrawRanges = _EVERYTHING) -> Setup:
    """Draw a specimen and its test.

    Parameters
    ----------
    rng : numpy.random.Generator
        Source of randomness.
    plan : DrawRanges, optional
        Kinds of specimens, and share of baselines.

    Returns
    -------
    Setup
        One whose first frequency is at least 5 Hz and whose band ends below 6 kHz.

    Raises
    ------
    StudyError
        If something of bricks is asked for, and there is no CalculiX.
    """
    of_bricks = [kind for kind in plan.kinds if kind in BRICKS]
    if of_bricks and not available():
        raise StudyError(
            f"plan: bodies of bricks ({', '.join(of_bricks)}) need CalculiX, and there is no ccx on the path; "
            "install calculix-ccx, or leave them out of the kinds"
        )
    makers = {
        "beam": _draw_beam,
        "plate": draw_plate,
        "solid": _draw_solid,
        "frame": draw_frame,
        "ribbed": draw_ribbed,
        "bracket": draw_bracket,
    }
    maker = makers[_draw_kind(rng, plan)]
    while True:
        setup = maker(rng, plan)
        if setup is not None:
            return setup


def _draw_kind(rng: np.random.Generator, plan: DrawRanges) -> str:
    others = [kind for kind in plan.kinds if kind != "beam"]
    some_left = "beam" in plan.kinds and len(others) * plan.plates < 1
    share = plan.plates if some_left else 1 / len(plan.kinds)
    borders = share * np.arange(1, len(others) + 1)
    return [*others, "beam"][int(np.searchsorted(borders, rng.random(), side="right"))]


def _draw_beam(rng: np.random.Generator, plan: DrawRanges) -> Setup | None:
    length = round(rng.uniform(0.25, 1.0), 3)
    thickness = round(max(0.002, length / np.exp(rng.uniform(np.log(20), np.log(150)))), 4)
    width = round(rng.uniform(max(0.015, 1.5 * thickness), max(0.02, 2 * thickness, 0.2 * length)), 3)
    material = MATERIALS[int(rng.choice(3, p=MATERIAL_SHARES))]
    clamped = _CLAMPS[int(rng.choice(3, p=_CLAMP_SHARES))]
    setup = _tested(rng, plan, "beam", (length, width, thickness), material, clamped)
    return setup and _fit_theory(rng, setup)


def _draw_solid(rng: np.random.Generator, plan: DrawRanges) -> Setup | None:
    """Draw a cantilever of compact section, which is half a row of bricks wide; shear is in its model."""
    length = round(rng.uniform(0.25, 0.8), 3)
    thickness = round(length / np.exp(rng.uniform(np.log(35), np.log(100))), 4)
    width = round(thickness * rng.uniform(1.5, 3.0), 4)
    material = MATERIALS[int(rng.choice(3, p=MATERIAL_SHARES))]
    setup = _tested(rng, plan, "solid", (length, width, thickness), material, ("x0",))
    return setup and replace(setup, theory="timoshenko")


def _tested(
    rng: np.random.Generator,
    plan: DrawRanges,
    kind: str,
    size: tuple[float, float, float],
    material: tuple[float, float, float],
    clamped: tuple[str, ...],
) -> Setup | None:
    """Draw the test on a beam of some length, width and thickness; None where it is too slow or too fast."""
    (length, width, thickness), (E, density, poisson) = size, material
    points = _draw_points(rng, length, clamped)
    inner = [i for i, (x,) in enumerate(points) if 0 < x < length]
    ends = [i for i in range(len(points)) if i not in inner] or inner
    sensor = int(rng.choice(ends)) if rng.random() < 0.5 else int(rng.integers(len(points)))
    sensor_mass = round(rng.uniform(0.0, 0.01) * density * length * width * thickness, 5)
    modes = int(rng.choice([4, 5]))
    beam = Beam(0.0, length, 0.02, thickness, E, density, poisson=poisson, clamped=clamped, elements=5)
    omega, shapes = beam.real_modes(modes + beam.rigid_modes)
    seen = beam.rows(np.array(points), "w") @ shapes[:, beam.rigid_modes :]
    sensor = near_a_node(rng, seen, sensor)
    bare = omega[beam.rigid_modes :] / (2 * np.pi)
    band = (two_digits(0.25 * bare[0]), two_digits(1.2 * bare[-1]))
    alpha, beta = rayleigh(rng, float(bare[0]), float(bare[-1]))
    test = draw_test(rng, plan)
    tank: dict[str, Any] = draw_tank(rng, width) if test["environment"] is not None else {}
    setup = Setup(
        kind=kind,
        title=f"Beam of {1e3 * length:.0f} x {1e3 * width:.0f} x {1e3 * thickness:.1f} mm",
        length=length,
        width=width,
        thickness=thickness,
        E=E,
        density=density,
        poisson=poisson,
        clamped=clamped,
        theory="euler-bernoulli" if rng.random() < 0.3 else "timoshenko",
        elements=(int(rng.integers(20, 41)),),
        tolerances=Tolerances(),
        alpha=alpha,
        beta=beta,
        points=points,
        sensor=sensor,
        sensor_mass=sensor_mass,
        modes=modes,
        band=band,
        window=round(rng.uniform(0.5, 2.0) * 0.5 * alpha, 2) if rng.random() < 0.35 else 0.0,
        **test,
        **tank,
    )
    return None if bare[0] < 5.0 or band[1] > 6000.0 else setup


def _fit_theory(rng: np.random.Generator, setup: Setup) -> Setup:
    """Leave a slender theory only where it fits, or where what it lacks shows and was not there before.

    A stocky beam under a slender theory always has shear to hide, whatever else it has; some of them are kept.
    """
    if setup.theory == "timoshenko" or setup.shear_shift < _THIN_SHEAR * setup.repeatability:
        return setup
    if setup.shear_shift > _SHEAR_SHOWS and not setup.baseline and rng.random() < _SHEAR_KEPT:
        return setup
    return replace(setup, theory="timoshenko")


def lacks_shear(setup: Setup) -> bool:
    """Return whether the study's theory lacks shear that shows: then shear is hidden, alone or with another."""
    return setup.theory == "euler-bernoulli" and setup.shear_shift > _SHEAR_SHOWS


def _draw_points(
    rng: np.random.Generator, length: float, clamped: tuple[str, ...]
) -> tuple[tuple[float], ...]:
    count = int(rng.integers(5, 10))
    shares = {
        ("x0",): np.arange(1, count + 1) / count,
        ("x0", "x1"): np.arange(1, count + 1) / (count + 1),
        (): np.linspace(0.0, 1.0, count),
    }
    even = shares[clamped]
    inner = (even > 0) & (even < 1)
    jittered = even + inner * rng.uniform(-0.2, 0.2, count) / count
    return tuple((round(float(x), 3),) for x in length * jittered)
