"""What one matrix in a file of Nastran is, as its header states it and its columns confirm."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from acquisition.arrays import AnyArray
from updating.models.fields import Sparse

SINGLE, DOUBLE = 1, 2
"""Types of real matrices; from 3 on the entries are complex."""

COMPLEX_DOUBLE = 4
"""The last type."""

WIDEST = 65536
"""Rows from which OUTPUT4 writes the number of the row and the length of a string as two numbers in place of one."""

_NAME = re.compile(r"[A-Za-z]\w{0,7}", re.ASCII)


@dataclass(frozen=True, eq=False)
class Run:
    """Entries that stand below each other in a column.

    Parameters
    ----------
    column, row : int
        Of the first, from 1.
    count : int
        How many [-].
    raw : bytes
        Their numbers as the file has them.
    """

    column: int
    row: int
    count: int
    raw: bytes | memoryview


@dataclass(frozen=True, eq=False)
class Held:
    """A matrix in a file.

    Parameters
    ----------
    name : str
        Its name.
    rows, columns : int
        Its size [-].
    type : int
        1 and 2 are real in single and double precision, 3 and 4 complex.
    runs : tuple of Run
        What the file has of it.
    """

    name: str
    rows: int
    columns: int
    type: int
    runs: tuple[Run, ...] = ()

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name):
            raise ValueError(f"{self.name!r} is not a name of a matrix")
        if not SINGLE <= self.type <= COMPLEX_DOUBLE:
            raise ValueError(f"{self.name} has type {self.type}; types are 1 to 4")
        if self.rows < 1 or self.columns < 1:
            raise ValueError(f"{self.name} has {self.rows} rows and {self.columns} columns")

    @property
    def real(self) -> bool:
        """Whether the entries are real."""
        return self.type in (SINGLE, DOUBLE)

    @property
    def square(self) -> bool:
        """Whether there are as many rows as columns."""
        return self.rows == self.columns

    @property
    def entries(self) -> int:
        """How many numbers the file has of it [-]."""
        return sum(run.count for run in self.runs)

    def matrix(self, numbers: Callable[[bytes], AnyArray]) -> Sparse:
        """Return the matrix.

        Parameters
        ----------
        numbers : callable
            Takes the bytes of all runs to as many real numbers as they have.

        Raises
        ------
        ValueError
            If something in them is not a number.
        """
        values = np.asarray(numbers(b"".join(run.raw for run in self.runs)), dtype=np.float64)
        counts = [run.count for run in self.runs]
        below = np.arange(sum(counts)) - np.repeat(np.cumsum([0, *counts])[:-1], counts)
        row = np.repeat([run.row - 1 for run in self.runs], counts).astype(np.int64) + below
        column = np.repeat([run.column - 1 for run in self.runs], counts).astype(np.int64)
        return Sparse(sparse.coo_array((values, (row, column)), (self.rows, self.columns)).tocsr())

    def check_column(self, column: int, before: int) -> bool:
        """Return whether a column (from 1) is one of the matrix; the one behind the last ends it.

        Raises
        ------
        ValueError
            If it does not follow the one before it.
        """
        if not before < column <= self.columns + 1:
            raise ValueError(f"{self.name}: column {column} follows column {before} of {self.columns}")
        return column <= self.columns

    def check_rows(self, first: int, count: int, end: int) -> int:
        """Return the last of some rows of a column (from 1).

        Raises
        ------
        ValueError
            If they begin before the end of those before them, or go beyond the matrix.
        """
        if first <= end or count < 1 or first + count - 1 > self.rows:
            raise ValueError(f"{self.name}: {count} rows from {first} on in a matrix of {self.rows}")
        return first + count - 1
