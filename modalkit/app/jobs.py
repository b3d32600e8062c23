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
from modalkit.app.times import Stages, keep, kept, remaining
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
    before : sequence of (str, float)
        Stages of the last piece of this kind, with its end.
    ended : float
        How long it took, once it is done [s].
    found : dict of str to dict
        Single causes as far as they are compared, by name.
    """

    kind: str
    key: str
    folder: Path
    process: subprocess.Popen[str]
    begun: float
    stages: list[tuple[str, float]] = field(default_factory=list)
    state: str = "running"
    error: str = ""
    before: Stages = ()
    ended: float = 0.0
    found: dict[str, dict[str, Any]] = field(default_factory=dict)

    def document(self) -> dict[str, Any]:
        """Return how it stands."""
        seconds = time.monotonic() - self.begun
        return {
            "remaining_s": remaining(self.stages, seconds, self.before),
            "kind": self.kind,
            "key": self.key,
            "state": self.state,
            "stages": [{"name": name, "at_s": at} for name, at in self.stages],
            "seconds": seconds,
            "error": self.error,
            "found": list(self.found.values()),
        }


class Jobs:
    """The work of one app, one piece at a time.

    Parameters
    ----------
    times : Path
        File of how long work took.
    """

    def __init__(self, times: Path) -> None:
        """Begin with none."""
        self._times = times
        self._job: Job | None = None
        self._waiting: subprocess.Popen[str] | None = None
        self._lock = threading.Lock()

    @property
    def last(self) -> Job | None:
        """The work that runs, or ran last."""
        return self._job

    def warm(self) -> None:
        """Have a process at hand that has read all that work needs and waits for it, where none runs."""
        with self._lock:
            running = self._job is not None and self._job.state == "running"
            if not running and (self._waiting is None or self._waiting.poll() is not None):
                self._waiting = _process()

    def close(self) -> None:
        """Stop what is running, and the process that waits."""
        self.stop()
        with self._lock:
            if self._waiting is not None:
                _end(self._waiting)
                self._waiting = None

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
            process, self._waiting = self._waiting, None
            if process is None or process.poll() is not None:
                process = _process()
            assert process.stdin is not None
            task = {"kind": kind, "study": str(folder / "study.toml"), "folder": str(folder)}
            try:
                process.stdin.write(json.dumps(task) + "\n")
                process.stdin.close()
            except OSError as error:
                _end(process)
                raise InputError(f"the work cannot be started ({error.strerror}); start it again") from error
            before = kept(self._times, kind)
            job = Job(kind, key, folder, process, time.monotonic(), before=before)
            self._job = job
        threading.Thread(target=_watch, args=(job, self._times), daemon=True).start()
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


def _process() -> subprocess.Popen[str]:
    """Return a process that reads one task from its input and does it."""
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "modalkit.app.work"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=os.environ | child_environment() | ONE_THREAD,
    )


def _end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.wait()
    for stream in (process.stdin, process.stdout):
        if stream is not None:
            stream.close()


def _watch(job: Job, times: Path) -> None:
    """Follow the lines of a process to its end; what is no news of its own is what went wrong."""
    last = ""
    with job.process as process:
        assert process.stdout is not None
        for line in process.stdout:
            last = last if _note(job, line) else line.strip() or last
    if job.state == "done":
        keep(times, job.kind, job.stages, job.ended)
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
    if isinstance(one := news.get("found"), dict):
        job.found = job.found | {str(one["name"]): one}  # a new one: it may be read meanwhile
    job.error = str(news.get("error", job.error))
    if news.get("done") and job.state == "running":
        job.ended = time.monotonic() - job.begun
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
