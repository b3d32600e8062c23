"""Text to numbers, strictly: a parser sees nothing but characters of numbers, and every word is a whole number."""

from __future__ import annotations

import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from acquisition.arrays import AnyArray
from acquisition.errors import StudyError

NUMERALS = b"0123456789+-.eEdD \t\r\n"
"""Characters that numbers are written with, and what stands between them; Fortran's D is an exponent too."""

NUMBER = re.compile(r"[+-]?(\d+(?:\.\d*)?|\.\d+)([eEdD][+-]?\d+)?")
"""A whole number word."""

SPARSEST = 100
"""Rows that a sparse matrix may have for each of its entries [-]: one of a structure has several entries in every row;
twice as many would let a file of a kilobyte ask for twice the memory."""


def check_order(order: int, entries: int, path: Path) -> None:
    """Refuse a matrix with far more rows than entries: its size is a slip of the pen, and would fill the memory."""
    if order > 1000 + SPARSEST * entries:
        raise StudyError(f"{path}: row or column {order} in a matrix of {entries} entries; write it again")


def columns_of(text: bytes, kinds: str, path: Path, *, first: int = 1) -> list[AnyArray]:
    """Return the columns of lines of numbers.

    Parameters
    ----------
    text : bytes
        The lines; blank ones are passed over.
    kinds : str
        One letter a column: "i" whole numbers, "f" floating point.
    path : Path
        The file, for messages.
    first : int
        Number of the first line in the file, from 1.

    Raises
    ------
    StudyError
        With the line, if one has another number of words, or a word is not a number or not finite.
    """
    if text.translate(None, NUMERALS):
        raise _fault(text, kinds, path, first)
    if not text.strip():
        return [np.zeros(0, dtype=np.int64 if kind == "i" else np.float64) for kind in kinds]
    types = {i: np.int64 if kind == "i" else np.float64 for i, kind in enumerate(kinds)}
    plain = text.translate(_EXPONENTS) if b"D" in text or b"d" in text else text
    try:
        with np.errstate(invalid="raise"):
            table = pd.read_csv(
                io.BytesIO(plain), sep=r"\s+", header=None, dtype=types, engine="c", na_filter=False,
                low_memory=False, **_TO_THE_BIT,
            )  # fmt: skip
    except (ValueError, ArithmeticError, pd.errors.ParserError) as error:
        raise _fault(text, kinds, path, first) from error
    found = [table[i].to_numpy() for i in table.columns]
    if len(found) != len(kinds) or not all(np.isfinite(column).all() for column in found):
        raise _fault(text, kinds, path, first)
    return found


_TO_THE_BIT: dict[str, Any] = (
    {} if int(pd.__version__.split(".")[0]) >= 3 else {"float_precision": "round_trip"}
)
"""What makes pandas read a number to the last bit; since version 3 it always does."""

_EXPONENTS = bytes.maketrans(b"dD", b"eE")


def _fault(text: bytes, kinds: str, path: Path, first: int) -> StudyError:
    """Return the error for the first line that is not of numbers."""
    for number, raw in enumerate(re.split(rb"\r\n|\r|\n", text), start=first):
        words = raw.decode("latin-1").split()
        if words and (why := _wrong(words, kinds)):
            return StudyError(f"{path}, line {number}: {why}")
    return StudyError(f"{path}, line {first}: the numbers cannot be read; write the file again")


def _wrong(words: list[str], kinds: str) -> str:
    """State what is wrong with a line."""
    for word, kind in zip(words, kinds, strict=False):
        shown = repr(word[:40])
        if "," in word:
            return f"{shown} holds a comma; write numbers with a decimal point and blanks between them"
        if not NUMBER.fullmatch(word):
            return f"{shown} is not a number; the file is damaged or of another kind"
        if kind == "i" and (not word.lstrip("+-").isdigit() or abs(int(word[:20])) >= 2**63):
            return f"{shown} is not a whole number of a row or column"
        if not np.isfinite(float(word.upper().replace("D", "E"))):
            return f"{shown} is beyond any number"
    return "" if len(words) == len(kinds) else f"{len(words)} numbers on a line where {len(kinds)} should be"
