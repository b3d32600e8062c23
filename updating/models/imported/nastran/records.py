"""Records of Fortran: a length in four bytes, so many bytes, and the length again."""

from __future__ import annotations

import struct
from collections.abc import Callable

import numpy as np

from acquisition.arrays import AnyArray
from updating.models.imported.nastran.contents import Held

Matrix = tuple[Held, Callable[[bytes], AnyArray]]
"""A matrix in a file, and what takes its bytes to numbers."""


class Records:
    """The records of a file, one after the other.

    Parameters
    ----------
    raw : bytes
        The whole file.
    sizes : sequence of int
        Lengths that the first record may have [bytes]; they show the order of the bytes.

    Raises
    ------
    ValueError
        If the first record has another length in either order.
    """

    def __init__(self, raw: bytes, sizes: tuple[int, ...]) -> None:
        """Find the order of the bytes."""
        self._raw, self.at = raw, 0
        orders = [order for order in "<>" if raw[:4] in [struct.pack(f"{order}I", n) for n in sizes]]
        if not orders:
            raise ValueError(f"its first record has none of {' or '.join(map(str, sizes))} bytes")
        self.order = orders[0]
        self.first = struct.unpack_from(f"{self.order}I", raw)[0]

    @property
    def left(self) -> int:
        """Bytes that follow [-]."""
        return len(self._raw) - self.at

    def take(self) -> memoryview:
        """Return the content of the next record.

        Raises
        ------
        ValueError
            If it is cut off, or its two lengths differ.
        """
        size = struct.unpack_from(f"{self.order}I", self._raw, self.at)[0] if self.left >= 8 else self.left
        end = self.at + 4 + size
        if self.left < 8 + size:
            raise ValueError(f"a record at byte {self.at} goes beyond the end of the file")
        if self._raw[self.at : self.at + 4] != self._raw[end : end + 4]:
            raise ValueError(f"the record at byte {self.at} has two different lengths")
        content = memoryview(self._raw)[self.at + 4 : end]
        self.at = end + 4
        return content


def whole_numbers(order: str, word: int, content: memoryview, count: int) -> tuple[int, ...]:
    """Return the first whole numbers of a record, of words with 4 or 8 bytes.

    Raises
    ------
    ValueError
        If the record has fewer.
    """
    if len(content) < count * word:
        raise ValueError(f"a record of {len(content)} bytes where {count} numbers are needed")
    return struct.unpack_from(f"{order}{count}{'i' if word == 4 else 'q'}", content)


def size_of(held: Held, word: int) -> int:
    """Return the bytes of an entry, in a file of words with 4 or 8 bytes."""
    return (word if held.type % 2 else 8) * (1 if held.real else 2)


def reals(order: str, size: int) -> Callable[[bytes], AnyArray]:
    """Return what takes bytes to real numbers of 4 or 8 bytes each."""
    return lambda raw: np.frombuffer(raw, dtype=f"{order}f{size}")
