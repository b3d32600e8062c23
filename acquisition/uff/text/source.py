"""The bytes of a file: mapped for searching, read for the numbers, translated where text is unusual."""

from __future__ import annotations

import mmap
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import FileIO
from pathlib import Path
from typing import IO, Any

from acquisition.errors import InputError, cannot_open

_WINDOW = 1 << 20
_KEPT = 1 << 24  # bytes read before their pages are given back
_HEAD = 1 << 16


@dataclass(frozen=True, eq=False)
class Source:
    """An open file.

    Parameters
    ----------
    name : str
        Name of the file, for messages.
    data : mmap
        Its bytes, mapped: for headers and delimiters, not for numbers.
    file : binary file
        For reading numbers.
    note : str
        How it had to be translated; empty if not.
    """

    name: str
    data: mmap.mmap
    file: IO[bytes] | FileIO
    note: str = ""

    def newlines(self, start: int, stop: int) -> int:
        """Count line ends between two places."""
        count = 0
        for first in range(start, stop, _WINDOW):
            last = min(first + _WINDOW, stop)
            count += self.data[first:last].count(b"\n")
            self.passed(first, last)
        return count

    def passed(self, start: int, stop: int) -> None:
        """Record what has been read; every now and then its pages are given back to the system."""
        if start // _KEPT != stop // _KEPT:
            self.release()

    def release(self) -> None:
        """Give the pages of the map back to the system; they are read again when needed."""
        if hasattr(mmap, "MADV_DONTNEED"):
            self.data.madvise(mmap.MADV_DONTNEED)


@contextmanager
def opened(path: Path) -> Iterator[Source]:
    """Open a file for reading.

    Raises
    ------
    InputError
        If it cannot be opened, is empty, or is text in an encoding that cannot be read.
    """
    try:
        file: IO[bytes] | FileIO = path.open("rb", buffering=0)
    except (OSError, ValueError) as error:
        raise cannot_open(path, error) from None
    with file:
        translated, note = _translated(file, path)
        with translated:
            try:
                data = mmap.mmap(translated.fileno(), 0, access=mmap.ACCESS_READ)
            except ValueError:
                raise InputError(f"{path}: the file is empty; export it again") from None
            except OSError as error:
                raise InputError(f"{path}: cannot be read ({error.strerror}); copy it to a disk") from None
            with data:
                yield Source(path.name, data, translated, note)


def _translated(file: FileIO | IO[bytes], path: Path) -> tuple[Any, str]:
    """Return the file, or a temporary one with the same text in plain characters and line ends."""
    try:
        head = file.read(_HEAD)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from None
    encoding = _wide(head)
    if encoding:
        try:
            text = (head + file.read()).decode(encoding).lstrip("\ufeff").encode("latin-1", "replace")
        except UnicodeDecodeError:
            raise InputError(
                f"{path}: begins as {encoding} text and is cut off or garbled; export as plain text"
            ) from None
        return _temporary(text), f"it is {encoding} text; read as plain text"
    if head.startswith(b"\xef\xbb\xbf"):
        return _temporary(head[3:] + file.read()), ""
    if b"\r" in head and b"\n" not in head:
        return _temporary((head + file.read()).replace(b"\r", b"\n")), ""
    return file, ""


def _wide(head: bytes) -> str:
    """Return the encoding if the text has two bytes a character, else nothing."""
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    start = head[:64]
    if len(start) > 8:
        low, high = start[0::2], start[1::2]
        if not any(high) and all(low):
            return "utf-16-le"
        if not any(low) and all(high):
            return "utf-16-be"
    return ""


def _temporary(content: bytes) -> Any:
    file = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115  closed by the caller
    file.write(content)
    file.seek(0)
    return file
