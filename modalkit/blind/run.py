"""Run blind trials: draw, seal, measure, have diagnosed in another process, open, and keep the outcome."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path

from acquisition.errors import ModalkitError, StudyError
from modalkit.blind.answer import read_answer
from modalkit.blind.diagnoser import Diagnose, diagnosers
from modalkit.blind.outcome import Outcome, slim
from modalkit.blind.seal import open_seal, seal
from modalkit.blind.shrunk import true_shrinkage
from modalkit.blind.store import Store
from modalkit.blind.trial import Truth, draw_trial, write_trial
from modalkit.simulator.drawing.ranges import DrawRanges
from modalkit.workers.pool import in_flight

Announce = Callable[[int, str], None]
"""Called with a trial's number and its commitment before its diagnosis begins."""


@dataclass(frozen=True, eq=False)
class BlindResult:
    """Outcome of a run, in the order of the trials.

    Parameters
    ----------
    seed : int
        Of the run.
    plan : Plan
        What could be drawn.
    outcomes : tuple of Outcome
        One per trial.
    """

    seed: int
    plan: DrawRanges = field(default_factory=DrawRanges)
    outcomes: tuple[Outcome, ...] = ()


def run_trial(
    seed: int,
    index: int,
    *,
    diagnose: Diagnose,
    plan: DrawRanges | None = None,
    announce: Announce | None = None,
) -> Outcome:
    """Run one trial from the draw to the opened seal.

    Parameters
    ----------
    seed, index : int
        Of the run, and of the trial in it.
    diagnose : callable
        Study file, and effects to leave out of the library, to diagnosis.
    plan : Plan, optional
        What may be drawn.
    announce : callable, optional
        Called with the trial's number and commitment before the diagnosis begins.

    Returns
    -------
    Outcome
        With the failure's message in place of an answer where the diagnosis failed.
    """
    trial = draw_trial(seed, index, plan=plan or DrawRanges())
    sealed = seal(trial.truth.to_json())
    commitment = sealed.commitment
    if announce is not None:
        announce(index, commitment)
    answer, document, failure, shrinkage = None, None, None, None
    with tempfile.TemporaryDirectory(prefix="test-", ignore_cleanup_errors=True) as name:
        study = write_trial(trial, Path(name))
        begin = time.perf_counter()
        try:
            document = slim(diagnose(study, trial.truth.without))
            answer = read_answer(document)
        except (ModalkitError, OSError, ValueError, ArithmeticError, LookupError, TypeError) as error:
            document, failure = None, f"{type(error).__name__}: {error}"
        seconds = time.perf_counter() - begin
    truth = Truth.from_json(open_seal(sealed, commitment))
    if answer is not None:
        shrinkage = true_shrinkage(trial, answer)
    return Outcome(index, truth, answer, document, failure, sealed, seconds, shrinkage)


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
    plan : Plan, optional
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
        Called with each outcome, those of the store first, then in the order in which the trials end.
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
    if trials < 1 or workers < 1:
        raise StudyError(f"{trials} trials with {workers} workers; both must be at least 1")
    if scheduler is not None:
        from modalkit.workers.cluster import check_scheduler

        check_scheduler(scheduler)
    plan = plan or DrawRanges()
    outcomes: dict[int, Outcome] = {}

    def came(outcome: Outcome) -> None:
        outcomes[outcome.index] = outcome if documents else replace(outcome, document=None)
        if progress is not None:
            progress(outcome)

    with nullcontext() if store is None else Store(store, seed=seed, plan=plan, resume=resume) as kept:
        for index, outcome in sorted(kept.found.items() if kept else ()):
            if index < trials:
                came(outcome)

        def publish(index: int, commitment: str) -> None:
            if kept is not None:
                kept.commit(index, commitment)
            if announce is not None:
                announce(index, commitment)

        missing = [index for index in range(trials) if index not in outcomes]
        with closing(_running(missing, seed, plan, workers, scheduler, diagnose, publish)) as running:
            for outcome in running:
                if kept is not None:
                    kept.keep(outcome)
                came(outcome)
    return BlindResult(seed, plan, tuple(outcomes[i] for i in range(trials)))


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
        from modalkit.blind.cluster import cluster_outcomes

        yield from cluster_outcomes(
            indices, seed=seed, plan=plan, scheduler=scheduler, diagnose=diagnose, publish=publish
        )
        return
    workers = min(workers, len(indices))
    with ExitStack() as stack:
        pool = stack.enter_context(ThreadPoolExecutor(max_workers=workers))
        use = diagnose or stack.enter_context(
            diagnosers(workers)
        )  # ended first, so that no thread waits for it

        def run(index: int) -> Outcome:
            return run_trial(seed, index, diagnose=use, plan=plan, announce=publish)

        yield from in_flight(pool, run, indices, workers)
