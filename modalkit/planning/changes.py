"""What might be changed about a test: where to hit, how well to calibrate, what to test before, how wide, how often.

What an instrument reaches is that of the readings which a diagnosis proposes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition.quantities import number
from modalkit.planning.design import Design
from updating.diagnosis.next_test.instruments import Caliper, Chain, Weigh

HITS = 4
"""So many times more hits."""

CARE = 2.5
"""So many times better a repeatability: the same torque, the same temperature."""

ABOVE = 1.1
"""A band reaches so far above the mode that is to be in it [-]."""


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
    """

    key: str
    measure: str
    design: Design


Gain = Callable[[Design], float]
"""What a design is worth."""


def calibrated(design: Design) -> Change:
    """Calibrate the chain."""
    return Change(
        "calibration",
        f"calibrate the chain with a known free mass: level to {100 * Chain.sigma:g} % "
        f"instead of {100 * design.calibration:g} %",
        replace(design, calibration=Chain.sigma),
    )


def baseline(design: Design) -> Change:
    """Test the same structure before."""
    return Change(
        "baseline",
        "test the same structure in another state (before the change) as a baseline",
        replace(design, baseline=True),
    )


def sizes(design: Design, names: Sequence[str]) -> Iterator[Change]:
    """Weigh, and gauge what has a thickness; ``names`` are the properties with a tolerance."""
    reached = {"thickness": Caliper.sigma, "width": Caliper.sigma, "density": Weigh.sigma}
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
    )


def wider(design: Design, above: float) -> Change:
    """Look at the mode above the band too, at ``above`` [Hz]."""
    return Change(
        "band",
        f"widen the band to {number(ABOVE * above)} Hz (one more mode, at {above:.0f} Hz)",
        replace(design, modes=design.modes + 1),
    )


def careful(design: Design) -> Change:
    """Mount with care."""
    better = design.repeatability / CARE
    return Change(
        "repeatability",
        f"mount with care (same torque, same temperature): frequencies repeat to {100 * better:.2g} % "
        f"instead of {100 * design.repeatability:.2g} %",
        replace(design, repeatability=better),
    )


def more_hits(design: Design, hits: int) -> Change:
    """Hit each point more often than ``hits`` times."""
    return Change(
        "hits",
        f"hit each point {HITS * hits} times instead of {hits}",
        replace(design, noise=design.noise / np.sqrt(HITS)),
    )
