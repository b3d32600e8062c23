"""Matrices in MATLAB's files, sparse and full, plain and packed, with other variables beside them."""

from __future__ import annotations

import io
import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import undetectable
from corpus_matrices import chain
from family import Case, Family
from scipy import sparse
from scipy.io import savemat

from updating.models.imported import read_matrix

ORDER = 6


def saved(matrix: Any, *, packed: bool) -> bytes:
    """Return a file with a matrix between a word and a number, without its date."""
    plain = io.BytesIO()
    savemat(plain, {"title": "a chain", "K": matrix, "count": float(ORDER)}, do_compression=packed)
    return b"MATLAB 5.0 MAT-file".ljust(116) + plain.getvalue()[116:]


def _places(content: bytes, parts: Sequence[np.ndarray]) -> list[tuple[int, int]]:
    """Return where arrays stand in a file, one behind the other."""
    found, at = list[tuple[int, int]](), 0
    for raw in (part.tobytes() for part in parts):
        at = content.index(raw, at) + len(raw)
        found.append((at - len(raw), at))
    return found


def _case(name: str, matrix: Any, *, packed: bool) -> Case:
    """Return a case whose judge knows entries, and indices and pointers that may be others if they lead somewhere."""
    content = saved(matrix, packed=packed)
    if packed:
        return Case(name, {name: content}, 192, undetectable.payload([(0, 116)], len(content), _never))
    if not sparse.issparse(matrix):
        spans = _places(content, [matrix.ravel(order="F")])
        judge = undetectable.payload([(0, 116), *spans], len(content), _never)
        return Case(name, {name: content}, 192, judge, spans=spans)
    whole = sparse.csc_array(matrix)
    index, pointer, values = _places(
        content, [whole.indices.astype("<i4"), whole.indptr.astype("<i4"), whole.data]
    )
    inner = undetectable.payload([(0, 116), index, pointer, values], len(content), _never)

    def judge(original: bytes, mutant: bytes) -> bool:
        return inner(original, mutant) and _points_right(mutant, index, pointer)

    return Case(name, {name: content}, 192, judge, spans=[values])


def _points_right(content: bytes, index: tuple[int, int], pointer: tuple[int, int]) -> bool:
    """Tell whether pointers rise and row numbers lie in the matrix, each once in its column."""
    rows, starts = (np.frombuffer(content[a:b], "<i4") for a, b in (index, pointer))
    if starts[0] != 0 or (np.diff(starts) < 0).any() or starts[-1] > len(rows):
        return False
    columns = [rows[a:b] for a, b in itertools.pairwise(starts)]
    return all(len(set(c.tolist())) == len(c) and ((c >= 0) & (c < ORDER)).all() for c in columns)


def _never(original: bytes, mutant: bytes) -> bool:
    return False


def _read(path: Path) -> tuple[Any, Sequence[str]]:
    return read_matrix(path), ()


def matlab_families() -> list[Family]:
    """Return the family of matrices in MATLAB's files."""
    stiffness = sparse.csc_array(chain(ORDER)[0])
    stiffness.sort_indices()
    return [
        Family(
            "MATLAB matrices",
            [
                _case("sparse.mat", stiffness, packed=False),
                _case("full.mat", stiffness.toarray(), packed=False),
                _case("packed sparse.mat", stiffness, packed=True),
                _case("packed full.mat", stiffness.toarray(), packed=True),
            ],
            _read,
        )
    ]
