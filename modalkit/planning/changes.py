"""What might be changed about a test: where to hit, how well to calibrate, what to test before, how wide, how often."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from modalkit.planning.design import Design
from modalkit.planning.responses import TOLERANCES, Stations
from modalkit.simulator.setup import Setup, Tolerances

CALIBRATED = 0.005
"""What a calibration with a known free mass reaches, relative [-]."""

MICROMETER = 0.002
"""What a micrometer reaches on thickness and width, relative [-]."""

MASS_KNOWN = 0.001
"""What weighing, with the dimensions known, reaches on the density, relative [-]."""

HITS = 4
"""So many times more hits."""

CARE = 2.5
"""So many times better a repeatability: the same torque, the same temperature."""

MORE_POINTS = 3
"""So many points are proposed."""

ABOVE = 1.1
"""A band reaches so far above the mode that is to be in it [-]."""


def unchanged(setup: Setup) -> Setup:
    """Return a setup as it is: what is no rig's is not followed there."""
    return setup


@dataclass(frozen=True, eq=False)
class Change:
    """One change of a test.

    Parameters
    ----------
    key : str
        Short name.
    measure : str
        What to do.
    design : Design
        The test then.
    follow : callable
        Setup before to setup after, for trials on the rig.
    """

    key: str
    measure: str
    design: Design
    follow: Callable[[Setup], Setup] = unchanged


Gain = Callable[[Design], float]
"""What a design is worth."""


def changes(design: Design, stations: Stations, worth: Gain) -> Iterator[Change]:
    """Give all changes that are worth a look.

    Parameters
    ----------
    design : Design
        The test as it is.
    stations : Stations
        Where it might be hit, and the setup.
    worth : callable
        What a design is worth, for choosing points.
    """
    setup = stations.test
    if design.shapes:
        yield from _points(design, stations, worth)
        if design.calibration > CALIBRATED and not design.baseline:
            yield calibrated(design)
    else:
        yield _shapes_too(design)
    if not design.baseline:
        yield baseline(design)
        yield from sizes(design, TOLERANCES)
    yield wider(design, float(np.exp(stations.nominal[design.modes])) / (2 * np.pi))
    if design.repeatability:
        yield careful(design)
    yield more_hits(design, setup.hits)


def _points(design: Design, stations: Stations, worth: Gain) -> Iterator[Change]:
    setup = stations.test
    if setup.sensor not in design.stations:
        at = f"x = {1e3 * setup.points[setup.sensor][0]:.0f} mm"
        yield Change(
            "drive point",
            f"hit the sensor's own point too, the drive point ({at})",
            replace(design, stations=(*design.stations, setup.sensor)),
            lambda s: replace(s, drive=True),
        )
    grown, added = design, []
    for _ in range(MORE_POINTS):
        left = [i for i in range(stations.own, len(stations.x)) if i not in grown.stations]
        if not left:
            break
        tried = [replace(grown, stations=(*grown.stations, i)) for i in left]
        best = int(np.argmax([worth(one) for one in tried]))
        grown = tried[best]
        added.append(round(float(stations.x[left[best]]), 4))
    if added:
        where = ", ".join(f"{1e3 * x:.0f}" for x in sorted(added))
        yield Change(
            "points",
            f"hit {len(added)} more points, at x = {where} mm",
            grown,
            lambda s: replace(s, points=(*s.points, *((x,) for x in added))),
        )


def calibrated(design: Design) -> Change:
    """Calibrate the chain."""
    return Change(
        "calibration",
        f"calibrate the chain with a known free mass: level to {100 * CALIBRATED:g} % "
        f"instead of {100 * design.calibration:g} %",
        replace(design, calibration=CALIBRATED),
        lambda s: replace(s, calibration=CALIBRATED),
    )


def _shapes_too(design: Design) -> Change:
    return Change(
        "shapes",
        "measure FRFs with their level at all the points, not frequencies alone",
        replace(design, shapes=True, absolute=True),
        lambda s: s,
    )


def baseline(design: Design) -> Change:
    """Test the same structure before."""
    return Change(
        "baseline",
        "test the same structure in another state (before the change) as a baseline",
        replace(design, baseline=True),
        lambda s: replace(s, baseline=True),
    )


def sizes(design: Design, names: Sequence[str]) -> Iterator[Change]:
    """Weigh, and gauge what has a thickness; ``names`` are the properties with a tolerance."""
    reached = {"thickness": MICROMETER, "width": MICROMETER, "density": MASS_KNOWN}
    now = dict(zip(names, design.tolerances, strict=True))
    better = {name: min(reached.get(name, sigma), sigma) for name, sigma in now.items()}
    if better == now:
        return
    words = [f"{name} to {100 * value:g} %" for name, value in reached.items() if now.get(name, 0.0) > value]
    do = "weigh and gauge" if {"thickness", "width"} & set(names) else "weigh"
    yield Change(
        "sizes",
        f"{do} the specimen: {', '.join(words)}",
        replace(design, tolerances=tuple(better.values())),
        lambda s: replace(s, tolerances=Tolerances(**better, damping=s.tolerances.damping)),
    )


def wider(design: Design, above: float) -> Change:
    """Look at the mode above the band too, at ``above`` [Hz]."""

    def follow(setup: Setup) -> Setup:
        top = float(f"{ABOVE * above:.3g}")
        return replace(setup, modes=setup.modes + 1, band=(setup.band[0], top))

    return Change(
        "band",
        f"widen the band to {ABOVE * above:.3g} Hz: one more mode, at {above:.0f} Hz",
        replace(design, modes=design.modes + 1),
        follow,
    )


def careful(design: Design) -> Change:
    """Mount with care."""
    better = design.repeatability / CARE
    return Change(
        "repeatability",
        f"mount with care (same torque, same temperature): frequencies repeat to {100 * better:.2g} % "
        f"instead of {100 * design.repeatability:.2g} %",
        replace(design, repeatability=better),
        lambda s: replace(s, repeatability=s.repeatability / CARE),
    )


def more_hits(design: Design, hits: int) -> Change:
    """Hit each point more often than ``hits`` times."""
    return Change(
        "hits",
        f"hit each point {HITS * hits} times instead of {hits}",
        replace(design, noise=design.noise / np.sqrt(HITS)),
        lambda s: replace(s, hits=HITS * s.hits),
    )
