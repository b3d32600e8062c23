"""The mesh of a user's own model as it can be drawn: nodes, the skin of its elements, and the region of every node."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray, IntArray
from updating.models.imported import Imported
from updating.models.spec import Spec

FEW = 6.0
"""Mean number of nodes that a node is coupled with, up to which couplings of matrices are drawn as lines: bars have two
to four; solids have 26 and more, most of them diagonals through the inside [-]."""

LARGEST = 20_000
"""Nodes of a mesh that is drawn whole; of a larger one the skin is, too, but no couplings are sought [-]."""

QUADS = {
    4: ((0, 1, 2, 3),),
    8: ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
WEDGE = ((0, 1, 2), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))
TETRAHEDRON = ((0, 1, 2), (0, 1, 3), (1, 2, 3), (2, 0, 3))


@dataclass(frozen=True, eq=False)
class Mesh:
    """A mesh.

    Parameters
    ----------
    node : (n,) int array
        Node numbers.
    places : (n, 3) array
        Where they are, in the model's axes [m].
    lines, faces : lists of tuples of int
        Rows of ``places``: bars, and the faces that no two elements share.
    region : (n,) int array
        Region of each node, -1 for none.
    """

    node: IntArray
    places: FloatArray
    lines: list[tuple[int, ...]]
    faces: list[tuple[int, ...]]
    region: IntArray


def mesh_of(spec: Spec) -> Mesh | None:
    """Return the mesh of matrices or of a deck; None for beams and plates, which have no nodes of the user's."""
    imported = spec.imported
    if imported is None:
        return None
    number, first = np.unique(imported.nodes.node, return_index=True)
    places = imported.nodes.places[first]
    row = {int(n): i for i, n in enumerate(number)}
    if imported.deck is None:
        return Mesh(number, places, _coupled(imported, row), [], _of_parts(imported, row))
    lines, faces = _skin(imported.deck.mesh.elements.values(), row)
    region = np.full(len(number), -1, dtype=np.int64)
    for k, one in enumerate(imported.deck.division.regions):
        for element in one.elements:
            _, nodes = imported.deck.mesh.elements[element]
            region[[row[n] for n in nodes if n in row]] = k
    return Mesh(number, places, lines, faces, region)


def edges_of(faces: Sequence[Sequence[int]]) -> list[tuple[int, int]]:
    """Return the edges of faces, each once."""
    pairs = (
        (min(a, b), max(a, b)) for face in faces for a, b in zip(face, [*face[1:], face[0]], strict=True)
    )
    return list(dict.fromkeys(pairs))


def _skin(
    elements: Iterable[tuple[str, tuple[int, ...]]], row: dict[int, int]
) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
    """Return the lines of bars and the faces that belong to one element alone, as rows."""
    lines: list[tuple[int, ...]] = []
    faces: list[tuple[int, ...]] = []
    for kind, nodes in elements:
        if any(n not in row for n in nodes):
            continue
        at = [row[n] for n in nodes]
        if kind.startswith(("B3", "B2", "T3", "T2")):
            lines.append((at[0], at[-1] if kind[1:3] in ("31", "21") or len(at) == 2 else at[2]))
        else:
            faces += [tuple(at[i] for i in face) for face in _faces(kind, len(at))]
    count = Counter(frozenset(face) for face in faces)
    return lines, [face for face in faces if count[frozenset(face)] == 1]


def _faces(kind: str, count: int) -> tuple[tuple[int, ...], ...]:
    """Return the faces of an element by its corner nodes; none of a kind that is not drawn."""
    if kind.startswith("C3D"):
        return {4: TETRAHEDRON, 10: TETRAHEDRON, 6: WEDGE, 15: WEDGE, 8: QUADS[8], 20: QUADS[8]}.get(
            count, ()
        )
    if kind.startswith(("S", "CPS", "CPE", "M3D")) and not kind.startswith("SPRING"):
        return QUADS[4] if count in (4, 8) else ((0, 1, 2),) if count in (3, 6) else ()
    return ()


def _coupled(imported: Imported, row: dict[int, int]) -> list[tuple[int, ...]]:
    """Return the pairs of nodes that the stiffness couples, where they are few enough to be the bars of a frame."""
    if len(row) > LARGEST:
        return []
    owner = _owners(imported, row)
    coupled = imported.stiffness.tocoo()
    a, b = owner[coupled.row], owner[coupled.col]
    keep = (a >= 0) & (b >= 0) & (a < b) & (coupled.data != 0)
    pairs = np.unique(np.stack([a[keep], b[keep]], axis=1), axis=0)
    if 2 * len(pairs) > FEW * len(row):
        return []
    return [(int(i), int(j)) for i, j in pairs]


def _owners(imported: Imported, row: dict[int, int]) -> IntArray:
    """Return the node, as a row of the mesh, of each row of the matrices; -1 where the table does not say."""
    owner = np.full(imported.order, -1, dtype=np.int64)
    table = imported.nodes
    there = table.row >= 0
    owner[table.row[there]] = [row[int(n)] for n in table.node[there]]
    return owner


def _of_parts(imported: Imported, row: dict[int, int]) -> IntArray:
    """Return the region of each node by the matrices of the regions: the first that has something there."""
    region = np.full(len(row), -1, dtype=np.int64)
    owner = _owners(imported, row)
    parts = imported.stiffness_parts or imported.mass_parts
    for k, part in reversed(list(enumerate(parts))):
        held = owner[np.flatnonzero(np.abs(part.diagonal()) > 0)]
        region[held[held >= 0]] = k
    return region
