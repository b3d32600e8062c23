"""A study that may be written beside, for every test of the app."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture
def samples(tmp_path: Path) -> Path:
    """Return a copy of the sample data that may be written to."""
    for name in ("beam_dry", "beam_joint"):
        shutil.copytree(ROOT / "sample_data" / name, tmp_path / "samples" / name)
    return tmp_path / "samples"


@pytest.fixture
def beam(samples: Path) -> Path:
    """Return the study of a beam with hits and a model."""
    return samples / "beam_dry" / "study.toml"
