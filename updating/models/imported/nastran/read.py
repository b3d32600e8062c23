"""Reading one matrix of a file of OUTPUT4 or OUTPUT2: its records are checked here, its numbers are read by pyyeti.

pyyeti follows the counts in a file wherever they lead. A damaged count makes it run for minutes, or ask for all
memory; the records are therefore followed once to their end before it opens the file.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from scipy import sparse

from acquisition.archives import SMALL
from acquisition.errors import ModalkitError, StudyError
from acquisition.libraries import library
from updating.models.fields import Sparse
from updating.models.imported.naming import chosen
from updating.models.imported.nastran import op2, op4_binary, op4_text
from updating.models.imported.nastran.contents import Held
from updating.models.imported.numerals import check_order

FULLEST = 100
"""Bytes that a matrix of OUTPUT2 may take in memory for each byte of its file [-]: pyyeti makes room for all rows and
columns, and a structure of 6000 rows has some 60 entries in each."""


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
    InputError
        If pyyeti is not installed.
    """
    raw = path.read_bytes()
    held = _contents(raw, path)
    wanted = chosen({one.name: one.square and one.real for one in held}, kind, name, str(path))
    found = [one for one in held if one.name == wanted]
    if len(found) > 1:
        raise StudyError(f"{path}: {wanted} is {len(found)} times in it; write each matrix to the file once")
    if not found[0].real:
        raise StudyError(f"{path}: {wanted} is complex; stiffness and mass are real")
    check_order(max(found[0].rows, found[0].columns), found[0].entries, path)
    read = _READERS[path.suffix.lower()]
    try:
        matrix = Sparse(sparse.coo_array(read(path, found[0], len(raw))).tocsr())
    except (ModalkitError, MemoryError):
        raise
    except Exception as error:  # the library raises what a damaged file happens to lead to
        raise _damaged(path, error) from error
    if not np.isfinite(matrix.data).all():
        raise StudyError(f"{path}: an entry of {wanted} is not finite; write the file anew")
    matrix.eliminate_zeros()
    return matrix


def _contents(raw: bytes, path: Path) -> list[Held]:
    """Return the matrices of a file whose records are whole."""
    binary = 0 in raw[:4]
    text = op4_text.contents if path.suffix.lower() == ".op4" and not binary else None
    try:
        return (text or (op2 if path.suffix.lower() == ".op2" else op4_binary).contents)(raw)
    except ValueError as error:
        raise _damaged(path, error) from error


def _damaged(path: Path, error: Exception) -> StudyError:
    module = "OUTPUT2" if path.suffix.lower() == ".op2" else "OUTPUT4"
    return StudyError(
        f"{path}: not a whole file of {module} ({' '.join(str(error).split())[:200]}); write it anew"
    )


def _of_op4(path: Path, held: Held, size: int) -> Any:
    module = library("pyyeti.nastran.op4", path, extra="nastran")
    name = held.name.lower()
    return module.read(str(path), namelist=[name], justmatrix=True, sparse=True)[name]


def _of_op2(path: Path, held: Held, size: int) -> Any:
    module = library("pyyeti.nastran.op2", path, extra="nastran")
    if 8 * held.rows * held.columns > max(SMALL, FULLEST * size):
        raise StudyError(
            f"{path}: {held.name} has {held.rows} rows, of which the file has {held.entries} entries; matrices of "
            "OUTPUT2 are read with all their zeros: write this one with OUTPUT4"
        )
    with module.OP2(str(path)) as file:
        return file.rdop2mats([held.name])[held.name]


_READERS: Mapping[str, Callable[[Path, Held, int], Any]] = MappingProxyType(
    {".op4": _of_op4, ".op2": _of_op2}
)

OUTPUTS = frozenset(_READERS)
"""Endings of the files."""
