"""Harwell-Boeing: ``.hb``, ``.rsa``, ``.rua``, ``.rb``, as Nastran, Ansys and older collections write it."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import sparse

from acquisition.arrays import AnyArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse

_OF_VALUES, _OF_COUNTS = b"0123456789+-.eEdD ", b"0123456789 "
"""What may stand on cards: of all blanks the one of Fortran, or another in the place of a digit is passed over."""

_FORMAT = re.compile(
    r"\(\s*(?:-?\d+P\s*,?\s*)?(\d{0,9})\s*([IEDFG])(\d{1,9})(?:\.\d+)?(?:E\d+)?\s*\)", re.IGNORECASE
)
_TYPE = re.compile(r"R[SU]A", re.IGNORECASE)
_EXPONENTS = bytes.maketrans(b"dD", b"eE")

CARD = 256
"""Columns that a format may fill [-]: cards have 80, and what is written today seldom exceeds 132."""


@dataclass(frozen=True)
class _Block:
    """Numbers in fields of fixed width: how many cards, how many numbers, and how they stand on a card."""

    name: str
    cards: int
    count: int
    layout: str


def read_boeing(path: Path) -> Sparse:
    """Read a real assembled matrix, symmetric (one triangle) or unsymmetric.

    The format is that of Duff, Grimes and Lewis (1989), ACM Transactions on Mathematical Software 15.

    Raises
    ------
    StudyError
        If the file is none, not whole, or of a type that no stiffness matrix has.
    """
    lines = [line.rstrip() for line in path.read_bytes().split(b"\n")]
    while lines and not lines[-1]:
        lines.pop()
    try:
        return _read(lines, path)
    except (ValueError, IndexError) as error:
        raise StudyError(
            f"{path}: not a Harwell-Boeing file, damaged or cut short ({error}); write it again or use MatrixMarket"
        ) from error


def _read(lines: list[bytes], path: Path) -> Sparse:
    total, *counts = (_whole(lines[1][i : i + 14]) for i in range(0, 56, 14))
    kind = lines[2][:3].decode("latin-1")
    if not _TYPE.fullmatch(kind):
        raise StudyError(f"{path}: Harwell-Boeing type {kind!r}; use RSA or RUA, real and assembled")
    rows, columns, entries = (_whole(lines[2][14 + i : 28 + i]) for i in (0, 14, 28))
    formats = [lines[3][a:b].decode("latin-1").strip() for a, b in ((0, 16), (16, 32), (32, 52))]
    right_sides = _whole(lines[1][56:70]) if lines[1][56:70].strip() else 0
    at = 5 if right_sides else 4
    if len(lines) - at != total or total != sum(counts) + right_sides:
        raise ValueError(f"{len(lines) - at} lines behind the header where {total} are announced")
    values = []
    named = zip(
        ("pointers", "indices", "values"), counts, (columns + 1, entries, entries), formats, strict=True
    )
    for block in (_Block(*row) for row in named):
        values.append(_numbers(lines[at : at + block.cards], block))
        at += block.cards
    pointer, index = (block.astype(np.int64) - 1 for block in values[:2])
    if pointer[0] != 0 or pointer[-1] != entries or (np.diff(pointer) < 0).any():
        raise ValueError(f"its pointers do not rise from 1 to {entries + 1}")
    if entries and not 0 <= index.min() <= index.max() < rows:
        raise ValueError(f"an index lies beyond its {rows} rows")
    matrix = sparse.csc_array((values[2], index, pointer), (rows, columns))
    if kind[1] in "Ss":
        if rows != columns:
            raise ValueError(f"symmetric, but {rows} x {columns}")
        matrix = matrix + sparse.tril(matrix, -1).T + sparse.triu(matrix, 1).T
    return Sparse(matrix.tocsr())


def _whole(field: bytes) -> int:
    if not field.strip().isdigit():
        raise ValueError(f"{field.decode('latin-1').strip()[:40]!r} where a count should be")
    return int(field)


def _numbers(cards: list[bytes], block: _Block) -> AnyArray:
    """Return the numbers on cards, each card with as many as its format states."""
    found = _FORMAT.fullmatch(block.layout)
    if found is None:
        raise ValueError(f"format {block.layout[:40]!r}")
    each, width = int(found.group(1) or 1), int(found.group(3))
    if not 0 < each * width <= CARD:
        raise ValueError(f"format {block.layout!r} fills {each * width} columns")
    full, rest = divmod(block.count, each)
    if block.cards != full + (rest > 0):
        raise ValueError(f"{block.cards} cards of {each} {block.name} where {block.count} should be")
    wanted = [*[each] * full, *([rest] if rest else [])]
    if b"".join(cards).translate(None, _OF_VALUES if block.name == "values" else _OF_COUNTS):
        raise ValueError(f"a character among the {block.name} that no number has")
    try:
        values = _cut(cards, wanted, width)
    except ValueError:
        values = _split(cards, wanted, block.name)
    if not np.isfinite(values).all():
        raise ValueError("a value is not finite")
    return values


def _cut(cards: list[bytes], wanted: list[int], width: int) -> AnyArray:
    """Cut cards into fields of fixed width, as Fortran does: numbers may touch."""
    if any(len(card) != n * width for card, n in zip(cards, wanted, strict=True)):
        raise ValueError("a card is longer or shorter than its format")
    return np.frombuffer(b"".join(cards).translate(_EXPONENTS), dtype=f"S{width}").astype(np.float64)


def _split(cards: list[bytes], wanted: list[int], name: str) -> AnyArray:
    """Split cards at blanks: scipy writes fields that are wider than its format."""
    words = [card.translate(_EXPONENTS).split() for card in cards]
    if [len(row) for row in words] != wanted:
        raise ValueError(f"a card of the {name} holds another count of numbers than its format")
    return np.array([word for row in words for word in row]).astype(np.float64)
