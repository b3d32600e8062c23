"""What is being computed, since when, for how long still; and how it is stopped."""

from __future__ import annotations

import ctypes
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from modalkit.app.times import keep, kept, remaining

WORTH = 1.0
"""Computations shorter than this are not recorded [s]."""


class Stopped(BaseException):
    """Raised in the thread that computes once it is to stop; no error of the data, which nothing may pass over."""


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
        self._steps: list[tuple[str, float]] = []
        self._thread: int | None = None

    @contextmanager
    def step(self, name: str) -> Iterator[None]:
        """Name what is computed inside; steps lie within one another."""
        outermost = not self._steps
        if outermost:
            self._thread = threading.get_ident()
        began = time.monotonic()
        self._steps.append((name, began))
        try:
            yield
            seconds = time.monotonic() - began
            if seconds > WORTH and self._times is not None:
                keep(self._times, name, [], seconds)
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
        name, began = steps[-1]
        seconds = time.monotonic() - began
        before = [] if self._times is None else kept(self._times, name)
        left = remaining([], seconds, before)
        return {"what": name, "seconds": seconds, "remaining_s": left}

    def stop(self) -> None:
        """Raise `Stopped` in the thread that computes, at its next step in Python; nothing where none computes."""
        with self._lock:
            if self._thread is not None:
                ctypes.pythonapi.PyThreadState_SetAsyncExc(
                    ctypes.c_ulong(self._thread), ctypes.py_object(Stopped)
                )
