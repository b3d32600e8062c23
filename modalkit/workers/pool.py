"""Several warm processes, shared among threads, and a bounded number of things in flight."""

from __future__ import annotations

import queue
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TypeVar

from modalkit.workers.client import COMMAND, TIMEOUT, WarmProcess

T = TypeVar("T")
R = TypeVar("R")

RunCommand = Callable[[Path, Sequence[str]], None]
"""Folder, and words without ``modalkit``; see :meth:`modalkit.workers.WarmProcess.run`."""


@contextmanager
def warm_pool(
    number: int, *, command: Sequence[str] = COMMAND, timeout: float = TIMEOUT
) -> Iterator[RunCommand]:
    """Keep warm processes and share them among threads.

    Parameters
    ----------
    number : int
        Processes, and commands that may run at a time [-].
    command : sequence of str
        What is started.
    timeout : float
        Longest time a command may take [s].

    Yields
    ------
    callable
        Runs a command in a process that is free, and waits for one where none is.
    """
    free: queue.SimpleQueue[WarmProcess] = queue.SimpleQueue()
    with ExitStack() as stack:
        for _ in range(number):
            process = WarmProcess(command=command, timeout=timeout)
            process.start(wait=False)
            stack.callback(process.close)
            free.put(process)

        def run(folder: Path, arguments: Sequence[str]) -> None:
            process = free.get()
            try:
                process.run(folder, arguments)
            finally:
                free.put(process)

        yield run


def in_flight(
    pool: ThreadPoolExecutor, work: Callable[[T], R], things: Sequence[T], at_a_time: int
) -> Iterator[R]:
    """Yield results as they come; the next thing begins when a result has been taken.

    Parameters
    ----------
    pool : ThreadPoolExecutor
        Whose threads work.
    work : callable
        Thing to result.
    things : sequence
        What is worked on, in this order.
    at_a_time : int
        So many at a time [-].
    """
    waiting: set[Future[R]] = set()
    left = iter(things)
    more = True
    try:
        while True:
            while more and len(waiting) < at_a_time:
                try:
                    waiting.add(pool.submit(work, next(left)))
                except StopIteration:
                    more = False
            if not waiting:
                return
            done, waiting = wait(waiting, return_when=FIRST_COMPLETED)
            for future in done:
                yield future.result()
    finally:
        for future in waiting:
            future.cancel()
