"""What might be changed about a test of a study's own model: and where two more points would help."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from modalkit.planning.changes import (
    ABOVE,
    CALIBRATED,
    CARE,
    HITS,
    MASS_KNOWN,
    MICROMETER,
    Change,
    Gain,
)
from modalkit.planning.design import Design
from modalkit.planning.own.layout import Layout

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
        if layout.drive is not None and layout.drive not in design.stations:
            where = (
                "put the sensor at the hammer's point too"
                if layout.roving
                else "hit the sensor's own point too"
            )
            yield Change(
                "drive point",
                f"{where}, the drive point",
                replace(design, stations=(*design.stations, layout.drive)),
            )
        yield from _points(design, layout, worth)
        if design.absolute and design.calibration > CALIBRATED and not design.baseline:
            yield Change(
                "calibration",
                f"calibrate the chain with a known free mass: level to {100 * CALIBRATED:g} % instead of "
                f"{100 * design.calibration:g} %",
                replace(design, calibration=CALIBRATED),
            )
    else:
        yield from _shapes_too(design, layout)
    if not design.baseline:
        yield Change(
            "baseline",
            "test the same structure in another state (before the change) as a baseline",
            replace(design, baseline=True),
        )
        yield from _sizes(design, names)
    if above is not None:
        yield Change(
            "band",
            f"widen the band to {ABOVE * above:.3g} Hz: one more mode, at {above:.0f} Hz",
            replace(design, modes=design.modes + 1),
        )
    if design.repeatability:
        better = design.repeatability / CARE
        yield Change(
            "repeatability",
            f"mount with care (same torque, same temperature): frequencies repeat to {100 * better:.2g} % instead of "
            f"{100 * design.repeatability:.2g} %",
            replace(design, repeatability=better),
        )
    yield Change(
        "hits",
        f"hit each point {HITS * hits} times instead of {hits}",
        replace(design, noise=design.noise / np.sqrt(HITS)),
    )


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


def _shapes_too(design: Design, layout: Layout) -> Iterator[Change]:
    """Measure at all points there are; where frequencies alone are known, at all the places that are tried."""
    where = layout.own or tuple(np.unique(layout.station).tolist())
    yield Change(
        "shapes",
        f"measure FRFs with their level at {len(where)} points, not frequencies alone",
        replace(design, shapes=True, absolute=not layout.blank.bare, stations=where),
    )


def _sizes(design: Design, names: Sequence[str]) -> Iterator[Change]:
    """Weigh, and gauge what has a thickness."""
    reached = {"thickness": MICROMETER, "width": MICROMETER, "density": MASS_KNOWN}
    better = tuple(min(reached.get(n, s), s) for n, s in zip(names, design.tolerances, strict=True))
    if better == design.tolerances:
        return
    words = [
        f"{n} to {100 * reached[n]:g} %"
        for n, s in zip(names, design.tolerances, strict=True)
        if s > reached.get(n, s)
    ]
    do = "weigh and gauge" if any(n in ("thickness", "width") for n in names) else "weigh"
    yield Change("sizes", f"{do} the specimen: {', '.join(words)}", replace(design, tolerances=better))
