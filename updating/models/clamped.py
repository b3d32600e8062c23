"""The columns of a reduced basis that a structure needs while its clamps hold."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

from acquisition.arrays import FloatArray
from updating.models.reduced import Reduced


@dataclass(frozen=True, eq=False)
class Clamped(Reduced):
    """A structure on the leading columns of a reduced basis, on which no clamp can be released.

    Parameters
    ----------
    structure, basis, ranks, changes
        As of :class:`Reduced`.
    released : Reduced
        The same structure on all columns.
    """

    released: Reduced = field(kw_only=True)

    @classmethod
    def of(cls, reduced: Reduced, *, worthwhile: float = 0.7) -> Reduced:
        """Return a model on its clamped columns; itself where these are more than a share ``worthwhile`` of all [-].

        Work goes with the square. A clamped plate keeps a third of its columns, a beam nine tenths.
        """
        n, held = reduced.ranks[frozenset()], frozenset[str]()
        if reduced.whole or n > worthwhile * reduced.basis.shape[1]:
            return reduced
        changes = tuple(replace(one, matrix=one.matrix[:n, :n]) for one in reduced.changes)
        return cls(reduced.structure, reduced.basis[:, :n], {held: n}, changes, released=reduced)

    @cached_property
    def parts(self) -> tuple[FloatArray, ...]:
        """Matrix of every term and region, see :attr:`Reduced.parts`."""
        n = self.basis.shape[1]
        return tuple(part[:, :n, :n] for part in self.released.parts)

    @cached_property
    def point_masses(self) -> FloatArray:
        """Matrix of the masses stated by the modeller, see :attr:`Reduced.point_masses`."""
        n = self.basis.shape[1]
        return self.released.point_masses[:n, :n]
