"""Numbers of a model that look like another unit's: GPa, g/cm3 or mm where SI is meant."""

from __future__ import annotations

import math
from itertools import product
from typing import TYPE_CHECKING

from acquisition.errors import StudyError
from acquisition.si_units import si_value

if TYPE_CHECKING:
    from modalkit.study.model_tables import MaterialTable, ModelTable

SPEEDS = (8.0, 30e3)
"""Speed of waves along a bar, sqrt(E/density), of anything that is struck: soft silicone 10, diamond 18000 [m/s]."""

USUAL_SPEEDS = (500.0, 20e3)
"""The same of what most structures are made of, where a unit is guessed: soft plastics to beryllium [m/s]."""

DENSITIES = (1.0, 30e3)
"""Densities of solids: aerogel 1 to 3, osmium 22600 [kg/m3]."""

USUAL_DENSITIES = (100.0, 25e3)
"""The same where a unit is guessed: balsa to osmium [kg/m3]."""

MODULI = ("Pa", "GPa", "MPa", "psi", "ksi")
"""Units in which moduli are written."""

MASSES = ("kg/m^3", "g/cm^3", "t/mm^3", "lb/in^3")
"""Units in which densities are written."""

SIZES = (1e-7, 1e4)
"""Sizes of what is struck or modelled as a beam or plate: a micro-cantilever's thickness to a bridge [m]."""

SLENDER = 1e5
"""Length over thickness above which nothing bends as a beam: a millimetre on a hundred metres [-]."""


def check_units(model: ModelTable) -> None:
    """See that the numbers of a beam or a plate are those of a solid body in SI units.

    Raises
    ------
    StudyError
        If not; it names the units that were probably meant.
    """
    if model.type == "matrices" or model.material is None:
        return
    _check_material(model.material)
    sizes = {name: getattr(model, name) for name in ("length", "width", "thickness")}
    if any(size is None or not size > 0 for size in sizes.values()):
        return  # what is missing or not positive is refused elsewhere, by name
    for name, size in sizes.items():
        if not SIZES[0] <= size <= SIZES[1]:
            raise StudyError(
                f"[model] {name} = {size:g} m: this is implausible for a {model.type}; check its unit"
            )
    _check_thickness(model.type, **sizes)


def _check_material(material: MaterialTable) -> None:
    stated = (material.E, material.density)
    if _solid(*stated, SPEEDS, DENSITIES):
        return
    found = f"[model.material] E = {material.E:g} Pa with density = {material.density:g} kg/m3"
    meant = _guess(*stated)
    if meant is None:
        raise StudyError(f'{found}: no solid has such values; check both, or write their units, as "210 GPa"')
    raise StudyError(
        f"{found}: no solid has such values; probably {meant} is meant: write it so, or in SI units"
    )


def _guess(modulus: float, density: float) -> str | None:
    """Return the units with which the numbers are those of a usual solid, one that is not SI before two."""
    pairs = sorted(product(MODULI, MASSES), key=lambda pair: (pair[0] != "Pa") + (pair[1] != "kg/m^3"))
    for one, other in pairs:
        found = modulus * si_value(f"1 {one}", "Pa"), density * si_value(f"1 {other}", "kg/m^3")
        if _solid(*found, USUAL_SPEEDS, USUAL_DENSITIES):
            stated = [f'E = "{modulus:g} {one}"'] if one != "Pa" else []
            stated += [f'density = "{density:g} {other}"'] if other != "kg/m^3" else []
            return " and ".join(stated) or None
    return None


def _solid(
    modulus: float, density: float, speeds: tuple[float, float], densities: tuple[float, float]
) -> bool:
    speed = math.sqrt(modulus / density) if density > 0 else math.inf
    return densities[0] <= density <= densities[1] and speeds[0] <= speed <= speeds[1]


def _check_thickness(kind: str, length: float, width: float, thickness: float) -> None:
    """See that a body is thinner than it is long (a plate: and wide)."""
    least = length if kind == "beam" else min(length, width)
    if length > SLENDER * thickness:
        raise StudyError(
            f"[model] length = {length:g} m is {length / thickness:.2g} times thickness = {thickness:g} m: no {kind} "
            "is that thin; check the units of both"
        )
    if thickness < least:
        return
    meant = f'; probably thickness = "{thickness:g} mm" is meant' if thickness < 1000 * least else ""
    raise StudyError(
        f"[model] thickness = {thickness:g} m on a {kind} of {length:g} x {width:g} m: a {kind} cannot be as thick "
        f"as it is {'long' if kind == 'beam' else 'long or wide'}{meant}"
    )
