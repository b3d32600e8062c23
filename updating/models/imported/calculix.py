"""What CalculiX writes under ``*FREQUENCY, SOLVER=MATRIXSTORAGE``: ``job.sti``, ``job.mas``, ``job.dof``."""

from __future__ import annotations

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
    try:
        table = pd.read_csv(
            path,
            sep=r"\s+",
            header=None,
            names=["row", "column", "value"],
            dtype={"value": float},
            engine="c",
        )
        row, column = (table[name].to_numpy(dtype=np.int64) - 1 for name in ("row", "column"))
    except (ValueError, pd.errors.ParserError) as error:
        raise StudyError(f"{path}: not a matrix of CalculiX ({error}); see SOLVER=MATRIXSTORAGE") from error
    if not len(table):
        raise StudyError(f"{path}: is empty; did ccx stop early? its .sta and .dat files tell")
    if min(row.min(), column.min()) < 0:
        raise StudyError(f"{path}: row or column 0; CalculiX counts from 1")
    order = int(max(row.max(), column.max())) + 1
    matrix = Sparse(sparse.coo_array((table["value"].to_numpy(), (row, column)), (order, order)).tocsr())
    one_triangle = bool((row <= column).all() or (row >= column).all())
    return Sparse(matrix + matrix.T - sparse.diags_array(matrix.diagonal())) if one_triangle else matrix


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
