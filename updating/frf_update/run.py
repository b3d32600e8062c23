"""From a case and its FRFs to an updated model, in stages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.case import Case
from updating.frf_update.columns import columns
from updating.frf_update.finer import finer
from updating.frf_update.lines import choose_lines
from updating.frf_update.report import report
from updating.frf_update.result import FrfUpdate
from updating.frf_update.solve import BEGIN, solve
from updating.frf_update.stage import Stage, nominal
from updating.frf_update.statistics import assess
from updating.frf_update.step import Step, identified_ratios
from updating.matching import match
from updating.measured_frfs import MeasuredFrfs
from updating.models.state import NOMINAL, State
from updating.update.building import build_specimen
from updating.update.knobs import Panel
from updating.update.specimen import Specimen

PASSES = 2
"""How often a stage chooses its lines: on the nominal model, and again where that has brought it."""

UNTOLD_RATIO = 0.005
"""Damping ratio of modes of which the test says none, for what lies too near a resonance [-]."""


LEAST = 0.02
"""Discrepancy with which lines are chosen anew where a stage had come to rest on less [-]."""

FRESH = 1e-3
"""The same of a stage that is taken up again when others have moved [-]."""

CYCLES = 4
"""How often the stages are gone through at most: from the second time on each knows what the others have found."""

BASES = 3
"""Most reduced bases that are made anew at the solution."""

FOLLOWED = 0.02
"""Discrepancy under which measured and computed peaks lie within their widths of each other [-]."""

REST = 0.1
"""Change from one cycle to the next under which parameters rest, in standard deviations [-]."""


def update_frfs(
    case: Case,
    frfs: MeasuredFrfs,
    *,
    parameters: Sequence[str] = (),
    stages: Sequence[Sequence[str]] | None = None,
    lines: int | Sequence[float] | None = None,
) -> FrfUpdate:
    """Update a model by the FRFs of its test, Z evaluated at i omega + sigma where a window's decay is in them.

    Paper B, Eqs. 7-13: the first stage settles mass and stiffness without regard to damping, the second the
    damping of each region, and again in turn until they rest. Where the model then follows the FRFs closely,
    the parameters of all stages are turned together at the end. Eq. 10 is solved by singular values, those
    cut off that drown in the noise. The *nominal* model is updated; a baseline of the case plays no part.

    Parameters
    ----------
    case : Case
        Test beside model.
    frfs : MeasuredFrfs
        The FRFs of the test.
    parameters : sequence of str
        Names as for updating by eigenvalues, with ``region.area``, ``region.inertia`` and ``alpha``, ``beta``,
        ``loss_factor`` of the whole or of a region; coefficients of damping make up a second stage.
    stages : sequence of sequences of str, optional
        The stages, in place of ``parameters``.
    lines : int or sequence of float, optional
        How many frequency lines each stage compares, or which [Hz]; left out, 100 chosen for what they tell.

    Returns
    -------
    FrfUpdate

    Raises
    ------
    StudyError
        If a parameter does not exist, stands twice, or there are more of them than data.
    EstimationError
        If no measured mode has a partner.
    """
    return report(*solve_stages(case, frfs, parameters, stages, lines))


def solve_stages(
    case: Case,
    frfs: MeasuredFrfs,
    parameters: Sequence[str],
    stages: Sequence[Sequence[str]] | None,
    lines: int | Sequence[float] | None,
) -> tuple[Specimen, MeasuredFrfs, list[Step]]:
    """Go through the stages until they rest; see :func:`update_frfs`."""
    named = _staged(parameters, stages)
    specimen = build_specimen(case, [name for stage in named for name in stage])
    panels = _split(specimen.panel, [len(build_specimen(case, stage).panel.knobs) for stage in named])
    steps = _go_through(specimen, frfs, panels, [], lines)
    here = specimen
    for _ in range(BASES):
        better = finer(here, steps[-1])
        if better is None:
            break
        here = better
        steps = _go_through(here, frfs, panels, [s for s in steps if not s.together], lines)
    return specimen, frfs, steps


def _go_through(
    specimen: Specimen,
    frfs: MeasuredFrfs,
    panels: Sequence[Panel],
    done: Sequence[Step],
    lines: int | Sequence[float] | None,
) -> list[Step]:
    """Go through the stages until they rest on one basis, from where they rested on another."""
    steps = list(done)
    for _ in range(CYCLES if len(panels) > 1 else 1):
        for i, panel in enumerate(panels):
            steps.append(_solve(specimen, frfs, (i, panel), steps, lines))
        if _at_rest(steps, len(panels)):
            break
    if len(panels) > 1 and max(s.solved.discrepancy for s in steps[-len(panels) :]) < FOLLOWED:
        steps.append(_together(specimen, frfs, steps[-len(panels) :], lines))
    return steps


def _together(
    specimen: Specimen, frfs: MeasuredFrfs, last: Sequence[Step], lines: int | Sequence[float] | None
) -> Step:
    """Turn the parameters of all stages at once, where the model can follow the FRFs within their peaks."""
    stage = _stage(specimen, frfs, specimen.panel, NOMINAL)
    theta = np.concatenate([step.solved.theta for step in last])
    stage = stage.lines(choose_lines(stage, theta, LEAST, None if lines is None else _doubled(lines)))
    solved = solve(stage, theta, begin=max(FRESH, *(step.solved.discrepancy for step in last)))
    found = stage.state(solved.theta)
    return Step(len(last), stage, solved, found, found, together=True)


def _doubled(lines: int | Sequence[float]) -> int | Sequence[float]:
    return 2 * lines if isinstance(lines, int) else lines


def _at_rest(steps: Sequence[Step], count: int) -> bool:
    """Tell whether the last cycle moved any parameter beyond a share of its standard deviation."""
    if len(steps) < 2 * count:
        return False
    for old, new in zip(steps[-2 * count : -count], steps[-count:], strict=True):
        sigma = np.sqrt(np.diag(assess(new.stage, new.solved, 0.0).covariance))
        if np.any(np.abs(new.solved.theta - old.solved.theta) > REST * sigma):
            return False
    return True


def _staged(parameters: Sequence[str], stages: Sequence[Sequence[str]] | None) -> list[list[str]]:
    if stages is not None and len(parameters):
        raise StudyError("[update] names both parameters and stages; keep one of them")
    if stages is not None:
        named = [list(stage) for stage in stages]
    else:
        damping = [n for n in parameters if n.rpartition(".")[2] in ("alpha", "beta", "loss_factor")]
        named = [[n for n in parameters if n not in damping], damping]
    named = [stage for stage in named if stage]
    if not named:
        raise StudyError('[update] names no parameters; name some, for instance parameters = ["E"]')
    return named


def _split(panel: Panel, counts: Sequence[int]) -> list[Panel]:
    ends = np.cumsum([0, *counts])
    return [replace(panel, knobs=panel.knobs[first:last]) for first, last in pairwise(ends)]


def _solve(
    specimen: Specimen,
    frfs: MeasuredFrfs,
    numbered: tuple[int, Panel],
    done: Sequence[Step],
    lines: int | Sequence[float] | None,
) -> Step:
    """Choose lines, solve, and do both again where the model has come to."""
    number, panel = numbered
    if len(panel.knobs) > 2 * frfs.values.size:
        raise StudyError(
            f"update: {len(panel.knobs)} parameters and {2 * frfs.values.size} data; name fewer parameters"
        )
    latest = {step.number: step for step in done}
    others = NOMINAL
    for step in (latest[n] for n in sorted(latest) if n != number):
        others = others.plus(step.own)
    whole = _stage(specimen, frfs, panel, others)
    theta, size, passes = nominal(panel.knobs), BEGIN, PASSES
    if number in latest:
        theta, size, passes = latest[number].solved.theta, max(latest[number].solved.discrepancy, FRESH), 1
    visited = [theta]
    for _ in range(passes):
        stage = whole.lines(choose_lines(whole, theta, size, lines))
        solved = solve(stage, theta, begin=size)
        theta, size = solved.theta, max(solved.discrepancy, LEAST)
        visited += list(solved.history[1:])
    own = panel.state(specimen.predictor, [k.value(t) for k, t in zip(panel.knobs, theta, strict=True)])
    return Step(number, stage, replace(solved, history=np.array(visited)), own, stage.state(theta))


def _stage(specimen: Specimen, frfs: MeasuredFrfs, panel: Panel, earlier: State) -> Stage:
    test = specimen.measured
    damps = any(k.damper is not None for k in panel.knobs)
    only_damps = all(k.damper is not None for k in panel.knobs)
    unknown = not damps and not np.isfinite(test.damping).all()
    told = damps or unknown or bool(earlier.dampers)
    ratios = None if told else identified_ratios(specimen)
    widths = np.where(np.isfinite(test.damping), test.damping, UNTOLD_RATIO)
    order = np.argsort(test.frequency)
    return Stage(
        specimen.predictor,
        frfs,
        columns(frfs),
        panel,
        replace(earlier, ratios=ratios),
        test.frequency[order] if unknown else np.zeros(0),
        widths[order] if unknown else np.zeros(0),
        _warp(specimen, frfs, earlier) if only_damps else np.ones(len(frfs.laplace)),
        test.frequency[order],
    )


def _warp(specimen: Specimen, frfs: MeasuredFrfs, state: State) -> FloatArray:
    """Return computed over measured resonance, between resonances on a line, (n_lines,) [-].

    What a first stage leaves of the frequencies would else be mistaken for damping: two peaks that miss each
    other by a bandwidth look most alike when both are broad.
    """
    prediction = specimen.predictor.predict(state)
    partner = match(specimen.measured, prediction, specimen.order)
    order = np.argsort(specimen.measured.frequency)
    measured = specimen.measured.frequency[order]
    ratio = prediction.frequency[partner][order] / measured
    return np.asarray(np.interp(frfs.frequency, measured, ratio))
