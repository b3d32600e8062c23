"""One blind trial: draw, seal, measure, have diagnosed in another process, and open."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from acquisition.errors import ModalkitError
from modalkit.blind.answer import read_answer
from modalkit.blind.diagnoser import Diagnose
from modalkit.blind.outcome import Outcome, slim
from modalkit.blind.seal import open_seal, seal
from modalkit.blind.shrunk import true_shrinkage
from modalkit.blind.trial import Truth, draw_trial, write_trial
from modalkit.simulator.drawing.ranges import DrawRanges

Announce = Callable[[int, str], None]
"""Called with a trial's number and its commitment before its diagnosis begins."""


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
    plan : DrawRanges, optional
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
    return Outcome(
        index=index,
        truth=truth,
        answer=answer,
        document=document,
        failure=failure,
        sealed=sealed,
        seconds=seconds,
        shrinkage=shrinkage,
    )
