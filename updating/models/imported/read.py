"""Reading imported matrices by what their names end in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.archive import read_archive
from updating.models.imported.boeing import read_boeing
from updating.models.imported.calculix import read_triplets
from updating.models.imported.market import read_market
from updating.models.imported.matrices import Imported
from updating.models.imported.nodes import NodeTable, read_deck_table, read_table

READERS: dict[str, Callable[[Path], Sparse]] = {
    ".mtx": read_market,
    ".mm": read_market,
    ".gz": read_market,
    ".hb": read_boeing,
    ".rb": read_boeing,
    ".rsa": read_boeing,
    ".rua": read_boeing,
    ".psa": read_boeing,
    ".npz": read_archive,
    ".sti": read_triplets,
    ".mas": read_triplets,
}
"""Reader by the ending of the file name."""


def read_matrix(path: Path) -> Sparse:
    """Read a matrix: MatrixMarket, Harwell-Boeing, .npz or CalculiX.

    Raises
    ------
    StudyError
        If the file is missing, of an unknown kind, or not what its name says.
    """
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise StudyError(
            f"{path}: no reader for {path.suffix or 'a name without ending'}; known: {', '.join(READERS)}"
        )
    if not path.is_file():
        raise StudyError(f"{path}: no such file; paths of the study are relative to the study file")
    return reader(path)


def read_nodes(path: Path, stiffness: Path, order: int) -> NodeTable:
    """Read a node table (CSV), or the nodes of a CalculiX deck with the ``.dof`` file beside the stiffness.

    Raises
    ------
    StudyError
        If it cannot be read or does not fit the matrices.
    """
    if not path.is_file():
        raise StudyError(f"{path}: no such file; paths of the study are relative to the study file")
    if path.suffix.lower() == ".inp":
        return read_deck_table(path, stiffness.with_suffix(".dof"), order)
    return read_table(path, order)


def read_imported(
    stiffness: Path,
    mass: Path,
    nodes: Path,
    *,
    stiffness_parts: Sequence[Path] = (),
    mass_parts: Sequence[Path] = (),
) -> Imported:
    """Read a structure given by its matrices.

    Parameters
    ----------
    stiffness, mass : Path
        Matrices of the whole structure on its supports [SI].
    nodes : Path
        Node table (CSV), or the CalculiX deck.
    stiffness_parts, mass_parts : sequence of Path
        One of each region, in the order of the regions.

    Raises
    ------
    StudyError
        If a file cannot be read, or the matrices cannot be those of a structure.
    """
    whole = read_matrix(stiffness)
    table = read_nodes(nodes, stiffness, max(whole.shape))
    return Imported(
        whole,
        read_matrix(mass),
        table,
        tuple(read_matrix(path) for path in stiffness_parts),
        tuple(read_matrix(path) for path in mass_parts),
        f"{stiffness.name}, {mass.name}",
    )
