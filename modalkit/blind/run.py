"""Run blind trials: draw, seal, measure, have diagnosed in another process, open, and keep the outcome."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from acquisition.errors import EstimationError, ModalkitError, StudyError
from modalkit.blind.answer import Answer, read_answer
from modalkit.blind.seal import Seal, open_seal, seal
from modalkit.blind.trial import Truth, draw_trial, write_trial

Diagnose = Callable[[Path], Mapping[str, Any]]
TIMEOUT = 900.0
_HIDDEN_VARIABLES = ("PYTEST_CURRENT_TEST", "PYTEST_VERSION")


@dataclass(frozen=True, eq=False)
class Outcome:
    """One trial, opened.

    Parameters
    ----------
    index : int
        Number of the trial [-].
    truth : Truth
        What was hidden.
    answer : Answer or None
        What the diagnosis said; None where it failed.
    failure : str or None
        Message of a diagnosis that failed.
    sealed : Seal
        Statement and salt; its commitment was announced before the diagnosis began.
    seconds : float
        Time the diagnosis took [s].
    """

    index: int
    truth: Truth
    answer: Answer | None
    failure: str | None
    sealed: Seal
    seconds: float


@dataclass(frozen=True, eq=False)
class BlindResult:
    """Outcome of a run, in the order of the trials.

    Parameters
    ----------
    seed : int
        Of the run.
    outcomes : tuple of Outcome
        One per trial.
    """

    seed: int
    outcomes: tuple[Outcome, ...]


def diagnose_in_subprocess(study: Path, *, timeout: float = TIMEOUT) -> dict[str, Any]:
    """Run ``modalkit diagnose`` on a study in a process of its own.

    Parameters
    ----------
    study : Path
        The study file; the process starts in its folder and is given nothing else.
    timeout : float
        Longest time allowed [s].

    Returns
    -------
    dict
        The diagnosis as JSON.

    Raises
    ------
    EstimationError
        If the process fails, does not end, or writes no JSON.
    """
    out = study.parent / "diagnosis.json"
    command = [sys.executable, "-m", "modalkit", "diagnose", study.name, "--json", out.name]
    environment = {k: v for k, v in os.environ.items() if k not in _HIDDEN_VARIABLES}
    environment.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        done = subprocess.run(
            command,
            cwd=study.parent,
            env=environment,
            capture_output=True,
            text=True,
            timeout=timeout,
            stdin=subprocess.DEVNULL,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise EstimationError(f"the diagnosis did not end within {timeout:g} s") from error
    if done.returncode != 0:
        last = (done.stderr.strip().splitlines() or ["no message"])[-1]
        raise EstimationError(f"the diagnosis ended with code {done.returncode}: {last}")
    try:
        document: dict[str, Any] = json.loads(out.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise EstimationError(f"the diagnosis wrote no readable JSON: {error}") from error
    return document


def run_trial(
    seed: int,
    index: int,
    *,
    diagnose: Diagnose = diagnose_in_subprocess,
    effects: Sequence[str] | None = None,
    announce: Callable[[int, str], None] | None = None,
) -> Outcome:
    """Run one trial from the draw to the opened seal.

    Parameters
    ----------
    seed, index : int
        Of the run, and of the trial in it.
    diagnose : callable
        Study file to diagnosis.
    effects : sequence of str, optional
        What may be hidden; default everything the rig has.
    announce : callable, optional
        Called with the trial's number and commitment before the diagnosis begins.

    Returns
    -------
    Outcome
        With the failure's message in place of an answer where the diagnosis failed.
    """
    trial = draw_trial(seed, index, effects=effects)
    sealed = seal(trial.truth.to_json())
    commitment = sealed.commitment
    if announce is not None:
        announce(index, commitment)
    answer, failure = None, None
    with tempfile.TemporaryDirectory(prefix="test-") as name:
        study = write_trial(trial, Path(name))
        begin = time.perf_counter()
        try:
            answer = read_answer(diagnose(study))
        except (ModalkitError, OSError, ValueError, ArithmeticError, LookupError, TypeError) as error:
            failure = f"{type(error).__name__}: {error}"
        seconds = time.perf_counter() - begin
    opened = open_seal(sealed, commitment)
    truth = Truth(**(opened | {"accepted": tuple(opened["accepted"])}))
    return Outcome(index, truth, answer, failure, sealed, seconds)


def run_blind(
    trials: int,
    seed: int,
    *,
    diagnose: Diagnose = diagnose_in_subprocess,
    workers: int = 1,
    effects: Sequence[str] | None = None,
    announce: Callable[[int, str], None] | None = None,
    progress: Callable[[Outcome], None] | None = None,
) -> BlindResult:
    """Run blind trials; the result does not depend on the number of workers.

    Parameters
    ----------
    trials, seed : int
        Number of trials, and seed of the run.
    diagnose : callable
        Study file to diagnosis; the default starts a process per trial.
    workers : int
        Trials in flight at a time; each is a thread that waits for its own process [-].
    effects : sequence of str, optional
        What may be hidden; default everything the rig has.
    announce : callable, optional
        Called with the trial's number and commitment before its diagnosis begins.
    progress : callable, optional
        Called with each outcome, in the order in which the trials end.

    Returns
    -------
    BlindResult
        All outcomes in order.

    Raises
    ------
    StudyError
        If there are no trials or no workers, or the rig does not have an effect.
    """
    if trials < 1 or workers < 1:
        raise StudyError(f"{trials} trials with {workers} workers; both must be at least 1")
    outcomes: dict[int, Outcome] = {}
    with ThreadPoolExecutor(max_workers=workers) as pool:
        waiting = [
            pool.submit(run_trial, seed, i, diagnose=diagnose, effects=effects, announce=announce)
            for i in range(trials)
        ]
        try:
            for future in as_completed(waiting):
                outcome = future.result()
                outcomes[outcome.index] = outcome
                if progress is not None:
                    progress(outcome)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return BlindResult(seed, tuple(outcomes[i] for i in range(trials)))
