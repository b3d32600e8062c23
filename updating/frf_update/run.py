"""From a case and its FRFs to an updated model, in stages."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import StudyError
from updating.case import Case
from updating.frf_update.begin import from_frequencies
from updating.frf_update.channels import odd
from updating.frf_update.columns import columns
from updating.frf_update.finer import finer
from updating.frf_update.lines import choose_lines
from updating.frf_update.report import report
from updating.frf_update.result import FrfUpdate
from updating.frf_update.solve import BEGIN, Solved, solve
from updating.frf_update.stage import Stage, nominal
from updating.frf_update.statistics import assess
from updating.frf_update.step import UNTOLD_RATIO, Step, identified_ratios, last_steps
from updating.models.state import NOMINAL, State, combine
from updating.prediction.assignment import match
from updating.test_data.measured_frfs import MeasuredFrfs
from updating.update.building import build_specimen
from updating.update.data.specimen import Specimen
from updating.update.parameters.named import build_parameter_set, only_damps
from updating.update.parameters.parameters import ParameterSet

PASSES = 2
"""How often a stage chooses its lines: on the nominal model, and again where that has brought it."""

CHOICES = 2
"""How often each stage chooses its lines and weights before it keeps them: doubled, stages that a model cannot follow
go round among solutions some tenths of a standard deviation apart, each right by its own weights."""

LEAST = 0.02
"""Discrepancy with which lines are chosen anew where a stage had come to rest on less [-]."""

FRESH = 1e-3
"""The same of a stage that is taken up again when others have moved [-]."""

CYCLES = 6
"""How often the stages are gone through at most: from the second time on each uses the results of the others."""

BASES = 3
"""Most reduced bases that are made anew at the solution."""

FOLLOWED = 0.02
"""Discrepancy under which measured and computed peaks lie within their widths of each other [-]."""

ODD = 0.05
"""Discrepancy from which on an FRF unlike the others is sought [-]."""

ODD_GAIN = 0.5
"""Share of the discrepancy that may be left for such an FRF to be left out [-]."""

APART = 0.3
"""Discrepancy beyond which peaks may have met by chance, and another beginning is tried [-]."""

STRANGE = 0.02
"""Relative width about a resonance that the identification lacks, of which only damping is not asked [-]."""

EDGE = 1.1
"""Resonances up to so many times the highest line are examined [-]."""

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
    cut off that are below the noise. The *nominal* model is updated; a baseline of the case plays no part.

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
        How many frequency lines each stage compares, or which [Hz]; left out, 100 chosen for their information.

    Returns
    -------
    FrfUpdate

    Raises
    ------
    StudyError
        If a parameter does not exist, is given twice, or there are more of them than data.
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
    parameter_sets = _split(specimen, case, named)
    specimen, kept, steps = _without_odd(specimen, frfs, parameter_sets, lines)
    here = specimen
    for _ in range(BASES):
        better = finer(here, steps)
        if better is None:
            break
        here, steps = better
        steps = _go_through(here, kept, parameter_sets, [s for s in steps if not s.together], lines)
    return specimen, frfs, steps


def _without_odd(
    specimen: Specimen,
    frfs: MeasuredFrfs,
    parameter_sets: Sequence[ParameterSet],
    lines: int | Sequence[float] | None,
) -> tuple[Specimen, MeasuredFrfs, list[Step]]:
    """Go through the stages, and again without FRFs that no parameter can follow if the others then agree."""
    steps = _go_through(specimen, frfs, parameter_sets, [], lines)
    off = max(s.solved.discrepancy for s in last_steps(steps))
    if off < ODD:
        return specimen, frfs, steps
    state = replace(combine([s.own for s in last_steps(steps)]), ratios=steps[-1].stage.earlier.ratios)
    found = odd(frfs, specimen.predictor, state)
    if not found:
        return specimen, frfs, steps
    kept = frfs.select(np.setdiff1d(np.arange(len(frfs.values)), list(found)))
    again = _go_through(specimen, kept, parameter_sets, [], lines)
    better = max(s.solved.discrepancy for s in last_steps(again)) < ODD_GAIN * off
    nodes, what = (
        specimen.measured.nodes,
        "was left out" if better else "was kept, because the other FRFs do not fit better without it",
    )
    left_out = [
        f"the FRF at node {nodes[frfs.seen[i]]} by the force at node {nodes[frfs.hit[i]]} has {how} of the others, "
        f"relative to the model. It {what}; check its channel, calibration and direction"
        for i, how in sorted(found.items())
    ]
    specimen = replace(specimen, warnings=(*specimen.warnings, *left_out))
    return (specimen, kept, again) if better else (specimen, frfs, steps)


def _go_through(
    specimen: Specimen,
    frfs: MeasuredFrfs,
    parameter_sets: Sequence[ParameterSet],
    done: Sequence[Step],
    lines: int | Sequence[float] | None,
) -> list[Step]:
    """Go through the stages until they rest on one basis, from where they rested on another."""
    steps, count = list(done), len(parameter_sets)
    mixed = entangled(parameter_sets)
    for _ in range(1 if count == 1 or mixed else CYCLES):
        for i, parameter_set in enumerate(parameter_sets):
            steps.append(_solve(specimen, frfs, (i, parameter_set), steps, lines))
        if _at_rest(steps, count):
            break
    else:
        if count > 1 and not mixed:
            steps[-1] = replace(steps[-1], solved=replace(steps[-1].solved, converged=False))
    if count == 1:
        return steps
    off = max(s.solved.discrepancy for s in steps[-count:])
    if off < FOLLOWED:
        return [*steps, _together(specimen, frfs, steps[-count:], lines)]
    if mixed:
        both = _together(specimen, frfs, steps[-count:], lines, near=off > APART)
        return [*steps, both] if both.solved.discrepancy < off else steps
    return steps


def entangled(parameter_sets: Sequence[ParameterSet]) -> bool:
    """Return whether more than one stage turns mass or stiffness, so that one can only rest where the others do."""
    return (
        sum(not all(k.damps for k in parameter_set.model_parameters) for parameter_set in parameter_sets) > 1
    )


def _together(
    specimen: Specimen,
    frfs: MeasuredFrfs,
    last: Sequence[Step],
    lines: int | Sequence[float] | None,
    *,
    near: bool = False,
) -> Step:
    """Turn the parameters of all stages at once, from where they rested or from where the frequencies put them."""
    stage = _stage(specimen, frfs, specimen.parameter_set, NOMINAL)
    theta = np.concatenate([step.solved.theta for step in last])
    begin = max(FRESH, *(step.solved.discrepancy for step in last))
    if near:
        theta, begin = from_frequencies(specimen, stage, nominal(stage.model_parameters)), BEGIN
    stage = stage.lines(choose_lines(stage, theta, LEAST, None if lines is None else _doubled(lines)))
    solved = solve(stage, theta, begin=begin)
    found = stage.state(solved.theta)
    return Step(len(last), stage, solved, found, found, together=True)


def _doubled(lines: int | Sequence[float]) -> int | Sequence[float]:
    return 2 * lines if isinstance(lines, int) else lines


def _at_rest(steps: Sequence[Step], count: int) -> bool:
    """Return whether the last cycle moved any parameter beyond a share of its standard deviation."""
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
        damping = [n for n in parameters if only_damps(n)]
        named = [[n for n in parameters if n not in damping], damping]
    named = [stage for stage in named if stage]
    if not named:
        raise StudyError('[update] names no parameters; name some, for instance parameters = ["E"]')
    return named


def _split(specimen: Specimen, case: Case, named: Sequence[Sequence[str]]) -> list[ParameterSet]:
    """Return the panel of each stage."""
    fixed = {name: dict(values) for name, values in case.accepted}
    counts = [
        len(build_parameter_set(s, specimen.predictor, case.tolerances, fixed).model_parameters)
        for s in named
    ]
    ends = np.cumsum([0, *counts])
    return [
        replace(specimen.parameter_set, model_parameters=specimen.parameter_set.model_parameters[a:b])
        for a, b in pairwise(ends)
    ]


def _solve(
    specimen: Specimen,
    frfs: MeasuredFrfs,
    numbered: tuple[int, ParameterSet],
    done: Sequence[Step],
    lines: int | Sequence[float] | None,
) -> Step:
    """Choose lines, solve, and do both again where the model has come to."""
    number, parameter_set = numbered
    if len(parameter_set.model_parameters) > 2 * frfs.values.size:
        raise StudyError(
            f"update: {len(parameter_set.model_parameters)} parameters and {2 * frfs.values.size} data; "
            "name fewer parameters"
        )
    latest = {step.number: step for step in done}
    others = NOMINAL
    for step in (latest[n] for n in sorted(latest) if n != number):
        others = others.plus(step.own)
    whole = _stage(specimen, frfs, parameter_set, others)
    theta, size, passes = nominal(parameter_set.model_parameters), BEGIN, PASSES
    if number in latest:
        theta, size, passes = latest[number].solved.theta, max(latest[number].solved.discrepancy, FRESH), 1
    variance = None
    if sum(step.number == number for step in done) >= CHOICES:  # what chooses anew each time never rests
        lines, variance = latest[number].stage.frfs.frequency.tolist(), latest[number].solved.variance
    stage, solved, visited = _rested(whole, theta, size, lines, passes, variance)
    if solved.discrepancy > APART and number not in latest and not stage.damps_alone:
        near = from_frequencies(specimen, whole, theta)
        other = _rested(whole, near, size, lines, passes)
        if other[1].discrepancy < solved.discrepancy:
            stage, solved, visited = other[0], other[1], [theta, *other[2]]
    theta = solved.theta
    own = parameter_set.state(
        specimen.predictor, [k.value(t) for k, t in zip(parameter_set.model_parameters, theta, strict=True)]
    )
    return Step(number, stage, replace(solved, history=np.array(visited)), own, stage.state(theta))


def _rested(
    whole: Stage,
    theta: FloatArray,
    size: float,
    lines: int | Sequence[float] | None,
    passes: int,
    variance: FloatArray | None = None,
) -> tuple[Stage, Solved, list[FloatArray]]:
    """Return the stage on the lines it compared last, where it came to rest, and all coordinates on the way."""
    visited = [theta]
    for _ in range(passes):
        stage = whole.lines(choose_lines(whole, theta, size, lines))
        solved = solve(stage, theta, begin=size, variance=variance)
        theta, size = solved.theta, max(solved.discrepancy, LEAST)
        visited += list(solved.history[1:])
    return stage, solved, visited


def _stage(specimen: Specimen, frfs: MeasuredFrfs, parameter_set: ParameterSet, earlier: State) -> Stage:
    test = specimen.measured
    damps = any(k.damps for k in parameter_set.model_parameters)
    only_damps = all(k.damps for k in parameter_set.model_parameters)
    unknown = not damps and not np.isfinite(test.damping).all()
    stated = damps or unknown or bool(earlier.dampers)
    ratios = None if stated else identified_ratios(specimen)
    widths = np.where(np.isfinite(test.damping), test.damping, UNTOLD_RATIO)
    order = np.argsort(test.frequency)
    centres, widths = (test.frequency[order], widths[order]) if unknown else (np.zeros(0), np.zeros(0))
    if only_damps:
        centres = _unmatched(specimen, frfs, earlier)
        widths = np.full(len(centres), STRANGE)
    return Stage(
        predictor=specimen.predictor,
        frfs=frfs,
        ends=columns(frfs),
        parameter_set=parameter_set,
        earlier=replace(earlier, ratios=ratios),
        resonances=centres,
        widths=widths,
        warp=_warp(specimen, frfs, earlier) if only_damps else np.ones(len(frfs.laplace)),
        all_resonances=test.frequency[order],
    )


def _unmatched(specimen: Specimen, frfs: MeasuredFrfs, state: State) -> FloatArray:
    """Return where on the measured axis the model has resonances that the identification lacks [Hz]."""
    prediction = specimen.predictor.predict(state)
    partner = match(specimen.measured, prediction, specimen.order)
    own = np.delete(prediction.frequency, partner)
    order = np.argsort(specimen.measured.frequency)
    measured = specimen.measured.frequency[order]
    ratio = np.interp(
        own, prediction.frequency[partner][order], prediction.frequency[partner][order] / measured
    )
    found = own / ratio
    return np.asarray(found[found < EDGE * frfs.frequency.max()])


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
