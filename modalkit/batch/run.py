"""Run many studies in warm processes, on this machine or a cluster, and keep each result as it comes."""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, closing
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from acquisition.display import Displayed
from acquisition.errors import EstimationError, InputError
from modalkit.batch.find import Found
from modalkit.version import __version__
from modalkit.workers.client import CommandFailedError
from modalkit.workers.journal import Journal, is_store, read_journal
from modalkit.workers.pool import RunCommand, in_flight, warm_pool

SCHEMA = "modalkit.batchrun/1"
_OUT = "part.json"
_FINISHED = {"finished": True}


@dataclass(frozen=True)
class Part(Displayed):
    """One study of a batch.

    Parameters
    ----------
    name : str
        Its path in the folder.
    digest : str
        SHA-256 of its files.
    record : dict or None
        As :func:`modalkit.batch.part_document` returns it; None where the study failed.
    failure : str or None
        Message of a study that failed.
    """

    name: str
    digest: str
    record: dict[str, Any] | None
    failure: str | None


@dataclass(frozen=True)
class BatchResult(Displayed):
    """What came out of a folder of studies, in the order of their paths.

    Parameters
    ----------
    parts : tuple of Part
        One per study.
    """

    parts: tuple[Part, ...]

    @property
    def worked(self) -> tuple[Part, ...]:
        """Those with a record."""
        return tuple(part for part in self.parts if part.record is not None)

    @property
    def skipped(self) -> tuple[Part, ...]:
        """Those that failed."""
        return tuple(part for part in self.parts if part.record is None)

    def _headline(self) -> str:
        return f"{len(self.worked)} studies worked out, {len(self.skipped)} failed"


def run_batch(
    studies: Sequence[Found],
    *,
    workers: int = 1,
    scheduler: str | None = None,
    store: Path | str | None = None,
    resume: bool = False,
    progress: Callable[[Part], None] | None = None,
) -> BatchResult:
    """Run studies; the result does not depend on workers, cluster, order or interruptions.

    Parameters
    ----------
    studies : sequence of Found
        What to run.
    workers : int
        Studies in flight at a time on this machine, each in a process of its own [-].
    scheduler : str, optional
        Address of a Dask scheduler whose workers run the studies; they see the files under the same paths.
    store : path, optional
        File that takes each result as it comes; that of a run that came to its end is begun anew.
    resume : bool
        Whether to run only what the store does not hold: studies that are new, have changed, or failed.
    progress : callable, optional
        Called with each part, those of the store first, then in the order in which they end.

    Raises
    ------
    InputError
        If there are no workers, the store is not a store of a batch, or the scheduler cannot be reached.
    """
    if workers < 1:
        raise InputError(f"--workers {workers}: at least 1 is needed")
    if scheduler is not None:
        from modalkit.workers.cluster import check_scheduler

        check_scheduler(scheduler)
    parts: dict[str, Part] = {}
    with ExitStack() as stack:
        journal = None if store is None else stack.enter_context(_journal(Path(store), resume))
        for part in _kept(journal):
            parts[part.name] = part
        wanted = {found.name: found for found in studies}
        parts = {n: p for n, p in parts.items() if n in wanted and p.digest == wanted[n].digest}
        for part in parts.values():
            if progress is not None:
                progress(part)
        missing = [found for found in studies if found.name not in parts]
        with closing(_running(missing, workers, scheduler)) as running:
            for part in running:
                if journal is not None:
                    journal.append(_line(part))
                parts[part.name] = part
                if progress is not None:
                    progress(part)
        if journal is not None:
            journal.append(_FINISHED)
    return BatchResult(tuple(parts[found.name] for found in studies))


def _journal(store: Path, resume: bool) -> Journal:
    """Open a store; one of a run that came to its end is begun anew, unless it is to be gone on with."""
    if not resume and store.is_file():
        documents, _ = read_journal(store)
        if is_store(documents) and documents[-1] == _FINISHED:
            store.unlink()
    return Journal(store, resume=resume)


def _kept(journal: Journal | None) -> list[Part]:
    """Return what a store holds of studies that worked, after its header was written or checked."""
    if journal is None:
        return []
    if not journal.found:
        journal.append({"schema": SCHEMA, "version": __version__})
        return []
    header, *lines = journal.found
    if header.get("schema") != SCHEMA:
        raise InputError(f"{journal.path}: not a store of a batch ({SCHEMA}); name another table")
    if header.get("version") != __version__:
        raise InputError(
            f"{journal.path}: made by modalkit {header.get('version')}, this is {__version__}; remove it to start again"
        )
    parts = []
    for line in (line for line in lines if line != _FINISHED):
        try:
            part = Part(**{key: value for key, value in line.items() if key != "sha256"})
        except TypeError as error:
            raise InputError(
                f"{journal.path}: a line is not a result ({error}); remove it to start again"
            ) from error
        if _line(part) != line:
            raise InputError(
                f"{journal.path}: the result of {part.name} was changed; remove it to start again"
            )
        parts.append(part)
    return [part for part in parts if part.record is not None]


def _line(part: Part) -> dict[str, Any]:
    """Return a part as its line in the store, with the hash by which a change is seen."""
    content = asdict(part)
    plain = json.dumps(content, sort_keys=True, separators=(",", ":")).encode()
    return content | {"sha256": hashlib.sha256(plain).hexdigest()}


def _running(studies: Sequence[Found], workers: int, scheduler: str | None) -> Generator[Part, None, None]:
    if not studies:
        return
    if scheduler is not None:
        from modalkit.workers.cluster import Ended, connected

        with connected(scheduler) as cluster:
            tasks = [(found.name, str(found.path.resolve()), found.digest) for found in studies]
            for event in cluster.happens(_task, tasks):
                if isinstance(event, Ended):
                    yield Part(**event.result)
        return
    workers = min(workers, len(studies))
    with ExitStack() as stack:
        pool = stack.enter_context(ThreadPoolExecutor(max_workers=workers))
        run = stack.enter_context(warm_pool(workers))  # ended first, so that no thread waits for it
        yield from in_flight(pool, lambda found: run_part(found, run), studies, workers)


def run_part(found: Found, run: RunCommand) -> Part:
    """Run one study in a warm process.

    Parameters
    ----------
    found : Found
        The study.
    run : callable
        As :func:`modalkit.workers.pool.warm_pool` yields it.
    """
    with tempfile.TemporaryDirectory(prefix="batch-", ignore_cleanup_errors=True) as folder:
        out = Path(folder) / _OUT
        try:
            run(found.path.parent, ["part", found.path.name, "--json", str(out)])
            return Part(found.name, found.digest, json.loads(out.read_text(encoding="utf-8")), None)
        except CommandFailedError as error:
            return Part(found.name, found.digest, None, error.message.removeprefix(f"{found.path.name}: "))
        except EstimationError as error:
            return Part(found.name, found.digest, None, str(error))
        except (OSError, ValueError) as error:
            return Part(found.name, found.digest, None, f"no readable result: {error}")


def _task(name: str, study: str, path: str, digest: str) -> dict[str, Any]:
    """Run a study on a worker machine; runs there."""
    from modalkit.workers.cluster import keeper

    return asdict(run_part(Found(study, Path(path), digest), keeper(name).run))
