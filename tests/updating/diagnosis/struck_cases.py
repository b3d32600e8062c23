"""Hammer tests from the hits up, of a finer model than the candidates', with faults of the measurement in them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from updating_cases import BEAM, DOUBTS, PLATE, POINTS, blank

from acquisition import Dof, FrfSet, Geometry, HammerPlan, estimate_frfs, hammer_test, judge_hits
from identification import identify
from modalkit.workflow.joining import together
from updating import Axes, Case, Measured, Predictor, Spec, Tolerances, measured_from_identified
from updating.models.state import State
from updating.simulation import modal_system, simulated

GRID = np.array([[x, y] for x in (0.08, 0.16, 0.23, 0.3, 0.376) for y in (0.0, 0.06, 0.13, 0.2)])


@dataclass(frozen=True)
class Bench:
    """A specimen with its points, ready to be hit.

    Parameters
    ----------
    nominal, truth : Spec
        What the modeller thinks, and a finer model that stands for the specimen.
    points : (n, dim) array
        Nodes 1 to n, as stated [m].
    sensors : tuple of int
        Nodes of the fixed end: sensors, or the nodes hit where the accelerometer roves.
    band, rate, duration, width : floats
        Band [Hz], sampling rate [Hz], length of the records and of the pulse [s].
    """

    nominal: Spec
    truth: Spec
    points: np.ndarray
    sensors: tuple[int, ...]
    band: tuple[float, float]
    rate: float
    duration: float
    width: float


ROD = Bench(
    BEAM.with_elements(20), BEAM.with_elements(60), POINTS[:, None], (5,), (10.0, 1700.0), 5120.0, 1.6, 6e-4
)
SHEET = Bench(
    replace(PLATE, regions=()),
    replace(PLATE, elements=(16, 9), regions=()),
    GRID,
    (20,),
    (5.0, 480.0),
    1280.0,
    4.8,
    2e-3,
)


@dataclass(frozen=True)
class Faults:
    """What is wrong with the measurement.

    Parameters
    ----------
    gain, delay, decay : floats
        Factor of the level [-], lag of the responses [s], decay of a window that nobody took out [1/s].
    turned : tuple of int
        Nodes of the roving end hit, or mounted, the other way round.
    exchanged : tuple of int
        Two nodes of the roving end that bear each other's label.
    moved : mapping of int to tuple
        How far from its place a node of the roving end was hit, or mounted [m].
    upside_down : tuple of int
        Nodes of the fixed end whose signs are reversed.
    louder, louder_still : mappings of int to float
        Factors of the level at nodes of the roving end, and of the fixed one [-].
    """

    gain: float = 1.0
    delay: float = 0.0
    decay: float = 0.0
    turned: tuple[int, ...] = ()
    exchanged: tuple[int, ...] = ()
    moved: Mapping[int, tuple[float, ...]] = field(default_factory=dict)
    upside_down: tuple[int, ...] = ()
    louder: Mapping[int, float] = field(default_factory=dict)
    louder_still: Mapping[int, float] = field(default_factory=dict)


Roving = Literal["hammer", "accelerometer"]


def struck_case(
    bench: Bench,
    faults: Faults,
    *,
    seed: int,
    roving: Roving = "hammer",
    sensors: tuple[int, ...] | None = None,
    baseline: bool = False,
) -> Case:
    """Hit a specimen within its tolerances; with a baseline, hit it before without the faults as well."""
    bench = bench if sensors is None else replace(bench, sensors=sensors)
    rng = np.random.default_rng(seed)
    off = State(
        factors={n: float(np.exp(s * rng.standard_normal())) for n, s in DOUBTS.items()},
        ratios=tuple(_ratios(bench, rng)),
    )
    before = _measured(bench, off, Faults(), roving, rng) if baseline else None
    after = _measured(bench, off, faults, roving, rng)
    return Case("specimen", bench.nominal, after, baseline=before, tolerances=Tolerances(DOUBTS))


def _ratios(bench: Bench, rng: np.random.Generator) -> np.ndarray:
    """Damping ratios by mode that are off what the model expects by a fifth."""
    omega = 2 * np.pi * Predictor(bench.truth, blank(np.squeeze(bench.points))).predict(count=14).frequency
    stated = bench.truth.damping
    expected = 0.5 * (stated.alpha / omega + stated.beta * omega)
    return np.asarray(expected * np.exp(0.2 * rng.standard_normal(14)))


def _measured(bench: Bench, off: State, faults: Faults, roving: Roving, rng: np.random.Generator) -> Measured:
    frfs = hits_to_frfs(bench, off, faults, roving, rng)
    stated = frfs.decay - faults.decay  # the analyst takes out what he knows of
    modal = identify(replace(frfs, decay=stated), band=bench.band)
    return measured_from_identified(modal, Axes(), bench.nominal)


def hits_to_frfs(
    bench: Bench, off: State, faults: Faults, roving: Roving, rng: np.random.Generator
) -> FrfSet:
    """Carry the hammer test out, one fixed place and one record per hit, and label its FRFs."""
    count = len(bench.points)
    true = bench.points.copy()
    for node, away in faults.moved.items():
        true[node - 1] += np.asarray(away)
    for a, b in zip(faults.exchanged[::2], faults.exchanged[1::2], strict=True):
        true[[a - 1, b - 1]] = true[[b - 1, a - 1]]
    fixed = [int(s) - 1 for s in bench.sensors]
    model = simulated(
        Predictor(bench.truth, blank(np.squeeze(bench.points))),
        off,
        points=np.vstack([true, bench.points[fixed]]),
    )
    ends, names = np.arange(count), tuple(Dof(i + 1, 3) for i in range(count))
    places, stay = count + np.arange(len(fixed)), tuple(Dof(s, 3) for s in bench.sensors)
    flat = np.zeros((count, 3))
    flat[:, : true.shape[1]] = bench.points
    geometry = Geometry(tuple(range(1, count + 1)), flat)
    plan = HammerPlan(
        rate=bench.rate, samples=round(bench.rate * bench.duration), hits=3, width=bench.width, response_noise=3e-4,
        position_sigma=5e-4, decay=3.0 + faults.decay, gain=faults.gain, delay=faults.delay, pre_trigger=0.02,
    )  # fmt: skip
    if roving == "hammer":
        system = modal_system(model, seen=places, hit=ends, responses=stay, points=names)
        tests = [hammer_test(system, plan, rng=rng, geometry=geometry)]
    else:
        tests = [
            hammer_test(
                modal_system(model, seen=ends[[i]], hit=places, responses=(names[i],), points=stay),
                plan,
                rng=rng,
                geometry=geometry,
            )
            for i in range(count)
        ]
    sets = [estimate_frfs(test, verdicts=judge_hits(test)) for test in tests]
    whole = together(sets).band(0.0, bench.rate / 2.56)
    moving = whole.references if roving == "hammer" else whole.responses
    still = whole.responses if roving == "hammer" else whole.references
    signs = [
        (-1.0 if m.node in faults.turned else 1.0)
        * (-1.0 if s.node in faults.upside_down else 1.0)
        * faults.louder.get(m.node, 1.0)
        * faults.louder_still.get(s.node, 1.0)
        for m, s in zip(moving, still, strict=True)
    ]
    return replace(whole, values=whole.values * np.array(signs)[:, None])
