"""Reading one matrix of a file of OUTPUT4 or OUTPUT2.

The counts in a damaged file lead anywhere. All records are therefore followed once to the end of the file, each within
its matrix, before room is made for one.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from acquisition.errors import StudyError, in_one_line
from updating.models.fields import Sparse
from updating.models.imported.naming import chosen
from updating.models.imported.nastran import op2, op4_binary, op4_text
from updating.models.imported.nastran.records import Matrix
from updating.models.imported.numerals import check_order

OUTPUTS = frozenset({".op2", ".op4"})
"""Endings of the files."""


def read_output(path: Path, kind: str, name: str | None = None) -> Sparse:
    """Read the stiffness or the mass of a file that Nastran wrote with OUTPUT4 (text or binary) or OUTPUT2.

    Parameters
    ----------
    path : Path
        The file, ``.op4`` or ``.op2``.
    kind : {"stiffness", "mass"}
        Which one.
    name : str, optional
        Its name; see :func:`~updating.models.imported.naming.chosen` for the one without.

    Returns
    -------
    (n, m) sparse array
        As in the file.

    Raises
    ------
    StudyError
        If the file is damaged, holds no such matrix or several, or the matrix is complex or too large.
    """
    held = _contents(path.read_bytes(), path)
    wanted = chosen({one.name: one.square and one.real for one, _ in held}, kind, name, str(path))
    found = [(one, numbers) for one, numbers in held if one.name == wanted]
    if len(found) > 1:
        raise StudyError(f"{path}: {wanted} is {len(found)} times in it; write each matrix to the file once")
    one, numbers = found[0]
    if not one.real:
        raise StudyError(f"{path}: {wanted} is complex; stiffness and mass are real")
    check_order(max(one.rows, one.columns), one.entries, path)
    try:
        matrix = one.matrix(numbers)
    except ValueError as error:
        raise _damaged(path, error) from error
    if not np.isfinite(matrix.data).all():
        raise StudyError(f"{path}: an entry of {wanted} is not finite; write the file again")
    matrix.eliminate_zeros()
    return matrix


def _contents(raw: bytes, path: Path) -> list[Matrix]:
    """Return the matrices of a file whose records are whole."""
    of_op4 = op4_binary.contents if 0 in raw[:4] else op4_text.contents
    try:
        return (op2.contents if path.suffix.lower() == ".op2" else of_op4)(raw)
    except ValueError as error:
        raise _damaged(path, error) from error


def _damaged(path: Path, error: Exception) -> StudyError:
    module = "OUTPUT2" if path.suffix.lower() == ".op2" else "OUTPUT4"
    return StudyError(f"{path}: not a whole file of {module} ({in_one_line(error)}); write it again")
