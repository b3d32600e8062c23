"""What one matrix in a file of Nastran is, as its header states it and its columns confirm."""

from __future__ import annotations

import re
from dataclasses import dataclass

SINGLE, DOUBLE = 1, 2
"""Types of real matrices; from 3 on the entries are complex."""

COMPLEX_DOUBLE = 4
"""The last type."""

WIDEST = 65536
"""Rows from which OUTPUT4 writes the number of the row and the length of a string as two numbers in place of one."""

_NAME = re.compile(r"[A-Za-z]\w{0,7}", re.ASCII)


@dataclass(frozen=True)
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
    entries : int
        Numbers that the file has of it [-].
    """

    name: str
    rows: int
    columns: int
    type: int
    entries: int = 0

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name):
            raise ValueError(f"{self.name!r} is no name of a matrix")
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
