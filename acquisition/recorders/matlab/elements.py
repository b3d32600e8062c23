"""The elements of a MATLAB 5 file (save -v7, -v6): tags, arrays, structures.

The format is that of "MAT-File Format", MathWorks: a header of 128 bytes, then elements of type and size, each perhaps
compressed. Only numbers are read, by numpy from bytes whose count was compared with the dimensions: no object is made,
nothing is executed, and no parser of another library sees the file.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.errors import InputError

COMPRESSED, MATRIX = 15, 14
NUMBERS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
"""Types of the elements that hold numbers."""

CLASSES = {
    1: "a cell array",
    2: "a structure",
    3: "an object",
    4: "text",
    5: "a sparse matrix",
    16: "a function handle",
    17: "an object",
}
"""Classes of arrays that hold no plain numbers."""

STRUCTURE, SPARSE, FIRST_NUMBER, LAST_NUMBER = 2, 5, 6, 15
COMPLEX = 0x0800
DEEP = 4
"""So many structures may lie in one another; tools make two or three. Doubled, names get longer, no more."""


@dataclass(frozen=True)
class Bytes:
    """Bytes of a file with their order and a name for messages."""

    data: memoryview
    order: str
    where: str

    def tag(self, at: int) -> tuple[int, int, int, int]:
        """Return type, first byte, size and next place of the element at a place.

        Raises
        ------
        InputError
            If it does not lie in the data.
        """
        if at < 0 or at + 8 > len(self.data):
            raise self.broken("ends inside an element")
        kind, size = struct.unpack_from(f"{self.order}II", self.data, at)
        if kind >> 16:  # a small element: size and type in one word, up to four bytes behind it
            kind, size, start, after = kind & 0xFFFF, kind >> 16, at + 4, at + 8
            if size > 4:
                raise self.broken(f"has a small element of {size} bytes")
        else:
            start = at + 8
            after = start + size + (-size % 8 if kind != COMPRESSED else 0)
        if start + size > len(self.data):
            raise self.broken(f"announces {size} bytes where {len(self.data) - start} are left")
        return kind, start, size, after

    def part(self, start: int, size: int) -> Bytes:
        """Return some of the bytes."""
        return Bytes(self.data[start : start + size], self.order, self.where)

    def broken(self, what: str) -> InputError:
        """Return the error of a damaged file."""
        return InputError(f"{self.where}: {what}; the file is damaged: save it again with save(..., '-v7')")


@dataclass(frozen=True)
class Array:
    """An array as its header states; the numbers are still bytes.

    Parameters
    ----------
    name : str
        Its name.
    kind, flags : int
        Class, and whether it is complex.
    shape : tuple of int
        Dimensions.
    body : Bytes
        What follows the header.
    """

    name: str
    kind: int
    flags: int
    shape: tuple[int, ...]
    body: Bytes

    @property
    def count(self) -> int:
        """How many numbers there are by the dimensions."""
        return math.prod(self.shape)

    def numbers(self) -> AnyArray:
        """Return the numbers, real or complex in double precision.

        Raises
        ------
        InputError
            If it holds no numbers, or not as many as its dimensions say.
        """
        if not FIRST_NUMBER <= self.kind <= LAST_NUMBER:
            what = CLASSES.get(self.kind, f"of class {self.kind}")
            raise InputError(
                f"{self.body.where}: variable {self.name!r} is {what}; name one that holds numbers"
            )
        real, after = self._part(0)
        values = real.astype(np.complex128) if self.flags & COMPLEX else real.astype(np.float64)
        if self.flags & COMPLEX:
            values.imag, after = self._part(after)
        if after < len(self.body.data):
            raise self.body.broken(f"has more data after the numbers of {self.name!r}")
        return values.reshape(self.shape, order="F")

    def parts(self) -> list[AnyArray]:
        """Return the numbers of each element behind the header, as they are stored.

        Of a sparse matrix: the rows of its entries, where the columns begin among these, and the entries.

        Raises
        ------
        InputError
            If one is damaged, or holds no numbers.
        """
        found, at = [], 0
        while at < len(self.body.data):
            values, at = self._stored(at)
            found.append(values)
        return found

    def _part(self, at: int) -> tuple[AnyArray, int]:
        values, after = self._stored(at)
        if len(values) != self.count:
            raise self.body.broken(f"has {len(values)} numbers for {self.name!r} of shape {self.shape}")
        return values, after

    def _stored(self, at: int) -> tuple[AnyArray, int]:
        kind, start, size, after = self.body.tag(at)
        if kind not in NUMBERS:
            raise self.body.broken(f"has {self.name!r} with numbers of unknown type {kind}")
        dtype = np.dtype(f"{self.body.order}{NUMBERS[kind]}")
        if size % dtype.itemsize:
            raise self.body.broken(f"has {size} bytes for numbers of {dtype.itemsize} in {self.name!r}")
        return np.frombuffer(self.body.data[start : start + size], dtype), after

    def fields(self) -> Iterator[Array]:
        """Yield the fields of a structure of one element, by name.

        Raises
        ------
        InputError
            If it is an array of structures, or damaged.
        """
        if self.count != 1:
            raise InputError(
                f"{self.body.where}: {self.name!r} is an array of structures; save the one that is meant"
            )
        _, start, size, at = self.body.tag(0)
        width = struct.unpack_from(f"{self.body.order}i", self.body.data, start)[0] if size == 4 else 0
        _, start, size, at = self.body.tag(at)
        if width <= 0 or size % width:
            raise self.body.broken(f"has the structure {self.name!r} without names")
        for first in range(start, start + size, width):
            kind, begin, count, at = self.body.tag(at)
            if kind != MATRIX:
                raise self.body.broken(f"has the structure {self.name!r} without all its fields")
            name = bytes(self.body.data[first : first + width]).split(b"\0")[0].decode("latin-1")
            if count:
                yield header(self.body.part(begin, count), name)


def header(body: Bytes, name: str = "") -> Array:
    """Return an array with its header read; ``name`` for the fields of structures, which have none of their own.

    Raises
    ------
    InputError
        If it is damaged.
    """
    kind, start, size, at = body.tag(0)
    if kind != 6 or size != 8:
        raise body.broken("has an array without flags")
    flags = struct.unpack_from(f"{body.order}I", body.data, start)[0]
    kind, start, size, at = body.tag(at)
    shape = (
        struct.unpack_from(f"{body.order}{size // 4}i", body.data, start)
        if kind == 5 and size % 4 == 0
        else ()
    )
    if flags & 0xFF != 17 and (not 2 <= len(shape) <= 8 or min(shape) < 0):
        raise body.broken(f"has an array of dimensions {shape[:4]}")
    _, start, size, at = body.tag(at)
    own = bytes(body.data[start : start + min(size, 63)]).decode("latin-1")
    return Array(name or own, flags & 0xFF, flags, shape, body.part(at, max(len(body.data) - at, 0)))
