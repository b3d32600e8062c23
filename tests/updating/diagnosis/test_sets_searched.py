"""How many sets of causes there are."""

from __future__ import annotations

from collections import Counter
from itertools import combinations_with_replacement

import pytest

from updating.diagnosis.search.prior import count_sets


@pytest.mark.parametrize("causes", [1, 2, 3, 4])
@pytest.mark.parametrize(("once", "repeated"), [(5, 0), (5, 2), (4, 4)])
def test_sets_are_counted_as_they_can_be_listed(causes: int, once: int, repeated: int) -> None:
    def allowed(chosen: tuple[int, ...]) -> bool:
        return all(n == 1 or (n == 2 and i < repeated) for i, n in Counter(chosen).items())

    listed = [chosen for chosen in combinations_with_replacement(range(once), causes) if allowed(chosen)]
    assert count_sets(causes, once, repeated) == len(listed)
