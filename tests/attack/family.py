"""What is attacked: small whole files of one format, how they are read, and what no reader of it could see."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from scipy import sparse


@dataclass(frozen=True, eq=False)
class Reading:
    """What a reader made of a file: a digest of every value, and what it warns of."""

    digest: str
    warnings: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Case:
    """One valid file of a format, with those that belong to it.

    Parameters
    ----------
    name : str
        Name of the file that is attacked.
    files : mapping of str to bytes
        Contents by name, the attacked one among them.
    head : int
        Bytes of it that are its header [-].
    undetectable : callable
        Whether a change from the first bytes to the second leaves a valid file that says something else.
    spans : sequence of (int, int)
        Where numbers stand in binary, each of which may be any other.
    plainly : callable, optional
        From a content to one that says the same in other digits, where a format leaves these free: a mutant may hold
        another number than the whole file, but whoever reads it must read that number, not a part of it.
    """

    name: str
    files: Mapping[str, bytes]
    head: int
    undetectable: Callable[[bytes, bytes], bool]
    spans: Sequence[tuple[int, int]] = ()
    plainly: Callable[[bytes], bytes] | None = None

    def repaired(self, content: bytes) -> bytes:
        """Return a mutant of the same length with the whole file's numbers where they stand in binary."""
        content = content if len(content) == len(self.content) else content.replace(b"\r\n", b"\n")
        for start, stop in self.spans if len(content) == len(self.content) else ():
            content = content[:start] + self.content[start:stop] + content[stop:]
        return content

    @property
    def content(self) -> bytes:
        """The file that is attacked."""
        return self.files[self.name]


@dataclass(frozen=True, eq=False)
class Family:
    """An input family: valid files of one format and the reader that a user's file goes through."""

    name: str
    cases: Sequence[Case]
    read: Callable[[Path], tuple[Any, Sequence[str]]]

    def reading(self, path: Path) -> Reading:
        """Read a file as a user would."""
        values, warnings = self.read(path)
        return Reading(digest(values), tuple(warnings))


def written(name: str, write: Callable[[Path], object]) -> bytes:
    """Return what a writer writes."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / name
        write(path)
        return path.read_bytes()


def digest(value: Any) -> str:
    """Return a hash of every number and word in a value, however nested."""
    total = hashlib.sha256()
    _add(total.update, value)
    return total.hexdigest()


def _add(take: Callable[[bytes], None], value: Any) -> None:
    if isinstance(value, np.ndarray):
        take(f"{value.shape}".encode())
        take(
            np.ascontiguousarray(value, dtype=np.complex128 if value.dtype.kind in "fcui" else None).tobytes()
        )
    elif sparse.issparse(value):
        whole = sparse.csr_array(value)
        whole.sum_duplicates()
        for part in (np.array(whole.shape), whole.indptr, whole.indices, whole.data):
            _add(take, part)
    elif is_dataclass(value) and not isinstance(value, type):
        for field in (f for f in fields(value) if f.name != "source"):
            take(field.name.encode())
            _add(take, getattr(value, field.name))
    elif isinstance(value, Mapping):
        for key in sorted(value, key=str):
            take(f"{key}=".encode())
            _add(take, value[key])
    elif isinstance(value, list | tuple):
        take(f"{len(value)}:".encode())
        for part in value:
            _add(take, part)
    elif isinstance(value, set | frozenset):
        _add(take, sorted(value))
    else:
        take(f"{value!r};".encode())
