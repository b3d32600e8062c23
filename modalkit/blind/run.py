"""Run blind trials, on this machine or on a cluster, and keep their outcomes as they come."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing
from dataclasses import dataclass, field, replace
from itertools import chain
from pathlib import Path

from acquisition.errors import StudyError
from modalkit.blind.cluster import cluster_outcomes
from modalkit.blind.diagnoser import Diagnose, diagnosers
from modalkit.blind.outcome import Outcome
from modalkit.blind.single import Announce, run_trial
from modalkit.blind.store import Store
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.workers.cluster import check_scheduler
from modalkit.workers.pool import in_flight


@dataclass(frozen=True, eq=False)
class BlindResult:
    """Outcome of a run, in the order of the trials.

    Parameters
    ----------
    seed : int
        Of the run.
    plan : DrawRanges
        What could be drawn.
    outcomes : tuple of Outcome
        One per trial.
    """

    seed: int
    plan: DrawRanges = field(default_factory=DrawRanges)
    outcomes: tuple[Outcome, ...] = ()


def run_blind(
    trials: int,
    seed: int,
    *,
    plan: DrawRanges | None = None,
    workers: int = 1,
    scheduler: str | None = None,
    store: Path | None = None,
    resume: bool = False,
    diagnose: Diagnose | None = None,
    announce: Announce | None = None,
    progress: Callable[[Outcome], None] | None = None,
    documents: bool = True,
) -> BlindResult:
    """Run blind trials; the result does not depend on workers, cluster, order or interruptions.

    Parameters
    ----------
    trials, seed : int
        Number of trials, and seed of the run.
    plan : DrawRanges, optional
        What may be drawn.
    workers : int
        Trials in flight at a time on this machine, each with a diagnosing process of its own [-].
    scheduler : str, optional
        Address of a Dask scheduler, whose workers run the trials instead.
    store : Path, optional
        File for commitments and outcomes as they come.
    resume : bool
        Whether to run only what the store does not hold yet.
    diagnose : callable, optional
        In place of ``modalkit diagnose``; on a cluster it must be importable there.
    announce : callable, optional
        Called with the trial's number and commitment before its diagnosis begins.
    progress : callable, optional
        Called with each outcome, those of the store first, then as the trials end.
    documents : bool
        Whether the result holds the diagnoses as JSON, which no score needs; the store holds them always.

    Returns
    -------
    BlindResult
        All outcomes in order.

    Raises
    ------
    StudyError
        If there are no trials or no workers, or the rig does not have an effect.
    InputError
        If the store belongs to another run, or the scheduler cannot be reached.
    """
    _check(trials, workers, scheduler)
    plan, outcomes = plan or DrawRanges(), dict[int, Outcome]()
    every = _coming(trials, seed, plan, workers, scheduler, store, resume, diagnose, announce)
    with closing(every):
        for outcome in every:
            outcomes[outcome.index] = outcome if documents else replace(outcome, document=None)
            if progress is not None:
                progress(outcome)
    return BlindResult(seed, plan, tuple(outcomes[i] for i in range(trials)))


def _check(trials: int, workers: int, scheduler: str | None) -> None:
    """Refuse a run without trials or workers, or with a scheduler that cannot be reached."""
    if trials < 1 or workers < 1:
        raise StudyError(f"{trials} trials with {workers} workers; both must be at least 1")
    if scheduler is not None:
        check_scheduler(scheduler)


def _coming(
    trials: int,
    seed: int,
    plan: DrawRanges,
    workers: int,
    scheduler: str | None,
    store: Path | None,
    resume: bool,
    diagnose: Diagnose | None,
    announce: Announce | None,
) -> Generator[Outcome, None, None]:
    """Yield the outcomes that a store holds, then the others as they end."""
    with ExitStack() as stack:
        kept = None
        if store is not None:
            kept = stack.enter_context(Store(store, seed=seed, plan=plan, resume=resume))
        found, missing = _known(kept, trials)
        publish = _publisher(kept, announce)
        running = _running(missing, seed, plan, workers, scheduler, diagnose, publish)
        yield from chain(found, stack.enter_context(closing(_stored(running, kept))))


def _known(store: Store | None, trials: int) -> tuple[list[Outcome], list[int]]:
    """Return the outcomes that a store holds already, and the numbers of the trials that are missing."""
    found = [] if store is None else [one for i, one in sorted(store.found.items()) if i < trials]
    return found, sorted(set(range(trials)) - {outcome.index for outcome in found})


def _publisher(store: Store | None, announce: Announce | None) -> Announce:
    """Return what publishes a commitment: in the store first, then to the one who listens."""

    def publish(index: int, commitment: str) -> None:
        if store is not None:
            store.commit(index, commitment)
        if announce is not None:
            announce(index, commitment)

    return publish


def _stored(running: Generator[Outcome, None, None], store: Store | None) -> Generator[Outcome, None, None]:
    """Yield outcomes, each after it is in the store."""
    with closing(running):
        for outcome in running:
            if store is not None:
                store.keep(outcome)
            yield outcome


def _running(
    indices: Sequence[int],
    seed: int,
    plan: DrawRanges,
    workers: int,
    scheduler: str | None,
    diagnose: Diagnose | None,
    publish: Announce,
) -> Generator[Outcome, None, None]:
    """Yield outcomes as they come, from this machine or from a cluster."""
    if not indices:
        return
    if scheduler is not None:
        yield from cluster_outcomes(
            indices, seed=seed, plan=plan, scheduler=scheduler, diagnose=diagnose, publish=publish
        )
        return
    workers = min(workers, len(indices))
    with ExitStack() as stack:
        pool = stack.enter_context(ThreadPoolExecutor(max_workers=workers))
        # the processes are ended before the pool is, so that no thread waits for one
        use = diagnose or stack.enter_context(diagnosers(workers))

        def run(index: int) -> Outcome:
            return run_trial(seed, index, diagnose=use, plan=plan, announce=publish)

        yield from in_flight(pool, run, indices, workers)
