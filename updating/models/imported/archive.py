"""numpy's archives: what ``scipy.sparse.save_npz`` writes, or one plain two-dimensional array."""

from __future__ import annotations

from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from scipy import sparse

from acquisition.errors import StudyError
from updating.models.fields import Sparse


def read_archive(path: Path) -> Sparse:
    """Read a sparse matrix, or the only two-dimensional array of an archive.

    Raises
    ------
    StudyError
        If the file is no archive, or holds none or several matrices.
    """
    try:
        with np.load(path, allow_pickle=False) as archive:
            names = set(archive.files)
            flat = (
                {n: archive[n] for n in archive.files if archive[n].ndim == 2}
                if "format" not in names
                else {}
            )
    except (ValueError, OSError, BadZipFile) as error:
        raise StudyError(
            f"{path}: not an .npz archive of numbers ({error}); use scipy.sparse.save_npz"
        ) from error
    if "format" in names:
        return Sparse(sparse.coo_array(sparse.load_npz(path)).astype(float).tocsr())
    if len(flat) != 1:
        raise StudyError(
            f"{path}: holds {len(flat)} matrices ({', '.join(sorted(names)) or 'nothing'}); put one into each file"
        )
    matrix = next(iter(flat.values()))
    if matrix.dtype.kind not in "fiu":
        raise StudyError(f"{path}: holds {matrix.dtype} values; stiffness and mass are real")
    return Sparse(sparse.coo_array(matrix).astype(float).tocsr())
