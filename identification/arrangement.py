"""How the FRFs of a set form a matrix of responses by references."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from acquisition.arrays import ComplexArray, FloatArray, IntArray
from acquisition.dof import Dof
from acquisition.frfs.frf import FrfSet


@dataclass(frozen=True, eq=False)
class Arrangement:
    """The FRFs as a matrix with few columns, by reciprocity whichever side is the shorter.

    Parameters
    ----------
    rows, columns : tuple of Dof
        Degrees of freedom of the long and of the short side, directions positive.
    index : (n_rows, n_columns) int array
        Row number of each FRF in the set; -1 where it was not measured.
    transposed : bool
        True if the columns are the set's responses (a roving hammer).
    """

    rows: tuple[Dof, ...]
    columns: tuple[Dof, ...]
    index: IntArray
    transposed: bool

    @property
    def complete_rows(self) -> IntArray:
        """Rows measured against every column, shape (n,) int."""
        return np.flatnonzero((self.index >= 0).all(axis=1))


@lru_cache(maxsize=4096)
def unsigned(dof: Dof) -> Dof:
    """Return the same degree of freedom in its positive direction."""
    return Dof(dof.node, abs(dof.direction))


def signs(frfs: FrfSet) -> FloatArray:
    """Return sign(response) sign(reference) of each FRF, shape (n_frf,) [-]."""
    pairs = zip(frfs.responses, frfs.references, strict=True)
    return np.array([float(a.sign * b.sign) for a, b in pairs])


def arrange(frfs: FrfSet) -> Arrangement:
    """Sort the FRFs into a matrix; a pair of degrees of freedom that is given twice keeps its last FRF."""
    return _arranged(frfs.responses, frfs.references)


@lru_cache(maxsize=8)
def _arranged(named: tuple[Dof, ...], excited: tuple[Dof, ...]) -> Arrangement:
    """Return the arrangement of FRFs by their degrees of freedom, which an identification asks for often."""
    responses = tuple(unsigned(d) for d in named)
    references = tuple(unsigned(d) for d in excited)
    transposed = len(set(responses)) < len(set(references))
    long, short = (references, responses) if transposed else (responses, references)
    rows, columns = tuple(dict.fromkeys(long)), tuple(dict.fromkeys(short))
    row, column = {d: i for i, d in enumerate(rows)}, {d: i for i, d in enumerate(columns)}
    index = np.full((len(rows), len(columns)), -1, dtype=np.int64)
    index[[row[d] for d in long], [column[d] for d in short]] = np.arange(len(long))
    index.setflags(write=False)
    return Arrangement(rows, columns, index, transposed)


def matrix_form(frfs: FrfSet, scale: FloatArray) -> ComplexArray:
    """Return scaled FRFs as (n_rows, n_columns, n_lines), signs of directions applied.

    One factor per row and per column keeps the matrix fraction exact. If fewer than half of the FRFs stand
    in complete rows, all are stacked in a single column: a common denominator, which is always right.
    """
    plan = arrange(frfs)
    values = frfs.values * signs(frfs)[:, None]
    complete = plan.complete_rows
    if len(plan.columns) == 1 or len(complete) * len(plan.columns) * 2 < len(scale):
        return np.asarray((values * scale[:, None])[:, None, :])
    index = plan.index[complete]
    level = np.sqrt(np.mean(1.0 / scale[index] ** 2, axis=1))
    return np.asarray(values[index] / level[:, None, None])
