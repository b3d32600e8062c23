"""The way to a Dask cluster, and what stays on its worker machines between tasks: warm processes."""

from __future__ import annotations

import queue
import re
import secrets
import socket
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from typing import Any

from acquisition.errors import EstimationError, InputError
from modalkit.version import __version__
from modalkit.workers.client import COMMAND
from modalkit.workers.pool import warm_pool

_ADDRESS = re.compile(r"(?:(?:tcp|tls)://)?\[?(?P<host>[^/\s\[\]]+?)\]?:(?P<port>\d+)")
_CONNECT = 10.0  # s in which a scheduler must answer
_AHEAD = 3  # tasks in flight for each thread of the cluster: one runs, two wait
_LEAST = 16  # and at least so many


class Keeper:
    """A plugin of Dask's workers: a warm process for each of a worker's threads.

    Parameters
    ----------
    version : str
        Of modalkit; a worker with another one is refused.
    command : sequence of str, optional
        What is started there; empty for the usual one with the worker's own interpreter, None for no process at all.
    """

    def __init__(self, *, version: str = __version__, command: Sequence[str] | None = ()) -> None:
        """State what is to be started, and with which version."""
        self.version = version
        self.command = command

    def setup(self, worker: Any) -> None:
        """Start the processes.

        Raises
        ------
        InputError
            If another version of modalkit is installed on the worker.
        """
        if self.version != __version__:
            raise InputError(
                f"worker {worker.address} has modalkit {__version__}, the run {self.version}; install the same"
            )
        self.stack = ExitStack()
        if self.command is not None:
            pool = warm_pool(worker.state.nthreads, command=self.command or COMMAND)
            self.run = self.stack.enter_context(pool)

    def teardown(self, worker: Any) -> None:
        """End the processes."""
        self.stack.close()


@dataclass(frozen=True)
class Cluster:
    """A cluster whose workers keep warm processes.

    Parameters
    ----------
    client : distributed.Client
        The connection.
    name : str
        Of the workers' plugin, and of the topic of what they tell.
    events : queue.SimpleQueue
        What tasks tell on the way, and the futures that have ended.
    """

    client: Any
    name: str
    events: queue.SimpleQueue[Any]

    def happens(self, task: Callable[..., Any], tasks: Sequence[tuple[Any, ...]]) -> Iterator[Any]:
        """Run tasks and yield what happens: what they tell with :func:`tell`, and ``Ended`` results.

        Parameters
        ----------
        task : callable
            Called on a worker with the name of the plugin, then with what stands in ``tasks``.
        tasks : sequence of tuple
            Arguments.

        Raises
        ------
        EstimationError
            If the cluster goes away, or a task ends its worker again and again.
        """
        left = iter(enumerate(tasks))
        waiting: dict[Any, Any] = {}

        def fill() -> None:
            threads = sum(self.client.nthreads().values())
            while len(waiting) < max(_LEAST, _AHEAD * threads) and (one := next(left, None)) is not None:
                key = f"{self.name}-{one[0]}"
                future = self.client.submit(task, self.name, *one[1], key=key, pure=False)
                waiting[key] = future
                future.add_done_callback(self.events.put)

        try:
            fill()
            while waiting:
                event = self.events.get()
                if isinstance(event, dict):
                    yield event
                else:
                    waiting.pop(event.key)
                    result = _result(event)
                    fill()
                    yield Ended(result)
            while not self.events.empty():
                yield self.events.get()
        finally:
            if waiting:
                with suppress(OSError, TimeoutError):
                    self.client.cancel(list(waiting.values()))


@dataclass(frozen=True)
class Ended:
    """A task that has ended.

    Parameters
    ----------
    result : object
        What it returned.
    """

    result: Any


def keeper(name: str) -> Any:
    """Return the plugin of the worker that this task runs on."""
    from distributed import get_worker

    return get_worker().plugins[name]


def announce_event(name: str, document: dict[str, Any]) -> None:
    """Send a document from a task to the one who runs it, on the way of the results and before this one's."""
    from distributed import get_worker

    get_worker().log_event(name, document)


@contextmanager
def connected(scheduler: str, *, command: Sequence[str] | None = ()) -> Iterator[Cluster]:
    """Connect to a cluster and keep warm processes on its workers, those that join later too.

    Parameters
    ----------
    scheduler : str
        Address of the scheduler, ``tcp://host:8786``.
    command : sequence of str, optional
        What is started on the workers; empty for the usual one, None for nothing, where tasks need no warm process.

    Yields
    ------
    Cluster

    Raises
    ------
    InputError
        If Dask is not installed or the scheduler cannot be reached.
    """
    events: queue.SimpleQueue[Any] = queue.SimpleQueue()
    name = f"modalkit-{secrets.token_hex(8)}"
    with _client(scheduler) as client:
        client.subscribe_topic(name, lambda event: events.put(event[1]))
        client.register_plugin(_plugin(command), name=name)
        try:
            yield Cluster(client, name, events)
        finally:
            with suppress(OSError, ValueError, TimeoutError):
                client.unsubscribe_topic(name)
                client.unregister_worker_plugin(name)


def _plugin(command: Sequence[str] | None) -> Any:
    from distributed import WorkerPlugin

    return type("Keeper", (Keeper, WorkerPlugin), {})(command=command)


def _client(scheduler: str) -> Any:
    check_scheduler(scheduler)
    from distributed import Client

    try:
        return Client(scheduler, timeout=_CONNECT, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise InputError(_strange(scheduler)) from error


def check_scheduler(scheduler: str) -> None:
    """See that Dask is installed and somebody listens, before it tries for long, or a store is begun.

    Parameters
    ----------
    scheduler : str
        Address, ``tcp://host:8786``.

    Raises
    ------
    InputError
        If it is not, or nobody does.
    """
    try:
        import distributed  # noqa: F401
    except ImportError as error:
        raise InputError(
            "--scheduler needs Dask; install the extra: pip install 'modalkit-ema[cluster]'"
        ) from error
    found = _ADDRESS.fullmatch(scheduler)
    if found is None:
        raise InputError(f"--scheduler {scheduler!r}: not an address; give it as tcp://host:8786")
    try:
        with socket.create_connection((found["host"], int(found["port"])), timeout=_CONNECT) as line:
            if not scheduler.startswith("tls:") and not line.recv(1):  # a scheduler sends first
                raise InputError(_strange(scheduler))
    except TimeoutError as error:
        raise InputError(_strange(scheduler)) from error
    except (OSError, OverflowError) as error:
        raise InputError(
            f"--scheduler {scheduler}: no answer there; start one with `dask scheduler` and give its "
            "address, tcp://host:8786"
        ) from error


def _strange(scheduler: str) -> str:
    return f"--scheduler {scheduler}: the program there is not a compatible Dask scheduler; check the address"


def _result(future: Any) -> Any:
    from distributed import CancelledError, KilledWorker

    try:
        return future.result()
    except KilledWorker as error:
        raise EstimationError(f"a task stopped its worker several times: {error}") from error
    except (CancelledError, OSError) as error:
        raise EstimationError(
            "the connection to the cluster was lost; restore it and continue with --resume"
        ) from error
