"""A change of a test followed: the study as it then is, and its structure made ready to be hit so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from modalkit.planning.changes import ABOVE
from modalkit.planning.design import Design
from modalkit.planning.own.layout import Layout
from modalkit.planning.own.trials import Trial, drawn_chain
from modalkit.simulation.planned import named
from modalkit.simulation.setup import SAMPLING, MeasurementSetup
from modalkit.study.tables import TolerancesTable


def followed(trial: Trial, layout: Layout, design: Design) -> Trial:
    """Return the trial of a changed test.

    Parameters
    ----------
    trial : Trial
        The test as it is.
    layout : Layout
        Where it is or might be hit.
    design : Design
        The test then.
    """
    now, setup = trial.design, trial.ready.test_setup
    if design.stations != now.stations:
        setup = _elsewhere(trial, layout, design)
    if design.modes > now.modes:
        setup = _wider(setup, ABOVE * float(trial.problem.measured.frequency[now.modes]))
    hits = round(setup.plan.hits * (now.noise / design.noise) ** 2)
    setup = replace(setup, plan=replace(setup.plan, hits=hits))
    test = {"calibration": design.calibration, "repeatability": design.repeatability, "band": setup.band}
    names = zip(trial.problem.names, design.tolerances, strict=True)
    doubts = {name: value for name, value in names if name in TolerancesTable.model_fields}
    study = trial.study.model_copy(
        update={
            "test": trial.study.test.model_copy(update=test),
            "tolerances": trial.study.tolerances.model_copy(update=doubts),
        }
    )
    factors = {
        **trial.problem.tolerances.factors,
        **dict(zip(trial.problem.names, design.tolerances, strict=True)),
    }
    problem = replace(trial.problem, tolerances=replace(trial.problem.tolerances, factors=factors))
    ready = replace(trial.ready, study=drawn_chain(study), test_setup=setup)
    return Trial(study, ready, design, problem)


def _elsewhere(trial: Trial, layout: Layout, design: Design) -> MeasurementSetup:
    """Return how the structure is hit at the stations of a design."""
    blank, setup, study = layout.blank, trial.ready.test_setup, trial.study
    rows = np.isin(layout.station, design.stations)
    seen, hit = blank.seen[rows], blank.hit[rows]
    names, geometry = named(blank.points, blank.nodes, blank.directions, study.axes(study.test))
    nothing = np.zeros((len(seen), 0))
    measured = replace(
        setup.measured, points=blank.points, nodes=blank.nodes, directions=blank.directions, seen=seen, hit=hit,
        frequency=nothing[0], frequency_sigma=nothing[0], damping=nothing[0], damping_sigma=nothing[0],
        constants=nothing, constants_sigma=nothing, rows=None, signs=None, trusted=None, shared=None,
    )  # fmt: skip
    return replace(
        setup,
        measured=measured,
        responses=tuple(names[i] for i in seen),
        references=tuple(names[i] for i in hit),
        signs=np.ones(len(seen)),
        geometry=geometry,
    )


def _wider(setup: MeasurementSetup, top: float) -> MeasurementSetup:
    """Return how the structure is hit to see it up to a frequency [Hz]: shorter hits, sampled faster."""
    plan = setup.plan
    times = max(1.0, SAMPLING * top / plan.rate)
    faster = replace(
        plan, rate=times * plan.rate, samples=int(np.ceil(times * plan.samples)), width=plan.width / times
    )
    return replace(setup, band=(setup.band[0], top), plan=faster)
