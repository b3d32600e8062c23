"""What CalculiX writes under ``*FREQUENCY, SOLVER=MATRIXSTORAGE``: ``job.sti``, ``job.mas``, ``job.dof``."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pandas as pd
from scipy import sparse

from acquisition.arrays import IntArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse


def read_triplets(path: Path) -> Sparse:
    """Read a ``.sti`` or ``.mas`` file: row, column and value on each line, counted from 1, one triangle or both.

    Raises
    ------
    StudyError
        If a line is not of that kind.
    """
    table = _table(path)
    if not len(table):
        raise StudyError(f"{path}: is empty; did ccx stop early? its .sta and .dat files tell")
    row, column = (table[i].to_numpy(dtype=np.int64) - 1 for i in (0, 1))
    if min(row.min(), column.min()) < 0:
        raise StudyError(f"{path}: row or column 0 or below; CalculiX counts from 1")
    order = int(max(row.max(), column.max())) + 1
    if order > 1000 + 100 * len(table):
        raise StudyError(f"{path}: row or column {order} in a matrix of {len(table)} entries; write it anew")
    matrix = Sparse(sparse.coo_array((table[2].to_numpy(), (row, column)), (order, order)).tocsr())
    one_triangle = bool((row <= column).all() or (row >= column).all())
    return Sparse(matrix + matrix.T - sparse.diags_array(matrix.diagonal())) if one_triangle else matrix


def _table(path: Path) -> pd.DataFrame:
    """Return row, column and value of every line."""
    kinds = {0: np.int64, 1: np.int64, 2: np.float64}
    try:
        try:
            table = pd.read_csv(path, sep=r"\s+", header=None, dtype=kinds, engine="c")
        except (
            ValueError,
            OverflowError,
            pd.errors.ParserError,
        ):  # by somebody else: comments, commas, D exponents
            table = pd.read_csv(_plain(path), sep=r"\s+", header=None, dtype=kinds, engine="c")
    except pd.errors.EmptyDataError:
        return pd.DataFrame()
    except (ValueError, OverflowError, pd.errors.ParserError) as error:
        told = str(error).strip().replace("\n", " ")
        raise StudyError(f"{path}: not a matrix of CalculiX ({told}); see SOLVER=MATRIXSTORAGE") from error
    if len(table.columns) != len(kinds):
        raise StudyError(
            f"{path}: {len(table.columns)} numbers on a line; CalculiX writes row, column and value"
        )
    return table


def _plain(path: Path) -> io.StringIO:
    """Return the lines of a file without comments, with blanks between numbers and exponents with E."""
    lines = path.read_text(encoding="latin-1").upper().replace(",", " ").replace("D", "E").splitlines()
    return io.StringIO("\n".join(line for line in lines if line.strip()[:1] not in "*#%!"))


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
    except ValueError as error:
        raise StudyError(f"{path}: not a list of node.direction ({error})") from error
    return table[:, 0], table[:, 1]
