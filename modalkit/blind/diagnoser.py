"""The process that diagnoses: it gets a study file and what to leave out of the library, nothing else."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from acquisition.errors import EstimationError
from modalkit.workers import ATTEMPTS, COMMAND, TIMEOUT, WarmProcess
from modalkit.workers.pool import RunCommand, warm_pool

Diagnose = Callable[[Path, tuple[str, ...]], Mapping[str, Any]]
"""Study file, and effects to leave out of the library, to the diagnosis as JSON."""

DIAGNOSIS = "diagnosis.json"


class Diagnoser:
    """``modalkit diagnose`` in a warm process of its own.

    Parameters
    ----------
    command : sequence of str
        What is started; see :class:`modalkit.workers.WarmProcess`.
    timeout : float
        Longest time a diagnosis may take [s].
    attempts : int
        How often a diagnosis is tried whose process dies [-].
    """

    def __init__(
        self, *, command: Sequence[str] = COMMAND, timeout: float = TIMEOUT, attempts: int = ATTEMPTS
    ) -> None:
        """State what is to be started; it starts on entering the context."""
        self.process = WarmProcess(command=command, timeout=timeout, attempts=attempts)

    def __enter__(self) -> Self:
        """Begin to load; the first diagnosis waits until all is loaded."""
        self.process.start(wait=False)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """End the process."""
        self.process.close()

    def __call__(self, study: Path, without: tuple[str, ...] = ()) -> Mapping[str, Any]:
        """Diagnose a study.

        Parameters
        ----------
        study : Path
            The study file; the diagnosis runs in its folder and is given nothing else.
        without : tuple of str
            Effects to leave out of the library.

        Returns
        -------
        dict
            The diagnosis as JSON.

        Raises
        ------
        EstimationError
            If the diagnosis fails, does not end, or writes no JSON.
        """
        return diagnose_by(self.process.run)(study, without)


def read_diagnosis(path: Path) -> dict[str, Any]:
    """Read what a diagnosis has written.

    Raises
    ------
    EstimationError
        If it is not JSON.
    """
    try:
        document: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise EstimationError(f"the diagnosis wrote no readable JSON: {reason}") from error
    return document


def diagnose_by(run: RunCommand) -> Diagnose:
    """Return a diagnosis that runs where the command is run.

    Parameters
    ----------
    run : callable
        As :func:`modalkit.workers.pool.warm_pool` yields it.
    """

    def diagnose(study: Path, without: tuple[str, ...] = ()) -> dict[str, Any]:
        left_out = ["--without", ",".join(without)] if without else []
        run(study.parent, ["diagnose", study.name, "--json", DIAGNOSIS, *left_out])
        return read_diagnosis(study.parent / DIAGNOSIS)

    return diagnose


@contextmanager
def diagnosers(number: int, *, command: Sequence[str] = COMMAND) -> Iterator[Diagnose]:
    """Keep warm diagnosing processes and share them among threads.

    Parameters
    ----------
    number : int
        Processes, and diagnoses that may run at a time [-].
    command : sequence of str
        What is started.

    Yields
    ------
    callable
        Takes a process that is free, and waits for one where none is.
    """
    with warm_pool(number, command=command) as run:
        yield diagnose_by(run)
