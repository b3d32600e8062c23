"""One test from its draw to its count: simulated, identified, compared with the truth."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from acquisition import (
    FrfSet,
    HammerTest,
    UffContent,
    Windows,
    apply_windows,
    decide,
    estimate_frfs,
    hammer_test,
    judge_hits,
    pulses_alone,
    state_window,
)
from acquisition.errors import EstimationError
from acquisition.synthetic import ModalSystem
from hammer.counts import Outcome, counted
from hammer.kinds import DRAWN
from hammer.setups import Setup
from identification import ModalModel, identify
from identification.levels.hits import used_hits
from modalkit.workflow.identification import from_content
from modalkit.workflow.processing_options import ProcessingOptions

Trial = tuple[NDArray[np.bool_], Callable[[], ModalModel]]
"""Which modes stand out, and what identifies the test."""


def judged(kind: str, seed: int) -> Outcome:
    """Simulate one test, identify it and count."""
    setup = DRAWN[kind](np.random.default_rng([seed, list(DRAWN).index(kind)]))
    out, identified = _on_lines(setup, seed) if setup.without_hits else _by_hits(setup, seed)
    began = time.process_time()
    try:
        model = identified()
    except EstimationError as error:
        hertz = np.abs(setup.system.poles[out]) / (2 * np.pi)
        print(f"  {kind} {seed}: {error}")
        return Outcome(
            kind=kind,
            seed=seed,
            modes=int(out.sum()),
            found=0,
            missed=hertz.tolist(),
            invented=[],
            frequency_inside=0,
            damping_inside=0,
            frequency_z=[],
            damping_z=[],
            level=np.nan,
            cpu=0.0,
        )
    cpu = time.process_time() - began
    if model.levels is not None and setup.at_hit is not None:
        setup = replace(setup, system=setup.at_hit(0, 0, model.levels.level / _recorded(setup, seed)))
    return counted(kind, seed, setup, out, model, cpu)


def _by_hits(setup: Setup, seed: int) -> Trial:
    test, frfs = measured(setup, np.random.default_rng([seed, 1]))
    clean = estimate_frfs(apply_windows(_still(setup, seed), Windows(decay=setup.stated)))
    out = standing_out(setup, frfs, clean)
    if setup.by_levels:
        return out, lambda: _modes(test, setup)
    return out, lambda: identify(frfs, band=setup.band)


def _on_lines(setup: Setup, seed: int) -> Trial:
    """Make FRFs of a kind that has no hits; all modes well inside the band stand out."""
    assert setup.without_hits is not None
    top = 2 * np.pi * setup.band[1]
    true = setup.system.poles[setup.system.poles.imag < top]
    frfs, inside = setup.without_hits(setup.system, true, setup.band, np.random.default_rng([seed, 1]))
    return inside & (np.abs(setup.system.poles) < 0.97 * top), lambda: identify(frfs)


def _still(setup: Setup, seed: int) -> HammerTest:
    """Hit it once a point, without noise."""
    quiet = replace(
        setup.plan, force_noise=0.0, response_noise=0.0, adc_bits=None, position_sigma=0.0, drift=0.0, hits=1
    )
    return hammer_test(setup.system, quiet, rng=np.random.default_rng([seed, 1]))


def _recorded(setup: Setup, seed: int) -> float:
    """Return the mean peak that is recorded over that of the force, of the hits themselves: a filter lowers it [-]."""
    true: dict[tuple[int, int], float] = {}

    def listened(point: int, hit: int, level: float) -> ModalSystem:
        true[point, hit] = level
        return setup.system

    quiet = replace(setup.plan, force_noise=0.0, response_noise=0.0, adc_bits=None)
    test = hammer_test(setup.system, quiet, rng=np.random.default_rng([seed, 1]), at_hit=listened)
    recorded = [h.levels for h in used_hits([(test, ())])]
    return float(np.mean(np.concatenate(recorded)) / np.mean(list(true.values())))


def _modes(test: HammerTest, setup: Setup) -> ModalModel:
    """Identify from the hits, with what their levels show."""
    processed = from_content(UffContent(tests=(test,)), [Path("synthetic")], ProcessingOptions())
    return processed.identify(band=setup.band)


def measured(setup: Setup, rng: np.random.Generator) -> tuple[HammerTest, FrfSet]:
    """Hit it, judge the hits and estimate FRFs."""
    test = setup.analyser(hammer_test(setup.system, setup.plan, rng=rng, at_hit=setup.at_hit))
    stated, _ = state_window(test, decay=setup.stated)
    verdicts = decide(judge_hits(stated))
    return test, estimate_frfs(pulses_alone(stated)[0], verdicts=verdicts)


def standing_out(setup: Setup, frfs: FrfSet, clean: FrfSet) -> NDArray[np.bool_]:
    """Tell which modes stand ten times above the noise at their own peak, in the middle one of all FRFs."""
    poles, decay = setup.system.poles, setup.plan.decay + setup.stated
    hertz = np.abs(poles) / (2 * np.pi)
    lines = np.searchsorted(frfs.frequency, hertz).clip(0, len(frfs.frequency) - 1)
    residues = np.concatenate([setup.system.residues[:, j] for j in range(setup.system.residues.shape[1])])
    peak = np.abs(residues) * np.abs(poles) ** 2 / (decay - poles.real)
    noise = np.abs(frfs.values - clean.values) ** 2
    near = np.stack([noise[:, max(0, k - 10) : k + 11].mean(axis=1) for k in lines], axis=1)
    margin = 2.0 / setup.plan.samples * setup.plan.rate
    inside = (hertz > setup.band[0] + margin) & (hertz < setup.band[1] - margin)
    return np.asarray(inside & (np.median(peak**2 / near, axis=0) > 10.0))
