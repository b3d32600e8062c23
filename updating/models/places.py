"""Whether the masses and regions of a model lie on it, and are of its size."""

from __future__ import annotations

import math
from collections.abc import Mapping

from acquisition.errors import StudyError
from updating.models.parts import POSITIVE
from updating.models.spec import Spec

ROUNDED = 1e-3
"""How far, relative to the size, a coordinate may miss an edge: digits that a user does not write out [-]."""

LARGEST = 1e6
"""So many times larger or smaller than the structure's own a property is a slip; its powers leave no digits [-]."""

THOUSAND = 1000.0
"""Millimetres in a metre [-]."""


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
