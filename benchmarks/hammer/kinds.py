"""All kinds of test by name."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from hammer.absorbed import absorber_test
from hammer.changing import hardening_test, odd_mounting_test, softening_test
from hammer.on_lines import averaged_test, coarse_test, fading_test
from hammer.plain import array_test, beam_test, plate_test, roving_test
from hammer.records import force_window_test, long_test
from hammer.setups import Setup

DRAWN: dict[str, Callable[[np.random.Generator], Setup]] = {
    "beam": beam_test,
    "plate": plate_test,
    "array": array_test,
    "roving": roving_test,
    "long": long_test,
    "force_window": force_window_test,
    "odd mounting": odd_mounting_test,
    "softening": softening_test,
    "hardening": hardening_test,
    "absorber": absorber_test,
    "averaged": averaged_test,
    "coarse": coarse_test,
    "fading": fading_test,
}
"""How tests of each kind are drawn. The place in the table is part of the seed: further kinds are added at its end."""
