"""The comparisons made last: while one specimen's parameters move, those of the others stay."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field

from updating.likelihood.comparison import Comparison
from updating.thresholds import COMPARISONS_KEPT


@dataclass(frozen=True, eq=False)
class Recent:
    """The last comparisons by what they were made of."""

    _kept: OrderedDict[Hashable, Comparison] = field(default_factory=OrderedDict)

    def get(self, key: Hashable, make: Callable[[], Comparison]) -> Comparison:
        """Return the comparison of a key, made anew where it is not among the last ones."""
        if key not in self._kept:
            self._kept[key] = make()
            if len(self._kept) > COMPARISONS_KEPT:
                self._kept.popitem(last=False)
        self._kept.move_to_end(key)
        return self._kept[key]
