"""A journal: one JSON document a line, on the disk before the next thing happens, taken up again after a kill."""

from __future__ import annotations

import json
import os
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from acquisition.errors import InputError
from modalkit.output.destinations import is_torn_header

try:
    from fcntl import LOCK_EX, LOCK_NB, flock
except ImportError:  # where there is none, two runs on one journal are not noticed
    flock = None  # type: ignore[assignment]


def read_journal(path: Path) -> tuple[list[dict[str, Any]], int]:
    """Read a journal.

    Parameters
    ----------
    path : Path
        One JSON document a line.

    Returns
    -------
    documents : list of dict
        Those whose lines are whole; a last line without its end was torn by a kill and is left out.
    size : int
        Bytes that whole lines take [-].

    Raises
    ------
    InputError
        If it cannot be read, ends as no journal does, or a whole line is not JSON.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); name the store of a run") from error
    size = content.rfind(b"\n") + 1
    if content[size : size + 1] not in (b"", b"{"):
        raise InputError(f"{path}: not a store of a run, or damaged; name another file")
    documents = []
    for number, line in enumerate(content[:size].splitlines(), start=1):
        try:
            document = json.loads(line)
        except (ValueError, RecursionError) as error:
            raise InputError(
                f"{path}, line {number}: not JSON; the file was changed or is not a store of a run"
            ) from error
        if not isinstance(document, dict):
            raise InputError(f"{path}, line {number}: not a record; the file is not a store of a run")
        documents.append(document)
    return documents, size


def is_store(documents: Sequence[Mapping[str, Any]]) -> bool:
    """Return whether documents begin as those of our stores do; another's lines are not to be cut."""
    return bool(documents) and str(documents[0].get("schema", "")).startswith("modalkit.")


class Journal:
    """A journal that is written.

    Parameters
    ----------
    path : Path
        The file; its folder exists.
    resume : bool
        Whether to go on with one that stands there; a torn last line is dropped.

    Raises
    ------
    InputError
        If there is one and it is not to be resumed, it cannot be written, or another run writes to it.
    """

    def __init__(self, path: Path, *, resume: bool = False) -> None:
        """Open the file, and read what stands in it."""
        self.path = path
        self._lock = threading.Lock()
        try:
            self._file = os.open(
                path, os.O_RDWR | os.O_CREAT | os.O_APPEND | getattr(os, "O_BINARY", 0), 0o644
            )
        except OSError as error:
            raise InputError(f"{path}: cannot be written ({error.strerror}); name another file") from error
        try:
            self.found = self._take_up(resume)
        except BaseException:
            os.close(self._file)
            raise

    def _take_up(self, resume: bool) -> tuple[dict[str, Any], ...]:
        if flock is not None:
            try:
                flock(self._file, LOCK_EX | LOCK_NB)
            except OSError as error:
                raise InputError(f"{self.path}: another run writes to it; wait for its end") from error
        if not os.fstat(self._file).st_size:
            return ()
        if not resume:
            raise InputError(f"{self.path}: exists; continue it with --resume, or name another file")
        documents, size = read_journal(self.path)
        if not (is_store(documents) or (not documents and is_torn_header(self.path.read_bytes()))):
            raise InputError(f"{self.path}: is not a store of a run; name another file")
        os.ftruncate(self._file, size)
        return tuple(documents)

    def __enter__(self) -> Self:
        """Return the journal."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """Close the file, and leave it to others."""
        with self._lock:
            os.close(self._file)
            self._file = -1

    def append(self, document: Mapping[str, Any]) -> None:
        """Write a line, and see it on the disk; may be called by several threads.

        Raises
        ------
        InputError
            If the disk is full, or the journal closed; no part of the line is left, for others may come behind it.
        """
        line = json.dumps(document, separators=(",", ":"), allow_nan=False).encode() + b"\n"
        try:
            with self._lock:
                whole = os.fstat(self._file).st_size
                try:
                    while line:
                        line = line[os.write(self._file, line) :]
                    os.fsync(self._file)
                except OSError:
                    os.ftruncate(self._file, whole)
                    raise
        except OSError as error:
            raise InputError(f"{self.path}: cannot be written ({error.strerror})") from error
