"""What counts as the same print of a command, on this processor and on another."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

BLOCKS = Path(__file__).resolve().parents[2] / "docs" / "_ext" / "blocks.py"


@pytest.fixture(scope="module")
def blocks() -> ModuleType:
    spec = importlib.util.spec_from_file_location("page_blocks", BLOCKS)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["page_blocks"] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("written", "printed", "alike"),
    [
        ("Sure:    95 % probable", "Sure:    94 % probable", True),
        ("Sure:    95 % probable", "Sure:    89 % probable", False),
        (
            "Cause:   E (75 %) or shear (2.4 %) or 6 more",
            "Cause:   E (78 %) or shear (1.9 %) or 5 more",
            True,
        ),
        ("Cause:   E (75 %) or shear (2.4 %)", "Cause:   E (75 %) or taper (2.4 %)", False),
        ("Closes:  27.7 % -> 0.37 %", "Closes:  26.0 % -> 0.37 %", False),
        ("separates E by 4 sigma", "separates E by 3 sigma", True),
        ("separates E by 4 sigma", "separates density by 4 sigma", False),
        ("75 hits, 0 left out", "74 hits, 0 left out", False),
        ("119.79954     0.00032", "119.79955     0.00032", True),
        ("119.79954     0.00032", "119.79974     0.00032", False),
    ],
)
def test_measurements_have_a_last_digit_and_counts_are_equal(
    blocks: ModuleType, written: str, printed: str, alike: bool
) -> None:
    assert blocks.alike(written, printed) is alike
