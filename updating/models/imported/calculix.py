"""What CalculiX writes under ``*FREQUENCY, SOLVER=MATRIXSTORAGE``: ``job.sti``, ``job.mas``, ``job.dof``."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from scipy import sparse

from acquisition.arrays import IntArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.numerals import NUMERALS, check_order, columns_of


def read_triplets(path: Path) -> Sparse:
    """Read a ``.sti`` or ``.mas`` file: row, column and value on each line, counted from 1, one triangle or both.

    Raises
    ------
    StudyError
        If a line is not of that kind.
    """
    row, column, value = columns_of(_plain(path.read_bytes()), "iif", path)
    if not len(value):
        raise StudyError(f"{path}: is empty; did ccx stop early? see its .sta and .dat files")
    if min(row.min(), column.min()) < 1:
        raise StudyError(f"{path}: row or column 0 or below; CalculiX counts from 1")
    order = int(max(row.max(), column.max()))
    check_order(order, len(value), path)
    matrix = Sparse(sparse.coo_array((value, (row - 1, column - 1)), (order, order)).tocsr())
    if matrix.nnz < len(value):
        raise StudyError(f"{path}: {len(value) - matrix.nnz} entries are given twice; run ccx again")
    one_triangle = bool((row <= column).all() or (row >= column).all())
    return Sparse(matrix + matrix.T - sparse.diags_array(matrix.diagonal())) if one_triangle else matrix


def _plain(text: bytes) -> bytes:
    """Return a text without what others than CalculiX write: its comments blanked, its commas made blanks."""
    if not text.translate(None, NUMERALS):
        return text
    return _COMMENT.sub(b"", text).replace(b",", b" ")


_COMMENT = re.compile(rb"^[ \t]*[*#%!][^\n]*", re.MULTILINE)


def read_dofs(path: Path) -> tuple[IntArray, IntArray]:
    """Read a ``.dof`` file: the node and the direction of every row.

    A shell or beam stands in it with the numbers of its own nodes, though CalculiX has expanded it to a solid:
    the same node and direction come once for each layer.

    Returns
    -------
    node, direction : (n_dofs,) int arrays
        Node number, and 1, 2 or 3 for x, y or z.

    Raises
    ------
    StudyError
        If a line is no ``node.direction``.
    """
    try:
        pairs = [line.split(".") for line in path.read_text(encoding="ascii").split()]
        table = np.array(pairs, dtype=np.int64).reshape(-1, 2)
    except OSError as error:
        raise StudyError(
            f"{path}: cannot be read ({error.strerror}); keep it beside the .sti file"
        ) from error
    except (ValueError, OverflowError) as error:
        raise StudyError(f"{path}: not a list of node.direction, one to a line; export it again") from error
    return table[:, 0], table[:, 1]
