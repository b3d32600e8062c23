"""Trials on a Dask cluster: each task is a keeper on a worker machine, with a warm diagnosing process beside it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from acquisition.errors import EstimationError
from modalkit.blind.diagnoser import Diagnose, diagnose_by
from modalkit.blind.outcome import Outcome
from modalkit.blind.single import Announce, run_trial
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.workers.cluster import Ended, announce_event, connected, keeper


def cluster_outcomes(
    indices: Sequence[int],
    *,
    seed: int,
    plan: DrawRanges,
    scheduler: str,
    publish: Announce,
    diagnose: Diagnose | None = None,
    command: Sequence[str] = (),
) -> Iterator[Outcome]:
    """Run trials on a cluster and yield their outcomes as they come back.

    Parameters
    ----------
    indices : sequence of int
        Trials.
    seed, plan : int and DrawRanges
        Of the run.
    scheduler : str
        Address of the scheduler, ``tcp://host:8786``.
    publish : callable
        Called with a trial's number and commitment before its outcome is yielded; the worker sends it off before
        it begins the diagnosis.
    diagnose : callable, optional
        In place of ``modalkit diagnose``; importable on the workers, which then start no process.
    command : sequence of str
        What is started on the workers to diagnose; empty for the usual one.

    Raises
    ------
    InputError
        If Dask is not installed or the scheduler cannot be reached.
    EstimationError
        If the cluster goes away, or a trial ends its worker again and again.
    """
    published: dict[int, str] = {}
    early: dict[int, Outcome] = {}
    with connected(scheduler, command=command if diagnose is None else None) as cluster:
        for event in cluster.happens(_task, [(index, seed, plan, diagnose) for index in indices]):
            if isinstance(event, Ended):
                outcome = Outcome.from_json(json.loads(event.result))
                index = outcome.index
                early[index] = outcome
            else:
                index = event["trial"]
                published[index] = event["commitment"]
                publish(index, event["commitment"])
            if index in early and published.get(index) == early[index].sealed.commitment:
                yield early.pop(index)
    if early:
        raise EstimationError(
            f"the commitment of trial {min(early)} was lost on the way; go on with --resume, which repeats it"
        )


def _task(name: str, index: int, seed: int, plan: DrawRanges, diagnose: Diagnose | None) -> str:
    """Run a trial on a worker machine; runs there."""

    def publish(trial: int, commitment: str) -> None:
        announce_event(name, {"trial": trial, "commitment": commitment})

    use = diagnose or diagnose_by(keeper(name).run)
    outcome = run_trial(seed, index, diagnose=use, plan=plan, announce=publish)
    return json.dumps(outcome.to_json(), allow_nan=False)
