"""What tests of models share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest
from deck_cases import EXAMPLES, Bricks


@pytest.fixture(scope="module")
def bricks(example_of: Callable[[Path, str], ModuleType]) -> Bricks:
    made: Bricks = example_of(EXAMPLES / "deck", "bricks").brick_deck
    return made
