"""The node table: where every row of imported matrices sits, and which way it moves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

import numpy as np
import pandas as pd

from acquisition.arrays import FloatArray, IntArray, frozen_array
from acquisition.errors import StudyError, in_one_line
from updating.models.imported.calculix import read_dofs
from updating.models.imported.deck import Deck, read_deck
from updating.models.imported.sets import NodeSets, sets_of_deck, sets_of_table

COLUMNS = ("node", "x", "y", "z", "direction", "row")

SETS = "sets"
"""Column of the names of the node sets to which a node belongs; it may be left out."""

HELD = -1
"""Row of a degree of freedom that a support holds and the matrices do not contain."""


@dataclass(frozen=True, eq=False)
class NodeTable:
    """Places and directions of the rows of a pair of matrices.

    Parameters
    ----------
    node : (n,) int array
        Node numbers.
    places : (n, 3) array
        Their coordinates in model axes [m].
    direction : (n,) int array
        1, 2, 3 for a displacement along x, y, z; 4, 5, 6 for a rotation about them.
    row : (n,) int array
        Row of the matrices, from 0; -1 where a support holds. Several rows of one node and direction are layers
        of an expanded shell: the node moves with their mean.
    source : str
        File, for messages.
    sets : mapping of str to int array
        Node sets: the numbers of their nodes.
    """

    node: IntArray
    places: FloatArray
    direction: IntArray
    row: IntArray
    source: str = "nodes"
    sets: NodeSets = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        object.__setattr__(self, "places", frozen_array(self.places).reshape(-1, 3))
        for name in ("node", "direction", "row"):
            object.__setattr__(self, name, frozen_array(getattr(self, name), np.int64))
        strange = self.direction[(self.direction < 1) | (self.direction > 6)]
        if len(strange):
            raise StudyError(
                f"{self.source}: direction {strange[0]}; use 1, 2, 3 for x, y, z and 4, 5, 6 for rotations"
            )
        if not np.isfinite(self.places).all():
            raise StudyError(f"{self.source}: a coordinate is missing or not finite")
        used = self.row[self.row >= 0]
        if len(np.unique(used)) < len(used):
            twice = int(np.flatnonzero(np.bincount(used) > 1)[0])
            both = " and ".join(
                f"{self.node[i]}.{self.direction[i]}" for i in np.flatnonzero(self.row == twice)[:2]
            )
            raise StudyError(
                f"{self.source}: one row, {twice + 1} (counted from 1), belongs to two degrees of freedom, {both} "
                "(node.direction)"
            )
        self._check_places()

    def _check_places(self) -> None:
        _, first, where = np.unique(self.node, return_index=True, return_inverse=True)
        distance = np.abs(self.places - self.places[first[where]]).max(axis=1, initial=0.0)
        reach = np.abs(self.places).max(initial=0.0)
        if len(distance) and distance.max() > 1e-6 * reach:
            worst = int(np.argmax(distance))
            raise StudyError(
                f"{self.source}: node {self.node[worst]} stands at two places, "
                f"{self.places[first[where[worst]]].tolist()} and {self.places[worst].tolist()}"
            )

    def check(self, order: int) -> None:
        """See that no row lies beyond the matrices.

        Raises
        ------
        StudyError
            If one does.
        """
        if len(self.row) and self.row.max() >= order:
            raise StudyError(
                f"{self.source}: row {int(self.row.max()) + 1} (counted from 1) lies beyond the {order} rows of the "
                "matrices; rows of the table are counted from 1, or from 0 where one is 0"
            )


def read_table(path: Path, order: int) -> NodeTable:
    """Read a node table: CSV with the columns node, x, y, z, direction, row, and sets where nodes belong to some.

    Rows are counted from 1, as the matrix formats do; from 0 if the table has a row 0. An empty row is a degree
    of freedom that a support holds.

    Parameters
    ----------
    path : Path
        The file.
    order : int
        Number of rows of the matrices.

    Raises
    ------
    StudyError
        If a column is missing or unknown, a value is not a number, or a row lies beyond the matrices.
    """
    values, names = _columns_of(path)
    rows = values["row"].to_numpy()
    if np.nanmin(rows, initial=1.0) < 0:
        raise StudyError(f"{path}: row {int(np.nanmin(rows))}; leave it empty where a support holds")
    base = 0 if (rows == 0).any() else 1
    whole = values[["node", "direction"]]
    if whole.isna().to_numpy().any():
        line = 2 + int(np.flatnonzero(whole.isna().any(axis=1))[0])
        raise StudyError(f"{path}, line {line}: node or direction is missing")
    if not (rows >= 0).any():
        raise StudyError(
            f"{path}: no line gives a row of the matrices; give one line for each row that belongs to a node"
        )
    for column in ("node", "direction", "row"):
        stated = values[column].to_numpy()
        if (broken := ~np.isnan(stated) & ((stated != np.round(stated)) | (np.abs(stated) > 2**53))).any():
            line = int(np.flatnonzero(broken)[0])
            raise StudyError(f"{path}, entry {line + 1}: {column} {stated[line]:g} is not a whole number")
    found = NodeTable(
        values["node"].to_numpy(dtype=np.int64),
        values[["x", "y", "z"]].to_numpy(),
        values["direction"].to_numpy(dtype=np.int64),
        np.where(np.isnan(rows), HELD, np.nan_to_num(rows) - base).astype(np.int64),
        str(path),
        sets_of_table(values["node"].to_numpy(dtype=np.int64), names),
    )
    found.check(order)
    return found


@dataclass(frozen=True, eq=False)
class Nodes:
    """Nodes without rows, for matrices that name them.

    Parameters
    ----------
    nodes : mapping of int to tuple
        Coordinates of each.
    sets : mapping of str to int array
        Node sets: the numbers of their nodes.
    """

    nodes: Mapping[int, tuple[float, float, float]]
    sets: NodeSets


def read_places(path: Path) -> Nodes:
    """Read the nodes of matrices that name them: CSV with the columns node, x, y, z, and sets where wanted.

    Raises
    ------
    StudyError
        If a column is missing or unknown, or a value is not a number.
    """
    if not path.is_file():
        raise StudyError(f"{path}: no such file; paths of the study are relative to the study file")
    values, names = _columns_of(path, COLUMNS[:4])
    stated = values["node"]
    if values.isna().to_numpy().any() or (stated != stated.round()).any() or (stated.abs() > 2**53).any():
        raise StudyError(f"{path}: a node or a coordinate is missing or not a number; give node, x, y, z")
    node = values["node"].to_numpy(dtype=np.int64)
    at = dict(zip(node.tolist(), map(tuple, values[["x", "y", "z"]].to_numpy().tolist()), strict=True))
    return Nodes(at, sets_of_table(node, names))


def labelled_table(
    known: Nodes | Deck, rows: Mapping[tuple[int, int], int], held: Sequence[tuple[int, int]], source: str
) -> NodeTable:
    """Make the node table of matrices that name nodes and directions.

    Rows of nodes that have no place, and of directions that are none (modal coordinates of a superelement), are at no
    place.

    Raises
    ------
    StudyError
        If none of the nodes has a place.
    """
    every = [(n, d, row) for (n, d), row in rows.items()] + [(n, d, HELD) for n, d in held]
    placed = [entry for entry in every if entry[0] in known.nodes and 1 <= entry[1] <= 6]
    if not placed:
        raise StudyError(f"{source}: has none of the nodes that the matrices name; give those of this model")
    table = np.array(placed, dtype=np.int64)
    places = np.array([known.nodes[n] for n in table[:, 0].tolist()]).reshape(-1, 3)
    sets = sets_of_deck(known) if isinstance(known, Deck) else known.sets
    return NodeTable(table[:, 0], places, table[:, 1], table[:, 2], source, sets)


def _columns_of(path: Path, columns: Sequence[str] = COLUMNS) -> tuple[pd.DataFrame, list[str]]:
    """Return the columns of a node table as numbers, and the sets that each line names; its heading checked."""
    try:
        table = pd.read_csv(path, comment="#", skipinitialspace=True, encoding="utf-8-sig")
    except OSError as error:
        raise StudyError(f"{path}: cannot be read ({error.strerror})") from error
    except (ValueError, pd.errors.ParserError) as error:
        reason = in_one_line(error)
        raise StudyError(f"{path}: not a CSV table ({reason}); columns: {', '.join(COLUMNS)}") from error
    if not table.index.equals(pd.RangeIndex(len(table))):
        raise StudyError(f"{path}: lines have more values than the header has names; name every column")
    table.columns = pd.Index([str(c).strip().lower() for c in table.columns])
    if numbers := [c for c in table.columns if _is_number(c)]:
        raise StudyError(
            f"{path}, line 1: {numbers[0]!r} is not a name of a column; is the header's line end lost?"
        )
    if missing := [c for c in columns if c not in table.columns]:
        raise StudyError(
            f"{path}: no column {', '.join(missing)}; the table needs {', '.join(columns)}, separated by commas"
        )
    known = (*COLUMNS, SETS)
    again = table.columns.duplicated().tolist()
    if strange := [
        str(c)
        for c, twice in zip(table.columns, again, strict=True)
        if twice or (c not in known and not table[c].isna().to_numpy().all())
    ]:
        raise StudyError(
            f"{path}: column {strange[0]!r} is not one of {', '.join(known)}, or is given twice; rename it "
            "or take it out"
        )
    try:
        names = (
            [""] * len(table)
            if SETS not in table.columns
            else table[SETS].astype(object).fillna("").astype(str).to_list()
        )
        return table[list(columns)].astype(float), names
    except (ValueError, OverflowError) as error:
        raise StudyError(f"{path}: {error}; every column holds numbers") from error


def _is_number(name: str) -> bool:
    """Return whether a heading is a number, which stands there where a line has run into the header's."""
    try:
        float(name)
    except ValueError:
        return False
    return name != "nan"


def read_deck_table(path: Path, dofs: Path, order: int) -> NodeTable:
    """Make the node table of a CalculiX job from its deck and its ``.dof`` file.

    What the deck's supports hold is at rest. Nodes that CalculiX has made itself (the rotations and the swelling of
    a shell's fold) stand in the ``.dof`` file with numbers beyond the deck's, and at no place.

    Raises
    ------
    StudyError
        If the two do not belong together.
    """
    deck = read_deck(path)
    node, direction = read_dofs(dofs)
    if len(node) != order:
        raise StudyError(
            f"{dofs}: {len(node)} degrees of freedom where the matrices have {order} rows; run ccx again"
        )
    return deck_table(deck, node, direction, f"{path} and {dofs.name}")


def deck_table(deck: Deck, node: IntArray, direction: IntArray, source: str) -> NodeTable:
    """Make the node table of a deck from the node and the direction of every row, each (n_dofs,).

    Raises
    ------
    StudyError
        If a row belongs to a node that the deck does not have.
    """
    last = max(deck.nodes)
    unknown = sorted({n for n in node.tolist() if n not in deck.nodes and n <= last})
    if unknown:
        raise StudyError(
            f"{source}: node {unknown[0]} is in no *NODE card, but has a row; give the deck that was run"
        )
    rows = [
        (n, d, row)
        for row, (n, d) in enumerate(zip(node.tolist(), direction.tolist(), strict=True))
        if n in deck.nodes and (n, d) not in deck.held
    ]
    rows += [(n, d, HELD) for n, d in sorted(deck.held) if d <= 3 and n in deck.nodes]
    table = np.array(rows, dtype=np.int64).reshape(-1, 3)
    coordinates = np.array([deck.nodes[n] for n in table[:, 0].tolist()]).reshape(-1, 3)
    return NodeTable(table[:, 0], coordinates, table[:, 1], table[:, 2], source, sets_of_deck(deck))
