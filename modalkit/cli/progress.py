"""What a long command shows while it works, on stderr: its stage, how much of it is done, how long it will take.

In a terminal one line is renewed; where stderr is piped, a line is written every ten seconds. Nothing is written of
work that ends before that, and nothing where ``MODALKIT_PROGRESS`` is ``off``.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from rich.console import Console
from rich.progress import BarColumn, Progress, ProgressColumn, Task
from rich.text import Text

from modalkit.output.durations import duration
from modalkit.workflow.stages import READING

EVERY = 10.0
"""Between two lines where stderr is piped [s]."""

LEAST_PART = 0.03
"""Part of a stage from which on its duration is extrapolated [-]."""

SWITCH = "MODALKIT_PROGRESS"
"""Environment variable that switches these lines off."""

progress = Console(stderr=True)


@dataclass(eq=False)
class Work:
    """Work that goes on: its stage, and how much of that is done.

    Parameters
    ----------
    stage : str
        What is being done.
    clock : function
        Seconds from any moment on [s].
    then : str
        The stage that follows once all files are read.
    """

    stage: str
    clock: Callable[[], float] = time.monotonic
    then: str = ""
    part: float | None = None
    counted: tuple[int, int] | None = None
    _start: float = field(init=False)
    _stage_start: float = field(init=False)

    def __post_init__(self) -> None:
        """Take the time."""
        self._start = self._stage_start = self.clock()

    def begin(self, stage: str) -> None:
        """Go on to another stage."""
        self.stage, self.part, self.counted = stage, None, None
        self._stage_start = self.clock()

    def done(self, part: float) -> None:
        """State how much of the stage is done, from 0 to 1."""
        self.part = min(max(part, 0.0), 1.0)

    def read(self, part: float) -> None:
        """State how much of the files is read, from 0 to 1; the next stage begins once all are."""
        if part < 1.0:
            self.done(part)
        else:
            self.begin(self.then)

    def count(self, done: int, of: int) -> None:
        """State how many of the pieces of a stage are done."""
        self.counted = done, of
        self.done(done / of if of else 0.0)

    def counter(self, of: int) -> Callable[..., None]:
        """Return what is called once for every piece that is done, whatever it is called with."""
        self.count(0, of)
        finished = itertools.count(1)
        return lambda *_: self.count(next(finished), of)

    @property
    def left(self) -> float | None:
        """How long the stage will still take by what is done of it [s]; None where that is not known."""
        if self.part is None or self.part < LEAST_PART:
            return None
        return (self.clock() - self._stage_start) * (1 / self.part - 1)

    def line(self) -> str:
        """Return the stage, how much of it is done, how long it will still take, and how long all has taken."""
        parts = [self.stage]
        if self.counted is not None:
            parts.append(f"{self.counted[0]} of {self.counted[1]}")
        if self.part is not None:
            parts.append(f"{100 * self.part:.0f} %")
        if self.left is not None:
            whole = "" if self.counted is not None else " in this stage"
            parts.append(f"about {duration(self.left)} left{whole}")
        return f"{', '.join(parts)} ({duration(self.clock() - self._start)} so far)"


class _Line(ProgressColumn):
    """The line of a piece of work, written anew with every turn of the display."""

    def __init__(self, work: Work) -> None:
        super().__init__()
        self.work = work

    def render(self, task: Task) -> Text:
        """Return the line; the bar beside it follows the same part."""
        task.total = None if self.work.part is None else 1.0
        task.completed = self.work.part or 0.0
        return Text(self.work.line())


@contextmanager
def working(stage: str) -> Iterator[Work]:
    """Show work that goes on, until it ends.

    Parameters
    ----------
    stage : str
        Its first stage.
    """
    work = Work(stage)
    if os.environ.get(SWITCH, "").lower() == "off":
        yield work
    elif progress.is_terminal:
        with Progress(BarColumn(20), _Line(work), console=progress, transient=True) as bar:
            bar.add_task("", total=None)
            yield work
    else:
        with _lines(work):
            yield work


@contextmanager
def _lines(work: Work) -> Iterator[None]:
    """Write a line every ten seconds."""
    ended = threading.Event()

    def write() -> None:
        while not ended.wait(EVERY):
            with contextlib.suppress(OSError, ValueError):  # nobody reads it any more
                progress.print(work.line(), markup=False, highlight=False, soft_wrap=True)

    thread = threading.Thread(target=write, daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()


@contextmanager
def reading(then: str) -> Iterator[Work]:
    """Show how much of the files is read, which is stated by :meth:`Work.read`, and after that what is done with them.

    Parameters
    ----------
    then : str
        What is done once the files are read.
    """
    with working(READING) as work:
        work.then = then
        yield work
