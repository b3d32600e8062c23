"""CalculiX: from the text of a deck to its stiffness and mass matrices."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from acquisition.arrays import IntArray
from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.calculix import read_dofs, read_triplets
from updating.models.imported.decks.cache import kept

STEP = "*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n1\n*END STEP\n"
"""What makes CalculiX write its matrices and stop before it solves anything."""

ARRAYS = "arrays 1"
"""What :func:`_packed` keeps, and part of the key: another number where the arrays change, so none are misread."""

TIME_LIMIT = 3600.0
"""After which a run is stopped [s]: a deck of 100 000 degrees of freedom takes a minute."""


@dataclass(frozen=True, eq=False)
class Stored:
    """What CalculiX stores of a deck, in the deck's units.

    Parameters
    ----------
    stiffness, mass : (n, n) sparse arrays
        Supports and dependent degrees of freedom eliminated.
    node, direction : (n,) int arrays
        Of every row: the node's number, and 1, 2 or 3 for x, y or z.
    """

    stiffness: Sparse
    mass: Sparse
    node: IntArray
    direction: IntArray

    def same_rows(self, other: Stored) -> bool:
        """Return whether the rows of two decks are the same."""
        return np.array_equal(self.node, other.node) and np.array_equal(self.direction, other.direction)


def program() -> str:
    """Return where CalculiX is installed; one in the current folder, or beside a study, is not meant.

    Raises
    ------
    StudyError
        If it is not.
    """
    folders = [p for p in os.environ.get("PATH", os.defpath).split(os.pathsep) if Path(p).is_absolute()]
    found = shutil.which("ccx", path=os.pathsep.join(folders))
    if found is None:
        raise StudyError(
            '[model] of type calculix needs the program ccx, and there is none; on Debian and Ubuntu: "apt-get '
            'install calculix-ccx", or export the matrices and use type = "matrices"'
        )
    return found


@lru_cache(maxsize=1)
def _version(path: str) -> str:
    done = subprocess.run([path, "-v"], capture_output=True, text=True, errors="replace", check=False)
    return " ".join(done.stdout.split())


def stored(text: str, source: str) -> Stored:
    """Return the matrices of a deck without steps, as kept from an earlier run or as CalculiX writes them now.

    Parameters
    ----------
    text : str
        The deck.
    source : str
        What it is, for messages.

    Raises
    ------
    StudyError
        If CalculiX is missing, or does not solve the deck.
    """
    path = program()
    key = hashlib.sha256(f"{ARRAYS}\n{_version(path)}\n{text}".encode("latin-1", "replace")).hexdigest()
    arrays = kept(key, lambda: _packed(run(path, text, source)))
    n = len(arrays["node"])
    matrices = [
        Sparse(tuple(arrays[f"{kind}_{part}"] for part in ("data", "indices", "indptr")), shape=(n, n))
        for kind in ("stiffness", "mass")
    ]
    return Stored(matrices[0], matrices[1], arrays["node"], arrays["direction"])


def _packed(found: Stored) -> dict[str, np.ndarray]:
    """Return the arrays of a result by name."""
    arrays = {"node": found.node, "direction": found.direction}
    for kind in ("stiffness", "mass"):
        matrix: Sparse = getattr(found, kind)
        arrays |= {f"{kind}_{part}": getattr(matrix, part) for part in ("data", "indices", "indptr")}
    return arrays


def run(path: str, text: str, source: str) -> Stored:
    """Run CalculiX in a folder of its own; see :func:`stored`."""
    with tempfile.TemporaryDirectory(prefix="modalkit-") as folder:
        Path(folder, "job.inp").write_text(text + STEP, encoding="latin-1")
        try:
            done = subprocess.run(
                [path, "job"], cwd=folder, capture_output=True, text=True, errors="replace", check=False,
                timeout=TIME_LIMIT, env={**os.environ, "OMP_NUM_THREADS": "1"},
            )  # fmt: skip
        except subprocess.TimeoutExpired as late:
            raise StudyError(f"{source}: ccx has not written its matrices within {TIME_LIMIT:g} s") from late
        files = [Path(folder, f"job.{ending}") for ending in ("sti", "mas", "dof")]
        if "*ERROR" in done.stdout or not all(f.is_file() and f.stat().st_size for f in files):
            raise StudyError(f"{source}: ccx does not solve this deck: {_complaint(done.stdout)}")
        node, direction = read_dofs(files[2])
        stiffness, mass = (_of_order(read_triplets(f), len(node), source) for f in files[:2])
        return Stored(stiffness, mass, node, direction)


def _complaint(output: str) -> str:
    """Return CalculiX's error message, in one line."""
    found = re.search(r"\*ERROR[^\n]*(?:\n(?!\s*\n|\s*\*)[^\n]*){0,3}", output)
    message = found.group() if found else " ".join(output.split()[-30:])
    return " ".join(message.split())[:300] or "it stopped without a message"


def _of_order(matrix: Sparse, order: int, source: str) -> Sparse:
    """Return a matrix with the empty rows at its end, which its list of entries does not show."""
    if matrix.shape[0] > order:
        raise StudyError(f"{source}: ccx wrote {matrix.shape[0]} rows and named {order} of them")
    empty = np.full(order - matrix.shape[0], matrix.nnz, dtype=matrix.indptr.dtype)
    rows = np.concatenate([matrix.indptr, empty])
    return Sparse((matrix.data, matrix.indices, rows), shape=(order, order))
