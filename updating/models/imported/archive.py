"""numpy's files: what ``scipy.sparse.save_npz`` writes, or one plain two-dimensional array."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from scipy import sparse

from acquisition.errors import StudyError
from updating.models.fields import Sparse


def read_archive(path: Path) -> Sparse:
    """Read a sparse matrix, or the only two-dimensional array of an archive or of an ``.npy`` file.

    Raises
    ------
    StudyError
        If the file is no archive, holds none or several matrices, or not real numbers.
    """
    try:
        matrix = _read(path)
    except (ValueError, OSError, EOFError, KeyError, BadZipFile) as error:
        raise StudyError(
            f"{path}: not an .npz archive of one matrix ({error}); use scipy.sparse.save_npz"
        ) from error
    if matrix.dtype.kind not in "fiu":
        raise StudyError(f"{path}: holds {matrix.dtype} values; stiffness and mass are real")
    return Sparse(sparse.coo_array(matrix).astype(float).tocsr())


def _read(path: Path) -> Any:
    """Return the sparse or plain matrix of a file."""
    found = np.load(path, allow_pickle=False)
    if isinstance(found, np.ndarray):
        return found
    with found as archive:
        names = set(archive.files)
        if "format" in names:
            return sparse.coo_array(sparse.load_npz(path))
        flat = [archive[n] for n in archive.files if archive[n].ndim == 2]
    if len(flat) != 1:
        raise StudyError(
            f"{path}: holds {len(flat)} matrices ({', '.join(sorted(names)) or 'nothing'}); put one into each file"
        )
    return flat[0]
