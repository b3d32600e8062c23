"""Files of Nastran's modules OUTPUT4 and OUTPUT2, written for the tests."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from pyyeti.nastran import op4
from scipy import sparse

LAYOUTS: dict[str, dict[str, Any]] = {
    "dense text": {"binary": False, "sparse": "dense"},
    "sparse text": {"binary": False, "sparse": "nonbigmat"},
    "wide sparse text": {"binary": False, "sparse": "bigmat"},
    "dense binary": {"sparse": "dense"},
    "sparse binary": {"sparse": "nonbigmat"},
    "wide sparse binary": {"sparse": "bigmat"},
    "big-endian binary": {"sparse": "nonbigmat", "endian": ">"},
}
"""Options of the writer for each layout of OUTPUT4."""


def write_op4(path: Path, layout: str, **matrices: Any) -> Path:
    """Write matrices with OUTPUT4's layouts."""
    plain = {name: sparse.coo_array(matrix).toarray() for name, matrix in matrices.items()}
    op4.write(str(path), list(plain), list(plain.values()), **LAYOUTS[layout])
    return path


def output2(matrices: Mapping[str, Any], *, order: str = "<", word: int = 4, label: bool = True) -> bytes:
    """Return a file of OUTPUT2 with a table and matrices in double precision, one record for each run of entries."""
    number, width = ("i", 4) if word == 4 else ("q", 8)

    def record(content: bytes) -> bytes:
        size = struct.pack(f"{order}i", len(content))
        return size + content + size

    def keys(*values: int) -> bytes:
        return b"".join(record(struct.pack(f"{order}{number}", value)) for value in values)

    def words(*values: int) -> bytes:
        return record(struct.pack(f"{order}{len(values)}{number}", *values))

    def named(name: str) -> bytes:
        return record(name.ljust(2 * width).encode())

    def block(name: str, trailer: tuple[int, ...], kind: int) -> bytes:
        head = keys(2) + named(name) + keys(-1, 7) + words(*trailer) + keys(-2, 1, 0, 2) + named(name)
        return head + keys(-3, 1, kind)

    content = b""
    if label:
        content += (
            keys(3) + words(11, 25, 26) + keys(7) + record(b"NASTRAN FORT TAPE ID CODE - ".ljust(7 * width))
        )
        content += keys(2) + named("LABEL") + keys(-1, 0)
    content += block("GPL", (101, 2, 0, 0, 0, 0, 0), 0) + keys(3) + words(1, 2, 3) + keys(-4, 1, 0, 0)
    for at, (name, matrix) in enumerate(matrices.items(), start=102):
        values = sparse.coo_array(matrix).toarray()
        content += block(name, (at, values.shape[1], values.shape[0], 6, 2, 0, 0), 1)
        for column in range(values.shape[1]):
            for first, run in _runs(values[:, column]):
                row = struct.pack(f"{order}{number}", first + 1)
                content += keys(len(run) * 8 // width)
                content += record(row + struct.pack(f"{order}{len(run)}d", *run))
            content += keys(0, -4 - column, int(column + 1 < values.shape[1]))
        content += keys(0)
    return content + keys(0)


def _runs(column: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """Return the runs of entries of a column that are not zero, and where they begin."""
    rows = np.flatnonzero(column)
    cuts = np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1) if len(rows) else []
    return [(int(run[0]), column[run]) for run in cuts]
