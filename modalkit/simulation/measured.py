"""The rig of a study that has hits or FRFs, as far as these determine them."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from math import ceil

import numpy as np
from scipy.stats import chi2

from acquisition import Dof, FrfSet, HammerPlan, force_range
from acquisition.synthetic.pulses import pulse_transform
from identification.arrangement import signs
from modalkit.simulation.setup import (
    FORCE_NOISE,
    HITS,
    PEAK,
    PULSE,
    RESPONSE_NOISE,
    SAMPLING,
    TRIGGER,
    MeasurementSetup,
    Options,
)
from modalkit.workflow.case import Session

TEN_DB = 1.2554
"""Frequency times length of a haversine pulse where its spectrum is 10 dB down [-]."""

QUIET = 0.1
"""The share of the lines whose noise counts: hits beside the point add to the others in proportion to the FRF [-]."""


def rig_of_data(session: Session, options: Options) -> MeasurementSetup:
    """Return the rig that a study's FRFs or hits were measured on."""
    assert session.processed is not None
    assert session.identified is not None
    test, frfs = session.case.measured, session.identified.frfs
    assert test.rows is not None
    assert test.signs is not None
    rows = test.rows.tolist()
    notes: list[str] = []
    plan = _plan_of(session, options, notes)
    if session.identified.points_rejected:
        notes.append(f"not hit again: {'; '.join(session.identified.points_rejected)}")
    return MeasurementSetup(
        measured=test,
        responses=tuple(frfs.responses[i] for i in rows),
        references=tuple(frfs.references[i] for i in rows),
        signs=np.asarray(signs(frfs)[test.rows] * test.signs),
        geometry=frfs.geometry,
        band=session.identified.band,
        plan=plan,
        notes=tuple(notes),
    )


def _plan_of(session: Session, options: Options, notes: list[str]) -> HammerPlan:
    """Return how the structure was hit: from the records where they are there, else from the FRFs' lines."""
    processed, study = session.processed, session.study
    assert processed is not None
    frfs, top = processed.frfs, float(processed.frfs.frequency[-1])
    force = force_range(processed.hits)
    if processed.judged and force is not None:
        test = processed.judged[0].test
        count = Counter[Dof]()
        for point in (p for judged in processed.judged for p in judged.test.points):
            count[point.reference] += point.count
        hits, decay = int(np.median(list(count.values()))), test.decay
        rate, samples, form = test.rate, test.samples, test.form
        peak = float(np.median([v.peak for v in processed.hits if v.used]))
        width, quiet = TEN_DB / force.band10, _force_noise(session)
    else:
        hits = HITS if frfs.averages is None else int(np.median(frfs.averages))
        decay = frfs.decay
        samples = ceil(SAMPLING * top / frfs.df)
        rate, form, peak = samples * frfs.df, frfs.form, PEAK
        width, quiet = PULSE / top, FORCE_NOISE * PEAK
    plan = HammerPlan(
        rate=rate,
        samples=samples,
        hits=options.hits or hits,
        peak=peak,
        width=width,
        pre_trigger=TRIGGER * samples / rate,
        force_noise=quiet,
        position_sigma=study.test.position_sigma,
        decay=decay,
        form=form,
    )
    noisy = _with_noise(plan, frfs, options, notes)
    rate, samples = options.rate or rate, options.samples or samples
    return replace(noisy, rate=rate, samples=samples, pre_trigger=_trigger(frfs, width, samples / rate))


def _trigger(frfs: FrfSet, width: float, duration: float) -> float:
    """Return when the pulse starts [s]."""
    known = None if frfs.record is None else frfs.record.trigger - width / 2
    return TRIGGER * duration if known is None or not 0 <= known < duration / 4 else known


def _force_noise(session: Session) -> float:
    """Return the noise of the force channel before its window, from the second half of the records, r.m.s. [N]."""
    assert session.processed is not None
    levels = []
    for judged in session.processed.judged:
        half = judged.test.samples // 2
        growth = np.exp(judged.test.decay * np.arange(half, judged.test.samples) / judged.test.rate)
        for point in judged.test.points:
            offset = np.median(point.force, axis=-1, keepdims=True)
            tail = (point.force - offset)[:, half:] * growth
            spread = np.abs(tail - np.median(tail, axis=-1, keepdims=True))
            levels.append(1.4826 * np.median(spread, axis=-1))
    return float(np.median(np.concatenate(levels)))


def _with_noise(plan: HammerPlan, frfs: FrfSet, options: Options, notes: list[str]) -> HammerPlan:
    """Return the plan with the noise of the responses: as stated, else from the coherence, else usual."""
    if options.noise is not None:
        return replace(plan, response_noise=options.noise)
    if frfs.coherence is None or (frfs.averages is not None and frfs.averages.min() < 2):
        notes.append(
            f"the test's FRFs have no coherence over several hits: noise of {RESPONSE_NOISE:g} of the largest response"
        )
        return replace(plan, response_noise=RESPONSE_NOISE)
    inside = (frfs.frequency > 0) & (frfs.frequency <= plan.rate / SAMPLING)
    coherence = np.clip(frfs.coherence[:, inside], 1e-12, 1.0)
    laplace = np.asarray(2j * np.pi * frfs.frequency[inside] + frfs.decay, dtype=np.complex128)
    force = plan.rate * plan.peak * np.abs(pulse_transform(laplace, plan.width, plan.pulse))
    power = (1 / coherence - 1) * np.abs(frfs.values[:, inside] * force) ** 2
    averages = HITS if frfs.averages is None else int(np.median(frfs.averages))
    free = 2 * (averages - 1)
    time = np.arange(plan.samples) / plan.rate - plan.pre_trigger
    energy = float(np.sum(np.exp(-2 * frfs.decay * time)))
    quiet = np.quantile(power, QUIET, axis=1) * free / float(chi2.ppf(QUIET, free))
    return replace(plan, response_floor=float(np.sqrt(np.median(quiet) / energy)))
