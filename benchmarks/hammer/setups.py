"""A structure and how it is tested: noise, filter, converter, place of the hits, drift."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from acquisition import Dof, FrfSet, HammerTest
from acquisition.synthetic import HammerPlan, ModalSystem, modal_system
from hammer.bodies import Body


@dataclass(frozen=True, eq=False)
class Setup:
    """A structure and how it is tested."""

    system: ModalSystem
    plan: HammerPlan
    band: tuple[float, float]
    analyser: Callable[[HammerTest], HammerTest] = lambda test: test
    """What is done to the records before they are stored."""

    stated: float = 0.0
    """Decay of a window of the analyser, which the user states [1/s]."""

    at_hit: Callable[[int, int, float], ModalSystem] | None = None
    """System at point, hit and level [N], where it is not the same at all."""

    by_levels: bool = False
    """Identified from the hits of each level, not from FRFs alone."""

    without_hits: Callable[..., tuple[FrfSet, NDArray[np.bool_]]] | None = None
    """Maker of FRFs that come without hits, and of which modes are well inside the band."""


def set_up(rng: np.random.Generator, body: Body, seats: NDArray[np.int64], hit: NDArray[np.int64]) -> Setup:
    """Put structure and test together: noise, filter, converter, place of the hits, drift."""
    zeta = body.damping * np.exp(0.7 * rng.standard_normal(len(body.hertz)))
    system = modal_system(
        frequency=body.hertz, damping=zeta, response_shapes=body.shapes[seats], point_shapes=body.shapes[hit],
        responses=[Dof(int(k) + 1, 3) for k in seats], points=[Dof(int(k) + 1, 3) for k in hit],
    )  # fmt: skip
    both = np.stack(
        [np.einsum("im,jm->ijm", body.shapes[seats], s[hit]) / (2j * system.poles.imag) for s in body.slopes]
    )
    rate = 2.0 ** np.ceil(np.log2(2.56 * body.top))
    slowest = float((zeta * 2 * np.pi * body.hertz)[body.hertz < body.top].min())
    duration = float(np.clip(2.0 ** np.ceil(np.log2(4.6 / slowest)), 1.0, 4.0))
    peak = float(rng.uniform(40.0, 150.0))
    plan = HammerPlan(
        rate=rate, samples=int(rate * duration), hits=int(rng.integers(3, 8)), peak=peak,
        width=float(rng.uniform(0.5, 1.2)) / body.top, pre_trigger=0.01, jitter=1e-4,
        decay=max(0.0, 4.6 / duration - slowest),
        force_noise=peak * 10 ** rng.uniform(-4.0, -2.5), response_noise=10 ** rng.uniform(-4.0, -2.0),
        adc_bits=int(rng.choice([16, 24])), position_sigma=float(rng.uniform(3e-4, 1e-3)), drift=5e-5,
        anti_alias="sharp",
    )  # fmt: skip
    return Setup(replace(system, gradients=both), plan, (max(5.0, 0.3 * float(body.hertz[0])), body.top))


def roving_hammer(rng: np.random.Generator, body: Body, sensors: int) -> Setup:
    """Hit a body at all points, with accelerometers at some of the later ones."""
    later = np.arange(len(body.shapes) // 2, len(body.shapes))
    return set_up(rng, body, rng.choice(later, sensors, replace=False), np.arange(len(body.shapes)))
