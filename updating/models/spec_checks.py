"""What masses and regions of a model must be: no numbers that nothing has, and on the structure."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from acquisition.errors import StudyError

if TYPE_CHECKING:
    from updating.models.spec import PointMass, Region, Spec

POSITIVE = ("E", "density", "thickness", "area", "inertia")
"""A region's own properties that are above zero."""

DAMPERS = ("alpha", "beta", "loss_factor")
"""A region's own damping, which is not negative."""

ROUNDED = 1e-3
"""How far, relative to the size, a coordinate may miss an edge: digits that a user does not write out [-]."""

LARGEST = 1e6
"""So many times larger or smaller than the structure's own a property is a slip; its powers leave no digits [-]."""

THOUSAND = 1000.0
"""Millimetres in a metre [-]."""


def check_parts(spec: Spec) -> None:
    """See that the masses and regions of a model can be.

    Raises
    ------
    StudyError
        If one has a number that nothing has, or the wrong count of coordinates.
    """
    for mass in spec.masses:
        _check_mass(spec, mass)
    for region in spec.regions:
        _check_region(spec, region)


def check_places(spec: Spec) -> None:
    """See that the masses and regions of a model lie on it, as a study states them, and are of its size.

    Raises
    ------
    StudyError
        If one lies off the structure, or is over a million times larger or smaller than what it replaces.
    """
    _check_sizes(spec)
    for mass in spec.masses:
        _check_on(spec, f"mass at {list(mass.at)}", {"x": tuple(mass.at[:1]), "y": tuple(mass.at[1:2])})
    for region in spec.regions:
        _check_on(spec, f"region {region.name!r}", {"x": region.x, "y": region.y or ()})


def _check_sizes(spec: Spec) -> None:
    """See that masses, and the regions' own properties, are no million times those of the structure."""
    body = spec.material.density * spec.length * spec.width * spec.thickness
    area = spec.width * spec.thickness
    usual = {
        "E": spec.material.E,
        "density": spec.material.density,
        "thickness": spec.thickness,
        "area": area,
        "inertia": area * spec.thickness**2 / 12,
    }
    stated = [
        (f"region {r.name!r}", n, getattr(r, n), usual[n], LARGEST) for r in spec.regions for n in POSITIVE
    ]
    for mass in spec.masses:
        whose = f"mass at {list(mass.at)}"
        stated += [(whose, "mass", mass.mass or None, body, math.inf)]
        stated += [(whose, "inertia", mass.inertia or None, body * spec.length**2, math.inf)]
    for whose, name, value, own, shrunk in stated:
        if value is not None and not own / shrunk <= value <= own * LARGEST:
            raise StudyError(
                f"model: {whose}: {name} = {value:g} is {value / own:.2g} times that of the {spec.kind} itself; check "
                "its unit"
            )


def _check_mass(spec: Spec, mass: PointMass) -> None:
    at = list(mass.at)
    if len(at) != spec.dim:
        many = "s" if spec.dim > 1 else ""
        raise StudyError(
            f"model: mass at {at} needs {spec.dim} coordinate{many} on {spec.called}, found {len(at)}"
        )
    if not (0 <= mass.mass < math.inf and 0 <= mass.inertia < math.inf):
        raise StudyError(
            f"model: mass at {at} of {mass.mass:g} kg, {mass.inertia:g} kg m2; neither is negative"
        )


def _check_region(spec: Spec, region: Region) -> None:
    whose = f"region {region.name!r}"
    for name in POSITIVE + DAMPERS:
        value, least = getattr(region, name), "above zero" if name in POSITIVE else "not negative"
        if value is not None and not (0 < value < math.inf or (value == 0 and name in DAMPERS)):
            raise StudyError(f"model: {whose} has {name} = {value:g}; it is finite and {least}")
    sides = {"x": region.x, "y": region.y or ()}
    if spec.kind == "beam" and region.y is not None:
        raise StudyError(f"model: {whose} has y; a beam reaches along x alone")
    if spec.kind == "plate" and (region.area, region.inertia, region.shear_coefficient) != (None, None, None):
        raise StudyError(f"model: {whose} has area or inertia; those are of beams")
    for axis, ends in sides.items():
        if ends and not ends[0] < ends[1]:
            raise StudyError(f"model: {whose}: {axis} = {list(ends)} ends before it begins; give [low, high]")


def _check_on(spec: Spec, what: str, sides: Mapping[str, tuple[float, ...]]) -> None:
    """See that coordinates lie on a beam or a plate, but for rounding; matrices say by their nodes where they are."""
    if spec.kind == "matrices":
        return
    for axis, size in (("x", spec.length), ("y", spec.width)):
        off = [c for c in sides[axis] if not -ROUNDED * size <= c <= (1 + ROUNDED) * size]
        if off:
            small = 0.01 * size < off[0] / THOUSAND <= (1 + ROUNDED) * size
            raise StudyError(
                f"model: {what}: {axis} = {off[0]:g} m is off the {spec.kind}, which reaches from 0 to {size:g} m"
                + (f'; if it is in mm, write "{off[0]:g} mm"' if small else "")
            )
