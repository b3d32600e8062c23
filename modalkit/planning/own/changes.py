"""What might be changed about a test of a study's own model: and where two more points would help."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from modalkit.planning.changes import (
    Change,
    Gain,
    baseline,
    calibrated,
    careful,
    more_hits,
    sizes,
    wider,
)
from modalkit.planning.design import Design
from modalkit.planning.own.layout import Layout
from updating.diagnosis.next_test.instruments import Chain

MORE = 2
"""So many points are proposed."""


def own_changes(
    design: Design, layout: Layout, names: Sequence[str], above: float | None, hits: int, worth: Gain
) -> Iterator[Change]:
    """Give all changes that are worth a look.

    Parameters
    ----------
    design : Design
        The test as it is.
    layout : Layout
        Where it might be hit or seen.
    names : sequence of str
        Properties with a tolerance.
    above : float or None
        Frequency of the mode above the band, None where there is none [Hz].
    hits : int
        Hits at each point [-].
    worth : callable
        What a design is worth, for choosing points.
    """
    if design.shapes:
        yield from _drive_point(design, layout)
        yield from _points(design, layout, worth)
        if design.absolute and design.calibration > Chain.sigma and not design.baseline:
            yield calibrated(design)
    else:
        yield _shapes_too(design, layout)
    if not design.baseline:
        yield baseline(design)
        yield from sizes(design, names)
    if above is not None:
        yield wider(design, above)
    if design.repeatability:
        yield careful(design)
    yield more_hits(design, hits)


def _drive_point(design: Design, layout: Layout) -> Iterator[Change]:
    if layout.drive is None or layout.drive in design.stations:
        return
    where = "put the sensor at the hammer's point too" if layout.roving else "hit the sensor's own point too"
    there = replace(design, stations=(*design.stations, layout.drive))
    yield Change("drive point", f"{where}, the drive point", there)


def _points(design: Design, layout: Layout, worth: Gain) -> Iterator[Change]:
    """Choose points one after the other among the places that are spread over the structure."""
    first = len(layout.blank.points) - len(layout.spots)
    grown, added = design, []
    for _ in range(min(MORE, len(layout.spots))):
        left = [i for i in range(len(layout.spots)) if first + i not in grown.stations]
        tried = [replace(grown, stations=(*grown.stations, first + i)) for i in left]
        best = int(np.argmax([worth(one) for one in tried]))
        grown = tried[best]
        added.append(layout.spots[left[best]].name)
    if added:
        do = "add sensors at" if layout.roving else "hit"
        yield Change("points", f"{do} {len(added)} more places: {'; '.join(added)}", grown)


def _shapes_too(design: Design, layout: Layout) -> Change:
    """Measure at all points there are; where frequencies alone are known, at all the places that are tried."""
    where = layout.own or tuple(np.unique(layout.station).tolist())
    return Change(
        "shapes",
        f"measure FRFs with their level at {len(where)} points, not frequencies alone",
        replace(design, shapes=True, absolute=not layout.blank.bare, stations=where),
    )
