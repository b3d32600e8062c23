"""MatrixMarket: ``.mtx``, ``.mtx.gz``."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy import sparse
from scipy.io import mmread

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
        matrix = mmread(str(path))
    except (ValueError, OverflowError) as error:
        raise StudyError(
            f"{path}: not a MatrixMarket file: {error}; write it anew with scipy.io.mmwrite"
        ) from error
    if np.iscomplexobj(matrix) or matrix.dtype.kind not in "fiu":
        raise StudyError(f"{path}: holds {matrix.dtype} values; stiffness and mass are real")
    return Sparse(sparse.coo_array(matrix).astype(float).tocsr())
