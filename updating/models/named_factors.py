"""Factors by name: of the whole structure, ``E``, or of the regions of one name, ``web.E``."""

from __future__ import annotations

from collections.abc import Mapping

from updating.models.spec import Spec
from updating.models.state import State


def regions_of(spec: Spec, name: str) -> tuple[tuple[int, ...], str]:
    """Return the regions that a factor is of, none for the whole structure, and which property it scales."""
    region, _, factor = name.rpartition(".")
    return tuple(i for i, r in enumerate(spec.regions) if region and r.name == region), factor


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
