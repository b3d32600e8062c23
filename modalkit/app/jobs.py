"""Long work in a process of its own: started, watched by its stages, stopped at once."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from acquisition.errors import InputError
from modalkit.app.work import DRAWINGS, KINDS, REPORT, RESULT
from modalkit.module_path import child_environment
from modalkit.output.whole import write_text

ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
"""Small matrices are worked on slower by several threads, and the page is to stay quick meanwhile."""


@dataclass
class Job:
    """One piece of work.

    Parameters
    ----------
    kind, key : str
        What is done, and to which state.
    folder : Path
        Where the result will stand.
    process : subprocess.Popen
        Who does it.
    begun : float
        When it began [s].
    stages : list of (str, float)
        Stages so far, with the seconds at which they began.
    state : {"running", "done", "failed", "stopped"}
        How it stands.
    error : str
        What went wrong.
    """

    kind: str
    key: str
    folder: Path
    process: subprocess.Popen[str]
    begun: float
    stages: list[tuple[str, float]] = field(default_factory=list)
    state: str = "running"
    error: str = ""

    def document(self) -> dict[str, Any]:
        """Return how it stands."""
        return {
            "kind": self.kind,
            "key": self.key,
            "state": self.state,
            "stages": [{"name": name, "at_s": at} for name, at in self.stages],
            "seconds": time.monotonic() - self.begun,
            "error": self.error,
        }


class Jobs:
    """The work of one app, one piece at a time."""

    def __init__(self) -> None:
        """Begin with none."""
        self._job: Job | None = None
        self._lock = threading.Lock()

    @property
    def last(self) -> Job | None:
        """The work that runs, or ran last."""
        return self._job

    def start(self, kind: str, key: str, study: str, folder: Path) -> Job:
        """Start a piece of work.

        Parameters
        ----------
        kind : str
            One of the kinds of :mod:`modalkit.app.work`.
        key : str
            Of the state it is done to.
        study : str
            The study file's text, its files named from ``folder``.
        folder : Path
            Where study and result are to stand; what stands there is replaced.

        Raises
        ------
        InputError
            If there is no such work, or some is running.
        """
        if kind not in KINDS:
            raise InputError(f"unknown job {kind!r}; there are {', '.join(KINDS)}")
        with self._lock:
            if self._job is not None and self._job.state == "running":
                raise InputError(f"{self._job.kind} is running; stop it, or wait for its end")
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
            write_text(folder / "study.toml", study)
            task = ["modalkit.app.work", kind, str(folder / "study.toml"), str(folder)]
            process = subprocess.Popen(
                [sys.executable, "-P", "-m", *task],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                env=os.environ | child_environment() | ONE_THREAD,
            )
            job = Job(kind, key, folder, process, time.monotonic())
            self._job = job
        threading.Thread(target=_watch, args=(job,), daemon=True).start()
        return job

    def stop(self) -> None:
        """Stop what is running; nothing of it is left."""
        job = self._job
        if job is None or job.state != "running":
            return
        job.state = "stopped"
        job.process.kill()
        job.process.wait()
        shutil.rmtree(job.folder, ignore_errors=True)


def _watch(job: Job) -> None:
    """Follow the lines of a process to its end; what is no news of its own is what went wrong."""
    last = ""
    with job.process as process:
        assert process.stdout is not None
        for line in process.stdout:
            last = last if _note(job, line) else line.strip() or last
    if job.state == "running":
        job.error = job.error or last or f"the process ended with {job.process.returncode}"
        job.state = "failed"


def _note(job: Job, line: str) -> bool:
    """Record a line of the process, and return whether it is new; the last is that the work is done."""
    try:
        news = json.loads(line)
    except ValueError:
        return False
    if not isinstance(news, dict):
        return False
    if "stage" in news:
        job.stages.append((str(news["stage"]), time.monotonic() - job.begun))
    job.error = str(news.get("error", job.error))
    if news.get("done") and job.state == "running":
        job.state = "done"
    return True


def result_of(folder: Path) -> dict[str, Any] | None:
    """Return a result that was finished; None where there is none."""
    return _read(folder / RESULT)


def drawings_of(folder: Path) -> dict[str, Any] | None:
    """Return what is drawn of a result that was finished; None where there is none."""
    return None if result_of(folder) is None else _read(folder / DRAWINGS)


def _read(path: Path) -> dict[str, Any] | None:
    try:
        found: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found


def report_of(folder: Path) -> str | None:
    """Return the report beside a result; None where there is none."""
    try:
        return (folder / REPORT).read_text(encoding="utf-8")
    except OSError:
        return None
