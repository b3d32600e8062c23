"""Factors by name: of the whole structure, ``E``, or of the regions of one name, ``web.E``."""

from __future__ import annotations

from collections.abc import Mapping

from updating.models.spec import Spec
from updating.models.state import State

UNASSIGNED = "unassigned"
"""What stands for a region's name where imported matrices hold more than the sum of their parts.

That may be steel which is not listed, and follow the modulus of the whole; or bolts, feet and lumped machines, which
do not. A factor of its own, beside that of the whole, leaves both open.
"""


def unassigned(spec: Spec) -> tuple[str, ...]:
    """Return the factors of what imported matrices hold in no region, none where that is nothing."""
    found = () if spec.imported is None else spec.imported.unassigned
    named = {region.name for region in spec.regions}
    return () if UNASSIGNED in named else tuple(f"{UNASSIGNED}.{factor}" for factor in found)


def regions_of(spec: Spec, name: str) -> tuple[tuple[int, ...], str]:
    """Return the regions that a factor is of, none for the whole structure, and which property it scales.

    What imported matrices hold in no region comes after all regions.
    """
    region, _, factor = name.rpartition(".")
    if name in unassigned(spec):
        return (len(spec.regions),), factor
    return tuple(i for i, r in enumerate(spec.regions) if region and r.name == region), factor


def carried_masses(spec: Spec) -> dict[str, str]:
    """Return the supports of imported matrices by the name of the doubt in the mass that each carries along."""
    supports = () if spec.imported is None else spec.imported.supports
    return {f"{support.name}.carried": support.name for support in supports}


def departure(spec: Spec, values: Mapping[str, float]) -> State:
    """Return the departure that factors by their names are [-]."""
    whole = {name: value for name, value in values.items() if "." not in name}
    regional = {
        (i, factor): value
        for name, value in values.items()
        for regions, factor in [regions_of(spec, name)]
        for i in regions
    }
    return State(factors=whole, regional=regional)
