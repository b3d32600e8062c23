"""Reading imported matrices by what their names end in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from acquisition.errors import StudyError
from updating.models.fields import Sparse
from updating.models.imported.archive import read_archive
from updating.models.imported.boeing import read_boeing
from updating.models.imported.calculix import read_triplets
from updating.models.imported.deck import read_deck
from updating.models.imported.labelled import is_labelled, read_labelled, rows_of
from updating.models.imported.market import read_market
from updating.models.imported.matlab import read_matlab
from updating.models.imported.matrices import Imported
from updating.models.imported.nodes import (
    NodeTable,
    labelled_table,
    read_deck_table,
    read_places,
    read_table,
)
from updating.models.imported.rounding import decimal_rounding
from updating.models.imported.units import SI, matrix_in_si, places_in_si

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
    ".npy": read_archive,
    ".mat": read_matlab,
    ".sti": read_triplets,
    ".mas": read_triplets,
}
"""Reader by the ending of the file name."""


def read_matrix(path: Path | str) -> Sparse:
    """Read a matrix by its rows: MatrixMarket, Harwell-Boeing, .npz, .mat or CalculiX.

    Raises
    ------
    StudyError
        If the file is missing, of an unknown kind, or not what its name says.
    """
    path = Path(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise StudyError(
            f"{path}: no reader for {path.suffix or 'a name without ending'}; known: {', '.join(READERS)}"
        )
    if not path.is_file():
        raise StudyError(f"{path}: no such file; paths of the study are relative to the study file")
    matrix = reader(path)
    if matrix.shape[0] != matrix.shape[1]:
        raise StudyError(
            f"{path}: the matrix is {matrix.shape[0]} x {matrix.shape[1]}; stiffness and mass are square"
        )
    return matrix


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
    units: str = SI,
) -> Imported:
    """Read a structure given by its matrices.

    Parameters
    ----------
    stiffness, mass : Path
        Matrices of the whole structure on its supports [as ``units`` says].
    nodes : Path
        Node table (CSV), or the CalculiX deck.
    stiffness_parts, mass_parts : sequence of Path
        One of each region, in the order of the regions.
    units : {"m-kg-s", "mm-t-s", "in-lbf-s"}
        What the matrices and the nodes are in; the result is in SI units.

    Raises
    ------
    StudyError
        If a file cannot be read, or the matrices cannot be those of a structure.
    """
    read = _labelled if is_labelled(stiffness) else _by_rows
    (whole, weight), parts, table = read(stiffness, mass, nodes, stiffness_parts, mass_parts)
    in_si = [tuple(matrix_in_si(matrix, table, units) for matrix in own) for own in parts]
    return Imported(
        matrix_in_si(whole, table, units),
        matrix_in_si(weight, table, units),
        places_in_si(table, units),
        in_si[0],
        in_si[1],
        f"{stiffness.name}, {mass.name}",
        decimal=decimal_rounding(whole),
    )


Parts = tuple[list[Sparse], list[Sparse]]
Read = tuple[tuple[Sparse, Sparse], Parts, NodeTable]
"""Stiffness and mass, their parts, and where their rows are."""


def _by_rows(
    stiffness: Path, mass: Path, nodes: Path, stiffness_parts: Sequence[Path], mass_parts: Sequence[Path]
) -> Read:
    """Read matrices by their rows."""
    whole = read_matrix(stiffness)
    table = read_nodes(nodes, stiffness, max(whole.shape))
    weight = read_matrix(mass)
    parts = [read_matrix(path) for path in stiffness_parts], [read_matrix(path) for path in mass_parts]
    return (whole, weight), parts, table


def _labelled(
    stiffness: Path, mass: Path, nodes: Path, stiffness_parts: Sequence[Path], mass_parts: Sequence[Path]
) -> Read:
    """Read matrices whose entries name nodes and directions; supports that are among them lose their rows."""
    whole, weight = read_labelled(stiffness, "stiffness"), read_labelled(mass, "mass")
    rows, held = rows_of([whole, weight])
    places = read_deck(nodes) if nodes.suffix.lower() == ".inp" else read_places(nodes)
    table = labelled_table(places, rows, held, str(nodes))
    parts = (
        [read_labelled(path, "stiffness").on(rows) for path in stiffness_parts],
        [read_labelled(path, "mass").on(rows) for path in mass_parts],
    )
    return (whole.on(rows), weight.on(rows)), parts, table
