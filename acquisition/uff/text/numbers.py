"""Numbers in text as Fortran writes them: touching each other, or with a D for the exponent."""

from __future__ import annotations

import re
import warnings

import numpy as np

from acquisition.arrays import FloatArray
from acquisition.errors import InputError

_TOUCHING = re.compile(rb"(?<=[\d.])(?=[+-])")
_FORTRAN = re.compile(rb"[dD](?=[+\-\d ])")
_NO_LETTER = re.compile(rb"(?<=\d)([+-]\d{3})(?=[\s+-]|\Z)")  # Fortran's 1.00000-105


def numbers_of(text: bytes) -> FloatArray:
    """Return all numbers of a text, which may touch each other or carry Fortran's D.

    Raises
    ------
    InputError
        If something else stands among them.
    """
    if b"\v" in text or b"\f" in text:  # numpy takes them for blanks, and a number falls in two
        raise InputError("a control character stands among its values; the file is damaged")
    if _signs_touch(text):
        text = _TOUCHING.sub(b" ", _NO_LETTER.sub(rb"E\1", text))
    if b"D" in text or b"d" in text:
        text = _FORTRAN.sub(b"E", text)
    if not text.strip():
        return np.zeros(0)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            return np.asarray(np.fromstring(text, dtype=np.float64, sep=" "))
    except (DeprecationWarning, ValueError):
        raise InputError(f"{_first_bad(text)!r} stands among its values and is not a number") from None


def _signs_touch(text: bytes) -> bool:
    """Return whether a sign follows a digit or a point somewhere."""
    code = np.frombuffer(text, np.uint8)
    after, before = code[1:], code[:-1]
    sign = np.flatnonzero((after == ord("+")) | (after == ord("-")))
    ahead = before[sign]
    return bool((((ahead >= ord("0")) & (ahead <= ord("9"))) | (ahead == ord("."))).any())


def _first_bad(text: bytes) -> str:
    for word in text.split():
        try:
            float(word)
        except ValueError:
            return word.decode("latin-1")[:40]
    return "something"
