"""Damage of six kinds: bytes, lines, digits, headers, payloads, archives; each of a content, by a random generator."""

from __future__ import annotations

import gzip
import io
import re
import zipfile
import zlib
from collections.abc import Callable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

Rng = np.random.Generator
Mutator = Callable[[bytes, Rng], bytes]

BOMB = 400_000_000
"""Bytes that a small archive swells to [-]; beyond what any reader may take, twice that shows nothing more."""

DEPTH = 20_000
"""How deep brackets are nested; twenty times what Python's own stack bears."""

STRANGE = (
    b"nan",
    b"inf",
    b"-1",
    b"0",
    b"99999999999",
    b"-2000000000",
    b"2147483648",
    b"1e999",
    b"1e300",
    b"x",
    b"",
)
"""Words put in the place of a number."""


def _place(data: bytes, rng: Rng) -> int:
    return int(rng.integers(0, max(len(data), 1)))


def _cut(data: bytes, start: int, stop: int, new: bytes = b"") -> bytes:
    return data[:start] + new + data[stop:]


def flip(data: bytes, rng: Rng) -> bytes:
    at = _place(data, rng)
    return _cut(data, at, at + 1, bytes([data[at] ^ (1 << int(rng.integers(8)))])) if data else b"\0"


def put(data: bytes, rng: Rng) -> bytes:
    at = _place(data, rng)
    return _cut(
        data, at, at + 1, bytes([int(rng.choice([0, 9, 10, 13, 26, 32, 42, 44, 45, 255, rng.integers(256)]))])
    )


def lose(data: bytes, rng: Rng) -> bytes:
    at = _place(data, rng)
    return _cut(data, at, at + int(rng.choice([1, 2, 3, 4, 5, 8, 16, 80, 500])))


def gain(data: bytes, rng: Rng) -> bytes:
    at, count = _place(data, rng), int(rng.choice([1, 2, 4, 8, 80]))
    return _cut(data, at, at, bytes(int(rng.choice([0, 32, 48, 255])) for _ in range(count)))


def double(data: bytes, rng: Rng) -> bytes:
    at = _place(data, rng)
    return _cut(data, at, at, data[at : at + int(rng.choice([1, 4, 80, 1000]))])


def end(data: bytes, rng: Rng) -> bytes:
    return data[: _place(data, rng)]


def trail(data: bytes, rng: Rng) -> bytes:
    return data + rng.bytes(int(rng.integers(1, 40)))


def blanks(data: bytes, rng: Rng) -> bytes:
    at = _place(data, rng)
    return _cut(data, at, at + 8, data[at : at + 8].translate(bytes.maketrans(b"0123456789", b" " * 10)))


def nothing(data: bytes, rng: Rng) -> bytes:
    return [b"", b"\n", b"\0" * len(data), b" " * 200_000, data[:1] * 200_000][int(rng.integers(5))]


def _on_lines(change: Callable[[list[bytes], int, Rng], None]) -> Mutator:
    def mutate(data: bytes, rng: Rng) -> bytes:
        lines = data.split(b"\n")
        change(lines, int(rng.integers(0, max(len(lines) - 1, 1))), rng)
        return b"\n".join(lines)

    return mutate


def _exchange(lines: list[bytes], at: int, rng: Rng) -> None:
    other = int(rng.integers(0, len(lines)))
    lines[at], lines[other] = lines[other], lines[at]


def _indent(lines: list[bytes], at: int, rng: Rng) -> None:
    lines[at] = b" " * int(rng.integers(1, 9)) + lines[at]


def _shorten(lines: list[bytes], at: int, rng: Rng) -> None:
    lines[at] = lines[at][: int(rng.integers(0, len(lines[at]) + 1))]


def _blank(lines: list[bytes], at: int, rng: Rng) -> None:
    lines[at] = b" " * len(lines[at])


def _join(lines: list[bytes], at: int, rng: Rng) -> None:
    lines[at : at + 2] = [b"".join(lines[at : at + 2])]


def _break(lines: list[bytes], at: int, rng: Rng) -> None:
    cut = int(rng.integers(0, len(lines[at]) + 1))
    lines[at : at + 1] = [lines[at][:cut], lines[at][cut:]]


def _swell(lines: list[bytes], at: int, rng: Rng) -> None:
    lines[at] += b" " * 200_000 + b"x" * int(rng.integers(0, 2))


def windows_ends(data: bytes, rng: Rng) -> bytes:
    return data.replace(b"\n", b"\r\n")


def _numbers(data: bytes) -> list[re.Match[bytes]]:
    return list(re.finditer(rb"[+-]?\d[\d.]*([eEdD][+-]?\d+)?", data[:200_000]))


def _on_number(change: Callable[[bytes, Rng], bytes]) -> Mutator:
    def mutate(data: bytes, rng: Rng) -> bytes:
        found = _numbers(data)
        if not found:
            return flip(data, rng)
        one = found[int(rng.integers(0, len(found)))]
        return _cut(data, one.start(), one.end(), change(one.group(), rng))

    return mutate


def _one_character(pattern: bytes, new: bytes) -> Callable[[bytes, Rng], bytes]:
    def change(number: bytes, rng: Rng) -> bytes:
        places = [m.start() for m in re.finditer(pattern, number)]
        if not places:
            return number + new
        at = places[int(rng.integers(0, len(places)))]
        return _cut(number, at, at + 1, new)

    return change


def _other_digit(number: bytes, rng: Rng) -> bytes:
    return _one_character(rb"\d", b"%d" % int(rng.integers(0, 10)))(number, rng)


def _strange(number: bytes, rng: Rng) -> bytes:
    return STRANGE[int(rng.integers(0, len(STRANGE)))]


def _fortran(number: bytes, rng: Rng) -> bytes:
    return re.sub(rb"[eE]", bytes([b"DdqP"[int(rng.integers(0, 4))]]), number)


def _short(number: bytes, rng: Rng) -> bytes:
    return number[: int(rng.integers(0, len(number)))]


def _longer(number: bytes, rng: Rng) -> bytes:
    return number + b"%d" % int(rng.integers(0, 10)) * int(rng.choice([1, 2, 9, 400, 6000]))


def nest(data: bytes, rng: Rng) -> bytes:
    """Put a value nested far deeper than a program's stack into the place of a number, or before all else."""
    opening, closing = [(b"[", b"]"), (b'{"a":', b"}"), (b"{a=", b"}"), (b"(", b")")][int(rng.integers(4))]
    inner = opening * DEPTH + b"1" + closing * DEPTH
    found = _numbers(data)
    if not found or rng.random() < 0.2:
        return inner + b"\n" + data
    one = found[int(rng.integers(0, len(found)))]
    return _cut(data, one.start(), one.end(), inner)


def include_itself(data: bytes, rng: Rng) -> bytes:
    """Let a deck include itself and its own copy; elsewhere a line that means nothing."""
    at = data.find(b"\n", _place(data, rng)) + 1
    return _cut(data, at, at, b"*INCLUDE, INPUT=job.inp\n" * int(rng.integers(1, 9)))


BYTES: Mapping[str, Mutator] = MappingProxyType(
    {f.__name__: f for f in (flip, put, lose, gain, double, end, trail, blanks, nothing)}
)
LINES: Mapping[str, Mutator] = MappingProxyType(
    {
        "lose line": _on_lines(lambda lines, at, rng: lines.__delitem__(at)),
        "double line": _on_lines(lambda lines, at, rng: lines.insert(at, lines[at])),
        "exchange lines": _on_lines(_exchange),
        "indent": _on_lines(_indent),
        "shorten": _on_lines(_shorten),
        "blank": _on_lines(_blank),
        "join": _on_lines(_join),
        "break": _on_lines(_break),
        "swell": _on_lines(_swell),
        "ends": windows_ends,
    }
)
DIGITS: Mapping[str, Mutator] = MappingProxyType(
    {
        "other digit": _on_number(_other_digit),
        "digit to blank": _on_number(_one_character(rb"\d", b" ")),
        "digit to letter": _on_number(_one_character(rb"\d", b"x")),
        "digit to NUL": _on_number(_one_character(rb"\d", b"\0")),
        "point to comma": _on_number(_one_character(rb"\.", b",")),
        "point lost": _on_number(_one_character(rb"\.", b"")),
        "exponent letter": _on_number(_fortran),
        "sign": _on_number(lambda number, rng: b"-" + number.lstrip(b"+-")),
        "strange": _on_number(_strange),
        "short": _on_number(_short),
        "longer": _on_number(_longer),
        "nest": nest,
        "include": include_itself,
    }
)


def mutate(data: bytes, head: int, kind: str, rng: Rng) -> tuple[str, bytes]:
    """Damage a content in one way of a kind.

    Parameters
    ----------
    data : bytes
        A valid file.
    head : int
        Bytes of it that are its header [-].
    kind : str
        One of `KINDS`.
    rng : Generator
        Chooses the way and the place.

    Returns
    -------
    name : str
        What was done.
    mutant : bytes
    """
    if kind == "headers":
        name, part = _any(data[:head], rng)
        return f"header: {name}", part + data[head:]
    if kind == "payloads":
        name, part = _any(data[head:], rng)
        return f"payload: {name}", data[:head] + part
    if kind == "archives":
        return _archived(data, rng)
    return _one(_TABLES[kind], data, rng)


def _one(table: Mapping[str, Mutator], data: bytes, rng: Rng) -> tuple[str, bytes]:
    name = list(table)[int(rng.integers(0, len(table)))]
    return name, table[name](data, rng)


def _any(data: bytes, rng: Rng) -> tuple[str, bytes]:
    return _one([BYTES, LINES, DIGITS][int(rng.integers(0, 3))], data, rng)


_TABLES: Mapping[str, Mapping[str, Mutator]] = MappingProxyType(
    {"bytes": BYTES, "lines": LINES, "digits": DIGITS}
)
KINDS = ("bytes", "lines", "digits", "headers", "payloads", "archives")


def _archived(data: bytes, rng: Rng) -> tuple[str, bytes]:
    """Damage what an archive holds and pack it anew, with right checksums; other files are packed."""
    if data[:2] == b"\x1f\x8b":
        if rng.random() < 0.1:
            return "gz bomb", gz_bomb()
        name, inner = _any(gzip.decompress(data), rng)
        return f"in gz: {name}", gzip.compress(inner, 1, mtime=0)
    if data[:2] == b"PK":
        return _in_zip(data, rng)
    way = int(rng.integers(0, 4))
    return [
        ("as gz", gzip.compress(data, 1, mtime=0)),
        ("as zip", _zipped({"a": data})),
        ("as zlib", zlib.compress(data, 1)),
        ("as UTF-16", data.decode("latin-1").encode("utf-16")),
    ][way]


def _in_zip(data: bytes, rng: Rng) -> tuple[str, bytes]:
    with zipfile.ZipFile(io.BytesIO(data)) as old:
        members = {name: old.read(name) for name in old.namelist()}
    chosen = list(members)[int(rng.integers(0, len(members)))]
    way = int(rng.integers(0, 9))
    if way == 0:
        del members[chosen]
        return "member lost", _zipped(members)
    if way == 1:
        return "bomb", zip_bomb(chosen)
    if way == 2:
        return "encrypted", _flagged(data, 6, 1)
    if way == 3:
        return "another packing", _flagged(data, 8, int(rng.choice([1, 8, 12, 14, 93, 99])))
    if way == 4:
        sizes = b"".join(int(rng.integers(0, 2**31)).to_bytes(4, "little") for _ in range(2))
        at = data.rfind(b"PK\x01\x02")
        return "sizes", _cut(data, at + 20, at + 28, sizes)
    if way == 5:
        name, members[chosen] = _any(members[chosen], rng)
        return f"in member: {name}", _zipped(members)
    if way == 6:
        members[chosen] = _header_changed(members[chosen], rng)
        return "array header", _zipped(members)
    members[chosen] = _array_changed(members[chosen], rng)
    return "array", _zipped(members)


def repacked(data: bytes) -> bytes:
    """Return an archive with the same members, the same at all times: without dates."""
    with zipfile.ZipFile(io.BytesIO(data)) as old:
        return _zipped({name: old.read(name) for name in old.namelist()})


def _flagged(data: bytes, offset: int, value: int) -> bytes:
    """Set a field of every local header, and of every entry of the directory, where it stands two bytes further."""
    changed = bytearray(data)
    for mark, shift in ((b"PK\x03\x04", 0), (b"PK\x01\x02", 2)):
        for found in re.finditer(re.escape(mark), data):
            at = found.start() + offset + shift
            changed[at : at + 2] = value.to_bytes(2, "little")
    return bytes(changed)


def _zipped(members: Mapping[str, bytes]) -> bytes:
    plain = io.BytesIO()
    with zipfile.ZipFile(plain, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content in members.items():
            file.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
    return plain.getvalue()


@cache
def zip_bomb(name: str) -> bytes:
    """Return an archive of one huge array of zeros."""
    crc, size, packed = _bomb()
    info = zipfile.ZipInfo(name)
    info.compress_type = zipfile.ZIP_DEFLATED
    info.CRC, info.file_size, info.compress_size, info.header_offset = crc, size, len(packed), 0
    plain = io.BytesIO()
    with zipfile.ZipFile(plain, "w") as file:
        plain.write(info.FileHeader() + packed)
        file.filelist.append(info)
        file.start_dir = plain.tell()
    return plain.getvalue()


@cache
def _bomb() -> tuple[int, int, bytes]:
    """Return checksum, size and packed bytes of the array, which are the same whatever it is called: packing takes
    seconds.
    """
    plain = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        plain, {"descr": "<f8", "fortran_order": False, "shape": (BOMB // 8,)}
    )
    zeros, pack = bytes(BOMB // 100), zlib.compressobj(1, wbits=-zlib.MAX_WBITS)
    crc, size, packed = 0, 0, []
    for part in [plain.getvalue(), *[zeros] * 100]:
        crc, size = zlib.crc32(part, crc), size + len(part)
        packed.append(pack.compress(part))
    return crc, size, b"".join([*packed, pack.flush()])


@cache
def gz_bomb() -> bytes:
    """Return a compressed text of one huge blank line."""
    return gzip.compress(b"%%MatrixMarket matrix coordinate real general\n" + b" " * BOMB, 1, mtime=0)


def _header_changed(member: bytes, rng: Rng) -> bytes:
    """Put something else in the place of a number or word of an array's header, its length kept."""
    size = 10 + int.from_bytes(member[8:10], "little")
    head = member[10:size].decode("latin-1")
    swaps = [
        (r"\((\d+)", "(999999999999"), (r"\((\d+)", "(-1"), (r"\((\d+)", "(1"), (r"'<f8'", "'|O'"),
        (r"'<(i|f)[48]'", "'<c16'"), (r"'<i4'", "'<f4'"), (r"'<f8'", "'<U999999'"), (r"False", "True"),
        (r"\((\d+)", "((" * 9000), (r"'descr'", "'descr"), (r"\{", "{" * 9000),
    ]  # fmt: skip
    pattern, new = swaps[int(rng.integers(0, len(swaps)))]
    changed = re.sub(pattern, new, head, count=1).encode("latin-1")
    return member[:8] + len(changed).to_bytes(2, "little") + changed + member[size:]


def _array_changed(member: bytes, rng: Rng) -> bytes:
    """Write a member's array anew with values, a shape or a kind that cannot be."""
    array: Any = np.load(io.BytesIO(member), allow_pickle=False)
    flat = np.atleast_1d(array).copy()
    at = int(rng.integers(0, max(flat.size, 1)))
    way = int(rng.integers(0, 7))
    if flat.dtype.kind in "fiu" and way < 4 and flat.size:
        worst = np.iinfo(flat.dtype).max if flat.dtype.kind in "iu" else np.inf
        flat.flat[at] = [-1, worst, 0, worst // 2 if flat.dtype.kind in "iu" else np.nan][way]
    elif way == 4:
        flat = flat[:at]
    elif way == 5 and flat.dtype.kind in "fiub":
        with np.errstate(all="ignore"):
            flat = flat.astype(
                [object, np.complex128, np.int8, np.float16, ">f8", "U8", bool][int(rng.integers(7))]
            )
    else:
        flat = np.concatenate([flat, flat])
    plain = io.BytesIO()
    np.save(plain, flat.reshape(array.shape) if flat.size == array.size else flat, allow_pickle=True)
    return plain.getvalue()
