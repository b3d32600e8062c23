"""A user's own structure in space: regions with their probability, test points with directions, the places found."""

from __future__ import annotations

from typing import Any

import numpy as np

from modalkit.views.mesh import edges_of, mesh_of
from updating import Case, Diagnosis


def structure_page(diagnosis: Diagnosis, case: Case) -> dict[str, Any] | None:
    """Return the structure in the model's axes; None for beams and plates.

    Parameters
    ----------
    diagnosis : Diagnosis
        The answer.
    case : Case
        What was diagnosed.
    """
    mesh = mesh_of(case.spec)
    if mesh is None:
        return None
    found = {zone.name: zone.probability for zone in diagnosis.where.zones}
    names = [region.name for region in case.spec.regions]
    held = [None if diagnosis.verdict == "none" else found.get(name) for name in names]
    test = case.measured
    along = test.directions if test.directions is not None else [None] * len(test.nodes)
    sits = diagnosis.verdict in ("named", "class")
    return {
        "places": mesh.places,
        "lines": mesh.lines,
        "faces": mesh.faces,
        "edges": edges_of(mesh.faces),
        "values": [held[k] if 0 <= k < len(held) else None for k in mesh.region],
        "regions": [names[k] if 0 <= k < len(names) else "" for k in mesh.region],
        "points": [
            {"name": f"point {node}", "place": _in_space(place), "to": None if to is None else np.asarray(to)}
            for node, place, to in zip(test.nodes, test.points, along, strict=True)
        ],
        "found": [list(at) for at in diagnosis.where.locations] if sits else [],
    }


def _in_space(place: Any) -> list[float]:
    """Return a place with three coordinates."""
    return [*map(float, place), 0.0, 0.0][:3]
