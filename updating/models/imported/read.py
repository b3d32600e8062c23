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
from updating.models.imported.labelled import PUNCHED, is_labelled, read_labelled, rows_of
from updating.models.imported.market import read_market
from updating.models.imported.matlab import read_matlab
from updating.models.imported.matrices import Imported
from updating.models.imported.nastran.read import OUTPUTS, read_output
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


def read_matrix(path: Path | str, kind: str = "stiffness", name: str | None = None) -> Sparse:
    """Read a matrix by its rows: MatrixMarket, Harwell-Boeing, .npz, .mat, CalculiX, or OUTPUT4 and OUTPUT2 of Nastran.

    Parameters
    ----------
    path : Path or str
        The file.
    kind : {"stiffness", "mass"}
        Which one is needed of a file that has several matrices.
    name : str, optional
        Its name in such a file.

    Raises
    ------
    StudyError
        If the file is missing, of an unknown kind, or not what its name states.
    """
    path = Path(path)
    ending = path.suffix.lower()
    if ending not in READERS and ending not in OUTPUTS:
        known = ", ".join([*READERS, *sorted(OUTPUTS)])
        raise StudyError(f"{path}: no reader for {path.suffix or 'a name without ending'}; known: {known}")
    _check_named(path, kind, name)
    if not path.is_file():
        raise StudyError(f"{path}: no such file; paths of the study are relative to the study file")
    matrix = read_output(path, kind, name) if ending in OUTPUTS else READERS[ending](path)
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


Names = tuple[str | None, str | None]
"""Names of stiffness and mass in files that have several matrices."""

KINDS = ("stiffness", "mass")


def read_imported(
    stiffness: Path,
    mass: Path,
    nodes: Path,
    *,
    stiffness_parts: Sequence[Path] = (),
    mass_parts: Sequence[Path] = (),
    units: str = SI,
    names: Names = (None, None),
) -> Imported:
    """Read a structure given by its matrices.

    Parameters
    ----------
    stiffness, mass : Path
        Matrices of the whole structure on its supports [as ``units`` states].
    nodes : Path
        Node table (CSV), or the CalculiX deck.
    stiffness_parts, mass_parts : sequence of Path
        One of each region, in the order of the regions.
    units : {"m-kg-s", "mm-t-s", "in-lbf-s"}
        What the matrices and the nodes are in; the result is in SI units.
    names : (str or None, str or None)
        Names of stiffness and mass in files that have several matrices; that of the stiffness begins with K, that of
        the mass with M, unless given.

    Raises
    ------
    StudyError
        If a file cannot be read, or the matrices cannot be those of a structure.
    """
    labelled = _of_one_kind((stiffness, mass, *stiffness_parts, *mass_parts))
    read = _labelled if labelled else _by_rows
    (whole, weight), parts, table = read(((stiffness, stiffness_parts), (mass, mass_parts)), nodes, names)
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


Files = tuple[tuple[Path, Sequence[Path]], tuple[Path, Sequence[Path]]]
"""Of the stiffness and of the mass: the file of the whole and those of the regions."""


def _of_one_kind(paths: Sequence[Path]) -> bool:
    """Return whether entries name nodes and directions, in all files or in none.

    Raises
    ------
    StudyError
        If they do in some files alone.
    """
    kinds = [is_labelled(path) for path in paths]
    if len(set(kinds)) > 1:
        named, by_rows = paths[kinds.index(True)], paths[kinds.index(False)]
        raise StudyError(
            f"{named}: its entries are given by node and direction, those of {by_rows.name} by row alone; neither file "
            "states the order of the rows. Export all matrices of a model in one format"
        )
    return kinds[0]


def _check_named(path: Path, kind: str, name: str | None) -> None:
    """Refuse the name of a matrix where the file has no names."""
    if name is not None and path.suffix.lower() not in {*OUTPUTS, *PUNCHED}:
        endings = ", ".join(sorted({*OUTPUTS, *PUNCHED}))
        raise StudyError(
            f"{path}: {kind}_name = {name!r} is for {endings}; a matrix in this format has no name: leave it out"
        )


def _by_rows(files: Files, nodes: Path, names: Names) -> Read:
    """Read matrices by their rows."""
    (stiffness, _), (mass, _) = files
    whole = read_matrix(stiffness, KINDS[0], names[0])
    table = read_nodes(nodes, stiffness, max(whole.shape))
    weight = read_matrix(mass, KINDS[1], names[1])
    parts = [
        [read_matrix(path, kind, name) for path in paths]
        for kind, name, (_, paths) in zip(KINDS, names, files, strict=True)
    ]
    return (whole, weight), (parts[0], parts[1]), table


def _labelled(files: Files, nodes: Path, names: Names) -> Read:
    """Read matrices whose entries name nodes and directions; supports that are among them lose their rows."""
    for kind, name, (path, _) in zip(KINDS, names, files, strict=True):
        _check_named(path, kind, name)
    whole, weight = (
        read_labelled(path, kind, name) for kind, name, (path, _) in zip(KINDS, names, files, strict=True)
    )
    rows, held = rows_of([whole, weight])
    places = read_deck(nodes) if nodes.suffix.lower() == ".inp" else read_places(nodes)
    table = labelled_table(places, rows, held, str(nodes))
    parts = [
        [read_labelled(path, kind, name).on(rows) for path in paths]
        for kind, name, (_, paths) in zip(KINDS, names, files, strict=True)
    ]
    return (whole.on(rows), weight.on(rows)), (parts[0], parts[1]), table
