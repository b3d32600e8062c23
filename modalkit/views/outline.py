"""What is known of a structure in a plane: its edges, zones with their probabilities, test points and sensors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray
from updating import Case, Diagnosis


@dataclass(frozen=True, eq=False, kw_only=True)
class Outline:
    """What is drawn of a structure.

    Parameters
    ----------
    length, width : float
        Size along x and y; ``width`` is 0 for a beam [m].
    zones : list of (x0, x1, y0, y1, probability)
        Regions [m, m, m, m, -].
    names : list of str
        Theirs.
    points : (n, 2) array
        Test points [m].
    sensors : (n, 2) array
        Those that carry a transducer [m].
    clamped : tuple of str
        Clamped edges.
    """

    length: float
    width: float
    zones: list[tuple[float, float, float, float, float]]
    names: list[str]
    points: FloatArray
    sensors: FloatArray
    clamped: tuple[str, ...]

    @property
    def even(self) -> bool:
        """Whether no zone stands out."""
        values = [zone[4] / ((zone[1] - zone[0]) * max(zone[3] - zone[2], 1e-9)) for zone in self.zones]
        return not values or bool(max(values) < 1.5 * np.mean(values))


def outline(diagnosis: Diagnosis, case: Case | None) -> Outline:
    """Gather what is known of a beam or a plate; without a case, what the zones' centres show."""
    found = {zone.name: zone.probability for zone in diagnosis.where.zones}
    if case is None:
        return _from_centres(diagnosis)
    spec, test = case.spec, case.measured
    width = spec.width if spec.kind == "plate" else 0.0
    zones = [(*r.x, *(r.y or (0.0, width)), found.get(r.name, 0.0)) for r in spec.regions]
    points = np.zeros((len(test.points), 2))
    points[:, : test.points.shape[1]] = test.points
    return Outline(
        length=spec.length,
        width=width,
        zones=zones,
        names=[r.name for r in spec.regions],
        points=points,
        sensors=points[list(test.sensors)],
        clamped=spec.clamped,
    )


def _from_centres(diagnosis: Diagnosis) -> Outline:
    zones = diagnosis.where.zones
    x = _edges([z.center[0] for z in zones])
    flat = len({z.center[1] for z in zones}) < 2
    y = {0.0: (0.0, 0.0)} if flat else _edges([z.center[1] for z in zones])
    cells = [(*x[z.center[0]], *(y[0.0] if flat else y[z.center[1]]), z.probability) for z in zones]
    length, width = max((c[1] for c in cells), default=1.0), max((c[3] for c in cells), default=0.0)
    return Outline(
        length=length,
        width=width,
        zones=cells,
        names=[z.name for z in zones],
        points=np.zeros((0, 2)),
        sensors=np.zeros((0, 2)),
        clamped=(),
    )


def _edges(centres: list[float]) -> dict[float, tuple[float, float]]:
    """Return the limits about each centre, halfway to its neighbours, the first and last symmetric."""
    values = np.unique(centres)
    if len(values) < 2:
        return {float(v): (0.0, 2 * float(v) or 1.0) for v in values}
    middle = (values[1:] + values[:-1]) / 2
    low = np.r_[2 * values[0] - middle[0], middle]
    high = np.r_[middle, 2 * values[-1] - middle[-1]]
    return {float(v): (float(a), float(b)) for v, a, b in zip(values, low, high, strict=True)}
