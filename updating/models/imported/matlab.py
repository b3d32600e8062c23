"""MATLAB's files of versions 5 to 7: one matrix, sparse or full, each."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy import sparse

from acquisition.arrays import AnyArray
from acquisition.errors import InputError, StudyError, in_one_line
from acquisition.recorders.matlab.elements import COMPLEX, FIRST_NUMBER, LAST_NUMBER, SPARSE, Array
from acquisition.recorders.matlab.file import arrays
from updating.models.fields import Sparse
from updating.models.imported.archive import compressed
from updating.models.imported.numerals import check_order


def read_matlab(path: Path) -> Sparse:
    """Read the only matrix of a ``.mat``; numbers, words and vectors beside it are passed over.

    Raises
    ------
    StudyError
        If the file is of another version or damaged, holds none or several matrices, or not real numbers.
    """
    try:
        found = {array.name: _matrix(array, path) for array in arrays(path) if _is_matrix(array)}
    except InputError as error:
        raise StudyError(str(error)) from error
    except (ValueError, IndexError) as error:
        reason = in_one_line(error)
        raise StudyError(
            f"{path}: not a whole .mat ({reason}); save it again with save(..., '-v7')"
        ) from error
    if len(found) != 1:
        names = ", ".join(sorted(found)) or "none"
        raise StudyError(f"{path}: holds {len(found)} matrices ({names}); put one into each file")
    return next(iter(found.values()))


def _is_matrix(array: Array) -> bool:
    numbers = array.kind == SPARSE or FIRST_NUMBER <= array.kind <= LAST_NUMBER
    return numbers and len(array.shape) == 2 and min(array.shape) > 1


def _matrix(array: Array, path: Path) -> Sparse:
    if array.flags & COMPLEX:
        raise StudyError(f"{path}: {array.name} holds complex values; stiffness and mass are real")
    if array.kind != SPARSE:
        return Sparse(sparse.coo_array(_real(array.numbers(), path)).tocsr())
    rows, columns = array.shape
    indices, pointers, entries = array.parts()
    entries = _real(entries[: int(pointers[-1])], path)  # room for more than there are may follow them
    check_order(max(array.shape), len(entries), path)
    places = {"indices": indices[: len(entries)], "indptr": pointers}
    found = compressed(places, entries, (rows, columns), by_row=False)
    if _twice(found):
        raise ValueError("an entry that is given twice")
    return Sparse(found.tocsr())


def _twice(matrix: sparse.coo_array) -> bool:
    """Return whether an entry is given twice, as none does in a file of MATLAB: a sum would be a wrong number."""
    place = np.asarray(matrix.row, dtype=np.int64) * matrix.shape[1] + matrix.col
    return len(np.unique(place)) < len(place)


def _real(values: AnyArray, path: Path) -> AnyArray:
    """Return entries in double precision."""
    found = values.astype(np.float64)
    if not np.isfinite(found).all():
        raise StudyError(f"{path}: an entry is not finite; write it again")
    return found
