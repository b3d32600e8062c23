"""What joins nodes in drawings: trace lines of data set 82 and edges of elements of data set 2412."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from acquisition.arrays import IntArray
from acquisition.errors import InputError
from acquisition.uff.text.columns import check_columns
from acquisition.uff.text.numbers import numbers_of

_BEAMS = (11, 21, 22, 23, 24)
_SOLIDS = {  # by number of corner nodes
    4: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    6: ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    8: ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
}


def read_lines(number: int, body: bytes) -> tuple[IntArray, str]:
    """Return pairs of node numbers (n, 2) of a data set 82 or 2412, and what is odd about it.

    Raises
    ------
    InputError
        If entries are missing or are not whole numbers.
    """
    pairs, note = _trace(body) if number == 82 else _elements(body)
    lines = np.array([(min(p), max(p)) for p in pairs if p[0] != p[1]], dtype=np.int64).reshape(-1, 2)
    return np.unique(lines, axis=0), note


def _whole(text: bytes, number: int) -> list[int]:
    values = numbers_of(text)
    if not np.isfinite(values).all() or np.any(values % 1) or np.any(np.abs(values) > 1e15):
        raise InputError(f"data set {number}: node numbers that are not whole numbers")
    return [int(v) for v in values]


def _trace(body: bytes) -> tuple[list[tuple[int, int]], str]:
    """Read a pen's way: 0 lifts it, else it draws to the node."""
    lines = body.split(b"\n", 2)
    if len(lines) < 3:
        raise InputError("data set 82: its trace line is missing")
    header, nodes = _whole(lines[0], 82), _whole(lines[2], 82)
    if len(header) < 2 or header[1] < 0 or not nodes:
        raise InputError("data set 82: number of nodes or nodes missing")
    count = header[1]
    check_columns(lines[2])
    wrong = count > len(nodes) or (count and any(nodes[count:]))
    note = f"it announces {count} nodes and holds {len(nodes)}" if wrong else ""
    nodes = nodes[:count] if count else nodes
    return [(a, b) for a, b in pairwise(nodes) if a > 0 and b > 0], note


def _elements(body: bytes) -> tuple[list[tuple[int, int]], str]:
    entries = _whole(body, 2412)
    check_columns(body)
    pairs: list[tuple[int, int]] = []
    strange: set[int] = set()
    at = 0
    while at < len(entries):
        record = entries[at : at + 6]
        if len(record) < 6 or record[5] < 1:
            raise InputError(
                "data set 2412: an element without its number of nodes: it is cut off or garbled"
            )
        family, count = record[1], record[5]
        at += 9 if family in _BEAMS else 6
        nodes = entries[at : at + count]
        at += count
        if len(nodes) < count:
            raise InputError(
                f"data set 2412: element {record[0]} has {len(nodes)} of {count} nodes: it is cut off"
            )
        edges = _edges(family, count)
        if edges is None:
            strange.add(family)
        pairs += [(nodes[a], nodes[b]) for a, b in edges or ()]
    return pairs, f"elements of type {sorted(strange)} are not drawn" if strange else ""


def _edges(family: int, count: int) -> tuple[tuple[int, int], ...] | None:
    """Return the edges of an element: of lines, of the rim of surfaces, or of solids."""
    if family in _BEAMS or count <= 2:
        return tuple((i, i + 1) for i in range(count - 1))
    if family < 100:
        return tuple((i, (i + 1) % count) for i in range(count))
    return _SOLIDS.get(count) if family in (111, 112, 115) else None
