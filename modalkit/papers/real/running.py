"""Have real structures diagnosed, each in a process of its own that is not given what is known."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from acquisition.errors import ModalkitError, StudyError
from modalkit.blind.answer import Answer, read_answer
from modalkit.blind.diagnoser import DIAGNOSIS, read_diagnosis
from modalkit.papers.real.anonymous import write_anonymous
from modalkit.papers.real.case import Case
from modalkit.papers.real.judging import Judgement, judge
from modalkit.workers.pool import RunCommand, warm_pool

DiagnoseTogether = Callable[[Sequence[Path], tuple[str, ...], tuple[str, ...]], Mapping[str, Any]]


@dataclass(frozen=True, eq=False)
class RealOutcome:
    """One case, diagnosed and judged.

    Parameters
    ----------
    case : Case
        What is known, and what was withheld.
    document : mapping or None
        The diagnosis as JSON.
    answer : Answer or None
        What of it counts.
    judgement : Judgement or None
        Right, partly or wrong.
    missing : str or None
        Why there is no diagnosis.
    seconds : float
        Time it took [s].
    """

    case: Case
    document: Mapping[str, Any] | None
    answer: Answer | None
    judgement: Judgement | None
    missing: str | None
    seconds: float


def run_real(
    cases: Sequence[Case],
    samples: Path,
    data: Path | None,
    *,
    workers: int = 1,
    diagnose: DiagnoseTogether | None = None,
    progress: Callable[[RealOutcome], None] | None = None,
) -> tuple[RealOutcome, ...]:
    """Diagnose real structures and judge the answers.

    Parameters
    ----------
    cases : sequence of Case
        Which.
    samples : Path
        Folder of the sample studies.
    data : Path or None
        Folder of the measured data; cases that need it are skipped, with the reason, where it is not given.
    workers : int
        Diagnoses at a time [-].
    diagnose : callable, optional
        Study files, shared effects and effects left out to a diagnosis; default a process of its own.
    progress : callable, optional
        Called with each outcome, in the order in which they end.

    Returns
    -------
    tuple of RealOutcome
        In the order of the cases.

    Raises
    ------
    StudyError
        If there are no workers.
    """
    if workers < 1:
        raise StudyError(f"{workers} workers; there must be at least 1")
    with ExitStack() as stack:
        ask = diagnose or diagnose_together_by(stack.enter_context(warm_pool(workers)))
        pool = stack.enter_context(ThreadPoolExecutor(max_workers=workers))

        def run(case: Case) -> RealOutcome:
            outcome = _run_case(case, samples, data, ask)
            if progress is not None:
                progress(outcome)
            return outcome

        return tuple(pool.map(run, cases))


def _run_case(case: Case, samples: Path, data: Path | None, diagnose: DiagnoseTogether) -> RealOutcome:
    home = data if case.in_data else samples
    paths = [source.path for source in case.sources if source.path is not None]
    if home is None and paths:
        return _missing(case, "needs the folder of measured data; name it with --data")
    absent = next((path for path in paths if home is not None and not (home / path).exists()), None)
    if absent is not None:
        return _missing(case, f"{home}: no {absent} there")
    begin = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="test-") as name:
        folder = Path(name)
        try:
            studies = [write_anonymous(s, home, folder, i) for i, s in enumerate(case.sources)]
            document = diagnose(studies, case.shared, case.removed)
            answer = read_answer(document)
        except (ModalkitError, OSError) as error:
            return _missing(case, f"failed: {error}")
    seconds = time.perf_counter() - begin
    return RealOutcome(case, document, answer, judge(case, answer), None, seconds)


def _missing(case: Case, why: str) -> RealOutcome:
    return RealOutcome(case, None, None, None, why, 0.0)


def diagnose_together_by(run: RunCommand) -> DiagnoseTogether:
    """Return a diagnosis of one or more studies that runs where the command is run.

    Parameters
    ----------
    run : callable
        As :func:`modalkit.workers.pool.warm_pool` yields it; its processes end with the one that asks.
    """

    def diagnose(
        studies: Sequence[Path], shared: tuple[str, ...], without: tuple[str, ...]
    ) -> Mapping[str, Any]:
        options = [("--shared", shared), ("--without", without)]
        words = [word for name, values in options if values for word in (name, ",".join(values))]
        folder = studies[0].parent
        run(folder, ["diagnose", *(s.name for s in studies), "--json", DIAGNOSIS, *words])
        return read_diagnosis(folder / DIAGNOSIS)

    return diagnose
