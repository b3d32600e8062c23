"""Where outputs go: over no file that the command reads, and over none that is not of the kind it writes."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from acquisition.errors import InputError

_STORE = b'{"schema":"modalkit.'
_SCHEMA = re.compile(rb'\s*\{\s*"schema"\s*:\s*"(modalkit\.\w+)/\d+"')


@dataclass(frozen=True)
class Kind:
    """A kind of file that a command writes.

    Parameters
    ----------
    name : str
        What it is called in a message, with its article.
    word, ending : str
        What a name for one is made of: ``modes`` and ``.json``.
    known : callable
        From a file to whether it is one that modalkit wrote.
    """

    name: str
    word: str
    ending: str
    known: Callable[[Path], bool]


def uff_of(word: str) -> Kind:
    """Return the kind of universal files that modalkit writes; another program's may be measurements."""

    def known(path: Path) -> bool:
        lines = [line.strip() for line in _head(path).split(b"\n")]
        return lines[:2] == [b"-1", b"151"] and lines[4:5] == [b"modalkit"]

    return Kind("a universal file written by modalkit", word, ".uff", known)


def json_of(schema: str) -> Kind:
    """Return the kind of JSON files of a schema, ``modalkit.modes/1``; its version does not matter."""
    name = schema.partition("/")[0]

    def known(path: Path) -> bool:
        found = _SCHEMA.match(_head(path))
        return found is not None and found[1].decode() == name

    return Kind(f"a JSON file of {name}", name.rpartition(".")[2], ".json", known)


def store_of(schema: str) -> Kind:
    """Return the kind of stores of a schema, which have one JSON document a line; the first may be torn."""
    whole = json_of(schema).known

    def known(path: Path) -> bool:
        return whole(path) or is_torn_header(_head(path))

    return Kind(f"a store of {schema.partition('/')[0]}", "store", ".jsonl", known)


def is_torn_header(content: bytes) -> bool:
    """Return whether a file is a store whose writer was killed while it wrote the first line."""
    return b"\n" not in content and _STORE.startswith(content[: len(_STORE)])


def table_of(columns: Sequence[str], ending: str, word: str = "table") -> Kind:
    """Return the kind of tables that begin with certain columns, as text or Parquet."""
    first = [name.encode() for name in list(columns)[:2]]
    name = f"a table of {', '.join(list(columns)[:2])}, ..."
    if ending.lower() == ".parquet":
        return Kind(name, word, ending, lambda path: all(n in _parquet_footer(path) for n in first))
    return Kind(name, word, ending, lambda path: _head(path).startswith(b",".join(first)))


def text_of(name: str, word: str, ending: str, *begins: str) -> Kind:
    """Return the kind of text files that begin in one of some ways; case and blanks before do not matter."""
    starts = tuple(begin.lower().encode() for begin in begins)
    return Kind(name, word, ending, lambda path: _head(path).lstrip().lower().startswith(starts))


def _is_our_figure(path: Path) -> bool:
    head = _head(path)
    return head.startswith(b"\x89PNG\r\n\x1a\n") and b"Software\0modalkit" in head


PNG = Kind("a figure drawn by modalkit", "figure", ".png", _is_our_figure)
"""Figures."""


def check_outputs(*wanted: tuple[Path | None, Kind], reads: Iterable[Path] = ()) -> None:
    """See that all outputs of a command have places of their own, before work begins whose result would be lost.

    Parameters
    ----------
    *wanted : (Path or None, Kind)
        Each output and its kind; None is no output.
    reads : iterable of Path
        What the command reads.

    Raises
    ------
    InputError
        If one stands for two outputs, is read by the command, is not of its kind, or cannot be written.
    """
    given = [(path, kind) for path, kind in wanted if path is not None]
    for path, _ in given:
        check_place(path)
    read = {_identity(path) for path in reads}
    taken = set()
    for path, kind in given:
        if (which := _identity(path)) in taken:
            raise InputError(f"{path}: given for two different results; give each its own file")
        taken.add(which)
        if which in read:
            raise InputError(f"{path}: this command reads it; name another file, as {_free(path, kind)}")
        check_output(path, kind)


def check_output(path: Path, kind: Kind) -> None:
    """See that a file may be written or replaced: it is not there, empty, or one of the kind.

    Raises
    ------
    InputError
        If something else stands there, or it cannot be written.
    """
    check_place(path)
    if not path.exists():
        return
    if not path.is_file():
        raise InputError(
            f"{path}: is not an ordinary file; name one, as {_free(Path.cwd() / 'x', kind).name}"
        )
    if not os.access(path, os.W_OK):
        raise InputError(f"{path}: is read-only; name another file, as {_free(path, kind)}")
    if path.stat().st_size and not kind.known(path):
        raise InputError(
            f"{path}: exists and is not {kind.name}; name another file, as {_free(path, kind)}, or remove it"
        )


def check_place(path: Path | None) -> None:
    """See that a file could be written, before work begins whose result would be lost; None is no file.

    Raises
    ------
    InputError
        If its folder does not exist or cannot be written, or it is a folder itself.
    """
    if path is None:
        return
    if path.is_dir():
        raise InputError(f"{path}: is a folder; name a file")
    if not path.parent.is_dir() or not os.access(path.parent, os.W_OK):
        raise InputError(
            f"{path}: cannot be written (no such folder, or read-only); name a folder that exists"
        )


def _identity(path: Path) -> tuple[int, int] | Path:
    """Return what is the same for all names of a file, links of either kind among them."""
    try:
        status = path.stat()
    except OSError:
        return path.resolve()
    return (status.st_dev, status.st_ino)


def _free(path: Path, kind: Kind) -> Path:
    """Return a name near by that nothing has yet."""
    stem = path.stem if path.stem.endswith(kind.word) else f"{path.stem}_{kind.word}"
    names = (f"{stem}{'' if n == 1 else n}{kind.ending}" for n in count(1))
    return next(place for name in names if not (place := path.with_name(name)).exists())


def _head(path: Path) -> bytes:
    with path.open("rb") as file:
        return file.read(4096)


def _parquet_footer(path: Path) -> bytes:
    """Return where a Parquet file names its columns; nothing of a file that is none."""
    with path.open("rb") as file:
        size = file.seek(0, os.SEEK_END)
        file.seek(max(0, size - 8))
        last = file.read()
        length = int.from_bytes(last[:4], "little")
        if last[4:] != b"PAR1" or length > min(size - 8, 1_000_000):
            return b""
        file.seek(size - 8 - length)
        return file.read(length)
