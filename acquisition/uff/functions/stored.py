"""Numbers that stand in a file and are read when their place in memory is there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from io import FileIO
from typing import IO, Any, Protocol

import numpy as np

from acquisition.arrays import AnyArray
from acquisition.errors import InputError

_ROWS = 1 << 17


class Values(Protocol):
    """Numbers of a function, wherever they are."""

    @property
    def points(self) -> int:
        """How many."""
        ...

    @property
    def dtype(self) -> np.dtype[Any]:
        """Their type."""
        ...

    def into(self, out: AnyArray, factor: float = 1.0) -> None:
        """Write them, times a factor, to an array of that length."""
        ...


@dataclass(frozen=True, eq=False)
class Stored:
    """Numbers in a file.

    Parameters
    ----------
    file : binary file
        Open for reading.
    offset : int
        Where they begin [byte].
    layout : dtype
        Of one point: fields "x" where the abscissa is stored, and "y" with one or two numbers.
    points : int
        How many points.
    """

    file: IO[bytes] | FileIO
    offset: int
    layout: np.dtype[Any]
    points: int

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of a value, in the machine's byte order."""
        base, shape = self.layout["y"].base, self.layout["y"].shape
        kind = "c" if shape == (2,) else "f"
        return np.dtype(f"{kind}{base.itemsize * shape[0]}")

    def chunks(self, field: str = "y") -> Iterator[tuple[int, AnyArray]]:
        """Yield the values (or "x", the abscissae) piece by piece, each with the number of its first point."""
        for first in range(0, self.points, _ROWS):
            table = np.empty(min(_ROWS, self.points - first), self.layout)
            fill(self.file, self.offset + first * self.layout.itemsize, table)
            column = table[field]
            native = np.ascontiguousarray(column.astype(column.dtype.newbyteorder("="), copy=False))
            yield first, native if field == "x" else native.view(self.dtype)[:, 0]

    def into(self, out: AnyArray, factor: float = 1.0) -> None:
        """Write the values, times a factor, to an array of that length."""
        for first, values in self.chunks():
            put(out[first : first + len(values)], values, factor)

    def read(self, field: str = "y") -> AnyArray:
        """Return all values, or all abscissae ("x")."""
        dtype = self.dtype if field == "y" else self.layout["x"].newbyteorder("=")
        out = np.empty(self.points, dtype)
        for first, values in self.chunks(field):
            out[first : first + len(values)] = values
        return out


@dataclass(frozen=True, eq=False)
class Held:
    """Numbers in memory."""

    values: AnyArray

    @property
    def points(self) -> int:
        """How many."""
        return len(self.values)

    @property
    def dtype(self) -> np.dtype[Any]:
        """Their type."""
        return self.values.dtype

    def into(self, out: AnyArray, factor: float = 1.0) -> None:
        """Write them, times a factor, to an array of that length."""
        put(out, self.values, factor)


def put(out: AnyArray, values: AnyArray, factor: float) -> None:
    """Write values, times a real factor, to an array; every bit stays if the factor is 1."""
    if not np.iscomplexobj(out):
        values = values.real
    elif np.iscomplexobj(values):  # part by part: a complex product would touch infinities and signs of 0
        values, out = values.view(values.real.dtype), out.view(out.real.dtype)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        if factor == 1:
            np.copyto(out, values, casting="same_kind")
        else:
            np.multiply(values, factor, out=out, casting="same_kind")


def fill(file: IO[bytes] | FileIO, offset: int, table: AnyArray) -> None:
    """Read bytes straight into an array.

    Raises
    ------
    InputError
        If the file has become shorter.
    """
    view = memoryview(table.view(np.uint8))  # type: ignore[arg-type]  # arrays are buffers
    file.seek(offset)
    done = 0
    while done < len(view):
        count = file.readinto(view[done:])  # type: ignore[union-attr]
        if not count:
            raise InputError("the file has become shorter while it was read: read it again")
        done += count
