"""MatrixMarket: ``.mtx``, ``.mtx.gz``."""

from __future__ import annotations

import gzip
import io
import re
from pathlib import Path
from typing import Any

import numpy as np
from scipy import sparse
from scipy.io import mminfo, mmread

from acquisition.errors import StudyError
from updating.models.fields import Sparse


def read_market(path: Path) -> Sparse:
    """Read a real matrix of a MatrixMarket file, symmetric or general, coordinate or array.

    Raises
    ------
    StudyError
        If the file is no real MatrixMarket matrix.
    """
    try:
        *_, field, symmetry = mminfo(str(path))
        if field not in ("real", "integer", "double", "unsigned-integer"):
            raise StudyError(f"{path}: holds {field} values; stiffness and mass are real")
        matrix = mmread(str(path))
        if symmetry == "symmetric" and _repeats(matrix):
            matrix = _both_triangles(path, matrix)
    except (ValueError, OverflowError, OSError, EOFError) as error:
        raise StudyError(
            f"{path}: not a MatrixMarket file: {error}; write it anew with scipy.io.mmwrite"
        ) from error
    return Sparse(sparse.coo_array(matrix).astype(float).tocsr())


def _repeats(matrix: Any) -> bool:
    """Tell whether some entry of a sparse matrix stands twice."""
    if isinstance(matrix, np.ndarray):
        return False
    found = matrix.tocoo()
    entries = found.row.astype(np.int64) * found.shape[1] + found.col
    return bool(len(np.unique(entries)) < found.nnz)


def _both_triangles(path: Path, completed: Any) -> Any:
    """Return a matrix that is called symmetric and yet stored whole, as it is stored; others as completed."""
    raw = path.read_bytes()
    text = gzip.decompress(raw) if path.suffix.lower() == ".gz" else raw
    head, _, rest = text.partition(b"\n")
    stored = mmread(io.BytesIO(re.sub(rb"(?i)symmetric", b"general", head) + b"\n" + rest))
    return stored if sparse.triu(stored, 1).nnz and sparse.tril(stored, -1).nnz else completed
