"""Two modes at the very same frequency, as square plates have them."""

from __future__ import annotations

import numpy as np
from identification_cases import lines, structure

from identification import identify


def test_two_modes_at_one_frequency_are_warned_of():
    truth = structure((60.0, 120.0, 120.0, 200.0), (0.004, 0.003, 0.003, 0.004), 12, seed=5)
    pairs = [(i, j) for j in (4, 8) for i in range(1, 13)]
    frfs = truth.frfs(lines(df=0.25, high=300.0), pairs, noise=0.005, rng=np.random.default_rng(1))
    assert any("two modes at the very same frequency" in w for w in identify(frfs).warnings)
