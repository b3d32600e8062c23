"""Variables of a MATLAB file by name, decompressed only where wanted and never beyond what the file can hold."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from pathlib import Path

from acquisition.archives import allowed
from acquisition.arrays import AnyArray
from acquisition.errors import InputError, cannot_open
from acquisition.recorders.matlab.elements import (
    COMPRESSED,
    DEEP,
    FIRST_NUMBER,
    LAST_NUMBER,
    MATRIX,
    STRUCTURE,
    Array,
    Bytes,
    header,
)

HEADER = 128
HDF = b"\x89HDF\r\n\x1a\n"
PEEK = 4096
"""Bytes decompressed to learn the name of a variable: a header with eight dimensions and 63 letters takes 150."""


def variables(path: Path, names: list[str]) -> dict[str, AnyArray]:
    """Return variables of a MATLAB file as arrays of numbers.

    Parameters
    ----------
    path : Path
        The file.
    names : list of str
        Which; fields of structures with a dot, ``"test.H"``.

    Raises
    ------
    InputError
        If the file cannot be read, is of version 7.3 or 4, is damaged, or a variable is not in it, stands in it twice
        or holds no numbers.
    """
    raw = _bytes(path)
    found: dict[str, Array] = {}
    there: list[str] = []
    for array in _arrays(raw, {name.partition(".")[0] for name in names}):
        if array.name in there:
            raise raw.broken(f"holds {array.name!r} twice")
        there.append(array.name)
        found |= {name: array for name in names if name.partition(".")[0] == array.name}
    answer = {}
    for name in names:
        if name not in found:
            raise InputError(
                f"{path}: no variable {name.partition('.')[0]!r} in it; there are {_listed(there)}"
            )
        array = _field(found[name], name)
        if 16 * array.count > allowed(len(raw.data)):
            raise _too_large(raw)
        answer[name] = array.numbers()
    return answer


def arrays(path: Path) -> Iterator[Array]:
    """Yield all arrays of a file, each once.

    Raises
    ------
    InputError
        If the file cannot be read, is of version 7.3 or 4, is damaged, or two arrays have one name.
    """
    raw = _bytes(path)
    seen: set[str] = set()
    for array in _arrays(raw, None):
        if array.name in seen:
            raise raw.broken(f"holds {array.name!r} twice")
        seen.add(array.name)
        yield array


def listed(path: Path) -> list[str]:
    """Return the names of all variables of numbers, fields of structures among them.

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    raw = _bytes(path)
    found = []
    for array in _arrays(raw, None):
        fields = list(array.fields()) if array.kind == STRUCTURE and array.count == 1 else []
        named = [(f"{array.name}.{field.name}", field) for field in fields] or [(array.name, array)]
        found += [name for name, one in named if FIRST_NUMBER <= one.kind <= LAST_NUMBER]
    return found


def _bytes(path: Path) -> Bytes:
    try:
        raw = path.read_bytes()
    except (OSError, ValueError) as error:
        raise cannot_open(path, error) from None
    if raw[:10] == b"MATLAB 7.3" or raw[512:520] == HDF or raw[:8] == HDF:
        raise InputError(
            f"{path}: a MATLAB file of version 7.3 (HDF5), which is not read; save it with save(..., '-v7')"
        )
    order = {b"IM": "<", b"MI": ">"}.get(raw[126:128])
    if order is None or raw[124:126] not in (b"\x00\x01", b"\x01\x00"):
        raise InputError(f"{path}: not a MATLAB file of version 5 to 7.2; save it with save(..., '-v7')")
    return Bytes(memoryview(raw), order, str(path))


def _arrays(raw: Bytes, wanted: set[str] | None) -> Iterator[Array]:
    """Yield the arrays of a file; those that are not wanted with their header alone, None for all that are."""
    at, limit = HEADER, allowed(len(raw.data))
    while at < len(raw.data):
        kind, start, size, at = raw.tag(at)
        if kind == COMPRESSED:
            packed = raw.data[start : start + size]
            peek = Bytes(memoryview(_unpacked(packed, PEEK, raw)), raw.order, raw.where)
            name = header(_open(peek)).name
            if wanted is None or name in wanted:
                whole = memoryview(_unpacked(packed, limit, raw))
                if len(whole) >= limit:
                    raise _too_large(raw)
                yield header(_matrix(Bytes(whole, raw.order, raw.where)))
            else:
                yield header(_open(peek))
        elif kind == MATRIX:
            yield header(raw.part(start, size))
        else:
            raise raw.broken(f"has an element of type {kind} among its variables")


def _open(peek: Bytes) -> Bytes:
    """Return the beginning of an array whose end is not there."""
    if len(peek.data) < 8:
        raise peek.broken("holds an empty variable")
    return peek.part(8, len(peek.data) - 8)


def _matrix(whole: Bytes) -> Bytes:
    kind, start, size, _ = whole.tag(0)
    if kind != MATRIX:
        raise whole.broken(f"has a compressed element of type {kind}")
    return whole.part(start, size)


def _too_large(raw: Bytes) -> InputError:
    return InputError(
        f"{raw.where}: {len(raw.data)} bytes that decompress to more than {allowed(len(raw.data))}; save what is "
        "needed alone, or with '-v6', which does not compress"
    )


def _unpacked(packed: memoryview, limit: int, raw: Bytes) -> bytes:
    """Return the first ``limit`` bytes of a compressed element; a shorter one must be whole."""
    stream = zlib.decompressobj()
    try:
        unpacked = stream.decompress(packed, limit)
    except zlib.error as error:
        raise raw.broken(f"cannot be decompressed ({error})") from None
    if len(unpacked) < limit and not stream.eof:
        raise raw.broken("has a compressed variable that ends too early")
    return unpacked


def _field(array: Array, name: str) -> Array:
    """Return the field of a structure, or the array itself."""
    path = name.split(".")[1:]
    if len(path) > DEEP:
        raise InputError(
            f"{array.body.where}: {name!r} is nested {len(path)} fields deep; at most {DEEP} are read"
        )
    for part in path:
        if array.kind != STRUCTURE:
            raise InputError(
                f"{array.body.where}: {array.name!r} is not a structure; it has no field {part!r}"
            )
        fields = {field.name: field for field in array.fields()}
        if part not in fields:
            there = _listed(list(fields))
            raise InputError(f"{array.body.where}: no field {part!r} in {array.name!r}; there are {there}")
        array = fields[part]
    return array


def _listed(names: list[str]) -> str:
    shown = ", ".join(repr(n) for n in names[:12] if n)
    return (shown or "none") + (", ..." if len(names) > 12 else "")
