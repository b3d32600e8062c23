"""The comparisons made last: while one specimen's parameters move, those of the others stay."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

from updating.likelihood.comparison import Comparison


@dataclass(frozen=True, eq=False)
class Recent:
    """The last comparisons by what they were made of.

    Parameters
    ----------
    most : int
        How many are kept: those about one point of a candidate, whose parameters are moved one at a time; more are
        hardly asked for again, and each is up to a megabyte.
    """

    most: int = 32

    _kept: OrderedDict[Hashable, Comparison] = field(default_factory=OrderedDict)

    def get(self, key: Hashable, make: Callable[[], Comparison]) -> Comparison:
        """Return the comparison of a key, made anew where it is not among the last ones."""
        if key not in self._kept:
            self._kept[key] = make()
            if len(self._kept) > self.most:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key]
