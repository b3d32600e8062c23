"""Regions and node sets of imported matrices, on which effects act where there are no fields, by their names."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Sequence
from typing import TypeVar

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.effects.base import Values
from updating.effects.box import Place
from updating.models.fields import Sparse
from updating.models.imported.cords import Cords
from updating.models.imported.groups import Group, Joint, Support
from updating.models.spec import Spec
from updating.prediction.predict import Predictor

WAYS = ("x", "y", "z", "rx", "ry", "rz")
"""Directions along which, and about which, something acts at a node set."""

PLACED = ("region", "at", "joint", "support")
"""Values that name a place of the user's own model."""

Named = TypeVar("Named", Cords, Group, Joint, Support)


def stiff_regions(predictor: Predictor) -> tuple[str, ...]:
    """Return the names of the regions of imported matrices that have a stiffness of their own, each once."""
    imported = predictor.spec.imported
    return () if imported is None else _with_parts(predictor.spec, imported.stiffness_parts)


def heavy_regions(predictor: Predictor) -> tuple[str, ...]:
    """Return the names of the regions of imported matrices that have a mass of their own, each once."""
    imported = predictor.spec.imported
    return () if imported is None else _with_parts(predictor.spec, imported.mass_parts)


def _with_parts(spec: Spec, parts: Sequence[Sparse]) -> tuple[str, ...]:
    """Return the names of the regions whose part of a matrix has any entry, each once: springs have no mass."""
    named = zip(spec.regions, parts, strict=False)
    return tuple(dict.fromkeys(region.name for region, part in named if abs(part).max() > 0))


def named_places(values: Values) -> tuple[str, ...]:
    """Return the names of places of the user's own model among values; a number under such a label is no name."""
    return tuple(values[label] for label in PLACED if isinstance(values.get(label), str))


def regions_meant(spec: Spec, values: Values) -> tuple[int, ...]:
    """Return which regions are meant, by the name that they have in common or, from 0, by the number of one.

    Raises
    ------
    StudyError
        If there is none of that name.
    """
    stated, names = values.get("region"), [region.name for region in spec.regions]
    if isinstance(stated, str) and stated in names:
        return tuple(i for i, name in enumerate(names) if name == stated)
    if isinstance(stated, int | float) and stated == int(stated) and 0 <= stated < len(names):
        return (int(stated),)
    raise StudyError(f"region = {stated!r} is not one of the model's: {', '.join(dict.fromkeys(names))}")


def region_centre(predictor: Predictor, values: Values) -> Place:
    """Return the middle of a region, of several of one name that of all [m]."""
    spec, meant = predictor.spec, regions_meant(predictor.spec, values)
    boxes = [None if spec.imported is None else spec.imported.box(index) for index in meant]
    known = [box for box in boxes if box is not None]
    if known:
        low, high = np.min([box[0] for box in known], axis=0), np.max([box[1] for box in known], axis=0)
        x, y, z = ((low + high) / 2).tolist()
        return float(x), float(y), float(z)
    chosen = spec.regions[meant[0]]
    across = (0.0, spec.width) if chosen.y is None else chosen.y
    return (sum(chosen.x) / 2, sum(across) / 2, 0.0)


def one_of(known: Iterable[Named], values: Values, label: str) -> Named:
    """Return the node set, suspension, joint or support that a label names.

    Raises
    ------
    StudyError
        If there is none of that name.
    """
    found = {one.name: one for one in known}
    stated = values.get(label)
    if stated not in found:
        raise StudyError(
            f"{label} = {stated!r} is not one of the model's: {', '.join(found) or 'it has none'}"
        )
    return found[str(stated)]


def way(values: Values, label: str) -> int:
    """Return the direction, 0 to 2 along and 3 to 5 about an axis, that a label names.

    Raises
    ------
    StudyError
        If it is none.
    """
    stated = values.get(label)
    if stated not in WAYS:
        raise StudyError(f"{label} = {stated!r} is not a direction; use {', '.join(WAYS)}")
    return WAYS.index(str(stated))


def on_basis(predictor: Predictor, key: Hashable, full: Callable[[], Sparse]) -> FloatArray:
    """Return a matrix over all degrees of freedom on the basis, computed the first time it is asked for [SI]."""
    kept = predictor.reduced.kept
    if key not in kept:
        kept[key] = predictor.reduced.project(full())
    found: FloatArray = kept[key]
    return found


def centre_of(one: Group | Joint | Support) -> Place:
    """Return the middle of a node set, a joint or a support [m]."""
    x, y, z = one.centre.tolist()
    return float(x), float(y), float(z)
