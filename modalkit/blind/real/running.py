"""Have real structures diagnosed, each in a process of its own that is not told what is known."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from acquisition.errors import EstimationError, ModalkitError, StudyError
from modalkit.blind.answer import Answer, read_answer
from modalkit.blind.real.anonymous import write_anonymous
from modalkit.blind.real.case import Case
from modalkit.blind.real.judging import Judgement, judge
from modalkit.module_path import child_environment

DiagnoseTogether = Callable[[Sequence[Path], tuple[str, ...], tuple[str, ...]], Mapping[str, Any]]
TIMEOUT = 900.0
_HIDDEN_VARIABLES = ("PYTEST_CURRENT_TEST", "PYTEST_VERSION")


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
    """Diagnose real structures and judge what is said of them.

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
    with ThreadPoolExecutor(max_workers=workers) as pool:

        def run(case: Case) -> RealOutcome:
            outcome = _run_case(case, samples, data, diagnose or diagnose_together)
            if progress is not None:
                progress(outcome)
            return outcome

        return tuple(pool.map(run, cases))


def _run_case(case: Case, samples: Path, data: Path | None, diagnose: DiagnoseTogether) -> RealOutcome:
    home = data if case.in_data else samples
    if home is None:
        return _missing(case, "needs the folder of measured data; name it with --data")
    absent = next((s.path for s in case.sources if not (home / s.path).exists()), None)
    if absent is not None:
        return _missing(case, f"{home / absent} is not there")
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


def diagnose_together(
    studies: Sequence[Path], shared: tuple[str, ...], without: tuple[str, ...], *, timeout: float = TIMEOUT
) -> dict[str, Any]:
    """Run ``modalkit diagnose`` on one or more studies in a process of its own.

    Parameters
    ----------
    studies : sequence of Path
        Study files in one folder; the process starts there and is given nothing else.
    shared, without : tuple of str
        Effects of one size in all studies, and effects left out of the library.
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
    folder = studies[0].parent
    out = folder / "diagnosis.json"
    command = [
        sys.executable,
        "-P",
        "-m",
        "modalkit",
        "diagnose",
        *(s.name for s in studies),
        "--json",
        out.name,
    ]
    command += ["--shared", ",".join(shared)] if shared else []
    command += ["--without", ",".join(without)] if without else []
    environment = {k: v for k, v in os.environ.items() if k not in _HIDDEN_VARIABLES} | child_environment()
    environment.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        done = subprocess.run(
            command,
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            timeout=timeout,
            stdin=subprocess.DEVNULL,
            check=False,
        )
        if done.returncode != 0:
            last = (done.stderr.strip().splitlines() or ["no message"])[-1]
            raise EstimationError(f"the diagnosis ended with code {done.returncode}: {last}")
        document: dict[str, Any] = json.loads(out.read_text(encoding="utf-8"))
    except subprocess.TimeoutExpired as error:
        raise EstimationError(f"the diagnosis did not end within {timeout:g} s") from error
    except (OSError, ValueError) as error:
        raise EstimationError(f"the diagnosis wrote no readable JSON: {error}") from error
    return document
