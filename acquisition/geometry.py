"""Where the nodes of a test are."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from acquisition.arrays import FloatArray, IntArray, frozen_array
from acquisition.display import Displayed, counted
from acquisition.dof import Dof
from acquisition.errors import InputError

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, eq=False)
class Geometry(Displayed):
    """Nodes of the test, their coordinates, and the lines that join them in drawings.

    Parameters
    ----------
    nodes : tuple of int
        Node numbers, each once.
    coordinates : (n_nodes, 3) array
        Positions in the test's axes [m].
    lines : (n_lines, 2) int array, optional
        Pairs of node numbers to be joined in drawings.
    axes : (n_nodes, 3, 3) array, optional
        Rows are the axes, in the test's axes, in which the directions of a node are meant [-]; only where
        some node is turned by other than right angles (see `direction`).

    Raises
    ------
    InputError
        If a node number is given twice, the shapes do not agree, or a line ends at a node that does not exist.
    """

    nodes: tuple[int, ...]
    coordinates: FloatArray
    lines: IntArray = field(default_factory=lambda: np.zeros((0, 2), dtype=np.int64))
    axes: FloatArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "nodes", tuple(int(n) for n in self.nodes))
        object.__setattr__(self, "coordinates", frozen_array(self.coordinates).reshape(-1, 3))
        object.__setattr__(self, "lines", frozen_array(self.lines, np.int64).reshape(-1, 2))
        if self.axes is not None:
            object.__setattr__(self, "axes", frozen_array(self.axes).reshape(-1, 3, 3))
        self._check()

    def _check(self) -> None:
        if len(self.nodes) != len(self.coordinates):
            raise InputError(
                f"geometry has {len(self.nodes)} node numbers and {len(self.coordinates)} coordinates; "
                "give one row of x, y, z per node"
            )
        if self.axes is not None and len(self.axes) != len(self.nodes):
            raise InputError(f"geometry has {len(self.nodes)} nodes and axes for {len(self.axes)} of them")
        known = set(self.nodes)
        if len(known) != len(self.nodes):
            twice = sorted({n for n in self.nodes if self.nodes.count(n) > 1})
            raise InputError(f"geometry defines node(s) {twice} more than once; number every node once")
        strange = sorted(set(self.lines.ravel().tolist()) - known)
        if strange:
            raise InputError(f"geometry has lines to node(s) {strange[:5]}, which have no coordinates")

    @classmethod
    def empty(cls) -> Geometry:
        """Return a geometry without nodes."""
        return cls((), np.zeros((0, 3)))

    def __contains__(self, node: int) -> bool:
        """Return whether a node has coordinates."""
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
                f"no coordinates for node(s) {missing}; state them as places in the study's [test], or add them to "
                "data set 15 or 2411 of the test file, or to a table of modes as rows x, y, z in place of a frequency"
            )
        return np.array(self.coordinates[[row[n] for n in wanted]]).reshape(-1, 3)

    def direction(self, dof: Dof) -> FloatArray:
        """Return the signed direction of a translation in the test's axes, shape (3,) [-].

        It is that of the direction code, unless the node has axes of its own; zero for rotations and scalars.
        """
        if self.axes is None or dof.node not in self.nodes:
            return dof.unit_vector
        return np.asarray(dof.unit_vector @ self.axes[self.nodes.index(dof.node)], dtype=np.float64)

    def table(self) -> pd.DataFrame:
        """Return one row per node: its coordinates [m]."""
        import pandas as pd

        index = pd.Index(self.nodes, name="node")
        return pd.DataFrame(np.array(self.coordinates), index, ["x [m]", "y [m]", "z [m]"])

    def _headline(self) -> str:
        lines = f", {counted(len(self.lines), 'line')}" if len(self.lines) else ""
        return counted(len(self.nodes), "node") + lines
