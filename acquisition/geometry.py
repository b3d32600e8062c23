"""Where the nodes of a test are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from acquisition.arrays import FloatArray, frozen_array
from acquisition.errors import InputError


@dataclass(frozen=True, eq=False)
class Geometry:
    """Nodes of the test and their coordinates.

    Parameters
    ----------
    nodes : tuple of int
        Node numbers, each once.
    coordinates : (n_nodes, 3) array
        Positions in the test's axes [m].

    Raises
    ------
    InputError
        If a node number stands twice or the shapes do not agree.
    """

    nodes: tuple[int, ...]
    coordinates: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", tuple(int(n) for n in self.nodes))
        object.__setattr__(self, "coordinates", frozen_array(self.coordinates).reshape(-1, 3))
        if len(self.nodes) != len(self.coordinates):
            raise InputError(
                f"geometry has {len(self.nodes)} node numbers and {len(self.coordinates)} coordinates; "
                "give one row of x, y, z per node"
            )
        if len(set(self.nodes)) != len(self.nodes):
            twice = sorted({n for n in self.nodes if self.nodes.count(n) > 1})
            raise InputError(f"geometry defines node(s) {twice} more than once; number every node once")

    @classmethod
    def empty(cls) -> Geometry:
        """Return a geometry without nodes."""
        return cls((), np.zeros((0, 3)))

    def __contains__(self, node: int) -> bool:
        """Tell whether a node has coordinates."""
        return node in self.nodes

    def at(self, nodes: Iterable[int]) -> FloatArray:
        """Return the coordinates of some nodes, shape (n, 3) [m].

        Raises
        ------
        InputError
            If a node has no coordinates.
        """
        row = {node: i for i, node in enumerate(self.nodes)}
        wanted = list(nodes)
        missing = sorted({n for n in wanted if n not in row})
        if missing:
            raise InputError(
                f"no coordinates for node(s) {missing}; add them to data set 15 or 2411 of the test file"
            )
        return np.array(self.coordinates[[row[n] for n in wanted]]).reshape(-1, 3)
