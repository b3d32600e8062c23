"""Intervals of an update by FRFs from tests that might have been."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.display import Displayed
from acquisition.errors import StudyError
from updating.case import Case
from updating.frf_update.columns import columns
from updating.frf_update.evaluation import Evaluation, evaluate
from updating.frf_update.mounting import resonances, shifted
from updating.frf_update.report import report
from updating.frf_update.result import FrfUpdate
from updating.frf_update.run import solve_stages
from updating.frf_update.solve import CONVERGED, descend
from updating.frf_update.stage import Stage
from updating.frf_update.step import Step, last_steps
from updating.models.state import NOMINAL, combine
from updating.steps import SILENT, Steps
from updating.test_data.measured_frfs import MeasuredFrfs
from updating.update.intervals import check_draws, with_intervals

ROUNDS = 2
"""How often the stages are gone through for each draw, from the solution of the data at hand."""

STEPS = 4
"""Largest number of iterations of a stage for a draw: draws lie near the data."""


@dataclass(frozen=True, eq=False)
class FrfBootstrap(Displayed):
    """An update by FRFs and its repetitions.

    Parameters
    ----------
    update : FrfUpdate
        The update of the data at hand, whose parameters carry percentile intervals.
    values : (n, p) array
        Factors and values of the parameters of every draw.
    """

    update: FrfUpdate
    values: FloatArray


def bootstrap_frf_update(
    case: Case,
    frfs: MeasuredFrfs,
    *,
    rng: np.random.Generator,
    n: int = 100,
    draws: Iterable[MeasuredFrfs] | None = None,
    parameters: Sequence[str] = (),
    stages: Sequence[Sequence[str]] | None = None,
    lines: int | Sequence[float] | None = None,
    steps: Steps = SILENT,
) -> FrfBootstrap:
    """Update, then update again from FRFs drawn anew: of the hits where they are given, else from the noise.

    The level of each draw is scattered by the calibration, its resonances by mounting the structure anew. What the
    model cannot follow stays as it is in all draws: the intervals cover the scatter of the measurement, and where
    there is a discrepancy they are the narrower ones; the standard deviations of the parameters allow for it.

    Parameters
    ----------
    case, frfs, parameters, stages, lines
        As for :func:`updating.frf_update.update_frfs`.
    rng : numpy.random.Generator
        Source of the draws.
    n : int
        Number of draws [-].
    draws : iterable of MeasuredFrfs, optional
        FRFs from hits drawn anew, on the lines of ``frfs``; left out, the variance of ``frfs`` is drawn.
    steps : Steps
        Where it is announced how many draws are updated.

    Raises
    ------
    StudyError
        If there are fewer than twenty draws.
    """
    check_draws(n, better=100)
    specimen, _, solved = solve_stages(case, frfs, parameters, stages, lines)
    found = report(specimen, frfs, solved)
    last = last_steps(solved)
    whole = _whole(last, frfs)
    source = _from_noise(frfs, rng, n) if draws is None else draws
    test = case.measured
    values = np.array(
        [
            _repeat(
                last, frfs, _levelled(_mounted(draw, whole, rng, test.repeatability), rng, test.calibration)
            )
            for draw, _ in zip(source, steps.each(range(n)), strict=False)
        ]
    )
    if len(values) < n:
        raise StudyError(f"bootstrap: {len(values)} draws were given and {n} asked for")
    turned = [k for step in last for k in step.stage.model_parameters]
    estimates = with_intervals(found.parameters, values, turned)
    return FrfBootstrap(replace(found, parameters=estimates, draws=n), values)


def _from_noise(frfs: MeasuredFrfs, rng: np.random.Generator, n: int) -> Iterable[MeasuredFrfs]:
    for _ in range(n):
        scatter = rng.standard_normal(frfs.values.shape) + 1j * rng.standard_normal(frfs.values.shape)
        yield replace(frfs, values=frfs.values + np.sqrt(frfs.variance / 2) * scatter)


def _whole(last: Sequence[Step], frfs: MeasuredFrfs) -> Evaluation:
    """Return the updated model on all lines."""
    stage = last[-1].stage
    state = replace(combine([s.own for s in last]), ratios=stage.earlier.ratios)
    return evaluate(stage.predictor, state, columns(frfs), frfs.laplace, order=frfs.order)


def _mounted(
    frfs: MeasuredFrfs, at: Evaluation, rng: np.random.Generator, repeatability: float
) -> MeasuredFrfs:
    """Move every resonance as another mounting might."""
    shift = repeatability * rng.standard_normal(len(resonances(at)))
    return replace(frfs, values=frfs.values + shifted(at, columns(frfs), shift).sum(axis=0))


def _levelled(frfs: MeasuredFrfs, rng: np.random.Generator, calibration: float) -> MeasuredFrfs:
    return replace(frfs, values=frfs.values * np.exp(calibration * rng.standard_normal()))


def _repeat(last: Sequence[Step], frfs: MeasuredFrfs, draw: MeasuredFrfs) -> list[float]:
    """Go through the stages again with other data, from where they rested."""
    theta = [step.solved.theta for step in last]
    own = [step.own for step in last]
    for _ in range(ROUNDS if len(last) > 1 else 1):
        for i, step in enumerate(last):
            chosen = np.searchsorted(frfs.frequency, step.stage.frfs.frequency)
            others = NOMINAL
            for j, state in enumerate(own):
                others = others.plus(state) if j != i else others
            earlier = replace(others, ratios=step.stage.earlier.ratios)
            kept = set(step.stage.frfs.pairs())
            rows = np.array([k for k, pair in enumerate(draw.pairs()) if pair in kept])
            stage: Stage = replace(step.stage, frfs=draw.select(rows).lines(chosen), earlier=earlier)
            size, at = step.solved.discrepancy, stage.evaluate(theta[i])
            theta[i] = descend(
                stage, theta[i], at, size, share=CONVERGED, steps=STEPS, variance=stage.variance(at, size)
            )[0]
            own[i] = stage.parameter_set.state(stage.predictor, stage.values(theta[i]))
    return [v for step, t in zip(last, theta, strict=True) for v in step.stage.values(t)]
