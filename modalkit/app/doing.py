"""What is being computed, since when, for how long still; and how it is stopped."""

from __future__ import annotations

import ctypes
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from modalkit.app.times import keep, kept, remaining

WORTH = 1.0
"""Computations shorter than this are not recorded [s]."""


class Stopped(BaseException):
    """Raised in the thread that computes once it is to stop; no error of the data, which nothing may pass over."""


@dataclass
class _Step:
    """A step that is being computed, with the seconds at which its stages began."""

    name: str
    began: float
    stages: list[tuple[str, float]] = field(default_factory=list)

    @property
    def seconds(self) -> float:
        """How long it has gone on [s]."""
        return time.monotonic() - self.began


class Doing:
    """The computation of one thread at a time, by the names of its steps.

    Parameters
    ----------
    times : Path or None
        File of how long steps took; None where that is not kept.
    """

    def __init__(self, times: Path | None) -> None:
        """Begin with nothing computed."""
        self._times = times
        self._lock = threading.Lock()
        self._steps: list[_Step] = []
        self._thread: int | None = None

    @contextmanager
    def step(self, name: str) -> Iterator[None]:
        """Name what is computed inside; steps lie within one another."""
        outermost = not self._steps
        if outermost:
            self._thread = threading.get_ident()
        step = _Step(name, time.monotonic())
        self._steps.append(step)
        try:
            yield
            if step.seconds > WORTH and self._times is not None:
                keep(self._times, name, step.stages, step.seconds)
        finally:
            try:
                if outermost:
                    with self._lock:  # a stop that was asked for until now is raised here at the latest
                        self._thread = None
            finally:
                del self._steps[-1:]
                if outermost:
                    self._thread = None

    def document(self) -> dict[str, Any]:
        """Return what is computed, since when and for how long still [s]; an empty name for nothing."""
        steps = list(self._steps)
        if not steps:
            return {"what": "", "seconds": 0.0, "remaining_s": None}
        step = steps[-1]
        stages, seconds = list(step.stages), step.seconds
        before = [] if self._times is None else kept(self._times, step.name)
        left = remaining(stages, seconds, before)
        what = f"{step.name}: {stages[-1][0]}" if stages else step.name
        return {"what": what, "seconds": seconds, "remaining_s": left}

    def stage(self, name: str) -> None:
        """Name the stage that begins in the innermost step; nothing outside of steps."""
        if self._steps:
            step = self._steps[-1]
            step.stages.append((name, step.seconds))

    def stop(self) -> None:
        """Raise `Stopped` in the thread that computes, at its next step in Python; nothing where none computes."""
        with self._lock:
            if self._thread is not None:
                ctypes.pythonapi.PyThreadState_SetAsyncExc(
                    ctypes.c_ulong(self._thread), ctypes.py_object(Stopped)
                )
